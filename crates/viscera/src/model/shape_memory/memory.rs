//! What one node remembers, as a formula: the same text for forces and, over dual numbers, for their derivative.

use crate::math::rotation::scaled;
use crate::math::{Mat3, Real, Sym3, Vec3};

/// Shape of a neighbourhood, against that at rest, above which forces are the gradient of the energy; from half of it down they
/// only balance.
const WELL_SHAPED: f64 = 0.1;
/// A turn that the neighbours can hardly give is not asked of them: det H below this share of (tr H)³.
const TOO_FLAT: f64 = 1e-12;
/// Nor one of neighbours that have come together in a point: tr H below this, which is about 1 at rest.
const TOO_NEAR: f64 = 1e-12;

/// The neighbours of a node now: y_j = x_j − c about their centroid c, and what they make of the rest arms Y_j, with lengths over the
/// longest of those.
#[derive(Clone, Copy)]
pub(super) struct Neighbours<R> {
    /// Σ y_j Y_jᵀ.
    pub(super) covariance: Mat3<R>,
    /// Σ y_j y_jᵀ.
    pub(super) spread: Sym3<R>,
    /// x − c of the node itself [m].
    pub(super) offset: Vec3<R>,
    /// R, which fits the rest arms to the neighbours best.
    pub(super) rotation: Mat3<R>,
}

/// What does not change about a node.
#[derive(Clone, Copy)]
pub(super) struct Remembered<R> {
    /// d = X − C, where the node stands about the centroid of its neighbours at rest [m].
    pub(super) offset: Vec3<R>,
    /// k [N/m].
    pub(super) stiffness: R,
    /// g [N/m], of each neighbour.
    pub(super) grip: R,
    /// One over the longest rest arm [1/m].
    pub(super) unit: R,
    /// How well shaped the neighbours are at rest, see [`well_shaped`].
    pub(super) shape: R,
}

/// What holds a node and its neighbours.
#[derive(Clone, Copy)]
pub(super) struct Hold<R> {
    /// f = k r on the node [N], with r = x − T.
    pub(super) force: Vec3<R>,
    /// s [N/m] of the forces R (s×b_j) − f/n on the neighbours, in the frame of the rest shape.
    pub(super) spin: Vec3<R>,
    pub(super) rotation: Mat3<R>,
    /// β of the arms b_j = (1 − β) Y_j + β Rᵀy_j.
    pub(super) mix: R,
    /// g [N/m] of the forces g (y_j − R Y_j) on the neighbours.
    pub(super) grip: R,
}

impl<R: Real> Hold<R> {
    /// What holds the node.
    #[inline(always)]
    pub(super) fn new(now: &Neighbours<R>, rest: &Remembered<R>) -> Self {
        let Neighbours { covariance, spread, offset, rotation } = *now;
        let force = (offset - rotation * rest.offset) * rest.stiffness;
        let one = rest.stiffness.like(1.0);
        let turned = rotation.transpose() * covariance;
        let stretch = turned.symmetric_part();
        let gradient = Sym3::diagonal(stretch.trace()) - stretch;
        let shape = well_shaped(&covariance, &gradient) / rest.shape;
        let mix = (one.like(2.0) - shape * one.like(2.0 / WELL_SHAPED)).max(one.zero_like()).min(one);
        let turned = turned_back(&rotation, &spread);
        let inertia = Sym3::diagonal(turned.trace()) - turned;
        let matrix = gradient * (one - mix) + inertia * mix;
        let local = rotation.transpose_mul(force);
        Self {
            force,
            spin: solve(&matrix, local.cross(rest.offset * rest.unit) * rest.unit),
            rotation,
            mix,
            grip: rest.grip,
        }
    }

    /// The force on a neighbour besides its share of the node's, with the rest arm Y, at y from the centroid [N].
    #[inline(always)]
    pub(super) fn turn(&self, arm: Vec3<R>, y: Vec3<R>) -> Vec3<R> {
        let one = self.mix.like(1.0);
        let mixed = arm * (one - self.mix) + self.rotation.transpose_mul(y) * self.mix;
        self.rotation * self.spin.cross(mixed) + (y - self.rotation * arm) * self.grip
    }
}

/// det G/‖F‖³ = (σ1 + σ2)(σ2 + σ3)(σ3 + σ1)/‖F‖³ of the covariance F with G = tr S I − S, S = RᵀF: 1.5 where the neighbours
/// stand around the node alike, nothing where they stand in a line or are turned inside out alike along two axes, so that
/// the rotation that fits best jumps.
#[inline(always)]
pub(super) fn well_shaped<R: Real>(covariance: &Mat3<R>, gradient: &Sym3<R>) -> R {
    let (unit, scale) = scaled(covariance);
    let one = scale.like(1.0);
    let square = unit.squared_norm();
    let null = square.less_than(one.half());
    let size = R::select(null, one, square * square.sqrt());
    R::select(null, one.zero_like(), Mat3::from(*gradient * (one / scale)).determinant() / size)
}

/// RᵀA R.
#[inline(always)]
fn turned_back<R: Real>(rotation: &Mat3<R>, a: &Sym3<R>) -> Sym3<R> {
    let Sym3 { xx, yy, zz, xy, xz, yz } = *a;
    let full = Mat3::from_columns(Vec3::new(xx, xy, xz), Vec3::new(xy, yy, yz), Vec3::new(xz, yz, zz));
    (rotation.transpose() * full * *rotation).symmetric_part()
}

/// s of H s = t; nothing where H is singular, or next to nothing.
#[inline(always)]
fn solve<R: Real>(matrix: &Sym3<R>, t: Vec3<R>) -> Vec3<R> {
    let trace = matrix.trace();
    let scale = t.x.like(1.0) / trace;
    let scaled = Mat3::from(*matrix * scale);
    let cofactor = scaled.cofactor();
    let determinant = scaled.columns[0].dot(cofactor.columns[0]);
    let solution = cofactor * t * (scale / determinant);
    let solution = Vec3::select(t.x.like(TOO_FLAT).less_than(determinant), solution, t.zero_like());
    Vec3::select(t.x.like(TOO_NEAR).less_than(trace), solution, t.zero_like())
}
