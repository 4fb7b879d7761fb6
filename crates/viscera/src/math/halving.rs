use super::{Lanes, MAX_LANES, Part, Scalar, Simd, Vec3};

/// Numbers of a batch on their way from a part of a block to halves of it, through memory: with halves taken out of registers an implicit step
/// took 3 % longer with AVX-512.
pub(crate) type Halving<T, const NUMBERS: usize> = [[T; MAX_LANES]; NUMBERS];

/// Writes a vector of a part for its halves.
#[inline(always)]
pub(crate) fn store_vector<T: Scalar, S: Simd>(simd: S, v: Vec3<T::Lanes<S>>, kept: &mut Halving<T, 3>) {
    let part = Part::first(simd);
    v.x.store(part, &mut kept[0]);
    v.y.store(part, &mut kept[1]);
    v.z.store(part, &mut kept[2]);
}

/// Reads the vector of a half.
#[inline(always)]
pub(crate) fn load_vector<T: Scalar, S: Simd>(half: Part<S>, kept: &Halving<T, 3>) -> Vec3<T::Half<S>> {
    let half = half.within::<T>();
    let number = |i: usize| T::Half::<S>::load(half, &kept[i]);
    Vec3::new(number(0), number(1), number(2))
}
