use super::step::Motion;
use super::{StepError, World};
use crate::dynamics::Drive;
use crate::dynamics::implicit::{self, Implicit, ImplicitReport, Newton};
use crate::instrument::Span;
use crate::math::{Scalar, Vec3};
use crate::stage::{Stage, Stages};

impl<T: Scalar> World<T> {
    /// Moves the bodies by one implicit step. A linear solve that ended early is reported; a full solve that did not balance
    /// the forces is an error.
    pub(super) fn move_implicitly(
        &mut self,
        span: &Span,
        settings: &Implicit,
        stages: Stages,
    ) -> Result<Motion, StepError> {
        stages.run(Stage::Instruments, || {
            self.grip(span);
            self.move_tips(span.to);
        });
        let drive = Drive { end: span.to, tips: &self.tips, gravity: Vec3::from(self.config.gravity).cast() };
        let mut report = ImplicitReport::NOTHING;
        let mut failed = None;
        for (number, (body, memory)) in self.bodies.iter_mut().zip(&mut self.implicit).enumerate() {
            let own = stages.run(Stage::Newton, || {
                implicit::advance(body, memory, settings, span.from, self.config.step, &drive, stages)
            });
            if !own.converged && settings.newton != Newton::Linearised {
                failed = failed.or(Some((number, own)));
            }
            report = report.worst(own);
        }
        if !stages.run(Stage::Guard, || self.bodies.iter().all(|body| body.is_within_bounds())) {
            self.undo();
            return Err(self.diverged());
        }
        match failed {
            Some((number, own)) => Err(self.not_converged(number, &own)),
            None => Ok(Motion { substeps: 1, retries: 0, implicit: Some(report) }),
        }
    }

    fn not_converged(&self, body: usize, report: &ImplicitReport) -> StepError {
        let body = &self.bodies[body];
        StepError::NotConverged {
            time: self.time(),
            body: body.name.clone(),
            law: body.law(),
            iterations: report.newton_iterations,
            residual: report.residual,
        }
    }
}
