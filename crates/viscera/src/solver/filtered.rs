use super::Filter;
use crate::math::{Scalar, Vec3};

/// The filters of all nodes, and which nodes are not free: most are, and need no look.
#[derive(Clone, Copy, Debug)]
pub struct Filtered<'a, T> {
    /// Nodes of which nothing is free, in ascending order.
    pub held: &'a [u32],
    /// Nodes that are free in a plane or along a line, in ascending order.
    pub sliding: &'a [u32],
    /// S of every node.
    pub filters: &'a [Filter<T>],
}

impl<T: Scalar> Filtered<'_, T> {
    /// S v, where `v` holds the nodes from `first` on.
    pub(crate) fn apply(&self, first: usize, v: &mut [Vec3<T>]) {
        for &node in among(self.held, first, v.len()) {
            v[node as usize - first] = Vec3::ZERO;
        }
        self.apply_to_sliding(first, v);
    }

    /// S v + (I − S) prescribed, with the prescribed values of all nodes.
    pub(crate) fn merge(&self, first: usize, v: &mut [Vec3<T>], prescribed: &[Vec3<T>]) {
        for nodes in [self.held, self.sliding] {
            for node in among(nodes, first, v.len()).iter().map(|&node| node as usize) {
                v[node - first] = self.filters[node].merge(v[node - first], prescribed[node]);
            }
        }
    }

    /// [`Filtered::apply`] where held nodes have none. Once would leave the rounding of reactions, which are larger by far than what is
    /// left of a residual; twice leaves the rounding of that.
    pub(crate) fn apply_to_sliding(&self, first: usize, v: &mut [Vec3<T>]) {
        for &node in among(self.sliding, first, v.len()) {
            let (filter, value) = (&self.filters[node as usize], &mut v[node as usize - first]);
            *value = filter.apply(filter.apply(*value));
        }
    }
}

/// Those of `nodes` that are among the `count` from `first` on.
pub(crate) fn among(nodes: &[u32], first: usize, count: usize) -> &[u32] {
    let place = |node: usize| nodes.partition_point(|&other| (other as usize) < node);
    &nodes[place(first)..place(first + count)]
}
