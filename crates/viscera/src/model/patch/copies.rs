use crate::executor::{Executor, NODE_BLOCK, NodeBlocks, node_blocks};
use crate::math::{dispatch, dispatch_level, large_pages};

/// Where the copies of nodes are among the rows of all patches.
///
/// First copies stand apart from the others. Most nodes have one, and a loop over the copies of each node is taken by surprise wherever their
/// number changes, which took a quarter of the time of adding them up.
#[derive(Clone, Debug, Default)]
pub(super) struct Copies {
    /// The row of the first copy of each node; [`NONE`] where there is none.
    firsts: Vec<u32>,
    /// Node and row of each other copy, node after node, in the order of the patches.
    others: Vec<(u32, u32)>,
    /// Where those of each block of nodes begin in `others`, and the end.
    starts: Vec<u32>,
}

/// No row has this number.
const NONE: u32 = u32::MAX;

impl Copies {
    /// Those of `nodes` nodes: node and row of each, in the order of the patches.
    pub(super) fn new(nodes: usize, mut copies: Vec<(u32, u32)>) -> Self {
        copies.sort_by_key(|&(node, _)| node);
        let mut firsts = large_pages::filled(nodes, NONE);
        let mut others = Vec::new();
        for (node, row) in copies {
            if firsts[node as usize] == NONE {
                firsts[node as usize] = row;
            } else {
                others.push((node, row));
            }
        }
        let start = |block: usize| others.partition_point(|&(node, _)| (node as usize) < block * NODE_BLOCK) as u32;
        let starts = (0..=node_blocks(nodes)).map(start).collect();
        Self { firsts, others: large_pages::moved(others), starts }
    }

    /// Size of the stored numbers [bytes].
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.firsts.as_slice()) + size_of_val(self.others.as_slice())
    }

    /// Whether a row is the first copy of its node.
    pub(super) fn is_first(&self, node: u32, row: usize) -> bool {
        self.firsts[node as usize] as usize == row
    }

    /// Hands each node to `add` with the row of each of its copies.
    pub(super) fn each<V: Send>(&self, executor: &Executor, out: &mut [V], add: &(impl Fn(&mut V, usize) + Sync)) {
        executor.each(node_blocks(out.len()), NodeBlocks(out), &|block, NodeBlocks(out)| {
            dispatch!(dispatch_level(), _simd => self.each_of_block(block, out, add));
        });
    }

    /// The same for a block of nodes.
    #[inline(always)]
    pub(super) fn each_of_block<V>(&self, block: usize, out: &mut [V], add: &impl Fn(&mut V, usize)) {
        for (sum, &row) in out.iter_mut().zip(self.firsts(block, NODE_BLOCK)) {
            if row != NONE {
                add(sum, row as usize);
            }
        }
        self.each_other(block, out, add);
    }

    /// The rows of the first copies of `nodes` nodes of a block; [`NONE`] where there is none, which is beyond all rows.
    #[inline(always)]
    pub(super) fn firsts(&self, block: usize, nodes: usize) -> &[u32] {
        let firsts = &self.firsts[block * NODE_BLOCK..];
        &firsts[..nodes.min(firsts.len())]
    }

    /// Hands nodes of a block to `add` with the row of each copy but the first.
    #[inline(always)]
    pub(super) fn each_other<V>(&self, block: usize, out: &mut [V], add: impl Fn(&mut V, usize)) {
        for &(node, row) in &self.others[self.starts[block] as usize..self.starts[block + 1] as usize] {
            add(&mut out[node as usize - block * NODE_BLOCK], row as usize);
        }
    }
}
