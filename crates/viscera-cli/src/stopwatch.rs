//! Where the time of a run goes.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use viscera::stage::{Stage, StageObserver};

/// What takes time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Cost {
    /// Reading and checking the scene.
    Loading,
    /// Reading or making meshes, assembling models.
    Building,
    /// A stage of a step.
    Stage(Stage),
    /// Measuring what goes into tables.
    Observables,
    /// Writing files, drawing pictures.
    Output,
}

/// Own times of costs that may lie within one another: what lies within a cost is not counted for it again.
#[derive(Debug, Default)]
pub(crate) struct Stopwatch {
    running: Mutex<Running>,
}

#[derive(Debug, Default)]
struct Running {
    open: Vec<Cost>,
    /// When the innermost cost began or went on.
    since: Option<Instant>,
    spent: BTreeMap<Cost, Spent>,
}

/// Time and number of a cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spent {
    pub(crate) time: Duration,
    pub(crate) times: u64,
}

impl Stopwatch {
    /// Does something and counts the time for `cost`.
    pub(crate) fn time<R>(&self, cost: Cost, work: impl FnOnce() -> R) -> R {
        self.begin(cost);
        let result = work();
        self.end();
        result
    }

    /// What was spent so far, by cost.
    pub(crate) fn spent(&self) -> BTreeMap<Cost, Spent> {
        self.running().spent.clone()
    }

    /// Work that panicked leaves numbers behind, and those are whole.
    fn running(&self) -> MutexGuard<'_, Running> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn begin(&self, cost: Cost) {
        let mut running = self.running();
        running.settle();
        running.open.push(cost);
        running.spent.entry(cost).or_default().times += 1;
    }

    fn end(&self) {
        let mut running = self.running();
        running.settle();
        running.open.pop();
    }
}

impl Running {
    /// Counts the time since the last change for the innermost cost.
    fn settle(&mut self) {
        let now = Instant::now();
        if let (Some(&cost), Some(since)) = (self.open.last(), self.since) {
            self.spent.entry(cost).or_default().time += now - since;
        }
        self.since = Some(now);
    }
}

impl StageObserver for Stopwatch {
    fn enter(&self, stage: Stage) {
        self.begin(Cost::Stage(stage));
    }

    fn leave(&self, _stage: Stage) {
        self.end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The time of an outer cost is without that of the inner one, and nothing is counted twice.
    #[test]
    fn costs_within_one_another_add_up_to_the_whole() {
        let watch = Stopwatch::default();
        let begin = Instant::now();
        watch.time(Cost::Output, || {
            watch.time(Cost::Observables, || std::thread::sleep(Duration::from_millis(20)));
        });
        let whole = begin.elapsed();
        let spent = watch.spent();
        let (inner, outer) = (spent[&Cost::Observables], spent[&Cost::Output]);
        assert_eq!((inner.times, outer.times), (1, 1));
        assert!(inner.time >= Duration::from_millis(20));
        assert!(inner.time + outer.time <= whole);
    }
}
