//! The entries of a batch of points, and what the law makes of them.

use crate::material::{Law, LawFamily};
use crate::math::{Lanes, Mat3, Part, Real, Scalar, Simd, Vec3};
use crate::model::lane_vector::{Kept, keep, load, take_up};
use crate::model::tet_loop::gather_corner;

/// The most parameters of a law.
pub(super) const MAX_PARAMETERS: usize = 8;

/// Volume, share and law of a batch of points.
pub(super) struct Point<R> {
    volume: R,
    share: R,
    parameters: [R; MAX_PARAMETERS],
}

impl<R: Real> Point<R> {
    #[inline(always)]
    pub(super) fn load<T, S, L>(part: Part<S>, constants: &[T]) -> Self
    where
        T: Scalar<Lanes<S> = R>,
        S: Simd,
        R: Lanes<T, S>,
        L: LawFamily,
    {
        let constant = |column: usize| R::load(part, &constants[column * T::LANES..]);
        let mut parameters = [R::splat(part.simd, T::ZERO); MAX_PARAMETERS];
        for column in 0..L::PARAMETERS.len() {
            parameters[column] = constant(2 + column);
        }
        Self { volume: constant(0), share: constant(1), parameters }
    }

    /// V P(F̄) of the law, less the share of the cells.
    #[inline(always)]
    pub(super) fn stress<L: LawFamily>(&self, f: &Mat3<R>) -> Mat3<R> {
        let law = L::at(&self.parameters[..L::PARAMETERS.len()]);
        law.stress(f) * self.volume - *f * self.share
    }

    #[inline(always)]
    pub(super) fn tangent<L: LawFamily>(&self, f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
        let law = L::at(&self.parameters[..L::PARAMETERS.len()]);
        law.tangent(f, df) * self.volume - *df * self.share
    }
}

/// A mean of gradients, or a stress, and a pull of springs.
pub(super) type Around<R> = (Mat3<R>, Vec3<R>);

/// The entries of a batch of points.
#[derive(Clone, Copy)]
pub(super) struct Batch<'a, T> {
    pub(super) nodes: &'a [u32],
    /// Where the batch sums, entry by entry.
    pub(super) rows: &'a [u32],
    pub(super) gradients: &'a [T],
    pub(super) springs: &'a [T],
}

impl<'a, T: Scalar> Batch<'a, T> {
    /// A node, x, y, z of a gradient, and a spring, for each lane.
    #[inline(always)]
    pub(super) fn entries(self) -> impl Iterator<Item = (&'a [u32], &'a [T], &'a [T])> {
        let gradients = self.gradients.chunks_exact(3 * T::LANES);
        let others = gradients.zip(self.springs.chunks_exact(T::LANES));
        self.nodes.chunks_exact(T::LANES).zip(others).map(|(nodes, (gradient, spring))| (nodes, gradient, spring))
    }

    /// Σ_b (v_b − v_a) g_abᵀ and Σ_b k_ab (v_b − v_a): of places F̄ and the pull of the springs, of directions their
    /// derivatives. The differences keep digits that v alone would lose.
    #[inline(always)]
    pub(super) fn around<S: Simd>(self, part: Part<S>, v: &[[T; 4]]) -> Around<T::Lanes<S>> {
        let own = gather_corner::<T, S>(part, v, self.nodes, 0);
        let zero = Vec3::splat(T::Lanes::<S>::splat(part.simd, T::ZERO));
        let (mut mean, mut pull) = (Mat3::from_columns(zero, zero, zero), zero);
        for (nodes, gradient, spring) in self.entries().skip(1) {
            let apart = gather_corner::<T, S>(part, v, nodes, 0) - own;
            mean += apart.outer(load(part, gradient));
            pull += apart * T::Lanes::<S>::load(part, spring);
        }
        (mean, pull)
    }

    /// Adds the forces of a stress and of a pull of springs on the nodes around, half by half; what is left to make them all zero acts on
    /// the node itself. `kept` is memory on the way, which cleared for each batch would take a twentieth of the time.
    #[inline(always)]
    pub(super) fn spread<S: Simd>(
        self,
        part: Part<S>,
        (stress, pull): Around<T::Lanes<S>>,
        kept: &mut [Kept<T>; 4],
        out: &mut [[T; 4]],
    ) {
        let [a, b, c] = stress.columns;
        keep(part.simd, a, &mut kept[0]);
        keep(part.simd, b, &mut kept[1]);
        keep(part.simd, c, &mut kept[2]);
        keep(part.simd, pull, &mut kept[3]);
        for half in part.halves::<T>() {
            let (a, b) = (take_up::<T, S, _>(half, &kept[0]), take_up::<T, S, _>(half, &kept[1]));
            let (c, pull) = (take_up::<T, S, _>(half, &kept[2]), take_up::<T, S, _>(half, &kept[3]));
            self.spread_half::<S>(half, Mat3::from_columns(a, b, c), pull, out);
        }
    }

    #[inline(always)]
    fn spread_half<S: Simd>(self, half: Part<S>, stress: Mat3<T::Half<S>>, pull: Vec3<T::Half<S>>, out: &mut [[T; 4]]) {
        let mut sum = pull;
        let gradients = self.gradients.chunks_exact(3 * T::LANES);
        for (rows, gradient) in self.rows.chunks_exact(T::LANES).zip(gradients).skip(1) {
            let force = stress * load(half, gradient);
            sum += force;
            T::Half::<S>::scatter_add(force.to_array(), half.of::<T, T::Half<S>, _>(rows), out);
        }
        T::Half::<S>::scatter_add((-sum).to_array(), half.of::<T, T::Half<S>, _>(&self.rows[..T::LANES]), out);
    }
}
