//! St Venant–Kirchhoff tetrahedra in metric form: F is never formed.
//!
//! With D the current edge matrix, A0 = Dm⁻¹Dm⁻ᵀ and G = DᵀD (both symmetric):
//!
//! tr E = ½(A0:G − 3),   [f1 f2 f3] = V D [(λ tr E − μ) A0 + μ A0 G A0]
//!
//! because Dm⁻¹ E Dm⁻ᵀ = ½(A0 G A0 − A0). Fibres along a0 add, with b = Dm⁻¹ a0 and s = a0·E a0 = ½(b·G b − 1):
//!
//! [f1 f2 f3] += 2 V κ_a s (D b) bᵀ

use super::super::block_table::BlockTable;
use super::super::kernel_bound::BoundedKernel;
use super::super::tet_loop::{RestTet, TetConstants, TetKernel};
use crate::material::{Fibre, RestStiffness, StVenantKirchhoff};
use crate::math::{Mat3, Real, Scalar, Sym3, Vec3};

/// Constants: A0 (xx, yy, zz, xy, xz, yz), Vλ, Vμ.
#[derive(Clone, Debug)]
pub(super) struct StVenantKirchhoffMetric;

impl StVenantKirchhoffMetric {
    pub(super) fn constants(rest: &RestTet, stiffness: &RestStiffness) -> Vec<f64> {
        let metric = rest.inverse.transpose().gram();
        vec![
            metric.xx,
            metric.yy,
            metric.zz,
            metric.xy,
            metric.xz,
            metric.yz,
            rest.volume * stiffness.lame.lambda,
            rest.volume * stiffness.lame.mu,
        ]
    }
}

#[inline(always)]
fn metric<R: Real>(c: &[R]) -> Sym3<R> {
    Sym3 { xx: c[0], yy: c[1], zz: c[2], xy: c[3], xz: c[4], yz: c[5] }
}

/// tr E = ½(A0:G − 3).
#[inline(always)]
fn trace_of_strain<R: Real>(a0: Sym3<R>, g: Sym3<R>) -> R {
    (a0.contract(g) + g.xx.like(-3.0)).half()
}

/// V times (λ tr E − μ) A0 + μ A0 G A0: twice the energy's derivative with respect to G.
#[inline(always)]
fn contravariant_stress<R: Real>(c: &[R], g: Sym3<R>) -> Sym3<R> {
    let a0 = metric(c);
    a0.sandwich(g).mul_add(c[7], a0 * (c[6] * trace_of_strain(a0, g) - c[7]))
}

/// Its derivative along dG.
#[inline(always)]
fn contravariant_stress_along<R: Real>(c: &[R], dg: Sym3<R>) -> Sym3<R> {
    let a0 = metric(c);
    a0.sandwich(dg).mul_add(c[7], a0 * (c[6] * a0.contract(dg).half()))
}

/// DᵀdD + dDᵀD.
#[inline(always)]
fn metric_along<R: Real>(d: &Mat3<R>, dd: &Mat3<R>) -> Sym3<R> {
    (d.transpose() * *dd).symmetric_part() * d.columns[0].x.like(2.0)
}

#[inline(always)]
fn middle<R: Real>(from: Mat3<R>, to: Mat3<R>) -> Mat3<R> {
    (from + to) * from.columns[0].x.like(0.5)
}

#[inline(always)]
fn mean_metric<R: Real>(from: &Mat3<R>, to: &Mat3<R>) -> Sym3<R> {
    (from.gram() + to.gram()) * from.columns[0].x.like(0.5)
}

// tr(E²) = ¼ tr(M²) with M = A0 G − I: a product of small numbers at small strain, where tr C² − 2 tr C + 3 would cancel.
#[inline(always)]
fn isotropic_energy<R: Real>(c: &[R], g: Sym3<R>) -> R {
    let a0 = metric(c);
    let m = Mat3::from(a0) * g - Mat3::diagonal(g.xx.like(1.0));
    (c[6] * trace_of_strain(a0, g).squared()).half() + c[7] * m.contract(m.transpose()) * g.xx.like(0.25)
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

/// With W = D A0 and S the contravariant stress, the block of corner i is S_ii I + V (λ + μ) w_i w_iᵀ + V μ A0_ii D A0 Dᵀ.
#[inline(always)]
fn isotropic_diagonal<R: Real>(c: &[R], d: &Mat3<R>, stress: Sym3<R>) -> [Sym3<R>; 4] {
    let a0 = metric(c);
    let w = *d * a0;
    let left = (w * d.transpose()).symmetric_part();
    let (own, metrics, stresses) = (columns_at_corners(&w), at_corners(a0), at_corners(stress));
    let mut blocks = [left; 4];
    for corner in 0..4 {
        blocks[corner] = left * (c[7] * metrics[corner])
            + Sym3::square(own[corner]) * (c[6] + c[7])
            + Sym3::diagonal(stresses[corner]);
    }
    blocks
}

impl TetConstants for StVenantKirchhoffMetric {
    const CONSTANTS: usize = 8;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        *constants.get_mut(row, 6) = T::ZERO;
        *constants.get_mut(row, 7) = T::ZERO;
    }
}

impl TetKernel for StVenantKirchhoffMetric {
    const KEEPS_ENERGY: bool = true;
    const HAS_DIAGONAL: bool = true;

    #[inline(always)]
    fn diagonal<R: Real>(constants: &[R], d: &Mat3<R>) -> [Sym3<R>; 4] {
        isotropic_diagonal(constants, d, contravariant_stress(constants, d.gram()))
    }

