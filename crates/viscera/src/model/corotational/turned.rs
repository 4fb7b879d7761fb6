//! Turned gradients of corotational tetrahedra, and the products of the stiffness by them.

use super::hooke::Hooke;
use crate::math::{Lanes, Mat3, Part, Real, Scalar, Simd, Sym3, Vec3, prefetch};
use crate::model::lane_vector::{load, store};
use crate::model::patch::{Diagonal, Element};

/// Columns of a linearized element: three turned gradients and λ/μ, and where there are fibres their turned direction and 2κ/μ.
pub(super) const RATIO: usize = 9;
const TURNED: usize = 10;
pub(super) const FIBRE: usize = 10;
pub(super) const FIBRE_RATIO: usize = 13;
const TURNED_FIBRED: usize = 14;

/// How many columns a linearized element has.
pub(super) fn columns(fibred: bool) -> usize {
    if fibred { TURNED_FIBRED } else { TURNED }
}

/// √(s V μ) R A α of the corners 1, 2, 3 of a batch, and what is left of the law then: it is asked for σ/μ.
pub(super) struct Turned<R> {
    pub(super) gradients: Mat3<R>,
    /// λ/μ.
    pub(super) ratio: R,
    /// Turned direction and 2κ/μ.
    pub(super) fibre: Option<(Vec3<R>, R)>,
}

impl<R: Real> Turned<R> {
    /// σ(sym e)/μ.
    #[inline(always)]
    fn stress(&self, e: &Mat3<R>) -> Sym3<R> {
        let [a, b, c] = e.columns;
        let (two, pressure) = (self.ratio.like(2.0), self.ratio * e.trace());
        let stress = Sym3 {
            xx: a.x.mul_add(two, pressure),
            yy: b.y.mul_add(two, pressure),
            zz: c.z.mul_add(two, pressure),
            xy: a.y + b.x,
            xz: a.z + c.x,
            yz: b.z + c.y,
        };
        match self.fibre {
            Some((direction, ratio)) => Sym3::square(direction).mul_add(ratio * direction.dot(*e * direction), stress),
            None => stress,
        }
    }

    /// The forces of a frame in which the edges make `e` of the gradients.
    #[inline(always)]
    pub(super) fn forces(&self, e: &Mat3<R>) -> Mat3<R> {
        Mat3::from(self.stress(e)) * self.gradients
    }

    /// The law of σ/μ.
    #[inline(always)]
    fn hooke(&self) -> Hooke<R> {
        Hooke { lambda: self.ratio, mu: self.ratio.like(1.0), fibre: self.fibre }
    }

    /// Writes the columns of a block of rows.
    #[inline(always)]
    pub(super) fn store<T: Scalar, S: Simd>(&self, part: Part<S>, row: &mut [T])
    where
        R: Lanes<T, S>,
    {
        for i in 0..3 {
            store(part, self.gradients.columns[i], &mut row[3 * i * T::LANES..]);
        }
        self.ratio.store(part, &mut row[RATIO * T::LANES..]);
        if let Some((direction, ratio)) = self.fibre {
            store(part, direction, &mut row[FIBRE * T::LANES..]);
            ratio.store(part, &mut row[FIBRE_RATIO * T::LANES..]);
        }
    }
}

/// The derivative with the rotations held, from turned gradients. Tissue without fibres has a kernel of its own, whose registers
/// suffice: with both in one a product took a fifth longer.
pub(super) struct FrozenProduct<'a, T: Scalar, const FIBRED: bool>(pub(super) &'a [T]);

impl<T: Scalar, const FIBRED: bool> FrozenProduct<'_, T, FIBRED> {
    #[inline(always)]
    fn fetch(&self, slot: usize) {
        let len = T::LANES * columns(FIBRED);
        if let Some(row) = self.0.get(slot * len..(slot + 1) * len) {
            prefetch(row);
        }
    }

    #[inline(always)]
    fn load<S: Simd>(&self, part: Part<S>, slot: usize) -> Turned<T::Lanes<S>> {
        let len = T::LANES * columns(FIBRED);
        let row = &self.0[slot * len..][..len];
        let number = |column: usize| T::Lanes::<S>::load(part, &row[column * T::LANES..]);
        let gradients =
            Mat3::from_columns(load(part, row), load(part, &row[3 * T::LANES..]), load(part, &row[6 * T::LANES..]));
        let fibre = if FIBRED { Some((load(part, &row[FIBRE * T::LANES..]), number(FIBRE_RATIO))) } else { None };
        Turned { gradients, ratio: number(RATIO), fibre }
    }
}

// 117 flops for an isotropic law: 9 for dD, 45 for dD gᵀ, 12 for the stress, 45 for its products, 6 for corner 0. Benches count the 129 of a law with
// λ and μ apart.
impl<T: Scalar, const FIBRED: bool> Element<T, 1> for FrozenProduct<'_, T, FIBRED> {
    #[inline(always)]
    fn prefetch(&self, slot: usize) {
        self.fetch(slot);
    }

    #[inline(always)]
    fn forces<S: Simd>(&self, part: Part<S>, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1]) -> Mat3<T::Lanes<S>> {
        let turned = self.load(part, slot);
        turned.forces(&(edges[0] * turned.gradients.transpose()))
    }
}

impl<T: Scalar, const FIBRED: bool> Diagonal<T> for FrozenProduct<'_, T, FIBRED> {
    const IS_OF_EDGES: bool = false;

    #[inline(always)]
    fn prefetch(&self, slot: usize) {
        self.fetch(slot);
    }

    #[inline(always)]
    fn blocks<S: Simd>(&self, part: Part<S>, slot: usize, _edges: &Mat3<T::Lanes<S>>) -> [Sym3<T::Lanes<S>>; 4] {
        let turned = self.load(part, slot);
        let hooke = turned.hooke();
        let [b, c, d] = turned.gradients.columns;
        [hooke.own_block(-(b + c + d)), hooke.own_block(b), hooke.own_block(c), hooke.own_block(d)]
    }
}
