//! Batches of a loop in sections of a fixed length, which are handed to whichever thread is free.
//!
//! A section sums on copies of the nodes that it touches; the copies are added up in the order of the sections, so that the bits
//! of the sum do not depend on the number of threads. For loops whose batches keep the order of the mesh: those over tetrahedra
//! run in patches, which also keep places in the fastest cache.

use std::ops::Range;

use super::block_table::BlockTable;
use super::patch::{Patches, clear};
use crate::executor::{Divide, Executor, NodeBlocks, ReadBlocks, node_blocks};
use crate::math::{Mat3, Scalar, Vec3, dispatch, dispatch_level};

/// Batches in a section. Fewer, and copies at the seams weigh; more, and ten thousand cells are too few sections for two threads.
const BATCHES: usize = 64;

/// The sections of a loop.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sections {
    batches: usize,
    copies: Patches,
    /// For each entry of the loop's table of nodes, its row among the copies of its section.
    rows: Vec<u32>,
}

impl Sections {
    /// Sections of a loop over a body of `nodes` nodes; batch i touches the nodes `table[starts[i]..starts[i + 1]]`.
    pub(crate) fn new(nodes: usize, table: &[u32], starts: &[usize]) -> Self {
        let batches = starts.len() - 1;
        let bounds = |section: usize| starts[section * BATCHES]..starts[batches.min((section + 1) * BATCHES)];
        let touched = |section: usize| {
            let mut touched = table[bounds(section)].to_vec();
            touched.sort_unstable();
            touched.dedup();
            touched
        };
        let copies = Patches::over(nodes, (0..batches.div_ceil(BATCHES)).map(touched), None);
        let mut rows = vec![0; table.len()];
        for section in 0..copies.count() {
            let own = copies.nodes(section);
            for entry in bounds(section) {
                rows[entry] = own.partition_point(|&node| node < table[entry]) as u32;
            }
        }
        Self { batches, copies, rows }
    }

    /// Sections of a loop over the blocks of a table of `columns` nodes a row.
    pub(crate) fn of_table(nodes: usize, table: &BlockTable<u32>) -> Self {
        let entries: Vec<u32> = table.blocks().flatten().copied().collect();
        let mut starts = vec![0];
        starts.extend(table.blocks().scan(0, |end, block| {
            *end += block.len();
            Some(*end)
        }));
        Self::new(nodes, &entries, &starts)
    }

    /// Rows that the loop sums in.
    pub(crate) fn sum_rows(&self) -> usize {
        self.copies.rows()
    }

    /// The rows of the nodes in `entries` of the table, among the copies of their section.
    #[inline(always)]
    pub(crate) fn rows(&self, entries: Range<usize>) -> &[u32] {
        &self.rows[entries]
    }

    /// Size of the stored numbers [bytes].
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.rows.as_slice()) + self.copies.bytes()
    }

    /// Lets `work` write the numbers of the batches of each section, `width` for each batch.
    pub(crate) fn each<T: Scalar>(
        &self,
        executor: &Executor,
        numbers: &mut [T],
        width: usize,
        work: &(impl Fn(Range<usize>, &mut [T]) + Sync),
    ) {
        let data = Chunks { values: numbers, size: BATCHES * width };
        executor.each(self.copies.count(), data, &|section, part: Chunks<'_, T>| {
            work(section * BATCHES..self.batches.min((section + 1) * BATCHES), part.values);
        });
    }

    /// Lets `work` sum the batches of each section in its rows, and adds these up.
    pub(crate) fn add<T: Scalar>(
        &self,
        sums: &mut SectionSums<'_, T>,
        work: &(impl Fn(Range<usize>, &mut [[T; 4]]) + Sync),
    ) {
        let rows = &mut sums.rows[..self.sum_rows()];
        self.copies.each(sums.executor, rows, 1, &|section, rows| {
            clear(rows);
            work(section * BATCHES..self.batches.min((section + 1) * BATCHES), rows);
        });
        self.copies.add_up_rows(sums.executor, rows, sums.forces);
    }

    /// The same for symmetric blocks, which `work` sums in two rows for each copy: xx, yy, zz, then xy, xz, yz.
    pub(crate) fn add_blocks<T: Scalar>(
        &self,
        sums: &mut SectionSums<'_, T>,
        out: &mut [Mat3<T>],
        work: &(impl Fn(Range<usize>, &mut [[T; 4]]) + Sync),
    ) {
        let rows = &mut sums.rows[..2 * self.sum_rows()];
        self.copies.each(sums.executor, rows, 2, &|section, rows| {
            clear(rows);
            work(section * BATCHES..self.batches.min((section + 1) * BATCHES), rows);
        });
        self.copies.add_up_blocks(sums.executor, rows, out);
    }
}

/// An array in parts of equal size, the last one perhaps shorter.
struct Chunks<'a, V> {
    values: &'a mut [V],
    size: usize,
}

impl<V: Send> Divide for Chunks<'_, V> {
    fn divide(self, parts: usize) -> (Self, Self) {
        let (left, right) = self.values.split_at_mut(parts * self.size);
        (Self { values: left, size: self.size }, Self { values: right, size: self.size })
    }
}

/// Who sums, the rows of copies, and where the sums go.
pub(crate) struct SectionSums<'a, T> {
    pub(crate) executor: &'a Executor,
    pub(crate) rows: &'a mut [[T; 4]],
    pub(crate) forces: &'a mut [[T; 4]],
}

/// What loops in sections read and where they sum.
pub(crate) struct SectionScratch<'a, T> {
    pub(crate) nodal: &'a [[T; 4]],
    pub(crate) direction: &'a [[T; 4]],
    pub(crate) linearization: &'a [T],
    pub(crate) sums: SectionSums<'a, T>,
}

/// Writes vectors to rows.
pub(super) fn fill<T: Scalar>(executor: &Executor, rows: &mut [[T; 4]], vectors: &[Vec3<T>]) {
    assert_eq!(rows.len(), vectors.len(), "arrays and scratch must be those of the model's mesh");
    let data = (NodeBlocks(rows), ReadBlocks(vectors));
    executor.each(node_blocks(vectors.len()), data, &|_, (NodeBlocks(rows), ReadBlocks(vectors))| {
        dispatch!(dispatch_level(), _simd => write_rows(rows, vectors));
    });
}

/// Adds rows to vectors.
pub(super) fn add_rows<T: Scalar>(executor: &Executor, rows: &[[T; 4]], out: &mut [Vec3<T>]) {
    assert_eq!(rows.len(), out.len(), "arrays and scratch must be those of the model's mesh");
    let data = (ReadBlocks(rows), NodeBlocks(out));
    executor.each(node_blocks(rows.len()), data, &|_, (ReadBlocks(rows), NodeBlocks(out))| {
        dispatch!(dispatch_level(), _simd => add_up_rows(rows, out));
    });
}

#[inline(always)]
fn write_rows<T: Scalar>(rows: &mut [[T; 4]], vectors: &[Vec3<T>]) {
    for (row, v) in rows.iter_mut().zip(vectors) {
        *row = [v.x, v.y, v.z, T::ZERO];
    }
}

#[inline(always)]
fn add_up_rows<T: Scalar>(rows: &[[T; 4]], out: &mut [Vec3<T>]) {
    for (&[x, y, z, _], out) in rows.iter().zip(out) {
        *out += Vec3::new(x, y, z);
    }
}
