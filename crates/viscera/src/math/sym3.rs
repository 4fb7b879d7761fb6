use std::ops::{Add, Mul, Sub};

use super::{Mat3, Real, Vec3};

/// A symmetric 3×3 matrix: strains, metrics, second Piola–Kirchhoff stresses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Sym3<R> {
    /// Entry (0, 0).
    pub xx: R,
    /// Entry (1, 1).
    pub yy: R,
    /// Entry (2, 2).
    pub zz: R,
    /// Entries (0, 1) and (1, 0).
    pub xy: R,
    /// Entries (0, 2) and (2, 0).
    pub xz: R,
    /// Entries (1, 2) and (2, 1).
    pub yz: R,
}

impl<R: Real> Sym3<R> {
    /// `value` times the identity.
    #[inline(always)]
    pub fn diagonal(value: R) -> Self {
        let zero = value.zero_like();
        Self { xx: value, yy: value, zz: value, xy: zero, xz: zero, yz: zero }
    }
    /// v vᵀ.
    #[inline(always)]
    pub fn square(v: Vec3<R>) -> Self {
        Self { xx: v.x * v.x, yy: v.y * v.y, zz: v.z * v.z, xy: v.x * v.y, xz: v.x * v.z, yz: v.y * v.z }
    }
    /// tr A.
    #[inline(always)]
    pub fn trace(self) -> R {
        self.xx + self.yy + self.zz
    }
    /// A:B = Σ A_ij B_ij.
    #[inline(always)]
    pub fn contract(self, other: Self) -> R {
        let diagonal = self.xx.mul_add(other.xx, self.yy.mul_add(other.yy, self.zz * other.zz));
        let off = self.xy.mul_add(other.xy, self.xz.mul_add(other.xz, self.yz * other.yz));
        diagonal + off.double()
    }
    /// ‖A‖² = A:A.
    #[inline(always)]
    pub fn squared_norm(self) -> R {
        self.contract(self)
    }
    /// v·A v.
    #[inline(always)]
    pub fn quadratic(self, v: Vec3<R>) -> R {
        v.dot(self * v)
    }
    /// Upper bound of the largest eigenvalue: mean + √(⅔) ‖deviator‖, exact where the two smaller ones are equal.
    #[inline(always)]
    pub fn largest_eigenvalue_bound(self) -> R {
        let mean = self.trace() * self.xx.like(1.0 / 3.0);
        let deviator = self - Self::diagonal(mean);
        mean + (deviator.squared_norm() * mean.like(2.0 / 3.0)).sqrt()
    }
    /// cof A, symmetric too.
    #[inline(always)]
    pub fn cofactor(self) -> Self {
        let Self { xx, yy, zz, xy, xz, yz } = self;
        Self {
            xx: yy * zz - yz * yz,
            yy: xx * zz - xz * xz,
            zz: xx * yy - xy * xy,
            xy: xz * yz - xy * zz,
            xz: xy * yz - xz * yy,
            yz: xy * xz - yz * xx,
        }
    }
    /// A B A for symmetric A and B: symmetric again.
    #[inline(always)]
    pub fn sandwich(self, middle: Self) -> Self {
        let half = Mat3::from(self) * middle;
        let [p, q, r] = half.columns;
        let (x, y, z) = (Vec3::new(p.x, q.x, r.x), Vec3::new(p.y, q.y, r.y), Vec3::new(p.z, q.z, r.z));
        let (a, b, c) = (
            Vec3::new(self.xx, self.xy, self.xz),
            Vec3::new(self.xy, self.yy, self.yz),
            Vec3::new(self.xz, self.yz, self.zz),
        );
        Self { xx: x.dot(a), yy: y.dot(b), zz: z.dot(c), xy: x.dot(b), xz: x.dot(c), yz: y.dot(c) }
    }
    /// `self · factor + addend`, fused.
    #[inline(always)]
    pub fn mul_add(self, factor: R, addend: Self) -> Self {
        Self {
            xx: self.xx.mul_add(factor, addend.xx),
            yy: self.yy.mul_add(factor, addend.yy),
            zz: self.zz.mul_add(factor, addend.zz),
            xy: self.xy.mul_add(factor, addend.xy),
            xz: self.xz.mul_add(factor, addend.xz),
            yz: self.yz.mul_add(factor, addend.yz),
        }
    }
}

impl<R: Real> From<Sym3<R>> for Mat3<R> {
    #[inline(always)]
    fn from(s: Sym3<R>) -> Self {
        Mat3::from_columns(Vec3::new(s.xx, s.xy, s.xz), Vec3::new(s.xy, s.yy, s.yz), Vec3::new(s.xz, s.yz, s.zz))
    }
}

impl<R: Real> Mul<Vec3<R>> for Sym3<R> {
    type Output = Vec3<R>;
    #[inline(always)]
    fn mul(self, v: Vec3<R>) -> Vec3<R> {
        Mat3::from(self) * v
    }
}

impl<R: Real> Mul<R> for Sym3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        Self {
            xx: self.xx * factor,
            yy: self.yy * factor,
            zz: self.zz * factor,
            xy: self.xy * factor,
            xz: self.xz * factor,
            yz: self.yz * factor,
        }
    }
}

impl<R: Real> Add for Sym3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            xx: self.xx + other.xx,
            yy: self.yy + other.yy,
            zz: self.zz + other.zz,
            xy: self.xy + other.xy,
            xz: self.xz + other.xz,
            yz: self.yz + other.yz,
        }
    }
}

impl<R: Real> Sub for Sym3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            xx: self.xx - other.xx,
            yy: self.yy - other.yy,
            zz: self.zz - other.zz,
            xy: self.xy - other.xy,
            xz: self.xz - other.xz,
            yz: self.yz - other.yz,
        }
    }
}
