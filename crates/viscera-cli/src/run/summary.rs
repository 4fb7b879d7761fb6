//! The numbers of a run, as JSON.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use viscera_io::write::{WriteError, write_atomically};
use viscera_scene::file::Precision;

use super::folder::Folder;

/// What a run came to. Every name carries its unit.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Summary {
    pub(super) program: String,
    pub(super) scene: String,
    pub(super) title: Option<String>,
    /// Whether the user stopped it.
    pub(super) interrupted: bool,
    /// Why a step could not be made, if one could not.
    pub(super) failure: Option<String>,
    pub(super) precision: Precision,
    #[serde(rename = "simulated_time_s")]
    pub(super) simulated_time: f64,
    #[serde(rename = "duration_s")]
    pub(super) duration: f64,
    #[serde(rename = "step_s")]
    pub(super) step: f64,
    pub(super) steps: u64,
    pub(super) substeps: u64,
    pub(super) fewest_substeps_of_a_step: u32,
    pub(super) most_substeps_of_a_step: u32,
    /// Times that a step was made again with more substeps, because the tissue stiffened on the way.
    pub(super) retries: u64,
    pub(super) integrator: &'static str,
    /// What the implicit integrator took; nothing for the explicit one.
    pub(super) implicit: Option<ImplicitResult>,
    #[serde(rename = "stable_step_at_start_s")]
    pub(super) stable_step_at_start: f64,
    #[serde(rename = "stable_step_at_end_s")]
    pub(super) stable_step_at_end: f64,
    /// Time that stepping took, without writing.
    #[serde(rename = "computing_time_s")]
    pub(super) computing_time: f64,
    #[serde(rename = "wall_time_s")]
    pub(super) wall_time: f64,
    /// Simulated time over computing time: above 1 is faster than real time.
    pub(super) real_time_factor: f64,
    pub(super) cells: usize,
    pub(super) removed_cells: usize,
    pub(super) bodies: Vec<BodyResult>,
    pub(super) instruments: Vec<InstrumentResult>,
    /// The folder and its files, for the screen.
    #[serde(skip)]
    pub(super) files: (PathBuf, Vec<String>),
}

/// What the solver of implicit steps did over the run. Of several bodies, the one that took most counts in each step.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct ImplicitResult {
    pub(super) newton_iterations: u64,
    pub(super) linear_iterations: u64,
    pub(super) most_linear_iterations_of_a_step: u32,
    /// Steps whose linear solve ended above its tolerance.
    pub(super) steps_not_converged: u64,
    /// Steps that met a direction in which the tissue gives way by itself.
    pub(super) steps_of_negative_curvature: u64,
}

/// What became of a body.
#[derive(Clone, Debug, Serialize)]
pub(super) struct BodyResult {
    pub(super) name: String,
    pub(super) model: String,
    pub(super) law: String,
    pub(super) nodes: usize,
    /// Cells at the start.
    pub(super) cells: usize,
    pub(super) removed_cells: usize,
    pub(super) inverted_cells: usize,
    /// The most at a time.
    pub(super) peak_inverted_cells: usize,
    /// Which of them stay so at the end, and what to do about it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) inside_out: Option<String>,
    /// Shape of the worst cell at the end: 1 regular, 0 flat, negative inverted.
    pub(super) worst_quality: f64,
    /// The worst over the run.
    pub(super) lowest_quality: f64,
    /// Largest sum of the internal forces: rounding, where the model keeps Newton's third law.
    #[serde(rename = "peak_net_internal_force_N")]
    pub(super) peak_net_internal_force: f64,
    /// Largest torque of the internal forces about the centre of mass: rounding, where the model keeps angular momentum.
    #[serde(rename = "peak_net_internal_torque_Nm")]
    pub(super) peak_net_internal_torque: f64,
    /// Nodes of cells that are left.
    pub(super) nodes_left: usize,
    pub(super) nonlinear_nodes: usize,
    #[serde(rename = "mass_kg")]
    pub(super) mass: f64,
    #[serde(rename = "volume_m3")]
    pub(super) volume: f64,
    /// (V − V0)/V0 at the end, of the cells that are left.
    pub(super) volume_variation: f64,
    /// The one farthest from zero over the run, with its sign.
    pub(super) peak_volume_variation: f64,
    #[serde(rename = "max_displacement_m")]
    pub(super) max_displacement: f64,
    #[serde(rename = "peak_max_displacement_m")]
    pub(super) peak_max_displacement: f64,
    #[serde(rename = "kinetic_energy_J")]
    pub(super) kinetic_energy: f64,
    #[serde(rename = "elastic_energy_J")]
    pub(super) elastic_energy: f64,
    #[serde(rename = "gravity_energy_J")]
    pub(super) gravity_energy: f64,
    #[serde(rename = "reaction_N")]
    pub(super) reaction: [f64; 3],
    pub(super) at_rest: bool,
    #[serde(rename = "stable_step_at_end_s")]
    pub(super) stable_step: f64,
}

/// What an instrument did.
#[derive(Clone, Debug, Serialize)]
pub(super) struct InstrumentResult {
    pub(super) name: String,
    pub(super) kind: String,
    #[serde(rename = "peak_force_N")]
    pub(super) peak_force: f64,
    #[serde(rename = "time_of_peak_force_s")]
    pub(super) time_of_peak_force: f64,
    /// The most nodes that it held at a time.
    pub(super) held_nodes: usize,
}

impl Summary {
    /// Writes `summary.json`.
    pub(super) fn write(&self, folder: &Folder) -> Result<(), WriteError> {
        write_atomically(folder.file("summary.json"), |out| {
            serde_json::to_writer_pretty(&mut *out, self)?;
            writeln!(out)
        })
    }

    /// The summary with the files that were written.
    pub(super) fn with_files(mut self, folder: &Path, files: Vec<String>) -> Self {
        self.files = (folder.to_owned(), files);
        self
    }
}
