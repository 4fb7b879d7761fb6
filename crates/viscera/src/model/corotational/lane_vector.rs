//! Vectors of a batch in a row of a table: three columns of lanes.

use crate::math::{Lanes, Part, Scalar, Simd, Vec3};

#[inline(always)]
pub(super) fn store<T: Scalar, S: Simd>(part: Part<S>, vector: Vec3<impl Lanes<T, S>>, columns: &mut [T]) {
    vector.x.store(part, columns);
    vector.y.store(part, &mut columns[T::LANES..]);
    vector.z.store(part, &mut columns[2 * T::LANES..]);
}

#[inline(always)]
pub(super) fn load<T: Scalar, S: Simd>(part: Part<S>, row: &[T], column: usize) -> Vec3<T::Lanes<S>> {
    let number = |i: usize| T::Lanes::<S>::load(part, &row[(column + i) * T::LANES..]);
    Vec3::new(number(0), number(1), number(2))
}
