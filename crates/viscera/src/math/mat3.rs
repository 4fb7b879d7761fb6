use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use super::{Dual, Real, Scalar, Sym3, Vec3};

/// A 3×3 matrix, stored by columns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Mat3<R> {
    /// The three columns.
    pub columns: [Vec3<R>; 3],
}

impl<R: Real> Mat3<R> {
    /// The matrix with these columns.
    #[inline(always)]
    pub const fn from_columns(a: Vec3<R>, b: Vec3<R>, c: Vec3<R>) -> Self {
        Self { columns: [a, b, c] }
    }
    /// The matrix with these rows.
    #[inline(always)]
    pub fn from_rows(a: Vec3<R>, b: Vec3<R>, c: Vec3<R>) -> Self {
        Self::from_columns(a, b, c).transpose()
    }
    /// `value` times the identity.
    #[inline(always)]
    pub fn diagonal(value: R) -> Self {
        let zero = value.zero_like();
        Self::from_columns(Vec3::new(value, zero, zero), Vec3::new(zero, value, zero), Vec3::new(zero, zero, value))
    }
    /// The identity, with lanes like `self`'s.
    #[inline(always)]
    pub fn identity_like(self) -> Self {
        Self::diagonal(self.columns[0].x.like(1.0))
    }
    /// Aᵀ.
    #[inline(always)]
    pub fn transpose(self) -> Self {
        let [a, b, c] = self.columns;
        Self::from_columns(Vec3::new(a.x, b.x, c.x), Vec3::new(a.y, b.y, c.y), Vec3::new(a.z, b.z, c.z))
    }
    /// tr A.
    #[inline(always)]
    pub fn trace(self) -> R {
        self.columns[0].x + self.columns[1].y + self.columns[2].z
    }
    /// det A.
    #[inline(always)]
    pub fn determinant(self) -> R {
        let [a, b, c] = self.columns;
        a.dot(b.cross(c))
    }
    /// cof A = det(A) A⁻ᵀ, defined for singular A too; its columns are b×c, c×a, a×b.
    #[inline(always)]
    pub fn cofactor(self) -> Self {
        let [a, b, c] = self.columns;
        Self::from_columns(b.cross(c), c.cross(a), a.cross(b))
    }
    /// Derivative of cof A along `direction`.
    #[inline(always)]
    pub fn cofactor_along(self, direction: Self) -> Self {
        let ([a, b, c], [da, db, dc]) = (self.columns, direction.columns);
        Self::from_columns(db.cross(c) + b.cross(dc), dc.cross(a) + c.cross(da), da.cross(b) + a.cross(db))
    }
    /// A⁻¹; infinite or NaN entries where A is singular.
    #[inline(always)]
    pub fn inverse(self) -> Self {
        let cofactor = self.cofactor();
        cofactor.transpose() * (self.columns[0].x.like(1.0) / self.columns[0].dot(cofactor.columns[0]))
    }
    /// A · factor + addend, fused.
    #[inline(always)]
    pub fn mul_add(self, factor: R, addend: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.columns, addend.columns);
        Self::from_columns(a.mul_add(factor, d), b.mul_add(factor, e), c.mul_add(factor, f))
    }
    /// A:B = Σ A_ij B_ij.
    #[inline(always)]
    pub fn contract(self, other: Self) -> R {
        self.columns[0].dot(other.columns[0])
            + self.columns[1].dot(other.columns[1])
            + self.columns[2].dot(other.columns[2])
    }
    /// ‖A‖² = A:A.
    #[inline(always)]
    pub fn squared_norm(self) -> R {
        self.contract(self)
    }
    /// `if_true` where the mask holds, `if_false` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, if_true: Self, if_false: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (if_true.columns, if_false.columns);
        Self::from_columns(Vec3::select(mask, a, d), Vec3::select(mask, b, e), Vec3::select(mask, c, f))
    }
    /// The vector a with [a]× = A − Aᵀ: twice the axis of the skew part.
    #[inline(always)]
    pub fn double_axis(self) -> Vec3<R> {
        let [a, b, c] = self.columns;
        Vec3::new(b.z - c.y, c.x - a.z, a.y - b.x)
    }
    /// Aᵀ v.
    #[inline(always)]
    pub fn transpose_mul(self, v: Vec3<R>) -> Vec3<R> {
        Vec3::new(self.columns[0].dot(v), self.columns[1].dot(v), self.columns[2].dot(v))
    }
    /// AᵀA.
    #[inline(always)]
    pub fn gram(self) -> Sym3<R> {
        let [a, b, c] = self.columns;
        Sym3 { xx: a.dot(a), yy: b.dot(b), zz: c.dot(c), xy: a.dot(b), xz: a.dot(c), yz: b.dot(c) }
    }
    /// ½(A + Aᵀ).
    #[inline(always)]
    pub fn symmetric_part(self) -> Sym3<R> {
        let [a, b, c] = self.columns;
        Sym3 { xx: a.x, yy: b.y, zz: c.z, xy: (a.y + b.x).half(), xz: (a.z + c.x).half(), yz: (b.z + c.y).half() }
    }
}

