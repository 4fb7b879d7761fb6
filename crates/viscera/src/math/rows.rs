//! Rows of four numbers to lanes and back, one row for each lane.
//!
//! A register takes rows of two lanes that are half a batch apart into its halves: what is left of the transpose then stays within the halves,
//! where a shuffle takes one cycle, and takes seven of them for eight lanes in place of eleven.
//!
//! Where a row begins is told by the number that it begins with, as processors multiply by four or eight where they address, but not by sixteen.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, f32x16, f64x2, f64x4, f64x8};

/// The number that the row of a lane begins with.
pub(super) trait Start: Fn(usize) -> usize + Copy {}

impl<F: Fn(usize) -> usize + Copy> Start for F {}

#[inline(always)]
fn row<T>(rows: &[T], start: usize) -> &[T] {
    &rows[start..start + 4]
}

#[inline(always)]
fn row_mut<T>(rows: &mut [T], start: usize) -> &mut [T] {
    &mut rows[start..start + 4]
}

/// Columns of eight rows.
#[inline(always)]
pub(super) fn gather_singles<S: Simd>(simd: S, rows: &[f32], start: impl Start) -> [f32x8<S>; 4] {
    let (a, b) = (two_singles(simd, rows, start, 0), two_singles(simd, rows, start, 1));
    let (c, d) = (two_singles(simd, rows, start, 2), two_singles(simd, rows, start, 3));
    let (xy_even, xy_odd) = (zip_low_singles(a, c), zip_low_singles(b, d));
    let (zw_even, zw_odd) = (zip_high_singles(a, c), zip_high_singles(b, d));
    [
        zip_low_singles(xy_even, xy_odd),
        zip_high_singles(xy_even, xy_odd),
        zip_low_singles(zw_even, zw_odd),
        zip_high_singles(zw_even, zw_odd),
    ]
}

/// Columns of sixteen rows.
#[inline(always)]
pub(super) fn gather_wide_singles<S: Simd>(simd: S, rows: &[f32], start: impl Start) -> [f32x16<S>; 4] {
    let (a, b) = (four_singles(simd, rows, start, 0), four_singles(simd, rows, start, 1));
    let (c, d) = (four_singles(simd, rows, start, 2), four_singles(simd, rows, start, 3));
    let (xy_even, xy_odd) = (zip_low_wide(a, c), zip_low_wide(b, d));
    let (zw_even, zw_odd) = (zip_high_wide(a, c), zip_high_wide(b, d));
    [
        zip_low_wide(xy_even, xy_odd),
        zip_high_wide(xy_even, xy_odd),
        zip_low_wide(zw_even, zw_odd),
        zip_high_wide(zw_even, zw_odd),
    ]
}

/// Adds three columns to the first three numbers of eight rows, row after row: they may be the same.
#[inline(always)]
pub(super) fn add_singles<S: Simd>([x, y, z]: [f32x8<S>; 3], start: impl Start, rows: &mut [f32]) {
    let zero: f32x8<S> = SimdBase::splat(x.token(), 0.0);
    let (xz_low, xz_high) = (zip_low_singles(x, z), zip_high_singles(x, z));
    let (y_low, y_high) = (zip_low_singles(y, zero), zip_high_singles(y, zero));
    add_two_singles(zip_low_singles(xz_low, y_low), start, 0, rows);
    add_two_singles(zip_high_singles(xz_low, y_low), start, 1, rows);
    add_two_singles(zip_low_singles(xz_high, y_high), start, 2, rows);
    add_two_singles(zip_high_singles(xz_high, y_high), start, 3, rows);
}

