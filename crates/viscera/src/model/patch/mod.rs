//! Cells in patches: parts of a mesh so small that the places and the forces of their nodes stay in the fastest cache, and
//! which are handed to whichever thread is free.
//!
//! A patch numbers its nodes for itself. A node that several patches share has a copy in each of them; the copies are added
//! up in the order of the patches, so that the bits of the sum do not depend on the number of threads.

mod batch;
mod copies;
mod deal;
mod direction;
mod element;
mod fan;
mod tet_fans;
mod visitor;

pub(crate) use element::{Deformed, Diagonal, Element, ForcesAndInvariants, Measure, Measured, Record, Shared};
pub(crate) use tet_fans::TetFans;

use self::copies::Copies;
use crate::executor::{Divide, Executor, NODE_BLOCK, NodeBlocks, node_blocks};
use crate::math::{Mat3, Scalar, Sym3, Vec3, dispatch, dispatch_level, large_pages};
use crate::mesh::partition;

/// The most nodes of a patch: places and forces of so many take 16 kB in single precision. A power of two, so that a number
/// modulo it is a number of a node, and needs no check.
pub(crate) const PATCH_NODES: usize = 512;

/// Nodes that sums are written to at a time.
const TOGETHER: usize = 16;

/// Numbers of the nodes of a patch, four to a node, so that lanes load and store whole rows.
pub(crate) type PatchRows<T> = [[T; 4]; PATCH_NODES];
/// Two rows for each node of a patch.
pub(crate) type PatchPairs<T> = [[T; 4]; 2 * PATCH_NODES];

/// Rows of no patch yet. Loops make them once for many patches: to clear them for each took 4 % of a sub-step.
#[inline(always)]
pub(crate) fn no_rows<T: Scalar, const FIELDS: usize>() -> [PatchRows<T>; FIELDS] {
    [[[T::ZERO; 4]; PATCH_NODES]; FIELDS]
}