impl<R: Real> Mat3<Dual<R>> {
    /// The matrix `value` that changes by `derivative`.
    #[inline(always)]
    pub fn with_derivative(value: &Mat3<R>, derivative: &Mat3<R>) -> Self {
        let dual = |i: usize| {
            let (v, d) = (value.columns[i], derivative.columns[i]);
            Vec3::new(Dual::new(v.x, d.x), Dual::new(v.y, d.y), Dual::new(v.z, d.z))
        };
        Self::from_columns(dual(0), dual(1), dual(2))
    }
}

impl<T: Scalar> Mat3<T> {
    /// The zero matrix.
    pub const ZERO: Self = Self { columns: [Vec3::ZERO; 3] };
    /// The identity matrix.
    pub const IDENTITY: Self = Self {
        columns: [
            Vec3 { x: T::ONE, y: T::ZERO, z: T::ZERO },
            Vec3 { x: T::ZERO, y: T::ONE, z: T::ZERO },
            Vec3 { x: T::ZERO, y: T::ZERO, z: T::ONE },
        ],
    };

    /// Whether every entry is finite.
    pub fn is_finite(self) -> bool {
        self.columns.iter().all(|column| column.is_finite())
    }
    /// The same matrix in another precision.
    pub fn cast<U: Scalar>(self) -> Mat3<U> {
        Mat3 { columns: self.columns.map(Vec3::cast) }
    }
}

impl<R: Real> Mul<Vec3<R>> for Mat3<R> {
    type Output = Vec3<R>;
    #[inline(always)]
    fn mul(self, v: Vec3<R>) -> Vec3<R> {
        self.columns[0].mul_add(v.x, self.columns[1].mul_add(v.y, self.columns[2] * v.z))
    }
}

impl<R: Real> Mul for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::from_columns(self * other.columns[0], self * other.columns[1], self * other.columns[2])
    }
}

impl<R: Real> Mul<Sym3<R>> for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: Sym3<R>) -> Self {
        Self::from_columns(
            self * Vec3::new(s.xx, s.xy, s.xz),
            self * Vec3::new(s.xy, s.yy, s.yz),
            self * Vec3::new(s.xz, s.yz, s.zz),
        )
    }
}

impl<R: Real> Mul<R> for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        let [a, b, c] = self.columns;
        Self::from_columns(a * factor, b * factor, c * factor)
    }
}

impl<R: Real> Add for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.columns, other.columns);
        Self::from_columns(a + d, b + e, c + f)
    }
}

impl<R: Real> AddAssign for Mat3<R> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Real> Sub for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.columns, other.columns);
        Self::from_columns(a - d, b - e, c - f)
    }
}

impl<R: Real> Neg for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let [a, b, c] = self.columns;
        Self::from_columns(-a, -b, -c)
    }
}
