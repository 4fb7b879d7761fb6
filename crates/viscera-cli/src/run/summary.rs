//! The numbers of a run, as JSON.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;
use viscera::math::Scalar;
use viscera::world::{BodyObservables, StepReport};
use viscera_io::write::{WriteError, write_atomically};
use viscera_scene::BuiltScene;
use viscera_scene::file::Precision;

use super::Ending;
use super::folder::Folder;
use super::observables::Measured;

/// What a run came to. Every name carries its unit.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Summary {
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

/// Extremes over the run.
pub(super) struct Tally {
    scene: String,
    stable_step_at_start: f64,
    substeps: u64,
    fewest: u32,
    most: u32,
    retries: u64,
    steps: u64,
    /// Of each body: the volume variation farthest from zero, the largest displacement [m], and the last observables.
    bodies: Vec<(f64, f64, BodyObservables)>,
    /// Of each instrument: the peak force [N], when it was [s], most held nodes.
    instruments: Vec<(f64, f64, usize)>,
}

impl Tally {
    pub(super) fn new<T: Scalar>(scene: &str, built: &BuiltScene<T>) -> Self {
        Self {
            scene: scene.to_owned(),
            stable_step_at_start: stable_step(built),
            substeps: 0,
            fewest: u32::MAX,
            most: 0,
            retries: 0,
            steps: 0,
            bodies: Vec::new(),
            instruments: vec![(0.0, 0.0, 0); built.instruments.len()],
        }
    }

    /// Counts a step.
    pub(super) fn count(&mut self, report: &StepReport) {
        self.steps += 1;
        self.substeps += u64::from(report.substeps);
        self.retries += u64::from(report.retries);
        self.fewest = self.fewest.min(report.substeps);
        self.most = self.most.max(report.substeps);
    }

    /// Takes in what was measured.
    pub(super) fn observe<T: Scalar>(&mut self, built: &BuiltScene<T>, measured: &Measured) {
        self.bodies.resize_with(measured.bodies.len(), || (0.0, 0.0, measured.bodies[0]));
        for ((variation, displacement, last), now) in self.bodies.iter_mut().zip(&measured.bodies) {
            if now.volume_variation.abs() > variation.abs() {
                *variation = now.volume_variation;
            }
            *displacement = displacement.max(now.max_displacement);
            *last = *now;
        }
        for ((force, time, held), now) in self.instruments.iter_mut().zip(&measured.instruments) {
            if now.force.norm() > *force {
                (*force, *time) = (now.force.norm(), built.world.time());
            }
            *held = now.held_nodes.max(*held);
        }
    }

    /// The summary of all.
    pub(super) fn summary<T: Scalar>(
        self,
        built: &BuiltScene<T>,
        ending: &Ending,
        computing_time: f64,
        wall_time: f64,
    ) -> Summary {
        let world = &built.world;
        let bodies: Vec<BodyResult> = built
            .bodies
            .iter()
            .zip(&self.bodies)
            .map(|((name, &id), (variation, displacement, last))| {
                let body = world.body(id);
                BodyResult {
                    name: name.clone(),
                    model: body.model().to_string(),
                    law: body.law().to_owned(),
                    nodes: body.mesh().nodes().len(),
                    cells: body.mesh().cell_count(),
                    removed_cells: last.removed_cells,
                    inverted_cells: last.inverted_cells,
                    nodes_left: body.state().cells_at_node.iter().filter(|&&cells| cells > 0).count(),
                    nonlinear_nodes: last.nonlinear_nodes,
                    mass: last.mass,
                    volume: last.volume,
                    volume_variation: last.volume_variation,
                    peak_volume_variation: *variation,
                    max_displacement: last.max_displacement,
                    peak_max_displacement: *displacement,
                    kinetic_energy: last.kinetic_energy,
                    elastic_energy: last.elastic_energy,
                    gravity_energy: last.gravity_energy,
                    reaction: last.reaction.to_array(),
                    at_rest: last.at_rest,
                    stable_step: body.stable_step(),
                }
            })
            .collect();
        let instruments = built.instruments.iter().zip(&self.instruments).map(|((name, &id), &(force, time, held))| {
            InstrumentResult {
                name: name.clone(),
                kind: world.instrument(id).kind().to_owned(),
                peak_force: force,
                time_of_peak_force: time,
                held_nodes: held,
            }
        });
        let failure = match ending {
            Ending::Failed(why) => Some(why.clone()),
            Ending::Complete | Ending::Interrupted => None,
        };
        Summary {
            program: concat!("viscera ", env!("CARGO_PKG_VERSION")).to_owned(),
            scene: self.scene,
            title: built.file.title.clone(),
            interrupted: *ending == Ending::Interrupted,
            failure,
            precision: built.file.precision,
            simulated_time: world.time(),
            duration: built.file.duration.0,
            step: world.config().step,
            steps: self.steps,
            substeps: self.substeps,
            fewest_substeps_of_a_step: self.fewest.min(self.most),
            most_substeps_of_a_step: self.most,
            retries: self.retries,
            stable_step_at_start: self.stable_step_at_start,
            stable_step_at_end: stable_step(built),
            computing_time,
            wall_time,
            real_time_factor: world.time() / computing_time,
            cells: bodies.iter().map(|body| body.cells).sum(),
            removed_cells: bodies.iter().map(|body| body.removed_cells).sum(),
            bodies,
            instruments: instruments.collect(),
            files: Default::default(),
        }
    }
}

/// The longest step that is stable for every body [s].
fn stable_step<T: Scalar>(built: &BuiltScene<T>) -> f64 {
    built.bodies.values().map(|&id| built.world.body(id).stable_step()).fold(f64::INFINITY, f64::min)
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
