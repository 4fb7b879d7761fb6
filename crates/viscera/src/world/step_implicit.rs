use super::step::{MOST_PARTS, Motion, most_deformed_cell, moving};
use super::{StepError, World};
use crate::dynamics::Drive;
use crate::dynamics::implicit::{self, Implicit, ImplicitReport, Interval, Newton, Refused, Scheme};
use crate::dynamics::tied::Together;
use crate::instrument::Span;
use crate::math::{Scalar, Vec3};
use crate::stage::{Stage, Stages};

/// How a step is made again that is not solved, or that throws tissue across a hump: in twice as many parts up to 64, and where those do not do
/// either, with shorter ones to begin with. Tissue that is let go from far off balance is thrown within the first of them, and its parts need be short
/// only until it has turned: free, integrated at the nodes and stretched 1010 times, it needed the 512th part of 20 ms there, and no more than the 16th after.
const DIVISIONS: [Division; 11] = [
    Division::equal(0),
    Division::equal(1),
    Division::equal(2),
    Division::equal(3),
    Division::equal(4),
    Division::equal(5),
    Division::equal(6),
    Division { halvings: 6, doublings: 3 },
    Division { halvings: 6, doublings: 6 },
    Division { halvings: 6, doublings: 9 },
    Division { halvings: 9, doublings: 6 },
];
/// From this one on solvers do all that they can.
const LAST: usize = 6;

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
            let (report, refused) = self.advance_implicitly(span, settings, (parts, retries >= LAST), stages);
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

    /// Moves all bodies by the parts of the step, in one of the last attempts or one before; gives what the solvers did, and the first body whose
    /// step is not to be taken.
    fn advance_implicitly(
        &mut self,
        span: &Span,
        settings: &Implicit,
        (parts, is_last): (Parts, bool),
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
                let (own, why) =
                    stages.run(Stage::Newton, || implicit::advance(all, together, settings, interval, is_last, stages));
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

/// How a step is divided.
#[derive(Clone, Copy)]
struct Division {
    /// How often into halves.
    halvings: u32,
    /// The first part again into so many and one, of which each is as long as all before it.
    doublings: u32,
}

impl Division {
    const fn equal(halvings: u32) -> Self {
        Self { halvings, doublings: 0 }
    }
}

/// The parts of a step.
#[derive(Clone, Copy)]
struct Parts {
    /// Equal ones.
    equal: u32,
    doublings: u32,
}

impl Parts {
    /// So many, and those divided, into more than 64 each only up to as many as a step of one part would have: fast tools ask for 256.
    fn new(parts: u32, Division { halvings, doublings }: Division) -> Self {
        Self { equal: (parts << halvings.min(6)).max(1 << halvings), doublings }
    }

    fn count(self) -> u32 {
        self.equal + self.doublings
    }

    /// The share of the step that is over at the beginning of a part.
    fn start(self, part: u32) -> f64 {
        if part == 0 { 0.0 } else { self.end(part - 1) }
    }

    /// The same at its end, in powers of ½ of an equal part up to the first.
    fn end(self, part: u32) -> f64 {
        let equal = f64::from(self.equal);
        if part < self.doublings {
            0.5_f64.powi((self.doublings - part) as i32) / equal
        } else {
            f64::from(part - self.doublings + 1) / equal
        }
    }

    /// Length of a part [s] in a step of `step` [s].
    fn length(self, part: u32, step: f64) -> f64 {
        // The first and the second are of one length.
        let halves = if part > self.doublings { 0 } else { self.doublings - part.saturating_sub(1) };
        step / f64::from(self.equal) * 0.5_f64.powi(halves as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_fill_a_step_whole() {
        for division in DIVISIONS {
            for parts in [1, 3, 256] {
                let parts = Parts::new(parts, division);
                assert_eq!((parts.start(0), parts.end(parts.count() - 1)), (0.0, 1.0));
                for part in 0..parts.count() {
                    let length = parts.end(part) - parts.start(part);
                    let error = (parts.length(part, 2.0) - 2.0 * length).abs();
                    assert!(length > 0.0 && error < 1e-15, "part {part} of {}: {length}", parts.count());
                }
            }
        }
    }
}
