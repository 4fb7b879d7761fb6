//! One explicit step of a world.

use super::step::{MOST_PARTS, Motion, most_deformed_cell, moving};
use super::{StepError, Substep, World};
use crate::body::SimulatedBody;
use crate::constraint::Unkept;
use crate::dynamics::tied::Aim;
use crate::dynamics::{Drive, explicit};
use crate::instrument::Span;
use crate::math::{Scalar, Vec3};
use crate::stage::{Stage, Stages};

/// The most sub-steps that are planned for a step.
pub(super) const MAX_SUBSTEPS: f64 = 1e6;
/// The most that it takes where more are needed on the way.
const MOST_ON_THE_WAY: f64 = 4e6;
/// How much farther tools look for tissue when some of it went farther than expected.
const WIDER: f64 = 8.0;
/// How many times a step is tried again because tools did not look far enough.
const MOST_LOOKS: u32 = 5;

impl<T: Scalar> World<T> {
    /// Moves the bodies with as many sub-steps as it takes.
    ///
    /// Sub-steps are planned for the stiffness at the beginning of the step. Where tissue stiffened beyond them on the way, the step is
    /// made again with [more care](Care). Many equal sub-steps would not do: stable neo-Hookean tissue let go at 1000 times its length is
    /// a hundred times as fast for short times on the way, and gets so within a few sub-steps; and what an attempt that ran away
    /// says of stiffness means nothing.
    pub(super) fn move_explicitly(
        &mut self,
        span: &Span,
        substep: Substep,
        stages: Stages,
    ) -> Result<Motion, StepError> {
        let (mut reach, mut looks, mut care) = (1.0, 0, 0);
        loop {
            let parts = stages.run(Stage::Instruments, || self.approach(span, reach));
            let failure = match self.travel(span, substep, parts, CARE[care], stages) {
                Ok(substeps) => {
                    if stages.run(Stage::Guard, || self.bodies.iter().all(|body| body.is_within_reach())) {
                        return Ok(Motion { substeps, retries: looks + care as u32, implicit: None });
                    }
                    (reach, looks) = (WIDER * reach, looks + 1);
                    None
                }
                Err(Refused::ForGood(error)) => return Err(error),
                Err(refused) => {
                    care += 1;
                    if let Refused::Unkept(error) = refused { Some(error) } else { None }
                }
            };
            self.undo();
            if care == CARE.len() || looks > MOST_LOOKS {
                return Err(failure.unwrap_or_else(|| self.diverged()));
            }
        }
    }

    /// Moves the bodies over the step by no fewer sub-steps than `parts`, planned as often as `care` wants; gives how many it took.
    fn travel(
        &mut self,
        span: &Span,
        substep: Substep,
        parts: u32,
        care: Care,
        stages: Stages,
    ) -> Result<u32, Refused> {
        self.begin_attachments();
        let step = self.config.step;
        let (mut share, mut taken) = (0.0, 0);
        let mut fastest = stages.run(Stage::FrequencyBound, || self.fastest());
        while share < 1.0 {
            let left = 1.0 - share;
            let rate = care.most_strain.map_or(0.0, |most| self.strain_rate() / most);
            let planned = self.plan_substeps(substep, left * step, &fastest.stiffened(care.stiffening), rate)?;
            let planned = planned.max((f64::from(parts) * left).ceil());
            let leg = Leg::new(share, planned, care.longest_leg);
            if f64::from(leg.substeps) > MAX_SUBSTEPS {
                return Err(Refused::ForGood(self.too_stiff(&fastest, planned)));
            }
            if f64::from(taken) >= MOST_ON_THE_WAY {
                self.undo();
                return Err(Refused::ForGood(self.too_stiff(&fastest, f64::from(taken) / share)));
            }
            if T::from_f64(leg.substep(step)) == T::ZERO {
                // No time passes in sub-steps that short, and there would be millions of them.
                return Err(Refused::Stiffened);
            }
            self.advance(span, leg, stages);
            (share, taken) = (leg.to, taken + leg.substeps);

            let finite = stages.run(Stage::Guard, || self.bodies.iter().all(|body| body.is_within_bounds()));
            if let Some(error) = self.unkept_volume() {
                return Err(Refused::Unkept(error));
            }
            fastest =
                if finite { stages.run(Stage::FrequencyBound, || self.fastest()) } else { fastest.stiffened(ASTRAY) };
            if !finite || leg.substep(step) > explicit::stable_step(fastest.squared_frequency) {
                // Whoever fixed the sub-step is to hear of it.
                self.plan_substeps(substep, step, &fastest, 0.0)?;
                return Err(Refused::Stiffened);
            }
        }
        Ok(taken)
    }

