//! Cells in patches: parts of a mesh so small that the places and the forces of their nodes stay in the fastest cache, and
//! which are handed to whichever thread is free.
//!
//! A patch numbers its nodes for itself. A node that several patches share has a copy in each of them; the copies are added
//! up in the order of the patches, so that the bits of the sum do not depend on the number of threads.

mod fan;
mod partition;
mod tet_fans;
mod visitor;

pub(crate) use tet_fans::{Diagonal, Element, Measure, Record, TetFans};

use fearless_simd::dispatch;

use self::partition::partition;
use crate::executor::{Divide, Executor, NODE_BLOCK, NodeBlocks, node_blocks};
use crate::math::{Mat3, Scalar, Sym3, Vec3, dispatch_level};
use crate::model::Inertia;
use crate::solver::dot_of;

/// The most nodes of a patch: places and forces of so many take 16 kB in single precision. A power of two, so that a number
/// modulo it is a number of a node, and needs no check.
pub(crate) const PATCH_NODES: usize = 512;

/// Numbers of the nodes of a patch, four to a node, so that lanes load and store whole rows.
pub(crate) type PatchRows<T> = [[T; 4]; PATCH_NODES];

/// Rows of no patch yet.
#[inline(always)]
pub(crate) fn no_rows<T: Scalar, const FIELDS: usize>() -> [PatchRows<T>; FIELDS] {
    [[[T::ZERO; 4]; PATCH_NODES]; FIELDS]
}

/// The patches of a mesh, and where the copies of its nodes are in them.
#[derive(Clone, Debug, Default)]
pub struct Patches {
    /// Nodes of each patch, patch after patch.
    nodes: Vec<u32>,
    /// Where each patch begins in `nodes`, and the end.
    starts: Vec<usize>,
    /// Where the rows of each patch begin, and the end.
    row_starts: Vec<usize>,
    /// The rows of the copies of each node, node after node.
    copies: Vec<u32>,
    /// Where each node begins in `copies`, and the end.
    copy_starts: Vec<u32>,
}

impl Patches {
    /// Divides `cells` over the `nodes` [m]; gives the cells of each patch as well.
    pub(crate) fn new<const CORNERS: usize>(nodes: &[Vec3<f64>], cells: &[[u32; CORNERS]]) -> (Self, Vec<Vec<u32>>) {
        let parts = partition(nodes, cells, PATCH_NODES);
        let touched = |part: &Vec<u32>| {
            let mut touched: Vec<u32> = part.iter().flat_map(|&cell| cells[cell as usize]).collect();
            touched.sort_unstable();
            touched.dedup();
            touched
        };
        (Self::over(nodes.len(), parts.iter().map(touched), Some(PATCH_NODES)), parts)
    }

    /// Parts of a mesh of `nodes` nodes that touch the nodes of `parts`, in ascending order; of as many `rows`, or as many as they have nodes.
    pub(crate) fn over(nodes: usize, parts: impl Iterator<Item = Vec<u32>>, rows: Option<usize>) -> Self {
        let mut patches = Self { starts: vec![0], row_starts: vec![0], ..Self::default() };
        let mut copies = Vec::new();
        for mut touched in parts {
            let first = patches.copies();
            copies.extend(touched.iter().zip(first..).map(|(&node, row)| (node, row as u32)));
            patches.row_starts.push(first + rows.unwrap_or(touched.len()));
            patches.nodes.append(&mut touched);
            patches.starts.push(patches.nodes.len());
        }
        copies.sort_by_key(|&(node, _)| node);
        patches.copies = copies.iter().map(|&(_, row)| row).collect();
        let mut ends = vec![0; nodes + 1];
        for (node, _) in copies {
            ends[node as usize + 1] += 1;
        }
        for node in 0..nodes {
            ends[node + 1] += ends[node];
        }
        patches.copy_starts = ends;
        patches
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Rows for the copies of nodes in all patches together.
    pub(crate) fn copies(&self) -> usize {
        self.row_starts[self.count()]
    }

    /// Nodes of a patch, in ascending order.
    #[inline(always)]
    pub(crate) fn nodes(&self, patch: usize) -> &[u32] {
        &self.nodes[self.starts[patch]..self.starts[patch + 1]]
    }

    /// Size of the stored numbers [bytes].
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
            + size_of_val(self.copies.as_slice())
            + size_of_val(self.copy_starts.as_slice())
    }

    /// Reads the nodes of a patch from nodal arrays. The rows are the caller's, so that they are not moved about.
    #[inline(always)]
    pub(crate) fn gather<T: Scalar, const FIELDS: usize>(
        &self,
        patch: usize,
        fields: &[&[Vec3<T>]; FIELDS],
        rows: &mut [PatchRows<T>; FIELDS],
    ) {
        for (rows, values) in rows.iter_mut().zip(fields) {
            for (row, &node) in rows.iter_mut().zip(self.nodes(patch)) {
                let value = values[node as usize];
                *row = [value.x, value.y, value.z, T::ZERO];
            }
        }
    }

