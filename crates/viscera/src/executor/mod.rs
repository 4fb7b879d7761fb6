//! Who computes: one thread, or a pool of them.
//!
//! Work is divided into parts whose number and bounds follow from the data alone, and results are joined in the order of the
//! parts: the bits of a result do not depend on how many threads there are.

mod team;

use std::sync::{Arc, Mutex, PoisonError};

use self::team::Team;

/// Threads that a step may use; by default just the one that calls.
///
/// Cloning is cheap, and clones share their threads; a step that finds them at work for another thread is made by its own alone.
#[derive(Clone, Debug, Default)]
pub struct Executor {
    team: Option<Arc<Team>>,
}

/// Why there are no threads to compute with.
#[derive(Debug, thiserror::Error)]
pub enum ExecutorError {
    /// The operating system refused to start them.
    #[error("{threads} threads could not be started: {source}. Ask for fewer")]
    NoThreads {
        /// How many were asked for.
        threads: usize,
        /// What the operating system said.
        source: std::io::Error,
    },
}

impl Executor {
    /// The calling thread alone.
    pub fn serial() -> Self {
        Self::default()
    }

    /// The calling thread and as many others as make `threads` [≥ 1].
    ///
    /// # Errors
    /// [`ExecutorError::NoThreads`] where the system refuses to start them.
    pub fn threads(threads: usize) -> Result<Self, ExecutorError> {
        if threads <= 1 {
            return Ok(Self::serial());
        }
        let team = Team::new(threads - 1).map_err(|source| ExecutorError::NoThreads { threads, source })?;
        Ok(Self { team: Some(Arc::new(team)) })
    }

    /// How many threads there are.
    pub fn thread_count(&self) -> usize {
        self.team.as_ref().map_or(1, |team| team.members())
    }

    /// Does `work` among the threads: what it divides then finds them awake. A step has dozens of loops of a few microseconds,
    /// and to wake a thread for each takes longer.
    pub(crate) fn enter<R>(&self, work: impl FnOnce() -> R) -> R {
        match &self.team {
            Some(team) => team.lead(work),
            None => work(),
        }
    }

    /// Hands part after part of `data` to `work`, with the part's number, on whichever threads are free.
    pub(crate) fn each<D: Divide>(&self, parts: usize, data: D, work: &(impl Fn(usize, D) + Sync)) {
        self.fold(parts, data, work, &|(), ()| ());
    }

    /// The same with memory that is made once for many parts, and comes as the part before has left it.
    pub(crate) fn each_with<M, D: Divide>(
        &self,
        memory: &(impl Fn() -> M + Sync),
        parts: usize,
        data: D,
        work: &(impl Fn(usize, D, &mut M) + Sync),
    ) {
        self.fold_with(memory, parts, data, work, &|(), ()| ());
    }

    /// [`Executor::each`] where every part has a result: neighbours are merged two by two, always the same two. None without parts.
    pub(crate) fn fold<D: Divide, R: Send>(
        &self,
        parts: usize,
        data: D,
        work: &(impl Fn(usize, D) -> R + Sync),
        merge: &(impl Fn(R, R) -> R + Sync),
    ) -> Option<R> {
        self.fold_with(&|| (), parts, data, &|part, data, ()| work(part, data), merge)
    }

    /// The same with memory as in [`Executor::each_with`].
    pub(crate) fn fold_with<M, D: Divide, R: Send>(
        &self,
        memory: &(impl Fn() -> M + Sync),
        parts: usize,
        data: D,
        work: &(impl Fn(usize, D, &mut M) -> R + Sync),
        merge: &(impl Fn(R, R) -> R + Sync),
    ) -> Option<R> {
        if parts == 0 {
            return None;
        }
        let Some(team) = self.team.as_ref().filter(|_| parts > D::FEWEST) else {
            return Some(fold(&mut memory(), 0, parts, data, work, merge));
        };
        team.lead(|| {
            Some(match team.members() {
                _ if !team.is_at_hand() => fold(&mut memory(), 0, parts, data, work, merge),
                2 => fold_among::<M, D, R, 2>(team, memory, parts, data, work, merge),
                3..=8 => fold_among::<M, D, R, 8>(team, memory, parts, data, work, merge),
                _ => fold_among::<M, D, R, 32>(team, memory, parts, data, work, merge),
            })
        })
    }
}

/// Neighbouring parts, which one thread does.
struct Chunk<D> {
    first: usize,
    parts: usize,
    data: D,
}

/// Two neighbouring chunks until somebody takes them, and their results then.
struct Pair<D, R> {
    chunks: [Option<Chunk<D>>; 2],
    results: [Option<R>; 2],
}

impl<D, R> Pair<D, R> {
    /// The first chunk that nobody has taken yet, and its place.
    fn take(&mut self) -> Option<(usize, Chunk<D>)> {
        self.chunks.iter_mut().enumerate().find_map(|(place, chunk)| Some((place, chunk.take()?)))
    }
}

/// A pair on cache lines of its own. Pairs, as the same member takes both as a rule, and what takes time is lines that go from core to core.
#[repr(align(128))]
struct Slot<D, R>(Mutex<Pair<D, R>>);