/// The same for sixteen rows.
#[inline(always)]
pub(super) fn add_wide_singles<S: Simd>([x, y, z]: [f32x16<S>; 3], start: impl Start, rows: &mut [f32]) {
    let zero: f32x16<S> = SimdBase::splat(x.token(), 0.0);
    let (xz_low, xz_high) = (zip_low_wide(x, z), zip_high_wide(x, z));
    let (y_low, y_high) = (zip_low_wide(y, zero), zip_high_wide(y, zero));
    add_four_singles(zip_low_wide(xz_low, y_low), start, 0, rows);
    add_four_singles(zip_high_wide(xz_low, y_low), start, 1, rows);
    add_four_singles(zip_low_wide(xz_high, y_high), start, 2, rows);
    add_four_singles(zip_high_wide(xz_high, y_high), start, 3, rows);
}

/// Columns of four rows.
#[inline(always)]
pub(super) fn gather_doubles<S: Simd>(simd: S, rows: &[f64], start: impl Start) -> [f64x4<S>; 4] {
    let (xy_even, zw_even) = two_doubles(simd, rows, start, 0);
    let (xy_odd, zw_odd) = two_doubles(simd, rows, start, 1);
    [
        zip_low_doubles(xy_even, xy_odd),
        zip_high_doubles(xy_even, xy_odd),
        zip_low_doubles(zw_even, zw_odd),
        zip_high_doubles(zw_even, zw_odd),
    ]
}

/// Columns of eight rows.
#[inline(always)]
pub(super) fn gather_wide_doubles<S: Simd>(simd: S, rows: &[f64], start: impl Start) -> [f64x8<S>; 4] {
    let [a, b, c, d] = gather_doubles(simd, rows, start);
    let [e, f, g, h] = gather_doubles(
        simd,
        rows,
        #[inline(always)]
        move |lane| start(lane + 4),
    );
    [a.combine(e), b.combine(f), c.combine(g), d.combine(h)]
}

/// Adds three columns to the first three numbers of four rows, row after row: they may be the same.
#[inline(always)]
pub(super) fn add_doubles<S: Simd>([x, y, z]: [f64x4<S>; 3], start: impl Start, rows: &mut [f64]) {
    let zero: f64x4<S> = SimdBase::splat(x.token(), 0.0);
    add_two_doubles(zip_low_doubles(x, y), zip_low_doubles(z, zero), start, 0, rows);
    add_two_doubles(zip_high_doubles(x, y), zip_high_doubles(z, zero), start, 1, rows);
}

/// The same for eight rows.
#[inline(always)]
pub(super) fn add_wide_doubles<S: Simd>([x, y, z]: [f64x8<S>; 3], start: impl Start, rows: &mut [f64]) {
    let ((x_low, x_high), (y_low, y_high), (z_low, z_high)) = (x.split(), y.split(), z.split());
    add_doubles([x_low, y_low, z_low], start, rows);
    add_doubles(
        [x_high, y_high, z_high],
        #[inline(always)]
        move |lane| start(lane + 4),
        rows,
    );
}

/// Two rows side by side.
#[inline(always)]
pub(super) fn singles_of<S: Simd>(simd: S, row: impl Fn(usize) -> [f32; 4] + Copy) -> f32x8<S> {
    f32x4::from_slice(simd, &row(0)).combine(f32x4::from_slice(simd, &row(1)))
}

/// Four rows.
#[inline(always)]
pub(super) fn wide_singles_of<S: Simd>(simd: S, row: impl Fn(usize) -> [f32; 4] + Copy) -> f32x16<S> {
    singles_of(simd, row).combine(singles_of(
        simd,
        #[inline(always)]
        move |number| row(number + 2),
    ))
}

/// One row.
#[inline(always)]
pub(super) fn doubles_of<S: Simd>(simd: S, row: impl Fn(usize) -> [f64; 4] + Copy) -> f64x4<S> {
    f64x4::from_slice(simd, &row(0))
}

/// Two rows.
#[inline(always)]
pub(super) fn wide_doubles_of<S: Simd>(simd: S, row: impl Fn(usize) -> [f64; 4] + Copy) -> f64x8<S> {
    f64x4::from_slice(simd, &row(0)).combine(f64x4::from_slice(simd, &row(1)))
}