    /// Moves all bodies by equal sub-steps over a leg of the step.
    fn advance(&mut self, span: &Span, leg: Leg, stages: Stages) {
        let dt = leg.substep(self.config.step);
        let gravity = Vec3::from(self.config.gravity).cast();
        let start = span.at(leg.from);
        for (number, body) in self.bodies.iter_mut().enumerate().filter(|(_, body)| body.moves()) {
            let is_tied = self.tied.iter().any(|tied| tied.bodies.contains(&number));
            explicit::begin(body, is_tied, start, gravity, stages);
        }
        self.begin_ties(stages);
        for substep in 1..=leg.substeps {
            let end = span.at(leg.share(substep));
            stages.run(Stage::Instruments, || self.move_tools(span, leg.share(substep - 1), leg.share(substep)));
            let drive = Drive { end, frames: &self.motion.frames, rods: &self.motion.rods, gravity };
            for body in moving(&mut self.bodies) {
                if body.is_left_alone && substep > 1 {
                    explicit::stride(body, dt, &drive, stages);
                } else {
                    explicit::drift(body, dt, &drive, stages);
                }
            }
            self.hold_together(dt, Aim::Place, stages);
            self.restrain(stages, |body| body.restore_places(dt));
            let drive = Drive { end, frames: &self.motion.frames, rods: &self.motion.rods, gravity };
            let is_last = substep == leg.substeps;
            for body in moving(&mut self.bodies).filter(|body| is_last || !body.is_left_alone) {
                explicit::kick(body, dt, &drive, is_last, stages);
            }
            self.hold_together(dt, Aim::Velocity, stages);
            self.restrain(stages, |body| body.restore_velocities(dt));
        }
    }

    /// Sub-steps for a time [s], of those that are not fixed at least so many in a second.
    fn plan_substeps(&self, substep: Substep, time: f64, fastest: &Fastest, rate: f64) -> Result<f64, Refused> {
        let Substep::Fixed(substep) = substep else {
            return Ok(explicit::substeps_for(time, fastest.squared_frequency).max((time * rate).ceil()));
        };
        let stable = explicit::stable_step(fastest.squared_frequency);
        if substep > stable {
            let body = self.bodies[fastest.body].name.clone();
            return Err(Refused::ForGood(StepError::UnstableSubstep { time: self.time(), body, substep, stable }));
        }
        Ok((time / substep).ceil().max(1.0))
    }

    /// The body that vibrates fastest.
    fn fastest(&mut self) -> Fastest {
        let mut fastest = Fastest { body: 0, squared_frequency: 0.0 };
        for (body, simulated) in self.bodies.iter_mut().enumerate().filter(|(_, body)| body.moves()) {
            let squared_frequency = simulated.squared_frequency();
            if squared_frequency > fastest.squared_frequency {
                fastest = Fastest { body, squared_frequency };
            }
        }
        fastest
    }

    /// The fastest strain in any cell [1/s].
    fn strain_rate(&mut self) -> f64 {
        moving(&mut self.bodies).map(|body| body.strain_rate()).fold(0.0, f64::max)
    }

    /// Lets instruments take hold or let go, and finds what they may touch in the step if no node goes farther than `reach` times what
    /// is to be expected; gives in how many parts they want the step divided.
    fn approach(&mut self, span: &Span, reach: f64) -> u32 {
        self.lead_tools(span);
        let (way, ratio) = self.survey_tools(span);
        if self.motion.rods.is_empty() {
            self.bodies.iter_mut().for_each(|body| body.contacts.forget());
            return 1;
        }
        let radius = self.motion.rods.iter().map(|rod| rod.start.radius).fold(0.0, f64::max);
        let fall = Vec3::from(self.config.gravity).norm() * self.config.step;
        let mut touches = false;
        for body in moving(&mut self.bodies) {
            let expected = (2.0 * body.fastest_node() + fall) * self.config.step + 2.0 * (way + radius);
            body.contacts.forget();
            touches |=
                body.contacts.gather(&self.motion.rods, body.skin.numbered(), &body.state.positions, reach * expected);
        }
        if touches { (2.0 * ratio).ceil().clamp(1.0, MOST_PARTS) as u32 } else { 1 }
    }

    /// Lets constraints act on the bodies that have any.
    fn restrain(&mut self, stages: Stages, act: impl Fn(&mut SimulatedBody<T>)) {
        for body in self.bodies.iter_mut().filter(|body| !body.constraints.is_empty()) {
            stages.run(Stage::Constraints, || act(body));
        }
    }

    /// A volume that could not be kept in the attempt that was just made.
    fn unkept_volume(&mut self) -> Option<StepError> {
        let time = self.time();
        let of_body = |body: &mut SimulatedBody<T>| {
            let Unkept { volume, error } = body.constraints.unkept.take()?;
            let volume = body.constraints.volumes[volume].name.clone();
            Some(StepError::VolumeNotKept { time, body: body.name.clone(), volume, error })
        };
        self.bodies.iter_mut().map(of_body).fold(None, Option::or)
    }

