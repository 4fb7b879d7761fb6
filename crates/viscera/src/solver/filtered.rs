use super::Filter;
use crate::math::{Scalar, Vec3};

/// The filters of all nodes, and which nodes are not free: most are, and need no look.
#[derive(Clone, Copy, Debug)]
pub struct Filtered<'a, T> {
    /// Nodes with a prescribed direction, in ascending order.
    pub nodes: &'a [u32],
    /// S of every node.
    pub filters: &'a [Filter<T>],
}

impl<T: Scalar> Filtered<'_, T> {
    /// S v, where `v` holds the nodes from `first` on. Once would leave the rounding of reactions, which are larger by far than what is
    /// left of a residual; twice leaves the rounding of that.
    pub(crate) fn apply(&self, first: usize, v: &mut [Vec3<T>]) {
        let place = |node: usize| self.nodes.partition_point(|&other| (other as usize) < node);
        for &node in &self.nodes[place(first)..place(first + v.len())] {
            let (filter, value) = (&self.filters[node as usize], &mut v[node as usize - first]);
            *value = filter.apply(filter.apply(*value));
        }
    }
}
