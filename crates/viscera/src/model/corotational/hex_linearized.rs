//! Products of hexahedra with the rotation held, in the form that costs what linear elasticity costs.
//!
//! With h = √(s V) R A g at each Gauss point, found once, K dx = Σ σ(sym Σ_q dx_q h_qᵀ) h_p: no rotation is left in it.

use std::ops::Range;

use super::hex::{CorotationalHexes, POINTS};
use super::hooke::Hooke;
use crate::math::{Lanes, Mat3, Part, Real, Scalar, Simd, Vec3};
use crate::model::BlockSink;
use crate::model::block_sink::add_block;
use crate::model::lane_vector::{load, store};
use crate::model::total_lagrangian::hex::{POINT, deformation, gather_corners, load_gradients};

/// Numbers of the turned gradients of a point.
const GRADIENTS: usize = 24;
/// Numbers of a linearized element: gradients, and the turned fibre direction.
const FIBRE: usize = POINTS * GRADIENTS;
pub(super) const LINEARIZED: usize = FIBRE + 3;

impl<T: Scalar> CorotationalHexes<T> {
    #[inline(always)]
    pub(super) fn linearize_with<S: Simd>(
        &self,
        simd: S,
        x: &[[T; 4]],
        batches: Range<usize>,
        linearization: &mut [T],
    ) {
        let rows = linearization.chunks_exact_mut(LINEARIZED * T::LANES);
        for (batch, row) in batches.zip(rows) {
            for part in Part::all::<T>(simd) {
                let place = gather_corners(part, x, self.corners.block(batch));
                let centre = load_gradients::<T, S>(part, self.centres.block(batch));
                let r = self.formulation.rotation(&deformation(&place, &centre));
                let turned = row.chunks_exact_mut(GRADIENTS * T::LANES);
                for (point, turned) in self.points.block(batch).chunks_exact(POINT * T::LANES).zip(turned) {
                    let gradients = load_gradients::<T, S>(part, point);
                    let volume = T::Lanes::<S>::load(part, &point[24 * T::LANES..]);
                    let (transport, scale) = self.formulation.transport(&r, &deformation(&place, &gradients));
                    let transport = transport * (volume * scale).sqrt();
                    for corner in 0..8 {
                        store(part, transport * gradients[corner], &mut turned[3 * corner * T::LANES..]);
                    }
                }
                if let Some((direction, _)) = self.load_law(part, self.law.block(batch)).fibre {
                    store(part, r * direction, &mut row[FIBRE * T::LANES..]);
                }
            }
        }
    }

    #[inline(always)]
    pub(super) fn add_linearized_product_with<S: Simd>(
        &self,
        simd: S,
        linearization: &[T],
        dx: &[[T; 4]],
        batches: Range<usize>,
        out: &mut [[T; 4]],
    ) {
        for batch in batches {
            let row = &linearization[batch * LINEARIZED * T::LANES..(batch + 1) * LINEARIZED * T::LANES];
            for part in Part::all::<T>(simd) {
                let hooke = self.load_turned_law(part, self.law.block(batch), row);
                let direction = gather_corners(part, dx, self.corners.block(batch));
                let mut forces = [Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO)); 8];
                for turned in row[..FIBRE * T::LANES].chunks_exact(GRADIENTS * T::LANES) {
                    let gradients = load_gradients::<T, S>(part, turned);
                    let stress = Mat3::from(hooke.stress(deformation(&direction, &gradients).symmetric_part()));
                    for corner in 0..8 {
                        forces[corner] += stress * gradients[corner];
                    }
                }
                self.scatter::<S>(part, &forces, batch, out);
            }
        }
    }

    #[inline(always)]
    pub(super) fn add_linearized_blocks_with<S: Simd>(
        &self,
        simd: S,
        linearization: &[T],
        sink: &mut dyn BlockSink<T>,
    ) {
        let rows = linearization.chunks_exact(LINEARIZED * T::LANES);
        for (batch, ((nodes, law), row)) in self.corners.blocks().zip(self.law.blocks()).zip(rows).enumerate() {
            let elements = self.corners.rows() - batch * T::LANES;
            for part in Part::all::<T>(simd) {
                let hooke = self.load_turned_law(part, law, row);
                for (q, p) in (0..8).flat_map(|q| (0..8).map(move |p| (q, p))) {
                    if p == q || !sink.keeps_diagonal_only() {
                        let mut block = Mat3::diagonal(T::Lanes::<S>::splat(simd, T::ZERO));
                        for turned in row[..FIBRE * T::LANES].chunks_exact(GRADIENTS * T::LANES) {
                            block += hooke.block(
                                load(part, &turned[3 * p * T::LANES..]),
                                load(part, &turned[3 * q * T::LANES..]),
                            );
                        }
                        add_block::<T, S>(part, &block, nodes, [p, q], elements, sink);
                    }
                }
            }
        }
    }

    /// The law of a batch, its fibres turned.
    #[inline(always)]
    fn load_turned_law<S: Simd>(&self, part: Part<S>, law: &[T], row: &[T]) -> Hooke<T::Lanes<S>> {
        let hooke = self.load_law(part, law);
        Hooke { fibre: hooke.fibre.map(|(_, stiffness)| (load(part, &row[FIBRE * T::LANES..]), stiffness)), ..hooke }
    }
}
