//! What is counted while a run goes: extremes, and what the solver did.

use serde::{Deserialize, Serialize};
use viscera::math::Scalar;
use viscera::world::{BodyObservables, StepReport};
use viscera_scene::BuiltScene;

use super::Ending;
use super::observables::Measured;
use super::summary::{BodyResult, ImplicitResult, InstrumentResult, Summary};

/// Extremes over the run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Tally {
    scene: String,
    stable_step_at_start: f64,
    substeps: u64,
    fewest: u32,
    most: u32,
    retries: u64,
    steps: u64,
    implicit: Option<ImplicitResult>,
    bodies: Vec<BodyTally>,
    /// Of each instrument: the peak force [N], when it was [s], most held nodes.
    instruments: Vec<(f64, f64, usize)>,
}

/// Extremes of a body.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct BodyTally {
    /// The one farthest from zero.
    volume_variation: f64,
    /// The largest [m].
    displacement: f64,
    /// The most.
    inverted_cells: usize,
    /// The lowest.
    quality: f64,
    /// The largest [N].
    net_force: f64,
    /// The largest [N m].
    net_torque: f64,
    /// What was measured last.
    last: BodyObservables,
}

impl BodyTally {
    fn new(first: &BodyObservables) -> Self {
        Self {
            volume_variation: 0.0,
            displacement: 0.0,
            inverted_cells: 0,
            quality: first.worst_quality,
            net_force: 0.0,
            net_torque: 0.0,
            last: *first,
        }
    }

    fn observe(&mut self, now: &BodyObservables) {
        if now.volume_variation.abs() > self.volume_variation.abs() {
            self.volume_variation = now.volume_variation;
        }
        self.displacement = self.displacement.max(now.max_displacement);
        self.inverted_cells = self.inverted_cells.max(now.inverted_cells);
        self.quality = self.quality.min(now.worst_quality);
        self.net_force = self.net_force.max(now.net_internal_force.norm());
        self.net_torque = self.net_torque.max(now.net_internal_torque.norm());
        self.last = *now;
    }
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
            implicit: None,
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
        if let Some(step) = report.implicit {
            let implicit = self.implicit.get_or_insert_default();
            implicit.newton_iterations += u64::from(step.newton_iterations);
            implicit.linear_iterations += u64::from(step.linear_iterations);
            implicit.most_linear_iterations_of_a_step =
                implicit.most_linear_iterations_of_a_step.max(step.linear_iterations);
            implicit.steps_not_converged += u64::from(!step.converged);
            implicit.steps_of_negative_curvature += u64::from(step.negative_curvature);
        }
    }

    /// Takes in what was measured.
    pub(super) fn observe<T: Scalar>(&mut self, built: &BuiltScene<T>, measured: &Measured) {
        if self.bodies.is_empty() {
            self.bodies = measured.bodies.iter().map(BodyTally::new).collect();
        }
        for (tally, now) in self.bodies.iter_mut().zip(&measured.bodies) {
            tally.observe(now);
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
        &self,
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
            .map(|((name, &id), tally)| {
                let (body, last) = (world.body(id), &tally.last);
                BodyResult {
                    name: name.clone(),
                    model: body.model().to_string(),
                    law: body.law().to_owned(),
                    nodes: body.mesh().nodes().len(),
                    cells: body.mesh().cell_count(),
                    removed_cells: last.removed_cells,
                    inverted_cells: last.inverted_cells,
                    peak_inverted_cells: tally.inverted_cells,
                    inside_out: last.inside_out.map(|cells| cells.to_string()),
                    worst_quality: last.worst_quality,
                    lowest_quality: tally.quality,
                    peak_net_internal_force: tally.net_force,
                    peak_net_internal_torque: tally.net_torque,
                    nodes_left: body.state().cells_at_node.iter().filter(|&&cells| cells > 0).count(),
                    nonlinear_nodes: last.nonlinear_nodes,
                    mass: last.mass,
                    volume: last.volume,
                    volume_variation: last.volume_variation,
                    peak_volume_variation: tally.volume_variation,
                    max_displacement: last.max_displacement,
                    peak_max_displacement: tally.displacement,
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
            scene: self.scene.clone(),
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
            integrator: built.file.integrator.kind.name(),
            implicit: self.implicit,
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
