use super::parts::{DIVISIONS, PATIENT, Parts};
use super::step::{MOST_PARTS, Motion, most_deformed_cell, moving};
use super::{StepError, World};
use crate::dynamics::Drive;
use crate::dynamics::implicit::{self, Implicit, ImplicitReport, Interval, Newton, Refused, Scheme};
use crate::dynamics::tied::Together;
use crate::instrument::Span;
use crate::math::{Scalar, Vec3};
use crate::stage::{Stage, Stages};

/// A body whose step is not to be taken, why, and what its solver did.
type Refusal = (usize, Refused, ImplicitReport);

impl<T: Scalar> World<T> {
    /// Moves the bodies by one implicit step. A linear solve that ended early is reported. Full equations that are not solved are those of
    /// too long a step from where the tissue is: half of it has a solution nearer by, and the step is made again [in parts](DIVISIONS).
    /// So are steps that leave the numbers that there are, and those that gain energy as their scheme does not. The 64th parts and shorter ones are taken
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
            let parts = stages.run(Stage::Instruments, || self.approach_in_time(span));
            let parts = Parts::new(parts, DIVISIONS[retries]);
            let (report, refused) = self.advance_implicitly(span, settings, (parts, retries >= PATIENT), stages);
            let within = stages.run(Stage::Guard, || self.bodies.iter().all(|body| body.is_within_bounds()));
            if within && refused.is_none() {
                let (substeps, retries) = (parts.count(), retries as u32);
                return Ok(Motion { substeps, retries, implicit: Some(report) });
            }
            self.undo();
            retries += 1;
            if retries == DIVISIONS.len() {
                return Err(refused
                    .filter(|_| within)
                    .map_or_else(|| self.diverged(), |refused| self.refusal(refused, settings)));
            }
        }
    }

    /// Moves all bodies by the parts of the step, patiently or not; gives what the solvers did, and the first body whose
    /// step is not to be taken.
    fn advance_implicitly(
        &mut self,
        span: &Span,
        settings: &Implicit,
        (parts, is_patient): (Parts, bool),
        stages: Stages,
    ) -> (ImplicitReport, Option<Refusal>) {
        let gravity = Vec3::from(self.config.gravity).cast();
        let (mut report, mut refused) = (ImplicitReport::NOTHING, None);
        self.begin_attachments();
        for part in 0..parts.count() {
            let [start, end] = [part, part + 1].map(|part| parts.start(part));
            stages.run(Stage::Instruments, || self.move_tools(span, start, end));
            let (from, end) = (span.at(start), if part + 1 == parts.count() { span.to } else { span.at(end) });
            let drive = Drive { end, frames: &self.motion.frames, rods: &self.motion.rods, gravity };
            let dt = parts.length(part, self.config.step);
            let interval = Interval { from, dt, is_first: part == 0, drive: &drive };
            // A scheme over two steps knows steps of one length.
            self.bodies.iter_mut().for_each(|body| body.state.past.is_known &= parts.count() == 1);
            for number in 0..self.bodies.len() {
                let Some(together) = Together::led_by(number, &mut self.tied) else { continue };
                if !self.bodies[number].moves() {
                    continue;
                }
                let all = (&mut self.bodies[..], &mut self.implicit[..]);
                let (own, why) = stages
                    .run(Stage::Newton, || implicit::advance(all, together, settings, interval, is_patient, stages));
                refused = refused.or(why.map(|why| (number, why, own)));
                report = report.worst(own);
            }
            self.bodies.iter_mut().for_each(|body| body.state.past.is_known &= parts.count() == 1);
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
