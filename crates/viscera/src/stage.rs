//! Stages of a step, for those who measure them. The engine has no clock; who calls it may have one.

/// A part of a step. Stages may lie within others; the time of an outer one includes theirs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// Copies of the motion, so that a step can be undone, and the check that all numbers are finite.
    Guard,
    /// The bound of the highest frequency, from which the sub-steps follow.
    FrequencyBound,
    /// Instruments that move, take hold or let go.
    Instruments,
    /// Internal forces of the model of this name.
    Forces(&'static str),
    /// Gravity and loads.
    Loads,
    /// Velocities and positions of an explicit sub-step.
    KickAndDrift,
    /// Volumes that are kept exactly, and rigid parts.
    Constraints,
    /// What holds together bodies that are grown to each other: impulses, or the ties' part in linear solves.
    Attachments,
    /// An implicit step of a body; of its own, the vectors of Newton's method.
    Newton,
    /// What a model computes once for all products of a linear solve.
    Linearisation,
    /// Blocks of the matrix, and the inverses of those on its diagonal.
    Preconditioner,
    /// A linear solve; of its own, the vectors of the conjugate gradient.
    LinearSolve,
    /// Products with the matrix, by the model of this name or the assembled matrix.
    Products(&'static str),
    /// Bodies that answer statically, put to where they rest.
    Response,
    /// Instruments that remove cells.
    Cutting,
}

/// Someone who wants to know when stages begin and end: with a clock, a profile.
///
/// Calls come one after another, in pairs, properly nested; from the thread that steps, or one of the executor's.
pub trait StageObserver: Sync {
    /// The stage begins.
    fn enter(&self, stage: Stage);
    /// The stage that was entered last ends.
    fn leave(&self, stage: Stage);
}

/// The observer of a step, or nobody: one test of a pointer for each stage then, nothing for each cell or node.
#[derive(Clone, Copy, Default)]
pub struct Stages<'a> {
    observer: Option<&'a dyn StageObserver>,
}

impl<'a> Stages<'a> {
    /// Stages that somebody observes.
    pub fn observed_by(observer: &'a dyn StageObserver) -> Self {
        Self { observer: Some(observer) }
    }

    /// Stages that nobody observes.
    pub const fn unobserved() -> Self {
        Self { observer: None }
    }

    /// Does the work of a stage.
    #[inline(always)]
    pub fn run<R>(self, stage: Stage, work: impl FnOnce() -> R) -> R {
        if let Some(observer) = self.observer {
            observer.enter(stage);
        }
        let result = work();
        if let Some(observer) = self.observer {
            observer.leave(stage);
        }
        result
    }
}

impl std::fmt::Debug for Stages<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str(if self.observer.is_some() { "Stages(observed)" } else { "Stages(unobserved)" })
    }
}
