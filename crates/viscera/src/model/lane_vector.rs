//! Vectors of a batch in memory: three columns of lanes, in the row of a table or on their way from a part of a block to halves of it.

use crate::math::{Lanes, MAX_LANES, Part, Scalar, Simd, Vec3};

/// Writes a vector to three columns of a block.
#[inline(always)]
pub(crate) fn store<T: Scalar, S: Simd>(part: Part<S>, vector: Vec3<impl Lanes<T, S>>, columns: &mut [T]) {
    vector.x.store(part, columns);
    vector.y.store(part, &mut columns[T::LANES..]);
    vector.z.store(part, &mut columns[2 * T::LANES..]);
}

/// Reads the vector of three columns of a block.
#[inline(always)]
pub(crate) fn load<T: Scalar, S: Simd, R: Lanes<T, S>>(part: Part<S>, columns: &[T]) -> Vec3<R> {
    Vec3::new(R::load(part, columns), R::load(part, &columns[T::LANES..]), R::load(part, &columns[2 * T::LANES..]))
}

/// A vector of a part that is taken up by halves, or whole once all are kept: with halves taken out of registers an implicit step took 3 % longer with AVX-512.
pub(crate) type Kept<T> = [T; 3 * MAX_LANES];

/// Nothing kept yet.
#[inline(always)]
pub(crate) fn nothing<T: Scalar>() -> Kept<T> {
    [T::ZERO; 3 * MAX_LANES]
}

/// Keeps a vector of a part.
#[inline(always)]
pub(crate) fn keep<T: Scalar, S: Simd>(simd: S, vector: Vec3<T::Lanes<S>>, kept: &mut Kept<T>) {
    store(Part::first(simd), vector, kept);
}

/// Takes up the vector of a half, or of the whole part.
#[inline(always)]
pub(crate) fn take_up<T: Scalar, S: Simd, R: Lanes<T, S>>(part: Part<S>, kept: &Kept<T>) -> Vec3<R> {
    load(part.within::<T, R>(), kept)
}