    // D in the middle, the stress, which is linear in G, at the mean of both G (Simo, Tarnow 1992).
    #[inline(always)]
    fn mean_forces<R: Real>(constants: &[R], from: &Mat3<R>, to: &Mat3<R>) -> Mat3<R> {
        middle(*from, *to) * contravariant_stress(constants, mean_metric(from, to))
    }

    #[inline(always)]
    fn energy<R: Real>(constants: &[R], d: &Mat3<R>) -> R {
        isotropic_energy(constants, d.gram())
    }

    #[inline(always)]
    fn forces<R: Real>(constants: &[R], d: &Mat3<R>) -> Mat3<R> {
        *d * contravariant_stress(constants, d.gram())
    }

    #[inline(always)]
    fn product<R: Real>(constants: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        *dd * contravariant_stress(constants, d.gram())
            + *d * contravariant_stress_along(constants, metric_along(d, dd))
    }
}

/// Upper bound of the largest eigenvalue of C, which has those of A0 G: mean + √(⅔) ‖deviator‖.
#[inline(always)]
fn stretch_bound<R: Real>(a0: Sym3<R>, g: Sym3<R>) -> R {
    let m = Mat3::from(a0) * g;
    let mean = m.trace() * g.xx.like(1.0 / 3.0);
    let deviator = m - Mat3::diagonal(mean);
    let square = deviator.contract(deviator.transpose());
    // Rounding makes it negative at rest.
    mean + (square.max(square.zero_like()) * mean.like(2.0 / 3.0)).sqrt()
}

impl BoundedKernel for StVenantKirchhoffMetric {
    #[inline(always)]
    fn stiffness_bound<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let (a0, g) = (metric(c), d.gram());
        StVenantKirchhoff { lambda: c[6], mu: c[7] }.bound_of(stretch_bound(a0, g), trace_of_strain(a0, g))
    }
}

/// Constants: those of [`StVenantKirchhoffMetric`], then b = Dm⁻¹a0 and 2Vκ_a.
#[derive(Clone, Debug)]
pub(super) struct TransverseMetric;

impl TransverseMetric {
    pub(super) fn constants(rest: &RestTet, stiffness: &RestStiffness) -> Vec<f64> {
        let b = rest.inverse * stiffness.direction;
        let mut constants = StVenantKirchhoffMetric::constants(rest, stiffness);
        constants.extend([b.x, b.y, b.z, 2.0 * rest.volume * stiffness.fibre_stiffness]);
        constants
    }
}

#[inline(always)]
fn fibre<R: Real>(c: &[R]) -> Vec3<R> {
    Vec3::new(c[8], c[9], c[10])
}

/// s = ½(b·G b − 1).
#[inline(always)]
fn fibre_strain<R: Real>(b: Vec3<R>, g: Sym3<R>) -> R {
    (g.quadratic(b) + b.x.like(-1.0)).half()
}

impl BoundedKernel for TransverseMetric {
    #[inline(always)]
    fn stiffness_bound<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let (a0, g) = (metric(c), d.gram());
        let stretch = stretch_bound(a0, g);
        StVenantKirchhoff { lambda: c[6], mu: c[7] }.bound_of(stretch, trace_of_strain(a0, g))
            + Fibre::bound_of(c[11], stretch, fibre_strain(fibre(c), g))
    }
}

impl TetConstants for TransverseMetric {
    const CONSTANTS: usize = 12;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        StVenantKirchhoffMetric::deactivate(constants, row);
        *constants.get_mut(row, 11) = T::ZERO;
    }
}

impl TetKernel for TransverseMetric {
    const KEEPS_ENERGY: bool = true;
    const HAS_DIAGONAL: bool = true;

    // Fibres add 2 V κ_a b_i² (s I + D b (D b)ᵀ) to the block of corner i.
    #[inline(always)]
    fn diagonal<R: Real>(constants: &[R], d: &Mat3<R>) -> [Sym3<R>; 4] {
        let (g, b) = (d.gram(), fibre(constants));
        let mut blocks = isotropic_diagonal(constants, d, contravariant_stress(constants, g));
        let along = Sym3::square(*d * b) + Sym3::diagonal(fibre_strain(b, g));
        for (block, share) in blocks.iter_mut().zip([-(b.x + b.y + b.z), b.x, b.y, b.z]) {
            *block = *block + along * (constants[11] * share.squared());
        }
        blocks
    }

    #[inline(always)]
    fn mean_forces<R: Real>(constants: &[R], from: &Mat3<R>, to: &Mat3<R>) -> Mat3<R> {
        let (g, b) = (mean_metric(from, to), fibre(constants));
        let along_fibre = Sym3::square(b) * (constants[11] * fibre_strain(b, g));
        middle(*from, *to) * (contravariant_stress(constants, g) + along_fibre)
    }

    #[inline(always)]
    fn energy<R: Real>(constants: &[R], d: &Mat3<R>) -> R {
        let g = d.gram();
        let s = fibre_strain(fibre(constants), g);
        isotropic_energy(constants, g) + (constants[11] * s.squared()).half()
    }

    #[inline(always)]
    fn forces<R: Real>(constants: &[R], d: &Mat3<R>) -> Mat3<R> {
        let (g, b) = (d.gram(), fibre(constants));
        let along_fibre = Sym3::square(b) * (constants[11] * fibre_strain(b, g));
        *d * (contravariant_stress(constants, g) + along_fibre)
    }

    #[inline(always)]
    fn product<R: Real>(constants: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        let (g, dg, b) = (d.gram(), metric_along(d, dd), fibre(constants));
        let bb = Sym3::square(b);
        let stress = contravariant_stress(constants, g) + bb * (constants[11] * fibre_strain(b, g));
        let d_stress = contravariant_stress_along(constants, dg) + bb * (constants[11] * dg.quadratic(b).half());
        *dd * stress + *d * d_stress
    }
}
