use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::{Mat3, Real, Vec3};

/// Two numbers that have nothing to do with each other: what a kernel computes of the second fills the time that the first waits
/// for roots and quotients.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<R>(pub(crate) R, pub(crate) R);

impl<R: Real> Real for Pair<R> {
    type Mask = (R::Mask, R::Mask);

    const ROUNDING: f64 = R::ROUNDING;

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self(self.0.like(value), self.1.like(value))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(self.0.mul_add(factor.0, addend.0), self.1.mul_add(factor.1, addend.1))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Self(self.0.ln(), self.1.ln())
    }
    #[inline(always)]
    fn cbrt(self) -> Self {
        Self(self.0.cbrt(), self.1.cbrt())
    }
    #[inline(always)]
    fn less_than(self, other: Self) -> Self::Mask {
        (self.0.less_than(other.0), self.1.less_than(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
        Self(R::select(mask.0, if_true.0, if_false.0), R::select(mask.1, if_true.1, if_false.1))
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        R::any(mask.0) | R::any(mask.1)
    }
}

macro_rules! impl_operator {
    ($operator:ident, $function:ident) => {
        impl<R: Real> $operator for Pair<R> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self(self.0.$function(other.0), self.1.$function(other.1))
            }
        }
    };
}

impl_operator!(Add, add);
impl_operator!(Sub, sub);
impl_operator!(Mul, mul);
impl_operator!(Div, div);

impl<R: Real> Neg for Pair<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<R: Real> AddAssign for Pair<R> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Real> SubAssign for Pair<R> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<R: Real> Mat3<Pair<R>> {
    /// Two matrices at a time.
    #[inline(always)]
    pub(crate) fn paired(first: &Mat3<R>, second: &Mat3<R>) -> Self {
        let pair = |a: Vec3<R>, b: Vec3<R>| Vec3::new(Pair(a.x, b.x), Pair(a.y, b.y), Pair(a.z, b.z));
        let ([a, b, c], [d, e, f]) = (first.columns, second.columns);
        Mat3::from_columns(pair(a, d), pair(b, e), pair(c, f))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation::polar;

    #[test]
    fn what_is_computed_of_two_has_the_bits_of_each() {
        let ordinary =
            Mat3::from_columns(Vec3::new(1.0, 0.2, -0.1), Vec3::new(0.1, 0.9, 0.3), Vec3::new(0.0, -0.2, 1.2));
        // Inverted with two equal stretches: the rotation goes the long way.
        let inverted =
            Mat3::from_columns(Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, -1.0));
        let both = polar(&Mat3::paired(&ordinary, &inverted));
        let parts = [
            both.columns.map(|v| Vec3::new(v.x.0, v.y.0, v.z.0)),
            both.columns.map(|v| Vec3::new(v.x.1, v.y.1, v.z.1)),
        ];
        assert_eq!(parts, [polar(&ordinary).columns, polar(&inverted).columns]);
    }
}
