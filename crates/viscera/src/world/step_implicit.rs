use super::step::{MOST_PARTS, Motion, most_deformed_cell, moving};
use super::{StepError, World};
use crate::dynamics::Drive;
use crate::dynamics::implicit::{self, Implicit, ImplicitReport, Interval, Newton, Refused, Scheme};
use crate::dynamics::tied::Together;
use crate::instrument::Span;
use crate::math::{Scalar, Vec3};
use crate::stage::{Stage, Stages};

/// How often a step that is not solved, or that throws tissue across a hump, is made again in twice as many parts.
const MOST_DIVISIONS: u32 = 6;

/// A body whose step is not to be taken, why, and what its solver did.
type Refusal = (usize, Refused, ImplicitReport);

impl<T: Scalar> World<T> {
    /// Moves the bodies by one implicit step. A linear solve that ended early is reported. Full equations that are not solved are those of
    /// too long a step from where the tissue is: half of it has a solution nearer by, and the step is made again in twice as many parts.
    /// So are steps that leave the numbers that there are, and those that gain energy as their scheme does not. The shortest parts are taken
    /// linearised where forces have no potential and full equations still no solution, and with a gain that linearised ones still have, short of
    /// ten times the energy before it where there is a potential.
    pub(super) fn move_implicitly(
        &mut self,
        span: &Span,
        settings: &Implicit,
        stages: Stages,
    ) -> Result<Motion, StepError> {
        let mut retries = 0;
        loop {
            let parts = stages.run(Stage::Instruments, || self.approach_in_time(span)) << retries;
            let is_last = retries == MOST_DIVISIONS;
            let (report, refused) = self.advance_implicitly(span, settings, (parts, is_last), stages);
            let within = stages.run(Stage::Guard, || self.bodies.iter().all(|body| body.is_within_bounds()));
            if within && refused.is_none() {
                return Ok(Motion { substeps: parts, retries, implicit: Some(report) });
            }
            self.undo();
            if is_last {
                return Err(refused
                    .filter(|_| within)
                    .map_or_else(|| self.diverged(), |refused| self.refusal(refused, settings)));
            }
            retries += 1;
        }
    }

    /// Moves all bodies by equal parts of the step, in the last attempt or one before; gives what the solvers did, and the first body whose
    /// step is not to be taken.
    fn advance_implicitly(
        &mut self,
        span: &Span,
        settings: &Implicit,
        (parts, is_last): (u32, bool),
        stages: Stages,
    ) -> (ImplicitReport, Option<Refusal>) {
        let gravity = Vec3::from(self.config.gravity).cast();
        let (mut report, mut refused) = (ImplicitReport::NOTHING, None);
        self.begin_attachments();
        let share = |part: u32| f64::from(part) / f64::from(parts);
        for part in 0..parts {
            stages.run(Stage::Instruments, || self.move_tools(span, share(part), share(part + 1)));
            let (from, end) =
                (span.at(share(part)), if part + 1 == parts { span.to } else { span.at(share(part + 1)) });
            let drive = Drive { end, frames: &self.motion.frames, rods: &self.motion.rods, gravity };
            let dt = self.config.step / f64::from(parts);
            let interval = Interval { from, dt, is_first: part == 0, drive: &drive };
            // A scheme over two steps knows steps of one length.
            self.bodies.iter_mut().for_each(|body| body.state.past.is_known &= parts == 1);
            for number in 0..self.bodies.len() {
                let Some(together) = Together::led_by(number, &mut self.tied) else { continue };
                if !self.bodies[number].moves() {
                    continue;
                }
                let all = (&mut self.bodies[..], &mut self.implicit[..]);
                let (own, why) =
                    stages.run(Stage::Newton, || implicit::advance(all, together, settings, interval, is_last, stages));
                refused = refused.or(why.map(|why| (number, why, own)));
                report = report.worst(own);
            }
            self.bodies.iter_mut().for_each(|body| body.state.past.is_known &= parts == 1);
            for tied in &self.tied {
                tied.each_impulse(|number, impulse| self.attachments[number].impulse += impulse);
            }
            if refused.is_some() {
                break;
            }
        }
        (report, refused)
    }

    /// Lets instruments take hold or let go, and has all tissue looked at that is near one that touches; gives in how many parts the
    /// step is divided, so that none of those goes farther than its radius in one.
    fn approach_in_time(&mut self, span: &Span) -> u32 {
        self.lead_tools(span);
        let (way, ratio) = self.survey_tools(span);
        if self.motion.rods.is_empty() {
            self.bodies.iter_mut().for_each(|body| body.contacts.forget());
            return 1;
        }
        let mut near = false;
        for body in moving(&mut self.bodies) {
            let coast = body.fastest_node() * self.config.step + way;
            near |= body.contacts.gather(&self.motion.rods, body.skin.numbered(), &body.state.positions, coast);
            // What is pushed pushes its neighbours: all of the surface may come to touch.
            body.contacts.gather(&self.motion.rods, body.skin.numbered(), &body.state.positions, f64::INFINITY);
        }
        if near { ratio.ceil().clamp(1.0, MOST_PARTS) as u32 } else { 1 }
    }

    fn refusal(&self, (number, why, report): Refusal, settings: &Implicit) -> StepError {
        let (time, body) = (self.time(), &self.bodies[number]);
        let (name, law) = (body.name.clone(), body.law());
        match why {
            Refused::Unsolved => {
                let (iterations, residual) = (report.newton_iterations, report.residual);
                StepError::NotConverged { time, body: name, law, iterations, residual }
            }
            Refused::GainedEnergy => {
                let (cell, stretch) = most_deformed_cell(body);
                let advice = match (settings.scheme, settings.newton) {
                    (Scheme::BackwardEuler, Newton::Linearised) => "solve it in full",
                    (Scheme::BackwardEuler, Newton::Full { .. }) => "the linearised one",
                    _ => "backward Euler",
                };
                StepError::GainedEnergy { time, body: name, law, cell, stretch, advice }
            }
        }
    }
}
