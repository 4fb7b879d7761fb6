//! Batches of numbers, in registers as wide as the processor has them.
//!
//! Element tables have [`Scalar::LANES`] rows to a block, on every processor: the registers of AVX-512 hold them at once, those of others half of
//! them, and a loop goes through a block part by part. Sums on nodes are made by halves on all of them, or where these share no node, so that
//! their bits do not depend on the width.

use std::cmp::PartialOrd;
use std::fmt::{Display, LowerExp};

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16, f64x4, f64x8};

use super::Real;
use super::rows::{
    add_doubles, add_singles, add_wide_doubles, add_wide_singles, doubles_of, gather_doubles, gather_singles,
    gather_wide_doubles, gather_wide_singles, singles_of, wide_doubles_of, wide_singles_of,
};

/// An instruction set, and the batches that its registers hold.
pub trait Simd: fearless_simd::Simd {
    /// A batch of `f32`.
    type Singles: Lanes<f32, Self>;
    /// A batch of `f64`.
    type Doubles: Lanes<f64, Self>;
}

macro_rules! impl_simd {
    ($token:ty, $singles:ident, $doubles:ident) => {
        impl Simd for $token {
            type Singles = $singles<Self>;
            type Doubles = $doubles<Self>;
        }
    };
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
impl_simd!(fearless_simd::x86::Sse2, f32x8, f64x4);
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
impl_simd!(fearless_simd::x86::Avx2, f32x8, f64x4);
// Wide ones where registers did not suffice cost up to a third (hexahedra, AVX2).
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
impl_simd!(fearless_simd::x86::Avx512, f32x16, f64x8);
#[cfg(target_arch = "aarch64")]
impl_simd!(fearless_simd::aarch64::Neon, f32x8, f64x4);
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
impl_simd!(fearless_simd::wasm32::WasmSimd128, f32x8, f64x4);

/// A floating-point number that a world can be simulated in: `f32` for play, `f64` for statics and validation.
pub trait Scalar: Real<Mask = bool> + PartialOrd + Default + Display + LowerExp + 'static {
    /// A batch as wide as the registers of `S`: a [block](Scalar::LANES), or half of one.
    type Lanes<S: Simd>: Lanes<Self, S>;
    /// Half a block.
    type Half<S: Simd>: Lanes<Self, S>;

    /// How many rows a block has; the layout of element tables depends on it.
    const LANES: usize;
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// `"f32"` or `"f64"`.
    const NAME: &'static str;

    /// The nearest number.
    fn from_f64(value: f64) -> Self;
    /// The same number in double precision.
    fn to_f64(self) -> f64;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

/// The part of a block that a batch stands for.
#[derive(Clone, Copy, Debug)]
pub struct Part<S> {
    /// The instruction set.
    pub simd: S,
    number: usize,
}

impl<S: Simd> Part<S> {
    /// The parts of a block, one after the other: one, where registers hold it whole.
    #[inline(always)]
    pub fn all<T: Scalar>(simd: S) -> impl Iterator<Item = Self> {
        (0..T::LANES / T::Lanes::<S>::COUNT).map(move |number| Self { simd, number })
    }

    /// The first part of a block.
    #[inline(always)]
    pub fn first(simd: S) -> Self {
        Self { simd, number: 0 }
    }

    /// The halves of a block that are in this part, one after the other: it may be one itself.
    #[inline(always)]
    pub fn halves<T: Scalar>(self) -> impl Iterator<Item = Self> {
        let count = T::Lanes::<S>::COUNT / T::Half::<S>::COUNT;
        (0..count).map(move |half| Self { simd: self.simd, number: self.number * count + half })
    }

    /// The number of a half within its part, or of the part itself: the compiler knows that.
    #[inline(always)]
    pub(crate) fn within<T: Scalar, L: Lanes<T, S>>(self) -> Self {
        Self { simd: self.simd, number: self.number % (T::Lanes::<S>::COUNT / L::COUNT) }
    }

    /// Whether it is the first of its block.
    #[inline(always)]
    pub(crate) fn is_first(self) -> bool {
        self.number == 0
    }

    /// Where its lanes begin in a block; by a remainder, from which the compiler sees that they lie within.
    #[inline(always)]
    pub(crate) fn start<T: Scalar, L: Lanes<T, S>>(self) -> usize {
        self.number % (T::LANES / L::COUNT) * L::COUNT
    }

    /// What lanes of the kind `L` have of the numbers of a block, one for each of its rows.
    #[inline(always)]
    pub fn of<T: Scalar, L: Lanes<T, S>, V>(self, column: &[V]) -> &[V] {
        &column[self.start::<T, L>()..][..L::COUNT]
    }
}

/// SIMD lanes of the scalar `T`, for the instruction set that the token `S` stands for.
pub trait Lanes<T: Scalar, S: Simd>: Real {
    /// How many there are: [`Scalar::LANES`], or half as many.
    const COUNT: usize;
    /// Reads its part of a column of a block.
    fn load(part: Part<S>, column: &[T]) -> Self;
    /// Writes its part of a column of a block.
    fn store(self, part: Part<S>, column: &mut [T]);
    /// The same value in every lane.
    fn splat(simd: S, value: T) -> Self;
    /// Reads four numbers per lane, lane `i` from `rows[start(i)]` on, and gives them column by column.
    ///
    /// Rows are loaded whole and transposed in registers: single loads into an array, read back as one vector,
    /// stall on store forwarding (three times slower, measured).
    fn gather_from(simd: S, rows: &[T], start: impl Fn(usize) -> usize + Copy) -> [Self; 4];
    /// Rows of four numbers side by side, as many as there are lanes for.
    fn rows_of(simd: S, row: impl Fn(usize) -> [T; 4] + Copy) -> Self;
    /// Adds three numbers per lane, lane `i` to those from `rows[start(i)]` on, lane after lane: lanes may name the same row.
    fn scatter_add_from(columns: [Self; 3], start: impl Fn(usize) -> usize + Copy, rows: &mut [T]);
    /// [`Lanes::gather_from`] of whole rows, lane `i` from `rows[nodes[i]]`.
    #[inline(always)]
    fn gather(simd: S, rows: &[[T; 4]], nodes: &[u32]) -> [Self; 4] {
        Self::gather_from(
            simd,
            rows.as_flattened(),
            #[inline(always)]
            |lane| 4 * nodes[lane] as usize,
        )
    }
    /// [`Lanes::scatter_add_from`] of whole rows, lane `i` to the first three numbers of `rows[nodes[i]]`.
    #[inline(always)]
    fn scatter_add(columns: [Self; 3], nodes: &[u32], rows: &mut [[T; 4]]) {
        Self::scatter_add_from(
            columns,
            #[inline(always)]
            |lane| 4 * nodes[lane] as usize,
            rows.as_flattened_mut(),
        );
    }
}

macro_rules! impl_scalar {
    ($scalar:ty, $lanes:ident, $half:ident, $count:expr, $name:expr) => {
        impl Scalar for $scalar {
            type Lanes<S: Simd> = S::$lanes;
            type Half<S: Simd> = $half<S>;

            const LANES: usize = $count;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = <$scalar>::EPSILON;
            const NAME: &'static str = $name;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $scalar
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                <$scalar>::is_finite(self)
            }
        }
    };
}

