//! Who computes: one thread, or a team of them.
//!
//! Work is divided into parts whose number and bounds follow from the data alone, and results are joined in the order of the
//! parts: the bits of a result do not depend on how many threads there are.

use std::sync::{Arc, Mutex, PoisonError};

use viscera_team::Team;

/// Threads that a step may use; by default just the one that calls.
///
/// Cloning is cheap, and clones share their threads. While one of them is at work for a caller, another caller works alone.
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
        let team = Team::new(threads).map_err(|source| ExecutorError::NoThreads { threads, source })?;
        Ok(Self { team: Some(Arc::new(team)) })
    }

    /// How many threads there are.
    pub fn thread_count(&self) -> usize {
        self.team.as_ref().map_or(1, |team| team.thread_count())
    }

    /// Does `work` while the threads stand ready for its loops. A step has hundreds of a few microseconds, and to wake a thread for each
    /// takes longer.
    pub(crate) fn enter<R>(&self, work: impl FnOnce() -> R) -> R {
        match &self.team {
            Some(team) => team.stand_ready(work),
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
        (parts > 0).then(|| match &self.team {
            Some(team) if parts > 1 => fold_together(team, parts, data, work, merge),
            _ => fold(0, parts, data, work, merge),
        })
    }
}

fn fold<D: Divide, R>(
    first: usize,
    parts: usize,
    data: D,
    work: &impl Fn(usize, D) -> R,
    merge: &impl Fn(R, R) -> R,
) -> R {
    if parts == 1 {
        return work(first, data);
    }
    let half = parts / 2;
    let (left, right) = data.divide(half);
    let left = fold(first, half, left, work, merge);
    merge(left, fold(first + half, parts - half, right, work, merge))
}

/// Branches of a fold for each thread, so that one that is late leaves some to the others, and the most of them at all: each has to
/// come from one core's cache into another's.
const BRANCHES: usize = 2;
const MOST_BRANCHES: usize = 16;

/// A branch of a fold: not begun yet, or folded.
enum Branch<D, R> {
    Waiting { first: usize, parts: usize, data: D },
    Folded(R),
}

/// The same as [`fold`], to the bit: the threads take whole branches of the same tree, each beginning with those that were its own in the loop
/// before.
fn fold_together<D: Divide, R: Send>(
    team: &Team,
    parts: usize,
    data: D,
    work: &(impl Fn(usize, D) -> R + Sync),
    merge: &(impl Fn(R, R) -> R + Sync),
) -> R {
    let threads = team.thread_count();
    let depth = (BRANCHES * threads).min(MOST_BRANCHES).next_power_of_two().ilog2();
    let mut branches: [Mutex<Option<Branch<D, R>>>; MOST_BRANCHES] = [const { Mutex::new(None) }; MOST_BRANCHES];
    let mut count = 0;
    branch_out(0, parts, data, depth, &mut |branch| {
        *branches[count].get_mut().unwrap_or_else(PoisonError::into_inner) = Some(branch);
        count += 1;
    });
    team.together(&|thread| {
        for turn in 0..count {
            let branch = &branches[(thread * count / threads + turn) % count];
            let lock = || branch.lock().unwrap_or_else(PoisonError::into_inner);
            let waiting = lock().take_if(|branch| matches!(branch, Branch::Waiting { .. }));
            if let Some(Branch::Waiting { first, parts, data }) = waiting {
                let folded = fold(first, parts, data, work, merge);
                *lock() = Some(Branch::Folded(folded));
            }
        }
    });
    let mut results =
        branches.into_iter().map_while(|branch| match branch.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(Branch::Folded(result)) => Some(result),
            _ => None,
        });
    join_branches(parts, depth, &mut results, merge).expect("a round of the team does every branch, or panics")
}

/// Divides a fold into branches, `depth` times at most, from left to right.
fn branch_out<D: Divide, R>(first: usize, parts: usize, data: D, depth: u32, hand_out: &mut impl FnMut(Branch<D, R>)) {
    if parts == 1 || depth == 0 {
        return hand_out(Branch::Waiting { first, parts, data });
    }
    let half = parts / 2;
    let (left, right) = data.divide(half);
    branch_out(first, half, left, depth - 1, hand_out);
    branch_out(first + half, parts - half, right, depth - 1, hand_out);
}

/// Merges the results of the branches as [`fold`] would have.
fn join_branches<R>(
    parts: usize,
    depth: u32,
    results: &mut impl Iterator<Item = R>,
    merge: &impl Fn(R, R) -> R,
) -> Option<R> {
    if parts == 1 || depth == 0 {
        return results.next();
    }
    let half = parts / 2;
    let left = join_branches(half, depth - 1, results, merge)?;
    Some(merge(left, join_branches(parts - half, depth - 1, results, merge)?))
}

/// Arrays that can be divided between threads.
pub(crate) trait Divide: Send + Sized {
    /// The first `parts` parts, and the rest.
    fn divide(self, parts: usize) -> (Self, Self);
}

/// Nodes in a part of a nodal array: enough work to be worth handing over, and few enough to divide a small body evenly.
pub(crate) const NODE_BLOCK: usize = 256;

/// How many parts a nodal array has.
pub(crate) fn node_blocks(nodes: usize) -> usize {
    nodes.div_ceil(NODE_BLOCK)
}

/// A nodal array in parts of [`NODE_BLOCK`] nodes, the last one perhaps shorter.
pub(crate) struct NodeBlocks<'a, V>(pub(crate) &'a mut [V]);

impl<V: Send> Divide for NodeBlocks<'_, V> {
    fn divide(self, parts: usize) -> (Self, Self) {
        let (left, right) = self.0.split_at_mut(parts * NODE_BLOCK);
        (Self(left), Self(right))
    }
}

/// The same for an array that is only read.
pub(crate) struct ReadBlocks<'a, V>(pub(crate) &'a [V]);

impl<V: Sync> Divide for ReadBlocks<'_, V> {
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
    fn divide(self, parts: usize) -> (Self, Self) {
        let ((a, c), (b, d)) = (self.0.divide(parts), self.1.divide(parts));
        ((a, b), (c, d))
    }
}