/// The rows of a lane and of the one four behind it.
#[inline(always)]
fn two_singles<S: Simd>(simd: S, rows: &[f32], start: impl Start, lane: usize) -> f32x8<S> {
    let first = f32x4::from_slice(simd, row(rows, start(lane)));
    first.combine(f32x4::from_slice(simd, row(rows, start(lane + 4))))
}

/// The rows of a lane and of those four, eight and twelve behind it.
#[inline(always)]
fn four_singles<S: Simd>(simd: S, rows: &[f32], start: impl Start, lane: usize) -> f32x16<S> {
    two_singles(simd, rows, start, lane).combine(two_singles(simd, rows, start, lane + 8))
}

#[inline(always)]
fn add_two_singles<S: Simd>(added: f32x8<S>, start: impl Start, lane: usize, rows: &mut [f32]) {
    let (first, second) = added.split();
    let row = row_mut(rows, start(lane));
    (f32x4::from_slice(first.token(), row) + first).store_slice(row);
    let row = row_mut(rows, start(lane + 4));
    (f32x4::from_slice(second.token(), row) + second).store_slice(row);
}

#[inline(always)]
fn add_four_singles<S: Simd>(added: f32x16<S>, start: impl Start, lane: usize, rows: &mut [f32]) {
    let (first, second) = added.split();
    add_two_singles(first, start, lane, rows);
    add_two_singles(second, start, lane + 8, rows);
}

/// The first halves of the rows of a lane and of the one two behind it, and the second ones.
#[inline(always)]
fn two_doubles<S: Simd>(simd: S, rows: &[f64], start: impl Start, lane: usize) -> (f64x4<S>, f64x4<S>) {
    let (first, second) = (row(rows, start(lane)), row(rows, start(lane + 2)));
    let xy = f64x2::from_slice(simd, &first[..2]).combine(f64x2::from_slice(simd, &second[..2]));
    let zw = f64x2::from_slice(simd, &first[2..]).combine(f64x2::from_slice(simd, &second[2..]));
    (xy, zw)
}

#[inline(always)]
fn add_two_doubles<S: Simd>(xy: f64x4<S>, zw: f64x4<S>, start: impl Start, lane: usize, rows: &mut [f64]) {
    let ((first_xy, second_xy), (first_zw, second_zw)) = (xy.split(), zw.split());
    let (first, second) = (first_xy.combine(first_zw), second_xy.combine(second_zw));
    let row = row_mut(rows, start(lane));
    (f64x4::from_slice(first.token(), row) + first).store_slice(row);
    let row = row_mut(rows, start(lane + 2));
    (f64x4::from_slice(second.token(), row) + second).store_slice(row);
}

/// The first halves of two registers, or their second ones, number by number in turn, within each 128 bits.
///
/// Spelt with shuffles of 128 bits, the compiler takes registers apart for them and puts them together again: so x86 has its own.
macro_rules! zip_within_halves {
    ($name:ident, $zip:ident, $lanes:ident, $register:ident, $unpack:ident, $x86:ident) => {
        #[cfg(target_arch = "x86_64")]
        fearless_simd::kernel!(
            #[inline]
            fn $x86(
                avx2: Avx2,
                a: std::arch::x86_64::$register,
                b: std::arch::x86_64::$register,
            ) -> std::arch::x86_64::$register {
                std::arch::x86_64::$unpack(a, b)
            }
        );

        #[inline(always)]
        fn $name<S: Simd>(a: $lanes<S>, b: $lanes<S>) -> $lanes<S> {
            #[cfg(target_arch = "x86_64")]
            if let Some(avx2) = a.token().level().as_avx2() {
                return $x86(avx2, a.into(), b.into()).simd_into(a.token());
            }
            let ((a_low, a_high), (b_low, b_high)) = (a.split(), b.split());
            a_low.$zip(b_low).combine(a_high.$zip(b_high))
        }
    };
}

