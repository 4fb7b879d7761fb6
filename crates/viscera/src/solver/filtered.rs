use super::Filter;
use crate::math::{Scalar, Vec3};

/// Which nodes are not free.
#[derive(Clone, Debug, Default)]
pub struct FilteredNodes {
    held: Vec<u32>,
    sliding: Vec<u32>,
}

impl FilteredNodes {
    /// Those that these filters of all nodes leave less than free.
    pub fn of<T: Scalar>(filters: &[Filter<T>]) -> Self {
        let mut nodes = Self::default();
        nodes.list(filters, 0..filters.len() as u32);
        nodes
    }

    /// None, with room for so many.
    pub(crate) fn with_room(nodes: usize) -> Self {
        Self { held: Vec::with_capacity(nodes), sliding: Vec::with_capacity(nodes) }
    }

    /// Lists those among `nodes`, which ascend.
    pub(crate) fn list<T: Scalar>(&mut self, filters: &[Filter<T>], nodes: impl Iterator<Item = u32>) {
        self.held.clear();
        self.sliding.clear();
        for node in nodes {
            match filters[node as usize] {
                Filter::Free => {}
                Filter::Held => self.held.push(node),
                _ => self.sliding.push(node),
            }
        }
    }

    /// Together with the filters that they were listed by.
    pub fn with<'a, T>(&'a self, filters: &'a [Filter<T>]) -> Filtered<'a, T> {
        Filtered { held: &self.held, sliding: &self.sliding, filters }
    }
}

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
        for node in self.nodes(first, v.len()) {
            v[node - first] = self.filters[node].merge(v[node - first], prescribed[node]);
        }
    }

    /// Those of the `count` nodes from `first` on that are not free.
    pub(crate) fn nodes(&self, first: usize, count: usize) -> impl Iterator<Item = usize> {
        let lists = [self.held, self.sliding].map(|nodes| among(nodes, first, count));
        lists.into_iter().flatten().map(|&node| node as usize)
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
