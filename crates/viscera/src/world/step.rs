//! One step of a world.

use super::{Integrator, StepError, World};
use crate::body::SimulatedBody;
use crate::dynamics::implicit::ImplicitReport;
use crate::executor::{Executor, ReadBlocks, node_blocks};
use crate::instrument::Span;
use crate::math::{Scalar, Vec3, dispatch, dispatch_level};
use crate::stage::{Stage, StageObserver, Stages};

/// Cells from which on threads pay. A step of 6 000 cells took a fifth longer on two threads than on one.
const WORTH_THREADS: usize = 10_000;
/// The most parts into which fast tools divide a step; faster ones rely on what finds contacts on the way.
pub(super) const MOST_PARTS: f64 = 256.0;

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Time at the end [s].
    pub time: f64,
    /// Sub-steps taken; 1 for an implicit step, unless a fast tool divides it, its full equations were not solved at once, or it gained energy.
    pub substeps: u32,
    /// Times that the step was done again with more sub-steps, because the tissue stiffened on the way, full equations were not solved, or
    /// energy was gained; between two equilibria, shares of the load that were tried in vain, of the body that took most.
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
        let has_tools = !self.instruments.is_empty();
        for body in &mut self.bodies {
            body.backup.keep(&body.state, has_tools, &body.scratch.executor);
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

    /// Whether every number is finite, and no node was thrown in the step.
    pub(super) fn is_within_bounds(&self) -> bool {
        let farthest = T::from_f64(THROWN * self.size);
        let (from, to, velocities) = (self.backup.positions(), &self.state.positions, &self.state.velocities);
        let work = |_: usize, (ReadBlocks(from), (ReadBlocks(to), ReadBlocks(velocities)))| dispatch!(dispatch_level(), _simd => are_within(from, to, velocities, farthest));
        let data = (ReadBlocks(from), (ReadBlocks(to), ReadBlocks(velocities)));
        self.scratch.executor.fold(node_blocks(to.len()), data, &work, &|a, b| a & b).unwrap_or(true)
    }
}

/// Whether all numbers are finite, and no node went farther than that. Without a branch for each node: one after the other takes four times as long.
#[inline(always)]
fn are_within<T: Scalar>(from: &[Vec3<T>], to: &[Vec3<T>], velocities: &[Vec3<T>], farthest: T) -> bool {
    let mut all = true;
    for ((&from, &to), &velocity) in from.iter().zip(to).zip(velocities) {
        let sum = to.x + to.y + to.z + (velocity.x + velocity.y + velocity.z);
        all &= sum.is_finite() & ((to - from).squared_norm() <= farthest * farthest);
    }
    all
}

/// The cell with the longest edge compared to rest, and the ratio of the lengths.
pub(super) fn most_deformed_cell<T: Scalar>(body: &SimulatedBody<T>) -> (usize, f64) {
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
