//! Where models put the 3×3 blocks of their tangent when it is assembled.

use std::ops::Range;

use crate::math::{Lanes, MAX_LANES, Mat3, Part, Scalar, Simd, Vec3};
use crate::solver::BlockSink;

/// Takes the blocks of the diagonal, one for each node, and drops the others.
pub(crate) struct DiagonalSink<'a, T>(pub(crate) &'a mut [Mat3<T>]);

impl<T: Scalar> BlockSink<T> for DiagonalSink<'_, T> {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        if row == column {
            self.0[row as usize] += block;
        }
    }

    fn keeps_diagonal_only(&self) -> bool {
        true
    }
}

/// Gives the blocks of a tetrahedron to `sink`, column by column: `product` makes the forces on the corners 1, 2, 3 of how the
/// edges change.
pub(crate) fn add_tet_blocks<T: Scalar>(
    corners: [u32; 4],
    sink: &mut dyn BlockSink<T>,
    product: impl Fn(&Mat3<T>) -> Mat3<T>,
) {
    for corner in 0..4 {
        let columns = [0, 1, 2].map(|axis| {
            let mut ends = [Vec3::ZERO; 4];
            ends[corner][axis] = T::ONE;
            let [f1, f2, f3] =
                product(&Mat3::from_columns(ends[1] - ends[0], ends[2] - ends[0], ends[3] - ends[0])).columns;
            [-(f1 + f2 + f3), f1, f2, f3]
        });
        for p in 0..4 {
            if p == corner || !sink.keeps_diagonal_only() {
                sink.add(corners[p], corners[corner], Mat3 { columns: columns.map(|forces| forces[p]) });
            }
        }
    }
}

/// Gives a batch's column of blocks to `sink`: `columns[axis][p]` is the force on corner p for a unit displacement of
/// corner `corner` along `axis`. The block holds `elements` elements, the lanes beyond are padding.
#[inline(always)]
pub(crate) fn add_block_column<T: Scalar, S: Simd, const CORNERS: usize>(
    part: Part<S>,
    columns: &[[Vec3<T::Lanes<S>>; CORNERS]; 3],
    nodes: &[u32],
    corner: usize,
    elements: usize,
    sink: &mut dyn BlockSink<T>,
) {
    let [x, y, z] = columns;
    for p in 0..CORNERS {
        if p == corner || !sink.keeps_diagonal_only() {
            add_block::<T, S>(part, &Mat3::from_columns(x[p], y[p], z[p]), nodes, [p, corner], elements, sink);
        }
    }
}

/// Gives one block of each element of a batch to `sink`, that of the two `corners`.
#[inline(always)]
pub(crate) fn add_block<T: Scalar, S: Simd>(
    part: Part<S>,
    block: &Mat3<T::Lanes<S>>,
    nodes: &[u32],
    corners: [usize; 2],
    elements: usize,
    sink: &mut dyn BlockSink<T>,
) {
    let mut numbers = [[[T::ZERO; MAX_LANES]; 3]; 3];
    for (stored, column) in numbers.iter_mut().zip(block.columns) {
        for (stored, component) in stored.iter_mut().zip(column.to_array()) {
            component.store(part, stored);
        }
    }
    let [rows, columns] = corners.map(|corner| &nodes[corner * T::LANES..(corner + 1) * T::LANES]);
    let start = part.start::<T, T::Lanes<S>>();
    send(&numbers, rows, columns, start..elements.min(start + T::Lanes::<S>::COUNT), sink);
}

/// Gives one block of each of these lanes to `sink`. Not inlined: the same for every instruction set.
#[inline(never)]
fn send<T: Scalar>(
    numbers: &[[[T; MAX_LANES]; 3]; 3],
    rows: &[u32],
    columns: &[u32],
    lanes: Range<usize>,
    sink: &mut dyn BlockSink<T>,
) {
    for lane in lanes {
        let [a, b, c] = numbers.map(|column| Vec3::from(column.map(|component| component[lane])));
        sink.add(rows[lane], columns[lane], Mat3::from_columns(a, b, c));
    }
}

/// The displacement of one corner by one metre along one axis, the others at rest.
#[inline(always)]
pub(crate) fn unit_displacement<T: Scalar, S: Simd, const CORNERS: usize>(
    simd: S,
    corner: usize,
    axis: usize,
) -> [Vec3<T::Lanes<S>>; CORNERS] {
    let mut corners = [Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO)); CORNERS];
    corners[corner][axis] = T::Lanes::<S>::splat(simd, T::ONE);
    corners
}
