//! One step of a world.

use super::{Integrator, StepError, Substep, World};
use crate::body::SimulatedBody;
use crate::constraint::Unkept;
use crate::dynamics::implicit::ImplicitReport;
use crate::dynamics::tied::Aim;
use crate::dynamics::{Drive, explicit};
use crate::executor::Executor;
use crate::instrument::Span;
use crate::math::{Scalar, Vec3};
use crate::stage::{Stage, StageObserver, Stages};

/// The most sub-steps of one step.
pub(super) const MAX_SUBSTEPS: f64 = 1e5;
/// Cells from which on threads pay. A step of 6 000 cells took a fifth longer on two threads than on one.
const WORTH_THREADS: usize = 10_000;
/// The most parts into which fast tools divide a step; faster ones rely on what finds contacts on the way.
pub(super) const MOST_PARTS: f64 = 256.0;
/// How much farther tools look for tissue when some of it went farther than expected.
const WIDER: f64 = 8.0;
/// How many times a step is tried again with more sub-steps.
const MAX_RETRIES: u32 = 5;

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Time at the end [s].
    pub time: f64,
    /// Sub-steps taken; 1 for an implicit step, unless a fast tool divides it, its full equations were not solved at once, or it gained energy.
    pub substeps: u32,
    /// Times that the step was done again with more sub-steps, because the tissue stiffened on the way, full equations were not solved, or
    /// backward Euler gained energy; between two equilibria, shares of the load that were tried in vain, of the body that took most.
    pub retries: u32,
    /// Cells removed.
    pub removed_cells: usize,
    /// What the solver did, in an implicit step and between two equilibria.
    pub implicit: Option<ImplicitReport>,
}

/// What moving the bodies over a step took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) substeps: u32,
    pub(super) retries: u32,
    pub(super) implicit: Option<ImplicitReport>,
}

impl<T: Scalar> World<T> {
    /// Advances by one step. Where that fails, the world is as it was before.
    ///
    /// # Errors
    /// [`StepError`] saying which body and cell, and what to change.
    pub fn step(&mut self) -> Result<StepReport, StepError> {
        self.step_on(&Executor::serial())
    }

    /// The same on the threads of `executor`. The bits of the result do not depend on how many there are; a world too small to
    /// gain from them stays on the calling thread.
    ///
    /// # Errors
    /// As [`World::step`].
    pub fn step_on(&mut self, executor: &Executor) -> Result<StepReport, StepError> {
        self.step_among(executor, Stages::unobserved())
    }

    /// The same, with the same bits, and `observer` is told when the stages of the step begin and end.
    ///
    /// # Errors
    /// As [`World::step`].
    pub fn step_observed(
        &mut self,
        executor: &Executor,
        observer: &dyn StageObserver,
    ) -> Result<StepReport, StepError> {
        self.step_among(executor, Stages::observed_by(observer))
    }

    fn step_among(&mut self, executor: &Executor, stages: Stages) -> Result<StepReport, StepError> {
        let cells: usize = self.bodies.iter().map(|body| body.mesh.cell_count()).sum();
        let executor = if cells < WORTH_THREADS { Executor::serial() } else { executor.clone() };
        for body in &mut self.bodies {
            body.scratch.executor = executor.clone();
        }
        executor.enter(|| self.step_once(stages))
    }

    fn step_once(&mut self, stages: Stages) -> Result<StepReport, StepError> {
        let span = Span { from: self.time(), to: (self.steps + 1) as f64 * self.config.step };
        stages.run(Stage::Guard, || self.keep());
        let Motion { substeps, retries, implicit } = self.move_bodies(&span, stages).inspect_err(|_| self.undo())?;
        stages.run(Stage::Response, || self.respond_statically(&span)).inspect_err(|_| self.undo())?;
        stages.run(Stage::Instruments, || self.settle_tools(&span));
        self.settle_attachments();
        let removed_cells = stages.run(Stage::Cutting, || self.cut(&span));
        self.steps += 1;
        Ok(StepReport { time: span.to, substeps, retries, removed_cells, implicit })
    }

    /// Remembers where everything is.
    fn keep(&mut self) {
        for body in &mut self.bodies {
            body.backup.keep(&body.state);
        }
        self.keep_tools();
    }

    /// Puts everything back to where it was.
    pub(super) fn undo(&mut self) {
        for body in &mut self.bodies {
            body.backup.put_back(&mut body.state);
            body.is_linearized = false;
        }
        self.put_tools_back();
    }

