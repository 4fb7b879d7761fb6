//! Vectors of a batch in a row of a table: three columns of lanes.

use fearless_simd::Simd;

use crate::math::{Lanes, Scalar, Vec3};

#[inline(always)]
pub(super) fn store<T: Scalar, S: Simd>(vector: Vec3<impl Lanes<T, S>>, columns: &mut [T]) {
    vector.x.store(columns);
    vector.y.store(&mut columns[T::LANES..]);
    vector.z.store(&mut columns[2 * T::LANES..]);
}

#[inline(always)]
pub(super) fn load<T: Scalar, S: Simd>(simd: S, row: &[T], column: usize) -> Vec3<T::Lanes<S>> {
    let number = |i: usize| T::Lanes::<S>::load(simd, &row[(column + i) * T::LANES..]);
    Vec3::new(number(0), number(1), number(2))
}