impl<D, R> Slot<D, R> {
    fn new(chunks: [Option<Chunk<D>>; 2]) -> Self {
        Self(Mutex::new(Pair { chunks, results: [None, None] }))
    }

    fn with<V>(&self, act: impl FnOnce(&mut Pair<D, R>) -> V) -> V {
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Lets `work` do what nobody has taken yet.
    fn empty(&self, work: impl Fn(Chunk<D>) -> R) {
        let mut next = self.with(Pair::take);
        while let Some((place, chunk)) = next {
            let result = work(chunk);
            next = self.with(|pair| {
                pair.results[place] = Some(result);
                pair.take()
            });
        }
    }
}

/// [`fold`] in twice as many chunks as there are `SLOTS`, a power of two, which members begin with at different ones.
fn fold_among<M, D: Divide, R: Send, const SLOTS: usize>(
    team: &Team,
    memory: &(impl Fn() -> M + Sync),
    parts: usize,
    data: D,
    work: &(impl Fn(usize, D, &mut M) -> R + Sync),
    merge: &(impl Fn(R, R) -> R + Sync),
) -> R {
    let mut slots: [Slot<D, R>; SLOTS] = std::array::from_fn(|_| Slot::new([None, None]));
    deal(Chunk { first: 0, parts, data }, &mut slots);
    team.share(&|member| {
        let home = member * SLOTS / team.members();
        // Of two, the helper leaves alone what the leader began with before it: to look there takes a line to and fro.
        let others = if team.members() == 2 { 0 } else { home };
        for slot in slots[home..].iter().chain(&slots[..others]) {
            slot.empty(|Chunk { first, parts, data }| fold(&mut memory(), first, parts, data, work, merge));
        }
    });
    collect(parts, D::FEWEST, &mut slots, merge).expect("a loop is over when all its chunks are done")
}

/// Divides a chunk among the slots as [`fold`] does.
fn deal<D: Divide, R>(Chunk { first, parts, data }: Chunk<D>, slots: &mut [Slot<D, R>]) {
    if parts <= D::FEWEST {
        slots[0] = Slot::new([Some(Chunk { first, parts, data }), None]);
        return;
    }
    let half = parts / 2;
    let (left, right) = data.divide(half);
    let left = Chunk { first, parts: half, data: left };
    let right = Chunk { first: first + half, parts: parts - half, data: right };
    if let [slot] = slots {
        *slot = Slot::new([Some(left), Some(right)]);
        return;
    }
    let (left_slots, right_slots) = slots.split_at_mut(slots.len() / 2);
    deal(left, left_slots);
    deal(right, right_slots);
}

/// Merges the results of the slots that `parts` were divided among.
fn collect<D, R>(parts: usize, fewest: usize, slots: &mut [Slot<D, R>], merge: &impl Fn(R, R) -> R) -> Option<R> {
    if parts <= fewest {
        return slots[0].with(|pair| pair.results[0].take());
    }
    if let [slot] = slots {
        return slot.with(|Pair { results: [left, right], .. }| Some(merge(left.take()?, right.take()?)));
    }
    let (half, (left, right)) = (parts / 2, slots.split_at_mut(slots.len() / 2));
    Some(merge(collect(half, fewest, left, merge)?, collect(parts - half, fewest, right, merge)?))
}

fn fold<M, D: Divide, R>(
    memory: &mut M,
    first: usize,
    parts: usize,
    data: D,
    work: &impl Fn(usize, D, &mut M) -> R,
    merge: &impl Fn(R, R) -> R,
) -> R {
    if parts == 1 {
        return work.part(first, data, memory);
    }
    let half = parts / 2;
    let (left, right) = data.divide(half);
    let left = fold(memory, first, half, left, work, merge);
    merge(left, fold(memory, first + half, parts - half, right, work, merge))
}

/// What is done with each part.
trait Work<M, D, R>: Fn(usize, D, &mut M) -> R {
    /// Does it with one. Out of line, as the loops with and without a pool would each have the whole of it within them otherwise; and a method,
    /// as those are compiled along with the closure that they are of, and functions with this file, all in one unit.
    #[inline(never)]
    fn part(&self, number: usize, data: D, memory: &mut M) -> R {
        self(number, data, memory)
    }
}

impl<M, D, R, W: Fn(usize, D, &mut M) -> R> Work<M, D, R> for W {}

/// Arrays that can be divided between threads.
pub(crate) trait Divide: Send + Sized {
    /// So many parts, or fewer, stay on one thread.
    const FEWEST: usize = 1;

    /// The first `parts` parts, and the rest.
    fn divide(self, parts: usize) -> (Self, Self);
}

/// Nodes in a part of a nodal array: few enough to divide a small body evenly.
pub(crate) const NODE_BLOCK: usize = 256;
/// How many such parts are worth handing over, with half a microsecond of work or less in each.
const FEWEST_BLOCKS: usize = 3;

/// How many parts a nodal array has.
pub(crate) fn node_blocks(nodes: usize) -> usize {
    nodes.div_ceil(NODE_BLOCK)
}

/// A nodal array in parts of [`NODE_BLOCK`] nodes, the last one perhaps shorter.
pub(crate) struct NodeBlocks<'a, V>(pub(crate) &'a mut [V]);

