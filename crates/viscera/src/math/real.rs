use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// What a kernel computes with: `f32`, `f64`, or a batch of SIMD lanes of either.
///
/// A kernel written over `Real` is the fast path, the reference and the derivative check in one text. Constants are made
/// from a value at hand (`x.like(3.0)`), because a batch of lanes needs the instruction-set token that its values carry.
/// Implementations and helpers must be `#[inline(always)]`: a call that is not inlined loses the target features.
pub trait Real:
    Copy
    + Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// The result of a comparison: `bool`, or one truth value per lane.
    type Mask: Copy;

    /// Distance from 1 to the next larger number: the largest relative error of two roundings.
    const ROUNDING: f64;

    /// The constant `value`, in every lane.
    fn like(self, value: f64) -> Self;
    /// `self * factor + addend`, fused where the hardware has it.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller of two values; unspecified when one is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of two values; unspecified when one is NaN.
    fn max(self, other: Self) -> Self;
    /// Natural logarithm, lane by lane where the hardware has none.
    fn ln(self) -> Self;
    /// Cube root, of negative numbers too; lane by lane where the hardware has none.
    fn cbrt(self) -> Self;
    /// Whether `self < other`.
    fn less_than(self, other: Self) -> Self::Mask;
    /// `if_true` where the mask holds, `if_false` elsewhere.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// Whether the mask holds in any lane.
    fn any(mask: Self::Mask) -> bool;
    /// Whether the mask holds in all lanes.
    fn all(mask: Self::Mask) -> bool;

    /// Zero, in every lane.
    #[inline(always)]
    fn zero_like(self) -> Self {
        self.like(0.0)
    }
    /// `self²`.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
    /// `2 self`.
    #[inline(always)]
    fn double(self) -> Self {
        self + self
    }
    /// `self / 2`.
    #[inline(always)]
    fn half(self) -> Self {
        self * self.like(0.5)
    }
}

macro_rules! impl_real_for_scalar {
    ($scalar:ty) => {
        impl Real for $scalar {
            type Mask = bool;

            const ROUNDING: f64 = <$scalar>::EPSILON as f64;

            #[inline(always)]
            fn like(self, value: f64) -> Self {
                value as $scalar
            }
            // Two roundings: without a compile-time fma feature, `mul_add` would be a library call (20 times slower).
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                self * factor + addend
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$scalar>::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$scalar>::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                <$scalar>::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                <$scalar>::max(self, other)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                <$scalar>::ln(self)
            }
            #[inline(always)]
            fn cbrt(self) -> Self {
                <$scalar>::cbrt(self)
            }
            #[inline(always)]
            fn less_than(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }
            #[inline(always)]
            fn any(mask: bool) -> bool {
                mask
            }
            #[inline(always)]
            fn all(mask: bool) -> bool {
                mask
            }
        }
    };
}

impl_real_for_scalar!(f32);
impl_real_for_scalar!(f64);