    fn too_stiff(&self, fastest: &Fastest, substeps: f64) -> StepError {
        let body = &self.bodies[fastest.body];
        let (cell, stretch) = most_deformed_cell(body);
        let (time, law, step) = (self.time(), body.law(), self.config.step);
        let advice = if body.substeps_at_rest(step) < 0.5 * substeps {
            "Pull it less, or take a softer law"
        } else {
            "It is as stiff at rest: take a shorter step, an implicit integrator, softer or denser tissue, or coarser cells"
        };
        StepError::TooStiff { time, body: body.name.clone(), law, cell, stretch, substeps, step, advice }
    }
}

impl<T: Scalar> SimulatedBody<T> {
    /// The fastest that two corners of a cell go apart or about each other, of their distance now or at rest, whichever is larger [1/s].
    fn strain_rate(&self) -> f64 {
        let state = &self.state;
        let mut fastest = 0.0_f64;
        for cell in (0..self.mesh.cell_count()).filter(|&cell| !state.removed[cell]) {
            let corners = self.mesh.cell(cell);
            for (i, &a) in corners.iter().enumerate() {
                for &b in &corners[..i] {
                    let (a, b) = (a as usize, b as usize);
                    let apart = (state.velocities[a] - state.velocities[b]).squared_norm().to_f64();
                    let square = |x: &[Vec3<T>]| (x[a] - x[b]).squared_norm().to_f64();
                    fastest = fastest.max(apart / square(&state.positions).max(square(&self.rest)));
                }
            }
        }
        fastest.sqrt()
    }

    /// Whether no node went farther in the step than tools looked for tissue.
    fn is_within_reach(&self) -> bool {
        let reach = self.contacts.reach();
        let (from, to) = (self.backup.positions(), &self.state.positions);
        self.skin.triangles().is_empty()
            || reach == f64::INFINITY
            || from.iter().zip(to).all(|(&from, &to)| (to - from).squared_norm().to_f64() <= reach * reach)
    }
}

/// A body, by its place in the world, and the bound of its ω_max² [1/s²].
#[derive(Clone, Copy, Debug)]
struct Fastest {
    body: usize,
    squared_frequency: f64,
}

impl Fastest {
    /// The same with `times` the square of the frequency.
    fn stiffened(self, times: f64) -> Self {
        Self { squared_frequency: times * self.squared_frequency, ..self }
    }
}

/// How carefully sub-steps are planned.
#[derive(Clone, Copy)]
struct Care {
    /// The most sub-steps before the next are planned anew.
    longest_leg: u32,
    /// How many times as large as at their beginning the square of the frequency may become within them, beside the usual margin.
    stiffening: f64,
    /// How much cells may be strained in a sub-step, if that is looked at.
    most_strain: Option<f64>,
}

/// How carefully the first attempt at a step is made, and those after it, each because the one before did not do. Found on a bar of
/// stable neo-Hookean tissue let go at 1000 times its length, from 60 starts that differ by a billionth: 54 come back by less than a
/// million sub-steps in each step, all by less than two; with 8, 64, 512, ... equal legs in place of these, 11 of 20. Hexahedra of that tissue
/// that nothing holds fly into each other faster than any frequency tells: they come back where strains are looked at.
const CARE: [Care; 7] = [
    Care { longest_leg: u32::MAX, stiffening: 1.0, most_strain: None },
    Care { longest_leg: 8, stiffening: 1.0, most_strain: None },
    Care { longest_leg: 2, stiffening: 4.0, most_strain: None },
    Care { longest_leg: 1, stiffening: 4.0, most_strain: None },
    Care { longest_leg: 1, stiffening: 16.0, most_strain: None },
    Care { longest_leg: 1, stiffening: 64.0, most_strain: None },
    Care { longest_leg: 1, stiffening: 16.0, most_strain: Some(0.1) },
];
/// How many times the square of its frequency tissue that went astray is taken to have reached.
const ASTRAY: f64 = 16.0;

/// Equal sub-steps over a part of a step.
#[derive(Clone, Copy)]
struct Leg {
    /// The share of the step that is over at its beginning.
    from: f64,
    /// The same at its end.
    to: f64,
    substeps: u32,
}

impl Leg {
    /// As many of the sub-steps that are `planned` for what is left of the step after `from` as it may have.
    fn new(from: f64, planned: f64, longest: u32) -> Self {
        let substeps = planned.min(f64::from(longest));
        let to = if substeps == planned { 1.0 } else { from + (1.0 - from) * (substeps / planned) };
        Self { from, to, substeps: substeps as u32 }
    }

    /// The share of the step that is over after a sub-step.
    fn share(self, substep: u32) -> f64 {
        self.from + (self.to - self.from) * (f64::from(substep) / f64::from(self.substeps))
    }

    /// Length of a sub-step [s] in a step of `step` [s].
    fn substep(self, step: f64) -> f64 {
        step * (self.to - self.from) / f64::from(self.substeps)
    }
}

/// Why an attempt is not taken.
enum Refused {
    /// The fixed sub-step is too long for the tissue, or more sub-steps are needed than there may be.
    ForGood(StepError),
    /// A volume could not be kept.
    Unkept(StepError),
    /// The tissue stiffened beyond its sub-steps, or went astray.
    Stiffened,
}
