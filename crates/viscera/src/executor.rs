//! Who computes: one thread, or a pool of them.
//!
//! Work is divided into parts whose number and bounds follow from the data alone, and results are joined in the order of the
//! parts: the bits of a result do not depend on how many threads there are.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::{ThreadPool, ThreadPoolBuilder, Yield};

/// How often a thread looks for work before it lets others have its core.
const PATIENCE: u32 = 1000;

/// Threads that a step may use; by default just the one that calls.
///
/// Cloning is cheap, and clones share their threads.
#[derive(Clone, Debug, Default)]
pub struct Executor {
    pool: Option<Arc<ThreadPool>>,
    /// Whether each thread has a core of its own, as far as the machine goes.
    has_cores: bool,
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
        source: rayon::ThreadPoolBuildError,
    },
}

impl Executor {
    /// The calling thread alone.
    pub fn serial() -> Self {
        Self::default()
    }

    /// A pool of `threads` threads [≥ 1]; one thread needs no pool.
    ///
    /// # Errors
    /// [`ExecutorError::NoThreads`] where the system refuses to start them.
    pub fn threads(threads: usize) -> Result<Self, ExecutorError> {
        if threads <= 1 {
            return Ok(Self::serial());
        }
        let has_cores = std::thread::available_parallelism().is_ok_and(|cores| threads <= cores.get());
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.map(|pool| Self { pool: Some(Arc::new(pool)), has_cores })
            .map_err(|source| ExecutorError::NoThreads { threads, source })
    }

    /// How many threads there are.
    pub fn thread_count(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// Does `work` among the threads: what it divides then finds them awake. A step has hundreds of loops of a few microseconds,
    /// and to wake a thread for each takes longer. Threads without a core of their own would only be in each other's way.
    pub(crate) fn enter<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) if self.has_cores => pool.install(|| among_wakeful_threads(work)),
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// Hands part after part of `data` to `work`, with the part's number, on whichever threads are free.
    pub(crate) fn each<D: Divide>(&self, parts: usize, data: D, work: &(impl Fn(usize, D) + Sync)) {
        self.fold(parts, data, work, &|(), ()| ());
    }

    /// The same where every part has a result: neighbours are merged two by two, always the same two. None without parts.
    pub(crate) fn fold<D: Divide, R: Send>(
        &self,
        parts: usize,
        data: D,
        work: &(impl Fn(usize, D) -> R + Sync),
        merge: &(impl Fn(R, R) -> R + Sync),
    ) -> Option<R> {
        (parts > 0).then(|| match &self.pool {
            Some(pool) if parts > 1 => pool.install(|| fold::<D, R, true>(0, parts, data, work, merge)),
            _ => fold::<D, R, false>(0, parts, data, work, merge),
        })
    }
}

thread_local! {
    /// How much work, and how many parts that may have come from another thread, this thread is in the middle of.
    static AT_WORK: Cell<u32> = const { Cell::new(0) };
}

/// Does `work` while the other threads of the pool look for parts of it without sleeping in between.
///
/// A thread may hear that it is to stay awake while it waits in the middle of a part, or of other work. There it must not stay: who
/// waits for it would wait until this work is finished, which may wait for them.
fn among_wakeful_threads<R>(work: impl FnOnce() -> R) -> R {
    let finished = AtomicBool::new(false);
    rayon::in_place_scope(|scope| {
        scope.spawn_broadcast(|_, _| {
            let (is_idle, mut vain) = (AT_WORK.get() == 0, 0);
            while is_idle && !finished.load(Ordering::Acquire) {
                vain = if rayon::yield_now() == Some(Yield::Executed) { 0 } else { vain + 1 };
                if vain < PATIENCE {
                    std::hint::spin_loop();
                } else {
                    std::thread::yield_now();
                }
            }
        });
        let _finish = Finish(&finished);
        let _at_work = AtWork::begin();
        work()
    })
}

/// While it lives, its thread is at work.
struct AtWork;

impl AtWork {
    fn begin() -> Self {
        AT_WORK.set(AT_WORK.get() + 1);
        Self
    }
}

impl Drop for AtWork {
    fn drop(&mut self) {
        AT_WORK.set(AT_WORK.get() - 1);
    }
}

/// Says that the work is finished, also where it panics.
struct Finish<'a>(&'a AtomicBool);

impl Drop for Finish<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

fn fold<D: Divide, R: Send, const POOL: bool>(
    first: usize,
    parts: usize,
    data: D,
    work: &(impl Fn(usize, D) -> R + Sync),
    merge: &(impl Fn(R, R) -> R + Sync),
) -> R {
    if parts == 1 {
        return work.part(first, data);
    }
    if POOL && parts <= D::FEWEST {
        return fold::<D, R, false>(first, parts, data, work, merge);
    }
    let half = parts / 2;
    let (left, right) = data.divide(half);
    let left = || fold::<D, R, POOL>(first, half, left, work, merge);
    let right = || {
        let _at_work = POOL.then(AtWork::begin);
        fold::<D, R, POOL>(first + half, parts - half, right, work, merge)
    };
    let (left, right) = if POOL { rayon::join(left, right) } else { (left(), right()) };
    merge(left, right)
}

/// What is done with each part.
trait Work<D, R>: Fn(usize, D) -> R {
    /// Does it with one. Out of line, as the loops with and without a pool would each have the whole of it within them otherwise; and a method,
    /// as those are compiled along with the closure that they are of, and functions with this file, all in one unit.
    #[inline(never)]
    fn part(&self, number: usize, data: D) -> R {
        self(number, data)
    }
}

impl<D, R, W: Fn(usize, D) -> R> Work<D, R> for W {}

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
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use super::*;

    /// Threads that stayed awake in the middle of a part kept others waiting, who kept them waiting: once in some thousand steps of one
    /// world, and at once where two worlds share their threads.
    #[test]
    fn steps_of_worlds_that_share_their_threads_end() {
        let executor = Executor { has_cores: true, ..Executor::threads(2).unwrap() };
        let (say, hear) = channel();
        for _ in 0..2 {
            let (executor, say) = (executor.clone(), say.clone());
            std::thread::spawn(move || {
                for _ in 0..2000 {
                    executor.enter(|| {
                        for _ in 0..4 {
                            executor.each(16, (), &|part, ()| (0..part * 8).for_each(|_| std::hint::spin_loop()));
                        }
                    });
                }
                say.send(()).unwrap();
            });
        }
        for _ in 0..2 {
            assert_eq!(hear.recv_timeout(Duration::from_secs(100)), Ok(()), "a step does not end");
        }
    }
}