    /// Moves the bodies over the step.
    fn move_bodies(&mut self, span: &Span, stages: Stages) -> Result<Motion, StepError> {
        match self.config.integrator {
            Integrator::Explicit(substep) => self.move_explicitly(span, substep, stages),
            Integrator::Implicit(settings) => self.move_implicitly(span, &settings, stages),
            Integrator::QuasiStatic(settings) => self.move_statically(span, &settings, stages),
        }
    }

    /// Moves the bodies with as many sub-steps as it takes.
    fn move_explicitly(&mut self, span: &Span, substep: Substep, stages: Stages) -> Result<Motion, StepError> {
        let mut fastest = stages.run(Stage::FrequencyBound, || self.fastest());
        let (mut reach, mut failure) = (1.0, None);
        for retries in 0..=MAX_RETRIES {
            let parts = stages.run(Stage::Instruments, || self.approach(span, reach));
            let substeps = match self.plan_substeps(substep, fastest) {
                // What an attempt that ran away says of stiffness means nothing.
                Err(StepError::TooStiff { .. }) if retries > 0 => {
                    return Err(failure.unwrap_or_else(|| self.diverged()));
                }
                plan => plan?.max(parts),
            };
            self.advance(span, substeps, stages);
            let finite = stages.run(Stage::Guard, || self.bodies.iter().all(|body| body.is_within_bounds()));
            failure = self.unkept_volume();
            let finite = finite && failure.is_none();
            let within = stages.run(Stage::Guard, || self.bodies.iter().all(|body| body.is_within_reach()));
            if finite && !within {
                reach *= WIDER;
                self.undo();
                continue;
            }
            let at_end = if finite { stages.run(Stage::FrequencyBound, || self.fastest()) } else { fastest };
            if finite && self.config.step / f64::from(substeps) <= explicit::stable_step(at_end.squared_frequency) {
                return Ok(Motion { substeps, retries, implicit: None });
            }
            // The tissue stiffened on the way: once more, for the stiffness at its end, or else for four times as many steps.
            // Stable neo-Hookean tissue let go at 1000 times its length is faster by far on the way than at both ends.
            if !finite {
                fastest.squared_frequency *= 16.0;
            } else if at_end.squared_frequency > fastest.squared_frequency {
                fastest = at_end;
            }
            self.undo();
        }
        Err(failure.unwrap_or_else(|| self.diverged()))
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

    fn plan_substeps(&self, substep: Substep, fastest: Fastest) -> Result<u32, StepError> {
        let step = self.config.step;
        let needed = match substep {
            Substep::Automatic => explicit::substeps_for(step, fastest.squared_frequency),
            Substep::Fixed(substep) => {
                let stable = explicit::stable_step(fastest.squared_frequency);
                if substep > stable {
                    let body = self.bodies[fastest.body].name.clone();
                    return Err(StepError::UnstableSubstep { time: self.time(), body, substep, stable });
                }
                (step / substep).ceil().max(1.0)
            }
        };
        if needed <= MAX_SUBSTEPS {
            return Ok(needed as u32);
        }
        let body = &self.bodies[fastest.body];
        let (cell, stretch) = most_deformed_cell(body);
        let (time, law) = (self.time(), body.law());
        Err(StepError::TooStiff { time, body: body.name.clone(), law, cell, stretch, substeps: needed, step })
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
                body.contacts.gather(&self.motion.rods, body.skin.triangles(), &body.state.positions, reach * expected);
        }
        if touches { (2.0 * ratio).ceil().clamp(1.0, MOST_PARTS) as u32 } else { 1 }
    }

    /// Moves all bodies by equal sub-steps over the step.
    fn advance(&mut self, span: &Span, substeps: u32, stages: Stages) {
        self.begin_attachments();
        let dt = self.config.step / f64::from(substeps);
        let gravity = Vec3::from(self.config.gravity).cast();
        for body in moving(&mut self.bodies) {
            explicit::begin(body, span.from, gravity, stages);
        }
        self.begin_ties(stages);
        for substep in 1..=substeps {
            let end = span.from + (span.to - span.from) * (f64::from(substep) / f64::from(substeps));
            let share = |substep: u32| f64::from(substep) / f64::from(substeps);
            stages.run(Stage::Instruments, || self.move_tools(span, share(substep - 1), share(substep)));
            let drive = Drive { end, frames: &self.motion.frames, rods: &self.motion.rods, gravity };
            for body in moving(&mut self.bodies) {
                explicit::drift(body, dt, &drive, stages);
            }
            self.hold_together(dt, Aim::Place, stages);
            self.restrain(stages, |body| body.restore_places(dt));
            let drive = Drive { end, frames: &self.motion.frames, rods: &self.motion.rods, gravity };
            for body in moving(&mut self.bodies) {
                explicit::kick(body, dt, &drive, stages);
            }
            self.hold_together(dt, Aim::Velocity, stages);
            self.restrain(stages, |body| body.restore_velocities(dt));
        }
    }