impl<V: Send> Divide for NodeBlocks<'_, V> {
    const FEWEST: usize = FEWEST_BLOCKS;

    fn divide(self, parts: usize) -> (Self, Self) {
        let (left, right) = self.0.split_at_mut(parts * NODE_BLOCK);
        (Self(left), Self(right))
    }
}

/// The same for an array that is only read.
pub(crate) struct ReadBlocks<'a, V>(pub(crate) &'a [V]);

impl<V: Sync> Divide for ReadBlocks<'_, V> {
    const FEWEST: usize = FEWEST_BLOCKS;

    fn divide(self, parts: usize) -> (Self, Self) {
        let (left, right) = self.0.split_at(parts * NODE_BLOCK);
        (Self(left), Self(right))
    }
}

impl Divide for () {
    fn divide(self, _: usize) -> (Self, Self) {
        ((), ())
    }
}

impl<A: Divide, B: Divide> Divide for (A, B) {
    const FEWEST: usize = if A::FEWEST > B::FEWEST { A::FEWEST } else { B::FEWEST };

    fn divide(self, parts: usize) -> (Self, Self) {
        let ((a, c), (b, d)) = (self.0.divide(parts), self.1.divide(parts));
        ((a, b), (c, d))
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use super::*;

    /// A sum whose rounding depends on its order.
    fn sum(executor: &Executor, parts: usize) -> Option<f32> {
        executor.fold(parts, (), &|part, ()| 1.0 / (part as f32 + 0.3), &|a, b| a + b)
    }

    #[test]
    fn sums_have_the_same_bits_on_any_number_of_threads() {
        for threads in [2, 3, 8, 9] {
            let executor = Executor::threads(threads).unwrap();
            for parts in [0, 1, 2, 3, 7, 64, 65, 1000] {
                let expected = sum(&Executor::serial(), parts);
                assert_eq!(sum(&executor, parts), expected, "{parts} parts on {threads} threads");
                let inside = executor.enter(|| [sum(&executor, parts), sum(&executor, parts)]);
                assert_eq!(inside, [expected; 2], "{parts} parts within a step on {threads} threads");
            }
        }
    }

    /// Memory is handed from part to part of neighbours, none is left out, and no two threads have the same.
    #[test]
    fn memory_is_made_for_many_parts_at_once() {
        for (threads, most) in [(1, 1), (2, 4), (8, 16)] {
            let executor = Executor::threads(threads).unwrap();
            let made = AtomicUsize::new(0);
            let memory = || {
                made.fetch_add(1, Ordering::Relaxed);
                None
            };
            let follow = |part: usize, (), before: &mut Option<usize>| {
                let last = before.replace(part);
                (last.is_none_or(|last| last + 1 == part), 1)
            };
            let both = |(left, some): (bool, usize), (right, more): (bool, usize)| (left && right, some + more);
            assert_eq!(executor.fold_with(&memory, 1000, (), &follow, &both), Some((true, 1000)));
            let made = made.into_inner();
            assert!((1..=most).contains(&made), "{made} for {threads} threads");
        }
    }

    /// A part that asks for a loop of its own gets it, from its own thread.
    #[test]
    fn loops_within_loops_end() {
        let executor = Executor::threads(3).unwrap();
        let inner = sum(&Executor::serial(), 100);
        let all = executor.fold(20, (), &|_, ()| sum(&executor, 100) == inner, &|a, b| a && b);
        assert_eq!(all, Some(true));
    }

    /// Worlds that share their threads: whoever finds them at work computes alone. With the pool that was here before, a thread that stayed
    /// awake for the one could keep the other waiting for ever.
    #[test]
    fn steps_of_worlds_that_share_their_threads_end() {
        let executor = Executor::threads(2).unwrap();
        let (say, hear) = channel();
        for _ in 0..2 {
            let (executor, say) = (executor.clone(), say.clone());
            std::thread::spawn(move || {
                let expected = sum(&Executor::serial(), 16);
                let good = (0..2000).all(|_| executor.enter(|| (0..4).all(|_| sum(&executor, 16) == expected)));
                say.send(good).unwrap();
            });
        }
        for _ in 0..2 {
            assert_eq!(hear.recv_timeout(Duration::from_secs(100)), Ok(true), "a step does not end, or is wrong");
        }
    }

    /// A part that panics does so in the thread that asked for it, whichever did the part; the threads are there for the next loop.
    #[test]
    fn a_panic_reaches_who_asked_for_the_loop() {
        let executor = Executor::threads(4).unwrap();
        for culprit in 0..16 {
            let work = |part: usize, ()| assert_ne!(part, culprit, "a part fails");
            let result = catch_unwind(AssertUnwindSafe(|| executor.enter(|| executor.each(16, (), &work))));
            assert!(result.is_err(), "part {culprit} failed and nobody heard of it");
            assert_eq!(sum(&executor, 50), sum(&Executor::serial(), 50));
        }
    }
}
