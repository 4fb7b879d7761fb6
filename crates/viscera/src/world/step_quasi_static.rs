use super::step::{Motion, moving};
use super::{StepError, World};
use crate::body::{NodeMotion, SimulatedBody};
use crate::contact::ToolFrame;
use crate::dynamics::Drive;
use crate::dynamics::implicit::ImplicitReport;
use crate::dynamics::quasi_static::{Bodies, QuasiStatic, StaticReport};
use crate::dynamics::tied::Together;
use crate::instrument::Span;
use crate::math::{Scalar, Vec3};
use crate::solver::LinearSolver;
use crate::stage::{Stage, Stages};

impl<T: Scalar> World<T> {
    /// Brings the bodies into the equilibrium of the end of the step, from that of its beginning; at small strain, from rest. Memory is
    /// asked for on the way, other than in steps of motion.
    pub(super) fn move_statically(
        &mut self,
        span: &Span,
        settings: &QuasiStatic,
        stages: Stages,
    ) -> Result<Motion, StepError> {
        stages.run(Stage::Instruments, || {
            self.lead_tools(span);
            self.move_tools(span, 0.0, 1.0);
        });
        self.begin_attachments();
        let gravity = Vec3::from(self.config.gravity).cast();
        let drive = Drive { end: span.to, frames: &self.motion.frames, rods: &self.motion.rods, gravity };
        if settings.small_strain {
            for body in moving(&mut self.bodies) {
                body.state.positions.clone_from(&body.rest);
                body.state.positions_changed();
            }
        }
        let (mut report, mut retries) = (ImplicitReport::NOTHING, 0);
        for number in 0..self.bodies.len() {
            let Some(mut together) = Together::led_by(number, &mut self.tied) else { continue };
            if !self.bodies[number].moves() {
                continue;
            }
            let mut of_ties;
            let (bodies, solver): (_, &mut dyn LinearSolver) = match &mut together {
                Together::Alone(number) => (Bodies::alone(&mut self.bodies[*number]), self.static_solver.as_mut()),
                Together::Tied(tied) => {
                    let bodies;
                    (bodies, of_ties) = Bodies::tied(tied, &mut self.bodies);
                    (bodies, &mut of_ties)
                }
            };
            let found = stages.run(Stage::Newton, || {
                let target = |body: &_, node: usize| drive.target(body, node, body.state.positions[node]);
                settings.solve_driven(bodies, gravity, span.to, target, solver)
            });
            if let Together::Tied(tied) = together {
                tied.each_force(|number, force| self.attachments[number].impulse += force * self.config.step);
            }
            match found {
                Ok(own) => {
                    report = report.worst(summary(&own));
                    retries = own.retries.max(retries);
                }
                Err(error) => return Err(StepError::NoEquilibrium { time: span.from, error }),
            }
        }
        for body in moving(&mut self.bodies) {
            account_for_holding(body, &self.motion.frames, span.to - span.from);
        }
        Ok(Motion { substeps: 1, retries: retries as u32, implicit: Some(report) })
    }
}

/// Writes down what carries the held nodes: what the internal forces have more than the external ones.
fn account_for_holding<T: Scalar>(body: &mut SimulatedBody<T>, frames: &[ToolFrame], duration: f64) {
    for node in 0..body.state.motions.len() {
        let NodeMotion::Held(tool) = body.state.motions[node] else { continue };
        let impulse = (body.state.internal_forces[node] - body.external_forces[node]).cast::<f64>() * duration;
        let lever = body.state.positions[node].cast::<f64>() - frames[tool as usize].tip.1;
        let load = &mut body.contacts.loads[tool as usize];
        load.holding += impulse;
        load.holding_moment += lever.cross(impulse);
    }
}

fn summary(report: &StaticReport) -> ImplicitReport {
    let residual = report.steps.last().and_then(|step| step.residuals.last().copied()).unwrap_or(0.0);
    ImplicitReport { newton_iterations: report.iterations() as u32, residual, ..ImplicitReport::NOTHING }
}
