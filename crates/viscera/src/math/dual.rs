use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::Real;

/// A number and its derivative along one direction: a kernel over `Dual` computes its own exact derivative.
///
/// (a + a'ε)(b + b'ε) = ab + (a'b + ab')ε,  ε² = 0
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<R> {
    /// The value.
    pub value: R,
    /// The derivative.
    pub derivative: R,
}

impl<R: Real> Dual<R> {
    /// A number with a derivative.
    #[inline(always)]
    pub fn new(value: R, derivative: R) -> Self {
        Self { value, derivative }
    }

    /// A number that does not change.
    #[inline(always)]
    pub fn constant(value: R) -> Self {
        Self { value, derivative: value.zero_like() }
    }
}

impl<R: Real> Real for Dual<R> {
    type Mask = R::Mask;

    const ROUNDING: f64 = R::ROUNDING;

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self::constant(self.value.like(value))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let derivative = self.value.mul_add(factor.derivative, addend.derivative);
        Self::new(self.value.mul_add(factor.value, addend.value), self.derivative.mul_add(factor.value, derivative))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self::new(root, self.derivative.half() / root)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let negative = self.value.less_than(self.value.zero_like());
        Self::select(negative, -self, self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(other.value.less_than(self.value), other, self)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.value.less_than(other.value), other, self)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Self::new(self.value.ln(), self.derivative / self.value)
    }
    #[inline(always)]
    fn cbrt(self) -> Self {
        let root = self.value.cbrt();
        Self::new(root, self.derivative / (root.squared() * root.like(3.0)))
    }
    #[inline(always)]
    fn less_than(self, other: Self) -> Self::Mask {
        self.value.less_than(other.value)
    }
    #[inline(always)]
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
        Self::new(
            R::select(mask, if_true.value, if_false.value),
            R::select(mask, if_true.derivative, if_false.derivative),
        )
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        R::any(mask)
    }
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        R::all(mask)
    }
}

impl<R: Real> Add for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.derivative + other.derivative)
    }
}

impl<R: Real> Sub for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value, self.derivative - other.derivative)
    }
}

impl<R: Real> Mul for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.value * other.value, self.derivative.mul_add(other.value, self.value * other.derivative))
    }
}

impl<R: Real> Div for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        Self::new(quotient, (self.derivative - quotient * other.derivative) / other.value)
    }
}

impl<R: Real> Neg for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.value, -self.derivative)
    }
}

impl<R: Real> AddAssign for Dual<R> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Real> SubAssign for Dual<R> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
