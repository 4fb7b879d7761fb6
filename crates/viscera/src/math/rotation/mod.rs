//! Rotations in a deformation gradient: how much of F is turning.
//!
//! Every extraction gives a rotation to rounding, det R = +1, for every finite F, flat, inverted and null ones included,
//! and depends on F alone: no memory of earlier ones, so that what is computed after a snapshot has the same bits.

mod polar;
mod qr;
mod svd;

pub use polar::{polar, polar_along};
pub use qr::qr;
pub use svd::{Svd, svd};

use super::{Mat3, Real, Vec3};

/// F over its largest entry, and that entry, so that no power of an entry leaves the range of the precision; stretches below 1e-30
/// count as nothing.
#[inline(always)]
pub(crate) fn scaled<R: Real>(f: &Mat3<R>) -> (Mat3<R>, R) {
    let largest = |v: Vec3<R>| v.x.abs().max(v.y.abs()).max(v.z.abs());
    let [a, b, c] = f.columns;
    let scale = largest(a).max(largest(b)).max(largest(c)).max(a.x.like(1e-30));
    (*f * (scale.like(1.0) / scale), scale)
}

/// a/|a|, or `instead` where |a|² is not above `least`.
#[inline(always)]
fn direction<R: Real>(a: Vec3<R>, least: R, instead: Vec3<R>) -> Vec3<R> {
    let square = a.squared_norm();
    Vec3::select(least.less_than(square), a / square.sqrt(), instead)
}

/// The orthonormal, right-handed frame of two vectors by Gram and Schmidt: the first keeps its direction. A vector shorter
/// than the square root of `least`, and what rounding leaves of the second where it is parallel to the first, has none;
/// one that has no direction is replaced.
#[inline(always)]
fn frame<R: Real>(first: Vec3<R>, second: Vec3<R>, least: R) -> Mat3<R> {
    let (zero, one) = (least.zero_like(), least.like(1.0));
    let a = direction(first, least, Vec3::new(one, zero, zero));
    // a unit vector normal to a, with the axis that is at least 45° away from it
    let near_y = least.like(0.5).less_than(a.y.squared());
    let axis = Vec3::select(near_y, Vec3::new(zero, zero, one), Vec3::new(zero, one, zero));
    let normal = axis - a * a.dot(axis);
    let normal = normal / normal.norm();
    // twice: once leaves a second vector that is nearly parallel off by the roundings of its projection
    let rest = second - a * a.dot(second);
    let rest = rest - a * a.dot(rest);
    let noise = second.squared_norm() * least.like((4.0 * R::ROUNDING) * (4.0 * R::ROUNDING));
    let b = direction(rest, least.max(noise), normal);
    let b = b - a * a.dot(b);
    let b = b / b.norm();
    Mat3::from_columns(a, b, a.cross(b))
}
