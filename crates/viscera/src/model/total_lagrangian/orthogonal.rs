//! Edges of a tetrahedron that are orthogonal at rest.
//!
//! The entries of A0 = Dm⁻¹Dm⁻ᵀ are the products of the gradients of the shape functions 1, 2, 3, here x, y, z as the edges are. Orthogonalised one
//! after the other (Gram, Schmidt), y, then z, then x, these are L u with vectors u_i that are orthogonal, of squares δ_i. In that order L has three
//! numbers below its diagonal, which is 1:
//!
//! A0 = L Δ Lᵀ,   Δ = diag(δ)
//!
//! The columns of B = D L are edges, combined such that they are orthogonal at rest, of lengths 1/√δ there; that of x is the edge
//! itself, which is the axis of a fan of tetrahedra. Invariants of F are sums over them: I_C = Σ δ_i |b_i|², and, as det L = 1, cof D = cof B Lᵀ and det D = det B.
//!
//! A product with L or Lᵀ is nine multiply-adds where one with A0 is twenty-seven operations. And entries of A0 grow with the square of a
//! tetrahedron's flatness, and cancel: in single precision, forces of St Venant–Kirchhoff cells a hundred times as wide as high were wrong by
//! 7 % with A0, stable neo-Hookean ones by 3·10⁻⁵; along these edges by 3·10⁻⁶ and 4·10⁻⁶.

use super::super::tet_loop::RestTet;
use crate::math::{Mat3, Real, Sym3, Vec3};

/// The constants that kernels along such edges begin with: L (zy, xy, xz), then `scale` times δ (x, y, z).
pub(super) fn constants(rest: &RestTet, scale: f64) -> Vec<f64> {
    let [_, x, y, z] = rest.gradients();
    let along = |v: Vec3<f64>, axis: Vec3<f64>| v.dot(axis) / axis.squared_norm();
    let zy = along(z, y);
    let z = z - y * zy;
    let xy = along(x, y);
    let x = x - y * xy;
    let xz = along(x, z);
    let x = x - z * xz;
    vec![zy, xy, xz, scale * x.squared_norm(), scale * y.squared_norm(), scale * z.squared_norm()]
}

/// L.
#[inline(always)]
pub(super) fn lower<R: Real>(c: &[R]) -> UnitLower<R> {
    UnitLower { zy: c[0], xy: c[1], xz: c[2] }
}

/// δ, scaled as it is.
#[inline(always)]
pub(super) fn squares<R: Real>(c: &[R]) -> Vec3<R> {
    Vec3::new(c[3], c[4], c[5])
}

/// L Δ Lᵀ.
#[inline(always)]
pub(super) fn metric<R: Real>(c: &[R]) -> Sym3<R> {
    let (Vec3 { x, y, z }, zero) = (squares(c), c[3].zero_like());
    lower(c).around(Sym3 { xx: x, yy: y, zz: z, xy: zero, xz: zero, yz: zero })
}

/// B Δ `factor`.
#[inline(always)]
pub(super) fn weighted<R: Real>(c: &[R], b: &Mat3<R>, factor: R) -> Mat3<R> {
    let [x, y, z] = b.columns;
    Mat3::from_columns(x * (c[3] * factor), y * (c[4] * factor), z * (c[5] * factor))
}

/// A matrix with 1 on the diagonal and, in the order y, z, x, nothing above it.
#[derive(Clone, Copy)]
pub(super) struct UnitLower<R> {
    zy: R,
    xy: R,
    xz: R,
}

impl<R: Real> UnitLower<R> {
    /// B = D L of the edges D.
    #[inline(always)]
    pub(super) fn orthogonal_edges(self, d: &Mat3<R>) -> Mat3<R> {
        let [x, y, z] = d.columns;
        Mat3::from_columns(x, x.mul_add(self.xy, z.mul_add(self.zy, y)), x.mul_add(self.xz, z))
    }

    /// A Lᵀ: what acts on the edges themselves, of what acts on the combined ones.
    #[inline(always)]
    pub(super) fn back_to_edges(self, a: &Mat3<R>) -> Mat3<R> {
        let [x, y, z] = a.columns;
        Mat3::from_columns(z.mul_add(self.xz, y.mul_add(self.xy, x)), y, y.mul_add(self.zy, z))
    }

    /// L A Lᵀ.
    #[inline(always)]
    pub(super) fn around(self, a: Sym3<R>) -> Sym3<R> {
        let left = self.back_to_edges(&Mat3::from(a)).transpose();
        self.back_to_edges(&left).symmetric_part()
    }

    /// L⁻¹ v.
    pub(super) fn solve(self, v: Vec3<R>) -> Vec3<R> {
        let z = v.z - self.zy * v.y;
        Vec3::new(v.x - self.xy * v.y - self.xz * z, v.y, z)
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