zip_within_halves!(zip_low_singles, zip_low, f32x8, __m256, _mm256_unpacklo_ps, unpack_low_singles);
zip_within_halves!(zip_high_singles, zip_high, f32x8, __m256, _mm256_unpackhi_ps, unpack_high_singles);
zip_within_halves!(zip_low_doubles, zip_low, f64x4, __m256d, _mm256_unpacklo_pd, unpack_low_doubles);
zip_within_halves!(zip_high_doubles, zip_high, f64x4, __m256d, _mm256_unpackhi_pd, unpack_high_doubles);

/// The same of sixteen numbers, within each 128 bits.
macro_rules! zip_within_quarters {
    ($name:ident, $of_halves:ident, $unpack:ident, $x86:ident) => {
        #[cfg(target_arch = "x86_64")]
        fearless_simd::kernel!(
            #[inline]
            fn $x86(
                avx512: Avx512,
                a: std::arch::x86_64::__m512,
                b: std::arch::x86_64::__m512,
            ) -> std::arch::x86_64::__m512 {
                std::arch::x86_64::$unpack(a, b)
            }
        );

        #[inline(always)]
        fn $name<S: Simd>(a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
            #[cfg(target_arch = "x86_64")]
            if let Some(avx512) = a.token().level().as_avx512() {
                return $x86(avx512, a.into(), b.into()).simd_into(a.token());
            }
            let ((a_low, a_high), (b_low, b_high)) = (a.split(), b.split());
            $of_halves(a_low, b_low).combine($of_halves(a_high, b_high))
        }
    };
}

zip_within_quarters!(zip_low_wide, zip_low_singles, _mm512_unpacklo_ps, unpack_low_wide);
zip_within_quarters!(zip_high_wide, zip_high_singles, _mm512_unpackhi_ps, unpack_high_wide);

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::math::dispatch_level;

    /// Columns come back into the rows that they were read from, each number to where it was, and rows that lanes share get all.
    #[test]
    fn rows_are_read_and_added_to_lane_by_lane() {
        let nodes = [3, 0, 7, 5, 1, 2, 6, 5];
        let single: Vec<[f32; 4]> = (0..8).map(|row| [0, 1, 2, 3].map(|column| (10 * row + column) as f32)).collect();
        let double: Vec<[f64; 4]> = single.iter().map(|row| row.map(f64::from)).collect();
        let (mut singles, mut doubles) = (vec![[0.0; 4]; 8], vec![[0.0; 4]; 8]);
        dispatch!(dispatch_level(), simd => {
            let [x, y, z, w] = gather_singles(simd, single.as_flattened(), |lane| 4 * nodes[lane]);
            for (column, lanes) in [x, y, z, w].into_iter().enumerate() {
                let expected: Vec<f32> = nodes.iter().map(|&node| single[node][column]).collect();
                assert_eq!(lanes.as_slice(), expected);
            }
            add_singles([x, y, z], |lane| 4 * nodes[lane], singles.as_flattened_mut());
            for nodes in nodes.chunks(4) {
                let [x, y, z, w] = gather_doubles(simd, double.as_flattened(), |lane| 4 * nodes[lane]);
                for (column, lanes) in [x, y, z, w].into_iter().enumerate() {
                    let expected: Vec<f64> = nodes.iter().map(|&node| double[node][column]).collect();
                    assert_eq!(lanes.as_slice(), expected);
                }
                add_doubles([x, y, z], |lane| 4 * nodes[lane], doubles.as_flattened_mut());
            }
        });
        for row in 0..8 {
            let times = nodes.iter().filter(|&&node| node == row).count() as f64;
            let expected: [f64; 4] =
                std::array::from_fn(|column| if column < 3 { times * double[row][column] } else { 0.0 });
            assert_eq!(doubles[row], expected);
            assert_eq!(singles[row].map(f64::from), expected);
        }
    }
}
