use std::cmp::PartialOrd;
use std::fmt::{Display, LowerExp};
use std::sync::OnceLock;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f32x8, f64x4};

use super::{Real, Vec3};

/// A floating-point number that a world can be simulated in: `f32` for play, `f64` for statics and validation.
pub trait Scalar: Real<Mask = bool> + PartialOrd + Default + Display + LowerExp + 'static {
    /// A batch of [`Scalar::LANES`] values in one or more SIMD registers.
    type Lanes<S: Simd>: Lanes<Self, S>;

    /// How many values a batch holds; the layout of element tables depends on it.
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

/// SIMD lanes of the scalar `T`, for the instruction set that the token `S` stands for.
pub trait Lanes<T: Scalar, S: Simd>: Real {
    /// Reads the first [`Scalar::LANES`] values.
    fn load(simd: S, values: &[T]) -> Self;
    /// Writes the first [`Scalar::LANES`] values.
    fn store(self, values: &mut [T]);
    /// The same value in every lane.
    fn splat(simd: S, value: T) -> Self;
}

macro_rules! impl_lanes {
    ($scalar:ty, $lanes:ident, $count:expr, $name:expr) => {
        impl Scalar for $scalar {
            type Lanes<S: Simd> = $lanes<S>;

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

        impl<S: Simd> Lanes<$scalar, S> for $lanes<S> {
            #[inline(always)]
            fn load(simd: S, values: &[$scalar]) -> Self {
                Self::from_slice(simd, &values[..$count])
            }
            #[inline(always)]
            fn store(self, values: &mut [$scalar]) {
                self.store_slice(&mut values[..$count]);
            }
            #[inline(always)]
            fn splat(simd: S, value: $scalar) -> Self {
                SimdBase::splat(simd, value)
            }
        }

        impl<S: Simd> Real for $lanes<S> {
            type Mask = <$lanes<S> as SimdBase<S>>::Mask;

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
            fn less_than(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
                mask.select(if_true, if_false)
            }
        }
    };
}

impl_lanes!(f32, f32x8, 8, "f32");
impl_lanes!(f64, f64x4, 4, "f64");

/// The best instruction set of the processor that the program runs on, found once.
pub fn dispatch_level() -> Level {
    static LEVEL: OnceLock<Level> = OnceLock::new();
    *LEVEL.get_or_init(Level::new)
}

/// The widest batch of any scalar.
pub const MAX_LANES: usize = 8;

/// Reads one vector per lane: lane `i` gets `values[nodes[i]]`.
#[inline(always)]
pub fn gather<T: Scalar, S: Simd>(simd: S, values: &[Vec3<T>], nodes: &[u32]) -> Vec3<T::Lanes<S>> {
    let (mut x, mut y, mut z) = ([T::ZERO; MAX_LANES], [T::ZERO; MAX_LANES], [T::ZERO; MAX_LANES]);
    for (lane, &node) in nodes[..T::LANES].iter().enumerate() {
        let value = values[node as usize];
        (x[lane], y[lane], z[lane]) = (value.x, value.y, value.z);
    }
    Vec3::new(T::Lanes::<S>::load(simd, &x), T::Lanes::<S>::load(simd, &y), T::Lanes::<S>::load(simd, &z))
}

/// Adds one vector per lane: `values[nodes[i]]` grows by lane `i`, lane after lane, so lanes may name the same node.
#[inline(always)]
pub fn scatter_add<T: Scalar, S: Simd>(vector: Vec3<T::Lanes<S>>, nodes: &[u32], values: &mut [Vec3<T>]) {
    let (mut x, mut y, mut z) = ([T::ZERO; MAX_LANES], [T::ZERO; MAX_LANES], [T::ZERO; MAX_LANES]);
    vector.x.store(&mut x);
    vector.y.store(&mut y);
    vector.z.store(&mut z);
    for (lane, &node) in nodes[..T::LANES].iter().enumerate() {
        values[node as usize] += Vec3::new(x[lane], y[lane], z[lane]);
    }
}