impl_scalar!(f32, Singles, f32x8, 16, "f32");
impl_scalar!(f64, Doubles, f64x4, 8, "f64");

macro_rules! impl_lanes {
    ($scalar:ty, $lanes:ident, $count:expr, $gather:path, $add:path, $rows:path) => {
        impl<S: Simd> Lanes<$scalar, S> for $lanes<S> {
            const COUNT: usize = $count;

            #[inline(always)]
            fn load(part: Part<S>, column: &[$scalar]) -> Self {
                Self::from_slice(part.simd, part.of::<$scalar, Self, _>(column))
            }
            #[inline(always)]
            fn store(self, part: Part<S>, column: &mut [$scalar]) {
                self.store_slice(&mut column[part.start::<$scalar, Self>()..][..$count]);
            }
            #[inline(always)]
            fn splat(simd: S, value: $scalar) -> Self {
                SimdBase::splat(simd, value)
            }
            #[inline(always)]
            fn gather_from(simd: S, rows: &[$scalar], start: impl Fn(usize) -> usize + Copy) -> [Self; 4] {
                $gather(simd, rows, start)
            }
            #[inline(always)]
            fn rows_of(simd: S, row: impl Fn(usize) -> [$scalar; 4] + Copy) -> Self {
                $rows(simd, row)
            }
            #[inline(always)]
            fn scatter_add_from(columns: [Self; 3], start: impl Fn(usize) -> usize + Copy, rows: &mut [$scalar]) {
                $add(columns, start, rows);
            }
        }

        impl<S: Simd> Real for $lanes<S> {
            type Mask = <$lanes<S> as SimdBase<S>>::Mask;

            const ROUNDING: f64 = <$scalar>::EPSILON as f64;

            #[inline(always)]
            fn like(self, value: f64) -> Self {
                SimdBase::splat(self.token(), value as $scalar)
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                SimdFloat::mul_add(self, factor, addend)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                SimdBase::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                SimdBase::max(self, other)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                let mut values = [0.0; $count];
                self.store_slice(&mut values);
                Self::from_slice(self.token(), &values.map(<$scalar>::ln))
            }
            #[inline(always)]
            fn cbrt(self) -> Self {
                let mut values = [0.0; $count];
                self.store_slice(&mut values);
                Self::from_slice(self.token(), &values.map(<$scalar>::cbrt))
            }
            #[inline(always)]
            fn less_than(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
                mask.select(if_true, if_false)
            }
            #[inline(always)]
            fn any(mask: Self::Mask) -> bool {
                mask.any_true()
            }
            #[inline(always)]
            fn all(mask: Self::Mask) -> bool {
                mask.all_true()
            }
        }
    };
}

impl_lanes!(f32, f32x8, 8, gather_singles, add_singles, singles_of);
impl_lanes!(f32, f32x16, 16, gather_wide_singles, add_wide_singles, wide_singles_of);
impl_lanes!(f64, f64x4, 4, gather_doubles, add_doubles, doubles_of);
impl_lanes!(f64, f64x8, 8, gather_wide_doubles, add_wide_doubles, wide_doubles_of);

/// Rows of the longest block of any scalar.
pub const MAX_LANES: usize = 16;