    /// Lets `work` write the rows of each patch, `width` for each of its nodes.
    pub(crate) fn each<T: Scalar>(
        &self,
        executor: &Executor,
        rows: &mut [[T; 4]],
        width: usize,
        work: &(impl Fn(usize, &mut [[T; 4]]) + Sync),
    ) {
        let data = PerPatch { values: rows, starts: &self.row_starts, width };
        executor.each(self.count(), data, &|patch, part: PerPatch<'_, [T; 4]>| work(patch, part.values));
    }

    /// Adds to each node of `out` the rows of its copies.
    pub(crate) fn add_up<T: Scalar>(&self, executor: &Executor, rows: &[[T; 4]], out: &mut [Vec3<T>]) {
        self.for_copies(executor, out, &|sum: &mut Vec3<T>, copy| *sum += first_three(rows[copy]));
    }

    /// Writes to each node of `out` the sum of the rows of its copies.
    pub(crate) fn write_up<T: Scalar>(&self, executor: &Executor, rows: &[[T; 4]], out: &mut [Vec3<T>]) {
        executor.each(node_blocks(out.len()), NodeBlocks(out), &|block, NodeBlocks(out)| {
            self.write_up_block(block, rows, out);
        });
    }

    /// The same for a block of nodes.
    #[inline(always)]
    pub(crate) fn write_up_block<T: Scalar>(&self, block: usize, rows: &[[T; 4]], out: &mut [Vec3<T>]) {
        let ends = &self.copy_starts[block * NODE_BLOCK..];
        for (sum, ends) in out.iter_mut().zip(ends.windows(2)) {
            let copies = &self.copies[ends[0] as usize..ends[1] as usize];
            // Most nodes have one.
            *sum = copies.split_first().map_or(Vec3::ZERO, |(&first, others)| {
                others
                    .iter()
                    .fold(first_three(rows[first as usize]), |sum, &copy| sum + first_three(rows[copy as usize]))
            });
        }
    }

    /// Writes to each node of `out` its mass times `dx` and the rows of its copies, filtered; gives `dx`·`out`.
    pub(crate) fn add_up_with_masses<T: Scalar>(
        &self,
        executor: &Executor,
        rows: &[[T; 4]],
        (dx, inertia): (&[Vec3<T>], &Inertia<'_, T>),
        out: &mut [Vec3<T>],
    ) -> f64 {
        assert_eq!(out.len() + 1, self.copy_starts.len(), "arrays and scratch must be those of the model's mesh");
        let work = |block: usize, NodeBlocks(out): NodeBlocks<'_, Vec3<T>>| {
            let nodes = block * NODE_BLOCK..block * NODE_BLOCK + out.len();
            let (dx, masses) = (&dx[nodes.clone()], &inertia.masses[nodes.clone()]);
            let ends = self.copy_starts[nodes.start..=nodes.end].windows(2);
            for (((sum, ends), &dx), &mass) in out.iter_mut().zip(ends).zip(dx).zip(masses) {
                *sum = dx * mass;
                if let Some((&first, others)) = self.copies[ends[0] as usize..ends[1] as usize].split_first() {
                    *sum += first_three(rows[first as usize]);
                    others.iter().for_each(|&copy| *sum += first_three(rows[copy as usize]));
                }
            }
            inertia.filtered.apply(nodes.start, out);
            dispatch!(dispatch_level(), _simd => dot_of(dx, out))
        };
        executor.fold(node_blocks(out.len()), NodeBlocks(out), &work, &|a, b| a + b).unwrap_or(0.0)
    }

    /// The same where `out` has rows as well.
    pub(crate) fn add_up_rows<T: Scalar>(&self, executor: &Executor, rows: &[[T; 4]], out: &mut [[T; 4]]) {
        self.for_copies(executor, out, &|sum: &mut [T; 4], copy| {
            let [x, y, z, _] = rows[copy];
            *sum = [sum[0] + x, sum[1] + y, sum[2] + z, sum[3]];
        });
    }

    /// Adds to each node of `out` the symmetric blocks of its copies: xx, yy, zz in one row, xy, xz, yz in the next.
    pub(crate) fn add_up_blocks<T: Scalar>(&self, executor: &Executor, rows: &[[T; 4]], out: &mut [Mat3<T>]) {
        self.for_copies(executor, out, &|sum: &mut Mat3<T>, copy| {
            let ([xx, yy, zz, _], [xy, xz, yz, _]) = (rows[2 * copy], rows[2 * copy + 1]);
            *sum += Mat3::from(Sym3 { xx, yy, zz, xy, xz, yz });
        });
    }

    /// Hands each copy of each node to `add`, in the order of the patches.
    fn for_copies<V: Send>(&self, executor: &Executor, out: &mut [V], add: &(impl Fn(&mut V, usize) + Sync)) {
        assert_eq!(out.len() + 1, self.copy_starts.len(), "arrays and scratch must be those of the model's mesh");
        executor.each(node_blocks(out.len()), NodeBlocks(out), &|block, out: NodeBlocks<'_, V>| {
            let starts = &self.copy_starts[block * NODE_BLOCK..];
            for (sum, ends) in out.0.iter_mut().zip(starts.windows(2)) {
                for &copy in &self.copies[ends[0] as usize..ends[1] as usize] {
                    add(sum, copy as usize);
                }
            }
        });
    }
}

/// The force in a row.
#[inline(always)]
fn first_three<T: Scalar>([x, y, z, _]: [T; 4]) -> Vec3<T> {
    Vec3::new(x, y, z)
}

/// Values of the patches, patch after patch.
pub(crate) struct PerPatch<'a, V> {
    /// The values of all patches of this part.
    pub(crate) values: &'a mut [V],
    /// Where the items of each patch begin, counted from anywhere, and the end.
    pub(crate) starts: &'a [usize],
    /// Values of an item.
    pub(crate) width: usize,
}

impl<V: Send> Divide for PerPatch<'_, V> {
    fn divide(self, parts: usize) -> (Self, Self) {
        let Self { values, starts, width } = self;
        let (left, right) = values.split_at_mut((starts[parts] - starts[0]) * width);
        (
            Self { values: left, starts: &starts[..=parts], width },
            Self { values: right, starts: &starts[parts..], width },
        )
    }
}