/// Clears rows; as one row of numbers, since rows the compiler stores one by one (2 % of forces).
#[inline(always)]
pub(crate) fn clear<T: Scalar>(rows: &mut [[T; 4]]) {
    rows.as_flattened_mut().fill(T::ZERO);
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
    copies: Copies,
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
            let first = patches.rows();
            copies.extend(touched.iter().zip(first..).map(|(&node, row)| (node, row as u32)));
            patches.row_starts.push(first + rows.unwrap_or(touched.len()));
            patches.nodes.append(&mut touched);
            patches.starts.push(patches.nodes.len());
        }
        patches.nodes = large_pages::moved(patches.nodes);
        patches.copies = Copies::new(nodes, copies);
        patches
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Rows for the copies of nodes in all patches together.
    pub(crate) fn rows(&self) -> usize {
        self.row_starts[self.count()]
    }

    /// Nodes of a patch, in ascending order.
    #[inline(always)]
    pub(crate) fn nodes(&self, patch: usize) -> &[u32] {
        &self.nodes[self.starts[patch]..self.starts[patch + 1]]
    }

    /// Size of the stored numbers [bytes].
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + self.copies.bytes()
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
            dispatch!(dispatch_level(), _simd => read_rows(self.nodes(patch), values, rows));
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
        let data = self.per_patch(rows, width);
        executor.each(self.count(), data, &|patch, part: PerPatch<'_, [T; 4]>| work(patch, part.values));
    }

    /// The rows of all patches, `width` for each of their nodes.
    pub(crate) fn per_patch<'a, V>(&'a self, rows: &'a mut [V], width: usize) -> PerPatch<'a, V> {
        PerPatch { values: rows, starts: &self.row_starts, width }
    }

    /// Adds to each node of `out` the rows of its copies.
    pub(crate) fn add_up<T: Scalar>(&self, executor: &Executor, rows: &[[T; 4]], out: &mut [Vec3<T>]) {
        let add = |sum: &mut Vec3<T>, row| *sum += force(rows, row);
        self.copies.each(executor, out, &add);
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
        let firsts = self.copies.firsts(block, out.len());
        let row = |number: u32| rows.get(number as usize).copied().unwrap_or([T::ZERO; 4]);
        // The fourth number goes to the next node, which is written after: a row is one load and one store. So many at a time that are known to be
        // there, as a look whether each is takes as long.
        let mut done = 0;
        while let Some((out, firsts)) =
            out[done..].first_chunk_mut::<{ TOGETHER + 1 }>().zip(firsts[done..].first_chunk::<TOGETHER>())
        {
            for node in 0..TOGETHER {
                let [x, y, z, next] = row(firsts[node]);
                out[node] = Vec3::new(x, y, z);
                out[node + 1].x = next;
            }
            done += TOGETHER;
        }
        for (out, &first) in out[done..].iter_mut().zip(&firsts[done..]) {
            let [x, y, z, _] = row(first);
            *out = Vec3::new(x, y, z);
        }
        self.copies.each_other(block, out, |sum, row| *sum += force(rows, row));
    }

    /// Adds to each node of `out` the rows of its copies, where `out` has rows as well.
    pub(crate) fn add_up_rows<T: Scalar>(&self, executor: &Executor, rows: &[[T; 4]], out: &mut [[T; 4]]) {
        let add = |sum: &mut [T; 4], row: usize| {
            let [x, y, z] = force(rows, row).to_array();
            *sum = [sum[0] + x, sum[1] + y, sum[2] + z, sum[3]];
        };
        self.copies.each(executor, out, &add);
    }

    /// Adds to each node of `out` the symmetric blocks of its copies: xx, yy, zz in one row, xy, xz, yz in the next.
    pub(crate) fn add_up_blocks<T: Scalar>(&self, executor: &Executor, rows: &[[T; 4]], out: &mut [Mat3<T>]) {
        executor.each(node_blocks(out.len()), NodeBlocks(out), &|block, NodeBlocks(out)| {
            let mut blocks = [Sym3::diagonal(T::ZERO); NODE_BLOCK];
            let blocks = &mut blocks[..out.len()];
            self.write_up_blocks(block, rows, blocks);
            out.iter_mut().zip(blocks).for_each(|(out, block)| *out += Mat3::from(*block));
        });
    }

    /// Writes to each of a block of nodes the sum of the symmetric blocks of its copies.
    pub(crate) fn write_up_blocks<T: Scalar>(&self, block: usize, rows: &[[T; 4]], out: &mut [Sym3<T>]) {
        dispatch!(dispatch_level(), _simd => {
            out.fill(Sym3::diagonal(T::ZERO));
            self.copies.each_of_block(block, out, &|sum: &mut Sym3<T>, row| *sum = *sum + block_of(rows, row));
        });
    }
}

/// Reads nodes in ascending order. The fourth number of a row is whatever comes next: a row is one load and one store then.
#[inline(always)]
fn read_rows<T: Scalar>(nodes: &[u32], values: &[Vec3<T>], rows: &mut PatchRows<T>) {
    let Some((&last, most)) = nodes.split_last() else { return };
    for (row, &node) in rows.iter_mut().zip(most) {
        let [own, next] = [values[node as usize], values[node as usize + 1]];
        *row = [own.x, own.y, own.z, next.x];
    }
    let Vec3 { x, y, z } = values[last as usize];
    rows[most.len()] = [x, y, z, T::ZERO];
}

/// The force in a row.
#[inline(always)]
fn force<T: Scalar>(rows: &[[T; 4]], row: usize) -> Vec3<T> {
    let [x, y, z, _] = rows[row];
    Vec3::new(x, y, z)
}

/// The symmetric block of a copy.
#[inline(always)]
fn block_of<T: Scalar>(rows: &[[T; 4]], copy: usize) -> Sym3<T> {
    let ([xx, yy, zz], [xy, xz, yz]) = (force(rows, 2 * copy).to_array(), force(rows, 2 * copy + 1).to_array());
    Sym3 { xx, yy, zz, xy, xz, yz }
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
