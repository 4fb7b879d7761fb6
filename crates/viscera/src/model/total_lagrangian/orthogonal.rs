//! Edges of a tetrahedron that are orthogonal at rest.
//!
//! The entries of A0 = Dm⁻¹Dm⁻ᵀ are the products of the gradients of the shape functions 1, 2, 3. Orthogonalised one after the other (Gram,
//! Schmidt), these are L u with vectors u_i that are orthogonal, of squares δ_i, and three numbers below the diagonal of L, which has 1 on it:
//!
//! A0 = L Δ Lᵀ,   Δ = diag(δ)
//!
//! The columns of B = D L are edges, combined such that they are orthogonal at rest, of lengths 1/√δ there. Invariants of F are sums over
//! them: I_C = Σ δ_i |b_i|², and, as det L = 1, cof D = cof B Lᵀ and det D = det B.
//!
//! A product with L or Lᵀ is nine multiply-adds where one with A0 is twenty-seven operations. And entries of A0 grow with the square of a
//! tetrahedron's flatness, and cancel: in single precision, forces of St Venant–Kirchhoff cells a hundred times as wide as high were wrong by
//! 7 % with A0, stable neo-Hookean ones by 3·10⁻⁵; along these edges by 3·10⁻⁶ and 4·10⁻⁶.

use super::super::tet_loop::RestTet;
use crate::math::{Mat3, Real, Sym3, Vec3};

/// L and δ: the gradients of the shape functions 1, 2, 3 are L times vectors that are orthogonal, of squares δ.
pub(super) fn orthogonal(rest: &RestTet) -> (UnitLower<f64>, Vec3<f64>) {
    let [_, x, y, z] = rest.gradients();
    let along = |v: Vec3<f64>, axis: Vec3<f64>| v.dot(axis) / axis.squared_norm();
    let yx = along(y, x);
    let y = y - x * yx;
    let zx = along(z, x);
    let z = z - x * zx;
    let zy = along(z, y);
    let z = z - y * zy;
    (UnitLower { yx, zx, zy }, Vec3::new(x.squared_norm(), y.squared_norm(), z.squared_norm()))
}

/// A matrix with 1 on the diagonal and nothing above it.
#[derive(Clone, Copy)]
pub(super) struct UnitLower<R> {
    pub(super) yx: R,
    pub(super) zx: R,
    pub(super) zy: R,
}

impl<R: Real> UnitLower<R> {
    /// A L.
    #[inline(always)]
    pub(super) fn after(self, a: &Mat3<R>) -> Mat3<R> {
        let [x, y, z] = a.columns;
        Mat3::from_columns(z.mul_add(self.zx, y.mul_add(self.yx, x)), z.mul_add(self.zy, y), z)
    }

    /// A Lᵀ.
    #[inline(always)]
    pub(super) fn transposed_after(self, a: &Mat3<R>) -> Mat3<R> {
        let [x, y, z] = a.columns;
        Mat3::from_columns(x, x.mul_add(self.yx, y), y.mul_add(self.zy, x.mul_add(self.zx, z)))
    }

    /// L A Lᵀ.
    #[inline(always)]
    pub(super) fn around(self, a: Sym3<R>) -> Sym3<R> {
        let left = self.transposed_after(&Mat3::from(a)).transpose();
        self.transposed_after(&left).symmetric_part()
    }

    /// L⁻¹ v.
    pub(super) fn solve(self, v: Vec3<R>) -> Vec3<R> {
        let y = v.y - self.yx * v.x;
        Vec3::new(v.x, y, v.z - self.zx * v.x - self.zy * y)
    }
}

/// Entries of a matrix over the edges that belong to the corners 0 to 3, on the diagonal: corner 0 moves all edges back.
#[inline(always)]
pub(super) fn at_corners<R: Real>(matrix: Sym3<R>) -> [R; 4] {
    let Sym3 { xx, yy, zz, xy, xz, yz } = matrix;
    [xx + yy + zz + (xy + xz + yz).double(), xx, yy, zz]
}

/// Columns that belong to the corners 0 to 3.
#[inline(always)]
pub(super) fn columns_at_corners<R: Real>(matrix: &Mat3<R>) -> [Vec3<R>; 4] {
    let [a, b, c] = matrix.columns;
    [-(a + b + c), a, b, c]
}
