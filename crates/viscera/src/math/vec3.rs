use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, Neg, Sub, SubAssign};

use serde::{Deserialize, Serialize};

use super::{Mat3, Real, Scalar};

/// A vector of three components.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[repr(C)]
pub struct Vec3<R> {
    /// First component.
    pub x: R,
    /// Second component.
    pub y: R,
    /// Third component.
    pub z: R,
}

impl<R: Real> Vec3<R> {
    /// The vector (x, y, z).
    #[inline(always)]
    pub const fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }
    /// The same value in all components.
    #[inline(always)]
    pub fn splat(value: R) -> Self {
        Self::new(value, value, value)
    }
    /// The zero vector, with lanes like `self`'s.
    #[inline(always)]
    pub fn zero_like(self) -> Self {
        Self::splat(self.x.zero_like())
    }
    /// Inner product a·b.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }
    /// Cross product a×b.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y.mul_add(other.z, -(self.z * other.y)),
            self.z.mul_add(other.x, -(self.x * other.z)),
            self.x.mul_add(other.y, -(self.y * other.x)),
        )
    }
    /// Outer product a bᵀ.
    #[inline(always)]
    pub fn outer(self, other: Self) -> Mat3<R> {
        Mat3::from_columns(self * other.x, self * other.y, self * other.z)
    }
    /// `self · factor + addend`, fused.
    #[inline(always)]
    pub fn mul_add(self, factor: R, addend: Self) -> Self {
        Self::new(self.x.mul_add(factor, addend.x), self.y.mul_add(factor, addend.y), self.z.mul_add(factor, addend.z))
    }
    /// |a|².
    #[inline(always)]
    pub fn squared_norm(self) -> R {
        self.dot(self)
    }
    /// |a|.
    #[inline(always)]
    pub fn norm(self) -> R {
        self.squared_norm().sqrt()
    }
    /// `if_true` where the mask holds, `if_false` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, if_true: Self, if_false: Self) -> Self {
        Self::new(
            R::select(mask, if_true.x, if_false.x),
            R::select(mask, if_true.y, if_false.y),
            R::select(mask, if_true.z, if_false.z),
        )
    }
    /// Component-wise minimum.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self::new(self.x.min(other.x), self.y.min(other.y), self.z.min(other.z))
    }
    /// Component-wise maximum.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self::new(self.x.max(other.x), self.y.max(other.y), self.z.max(other.z))
    }
    /// The components as an array.
    #[inline(always)]
    pub fn to_array(self) -> [R; 3] {
        [self.x, self.y, self.z]
    }
}

impl<T: Scalar> Vec3<T> {
    /// The zero vector.
    pub const ZERO: Self = Self { x: T::ZERO, y: T::ZERO, z: T::ZERO };

    /// a/|a|, or `None` where a has no direction (zero or not finite).
    pub fn normalized(self) -> Option<Self> {
        let norm = self.norm();
        (norm > T::ZERO && norm.is_finite()).then(|| self / norm)
    }
    /// Whether every component is finite.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
    /// The same vector in another precision.
    #[inline(always)]
    pub fn cast<U: Scalar>(self) -> Vec3<U> {
        Vec3 { x: U::from_f64(self.x.to_f64()), y: U::from_f64(self.y.to_f64()), z: U::from_f64(self.z.to_f64()) }
    }
}

impl<R: Real> From<[R; 3]> for Vec3<R> {
    #[inline(always)]
    fn from([x, y, z]: [R; 3]) -> Self {
        Self { x, y, z }
    }
}

impl<R: Real> From<Vec3<R>> for [R; 3] {
    #[inline(always)]
    fn from(v: Vec3<R>) -> Self {
        v.to_array()
    }
}

impl<R> Index<usize> for Vec3<R> {
    type Output = R;
    #[inline(always)]
    fn index(&self, axis: usize) -> &R {
        match axis {
            0 => &self.x,
            1 => &self.y,
            2 => &self.z,
            _ => panic!("a vector has axes 0, 1, 2, not {axis}"),
        }
    }
}

impl<R> IndexMut<usize> for Vec3<R> {
    #[inline(always)]
    fn index_mut(&mut self, axis: usize) -> &mut R {
        match axis {
            0 => &mut self.x,
            1 => &mut self.y,
            2 => &mut self.z,
            _ => panic!("a vector has axes 0, 1, 2, not {axis}"),
        }
    }
}

impl<R: Real> Add for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<R: Real> Sub for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<R: Real> Mul<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl<R: Real> Div<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, divisor: R) -> Self {
        Self::new(self.x / divisor, self.y / divisor, self.z / divisor)
    }
}

impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<R: Real> AddAssign for Vec3<R> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Real> SubAssign for Vec3<R> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
