//! Forces of hexahedra between two places that account for the energy between them, for laws that are quadratic in Green's strain.
//!
//! At each Gauss point P = ½(F + F⁺) S(½(E + E⁺)): S is linear in E, and sym(½(F + F⁺)ᵀ (F⁺ − F)) = E⁺ − E, so that
//! P:(F⁺ − F) = ψ(F⁺) − ψ(F). P times the transpose of the mean F is symmetric: no torque about the places in the middle.
//!
//! Source: Simo, Tarnow, The discrete energy-momentum method (1992).

use std::ops::Range;

use super::super::sections::SectionScratch;
use super::super::tet_loop::scatter_corners;
use super::super::{MeanForces, Scratch};
use super::hex::{HexLoop, POINT, deformation, gather_corners, load_gradients, load_parameters};
use crate::material::{Law, LawFamily, StrainMeasure, green_strain};
use crate::math::{Lanes, Mat3, Part, Scalar, Simd, Vec3, baseline};

/// Whether the law is one of those.
pub(super) fn keeps_energy<L: LawFamily>() -> bool {
    L::example().quadratic().is_some_and(|law| law.strain == StrainMeasure::Green)
}

impl<T: Scalar, L: LawFamily> MeanForces<T> for HexLoop<T, L> {
    fn add_mean_forces(&self, from: &[Vec3<T>], to: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(from);
        scratch.start_direction(to);
        let SectionScratch { nodal, direction, mut sums, .. } = scratch.sections(self.sections.sum_rows());
        self.sections.add(&mut sums, &|batches, rows| {
            self.add_means_with(baseline(), [nodal, direction], batches, rows);
        });
        scratch.finish(out);
    }
}

impl<T: Scalar, L: LawFamily> HexLoop<T, L> {
    #[inline(always)]
    fn add_means_with<S: Simd>(&self, simd: S, [from, to]: [&[[T; 4]]; 2], batches: Range<usize>, out: &mut [[T; 4]]) {
        let half = T::Lanes::<S>::splat(simd, T::from_f64(0.5));
        for batch in batches {
            let nodes = self.corners.block(batch);
            let rows = self.sections.rows(batch * 8 * T::LANES..(batch + 1) * 8 * T::LANES);
            for part in Part::all::<T>(simd) {
                let [from, to] = [from, to].map(|places| gather_corners::<T, S>(part, places, nodes));
                let parameters = load_parameters::<T, S, L>(part, self.parameters.block(batch));
                let law = L::at(&parameters[..L::PARAMETERS.len()]);
                let mut forces = [Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO)); 8];
                for point in self.points.block(batch).chunks_exact(POINT * T::LANES) {
                    let gradients = load_gradients::<T, S>(part, point);
                    let [before, after] = [from, to].map(|places| deformation(&places, &gradients));
                    let strain = (green_strain(&before) + green_strain(&after)) * half;
                    // At F = I the derivative of P along a symmetric dF is S(dF), for S is linear.
                    let second = law.tangent(&before.identity_like(), &Mat3::from(strain));
                    let stress = (before + after) * half * second * T::Lanes::<S>::load(part, &point[24 * T::LANES..]);
                    for corner in 0..8 {
                        forces[corner] += stress * gradients[corner];
                    }
                }
                scatter_corners::<T, S, 8>(part, &forces, rows, out);
            }
        }
    }
}
