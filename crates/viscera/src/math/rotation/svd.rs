use super::{frame, scaled};
use crate::math::{Mat3, Real, Vec3};

/// F = U Σ Vᵀ with two rotations U and V.
#[derive(Clone, Copy, Debug)]
pub struct Svd<R> {
    /// U, det U = +1.
    pub left: Mat3<R>,
    /// Σ: the first two ≥ 0, falling; the third has the smallest size, and the sign of det F.
    pub values: Vec3<R>,
    /// V, det V = +1.
    pub right: Mat3<R>,
}

impl<R: Real> Svd<R> {
    /// U Vᵀ: of all rotations the nearest to F, which is what polar decomposition gives where F is not inverted.
    #[inline(always)]
    pub fn rotation(&self) -> Mat3<R> {
        self.left * self.right.transpose()
    }
}

/// Sweeps over the three pairs of columns. Convergence is quadratic, and three or four do for most matrices.
const SWEEPS: usize = 6;

/// Singular value decomposition for inverted elements: one-sided Jacobi, which turns the columns of F in pairs until they
/// are orthogonal, then Gram–Schmidt on the two largest.
///
/// Source: Hestenes (1958) for the sweeps; Irving, Teran, Fedkiw (2004), section 4, for the signs.
#[inline(always)]
pub fn svd<R: Real>(f: &Mat3<R>) -> Svd<R> {
    let (f, scale) = scaled(f);
    let (mut columns, mut right) = (f.columns, f.identity_like().columns);
    for _ in 0..SWEEPS {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (cosine, sine) = jacobi_angle(columns[i], columns[j]);
            (columns[i], columns[j]) = turned(columns[i], columns[j], cosine, sine);
            (right[i], right[j]) = turned(right[i], right[j], cosine, sine);
        }
    }
    // The longest first: an exchange with one sign changed is a rotation.
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let shorter = columns[i].squared_norm().less_than(columns[j].squared_norm());
        (columns[i], columns[j]) = exchanged(shorter, columns[i], columns[j]);
        (right[i], right[j]) = exchanged(shorter, right[i], right[j]);
    }
    let [a, b, c] = columns;
    let noise = a.squared_norm() * a.x.like(R::ROUNDING * R::ROUNDING);
    let left = frame(a, b, noise.max(a.x.like(1e-36)));
    // of a second column that is noise the sign is noise
    let second = left.columns[1].dot(b).max(a.x.zero_like());
    let values = Vec3::new(left.columns[0].dot(a), second, left.columns[2].dot(c)) * scale;
    Svd { left, values, right: Mat3 { columns: right } }
}

/// Cosine and sine that make a and b orthogonal: t = tan φ solves t² + 2t (|b|² − |a|²)/(2 a·b) = 1, the smaller root.
#[inline(always)]
fn jacobi_angle<R: Real>(a: Vec3<R>, b: Vec3<R>) -> (R, R) {
    let one = a.x.like(1.0);
    let difference = b.squared_norm() - a.squared_norm();
    let double = a.dot(b).double();
    let length = difference.abs() + difference.mul_add(difference, double.squared()).sqrt();
    let sign = R::select(difference.less_than(one.zero_like()), -one, one);
    let tangent = sign * double / length.max(one.like(1e-36));
    let cosine = one / tangent.mul_add(tangent, one).sqrt();
    (cosine, cosine * tangent)
}

#[inline(always)]
fn turned<R: Real>(a: Vec3<R>, b: Vec3<R>, cosine: R, sine: R) -> (Vec3<R>, Vec3<R>) {
    (a * cosine - b * sine, a * sine + b * cosine)
}

#[inline(always)]
fn exchanged<R: Real>(mask: R::Mask, a: Vec3<R>, b: Vec3<R>) -> (Vec3<R>, Vec3<R>) {
    (Vec3::select(mask, b, a), Vec3::select(mask, -a, b))
}