    /// Lets instruments remove cells of the bodies that can be cut; gives how many went.
    fn cut(&mut self, span: &Span) -> usize {
        let mut removed = 0;
        for number in 0..self.instruments.len() {
            let tool = self.tool_use(number, span);
            let Some(instrument) = &self.instruments[number] else { continue };
            for body in self.bodies.iter_mut().filter(|body| body.model.info().no_cutting.is_none()) {
                let before = body.state.removed_count;
                self.removable.clear();
                instrument.cut(&tool, body, &mut self.removable);
                body.remove_cells(&mut self.removable);
                removed += body.state.removed_count - before;
            }
        }
        removed
    }

    pub(super) fn diverged(&self) -> StepError {
        let deformed = self.bodies.iter().map(|body| (body, most_deformed_cell(body)));
        let (body, (cell, stretch)) =
            deformed.max_by(|(_, a), (_, b)| a.1.total_cmp(&b.1)).expect("a world without bodies never diverges");
        let advice = if body.law().contains("st-venant-kirchhoff") {
            "This law loses its strength under strong compression: pull or press less, stiffen the tissue, or keep its \
             volume with `keep-volume`; or take `stable-neo-hookean`, which bears both"
        } else {
            "Pull or press less, or stiffen the tissue"
        };
        StepError::Diverged { time: self.time(), body: body.name.clone(), law: body.law(), cell, stretch, advice }
    }
}

/// A node that goes farther than this many sizes of its body in a step has been thrown: no digit of single precision tells
/// of its neighbours any more.
const THROWN: f64 = 1e6;

/// The bodies that move in time: the others answer once at the end of the step.
pub(super) fn moving<T: Scalar>(bodies: &mut [SimulatedBody<T>]) -> impl Iterator<Item = &mut SimulatedBody<T>> {
    bodies.iter_mut().filter(|body| body.moves())
}

impl<T: Scalar> SimulatedBody<T> {
    /// Whether it moves in time.
    pub(super) fn moves(&self) -> bool {
        self.answer.is_none()
    }

    /// Speed of the fastest node [m/s].
    pub(super) fn fastest_node(&self) -> f64 {
        self.state.velocities.iter().map(|v| v.squared_norm().to_f64()).fold(0.0, f64::max).sqrt()
    }

    /// Whether no node went farther in the step than tools looked for tissue.
    fn is_within_reach(&self) -> bool {
        let reach = self.contacts.reach();
        let (from, to) = (self.backup.positions(), &self.state.positions);
        self.skin.triangles().is_empty()
            || reach == f64::INFINITY
            || from.iter().zip(to).all(|(&from, &to)| (to - from).squared_norm().to_f64() <= reach * reach)
    }

    /// Whether every number is finite, and no node was thrown in the step.
    pub(super) fn is_within_bounds(&self) -> bool {
        let farthest = T::from_f64(THROWN * self.size);
        let (from, to) = (self.backup.positions(), &self.state.positions);
        self.state.is_finite()
            && from.iter().zip(to).all(|(&from, &to)| (to - from).squared_norm() <= farthest * farthest)
    }
}

/// A body, by its place in the world, and the bound of its ω_max² [1/s²].
#[derive(Clone, Copy, Debug)]
struct Fastest {
    body: usize,
    squared_frequency: f64,
}

/// The cell with the longest edge compared to rest, and the ratio of the lengths.
fn most_deformed_cell<T: Scalar>(body: &SimulatedBody<T>) -> (usize, f64) {
    let mut worst = (0, 0.0);
    for cell in (0..body.mesh.cell_count()).filter(|&cell| !body.state.removed[cell]) {
        let corners = body.mesh.cell(cell);
        for (i, &a) in corners.iter().enumerate() {
            for &b in &corners[..i] {
                let (a, b) = (a as usize, b as usize);
                let length = (body.state.positions[a] - body.state.positions[b]).norm().to_f64();
                let ratio = length / (body.rest[a] - body.rest[b]).norm().to_f64();
                if ratio > worst.1 {
                    worst = (cell, ratio);
                }
            }
        }
    }
    worst
}
