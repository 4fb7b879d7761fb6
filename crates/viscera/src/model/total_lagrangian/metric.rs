//! St Venant–Kirchhoff tetrahedra in metric form, along edges that are orthogonal at rest: F is never formed.
//!
//! With D the current edge matrix and A0 = Dm⁻¹Dm⁻ᵀ, whose entries are the products of the gradients of the shape functions,
//!
//! [f1 f2 f3] = V D [(λ tr E − μ) A0 + μ A0 G A0],   G = DᵀD,   tr E = ½(A0:G − 3)
//!
//! as Dm⁻¹ E Dm⁻ᵀ = ½(A0 G A0 − A0). Along [edges that are orthogonal at rest](super::orthogonal), A0 = L Δ Lᵀ and B = D L, with M = BᵀB,
//! Δ times q = √(Vμ), t_i = δ_i M_ii and r = λ/2μ
//!
//! [f1 f2 f3] = B [Δ M Δ + (r (t_1 + t_2 + t_3 − 3q) − q) Δ] Lᵀ
//!
//! in 132 operations, where the form above takes 200. Fibres along a0 add, with β = (Dm L)⁻¹ a0 and s = a0·E a0 = ½(β·M β − 1), 2 V κ_a s β βᵀ to what
//! is in brackets.

use super::super::block_table::BlockTable;
use super::super::kernel_bound::BoundedKernel;
use super::super::tet_loop::{RestTet, TetConstants, TetKernel};
use super::orthogonal::{self, at_corners, columns_at_corners, lower, squares};
use crate::material::{Fibre, RestStiffness, StVenantKirchhoff};
use crate::math::{Mat3, Real, Scalar, Sym3, Vec3};

/// Constants: L (zy, xy, xz), qδ (x, y, z), q = √(Vμ), r = λ/2μ.
#[derive(Clone, Debug)]
pub(super) struct StVenantKirchhoffMetric;

impl StVenantKirchhoffMetric {
    pub(super) fn constants(rest: &RestTet, stiffness: &RestStiffness) -> Vec<f64> {
        let lame = stiffness.lame;
        let root = (rest.volume.abs() * lame.mu).sqrt();
        let mut constants = orthogonal::constants(rest, root);
        constants.extend([root, lame.lambda / (2.0 * lame.mu)]);
        constants
    }
}

/// t = qδ_i M_ii: q times the diagonal of what is C in the basis of those edges.
#[inline(always)]
fn stretches<R: Real>(c: &[R], m: Sym3<R>) -> Vec3<R> {
    Vec3::new(c[3] * m.xx, c[4] * m.yy, c[5] * m.zz)
}

/// t_1 + t_2 + t_3 − 3q = 2q tr E, of the `sum` of the t.
#[inline(always)]
fn twice_trace<R: Real>(c: &[R], sum: R) -> R {
    c[6].mul_add(c[6].like(-3.0), sum)
}

/// What is in brackets for M = `m`.
#[inline(always)]
fn stress<R: Real>(c: &[R], m: Sym3<R>) -> Sym3<R> {
    let t = stretches(c, m);
    weighted(c, m, t, c[7].mul_add(twice_trace(c, t.x + t.y + t.z), -c[6]))
}

/// Its derivative along dM.
#[inline(always)]
fn stress_along<R: Real>(c: &[R], dm: Sym3<R>) -> Sym3<R> {
    let t = stretches(c, dm);
    weighted(c, dm, t, c[7] * (t.x + t.y + t.z))
}

/// Δ M Δ + `shift` Δ.
#[inline(always)]
fn weighted<R: Real>(c: &[R], m: Sym3<R>, t: Vec3<R>, shift: R) -> Sym3<R> {
    let Vec3 { x, y, z } = squares(c);
    Sym3 {
        xx: x * (t.x + shift),
        yy: y * (t.y + shift),
        zz: z * (t.z + shift),
        xy: (x * y) * m.xy,
        xz: (x * z) * m.xz,
        yz: (y * z) * m.yz,
    }
}

/// BᵀdB + dBᵀB.
#[inline(always)]
fn metric_along<R: Real>(b: &Mat3<R>, db: &Mat3<R>) -> Sym3<R> {
    (b.transpose() * *db).symmetric_part() * b.columns[0].x.like(2.0)
}

#[inline(always)]
fn mean_metric<R: Real>(from: &Mat3<R>, to: &Mat3<R>) -> Sym3<R> {
    (from.gram() + to.gram()) * from.columns[0].x.like(0.5)
}

#[inline(always)]
fn middle<R: Real>(from: &Mat3<R>, to: &Mat3<R>) -> Mat3<R> {
    (*from + *to) * from.columns[0].x.like(0.5)
}

// tr(E²) of products of small numbers at small strain, where tr C² − 2 tr C + 3 would cancel.
#[inline(always)]
fn isotropic_energy<R: Real>(c: &[R], m: Sym3<R>) -> R {
    let t = stretches(c, m);
    let (x, y, z) = (t.x - c[6], t.y - c[6], t.z - c[6]);
    let shear = off_diagonal(c, m);
    (c[7] * twice_trace(c, t.x + t.y + t.z).squared() + (x.squared() + y.squared() + z.squared()) + shear.double())
        * x.like(0.25)
}

/// q² (C_xy² + C_xz² + C_yz²) in the basis of those edges.
#[inline(always)]
fn off_diagonal<R: Real>(c: &[R], m: Sym3<R>) -> R {
    let Vec3 { x, y, z } = squares(c);
    (x * y) * m.xy.squared() + (x * z) * m.xz.squared() + (y * z) * m.yz.squared()
}

/// With W = q D A0 = B Δ Lᵀ and S = L [...] Lᵀ, the block of corner i is S_ii I + (2r + 1) w_i w_iᵀ + (L Δ Lᵀ)_ii B Δ Bᵀ.
#[inline(always)]
fn isotropic_diagonal<R: Real>(c: &[R], b: &Mat3<R>, stress: Sym3<R>) -> [Sym3<R>; 4] {
    let (lower, one) = (lower(c), c[7].like(1.0));
    let weighted = orthogonal::weighted(c, b, one);
    let left = (weighted * b.transpose()).symmetric_part();
    let own = columns_at_corners(&lower.back_to_edges(&weighted));
    let (metrics, stresses) = (at_corners(orthogonal::metric(c)), at_corners(lower.around(stress)));
    let both = c[7].double() + one;
    let mut blocks = [left; 4];
    for corner in 0..4 {
        blocks[corner] = left * metrics[corner] + Sym3::square(own[corner]) * both + Sym3::diagonal(stresses[corner]);
    }
    blocks
}

impl TetConstants for StVenantKirchhoffMetric {
    const CONSTANTS: usize = 8;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        for column in 3..7 {
            *constants.get_mut(row, column) = T::ZERO;
        }
    }
}

impl TetKernel for StVenantKirchhoffMetric {
    const KEEPS_ENERGY: bool = true;
    const HAS_DIAGONAL: bool = true;

    #[inline(always)]
    fn diagonal<R: Real>(constants: &[R], d: &Mat3<R>) -> [Sym3<R>; 4] {
        let b = lower(constants).orthogonal_edges(d);
        isotropic_diagonal(constants, &b, stress(constants, b.gram()))
    }

    // B in the middle, the stress, which is linear in M, at the mean of both M (Simo, Tarnow 1992).
    #[inline(always)]
    fn mean_forces<R: Real>(constants: &[R], from: &Mat3<R>, to: &Mat3<R>) -> Mat3<R> {
        let lower = lower(constants);
        let (from, to) = (lower.orthogonal_edges(from), lower.orthogonal_edges(to));
        lower.back_to_edges(&(middle(&from, &to) * stress(constants, mean_metric(&from, &to))))
    }

    #[inline(always)]
    fn energy<R: Real>(constants: &[R], d: &Mat3<R>) -> R {
        isotropic_energy(constants, lower(constants).orthogonal_edges(d).gram())
    }

    #[inline(always)]
    fn forces<R: Real>(constants: &[R], d: &Mat3<R>) -> Mat3<R> {
        let lower = lower(constants);
        let b = lower.orthogonal_edges(d);
        lower.back_to_edges(&(b * stress(constants, b.gram())))
    }

    #[inline(always)]
    fn product<R: Real>(constants: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        let lower = lower(constants);
        let (b, db) = (lower.orthogonal_edges(d), lower.orthogonal_edges(dd));
        let along = stress_along(constants, metric_along(&b, &db));
        lower.back_to_edges(&(db * stress(constants, b.gram()) + b * along))
    }
}

/// q tr C and q² times the square of the deviator of C, whose eigenvalues are those of Δ M.
#[inline(always)]
fn isotropic_invariants<R: Real>(c: &[R], m: Sym3<R>) -> [R; 2] {
    let t = stretches(c, m);
    let sum = t.x + t.y + t.z;
    let mean = sum * sum.like(1.0 / 3.0);
    let deviator = Vec3::new(t.x - mean, t.y - mean, t.z - mean);
    [sum, deviator.squared_norm() + off_diagonal(c, m).double()]
}

/// Upper bound of q times the largest eigenvalue of C: mean + √(⅔) ‖deviator‖.
#[inline(always)]
fn stretch_bound<R: Real>([sum, deviator, _]: &[R; 3]) -> R {
    *sum * sum.like(1.0 / 3.0) + (*deviator * sum.like(2.0 / 3.0)).sqrt()
}

/// V times the bound of the law, which is that of qλ/μ and q of q times the stretch.
#[inline(always)]
fn isotropic_bound<R: Real>(c: &[R], sum: R, stretch: R) -> R {
    let law = StVenantKirchhoff { lambda: c[6] * c[7].double(), mu: c[6] };
    law.bound_of(stretch, twice_trace(c, sum).half(), c[6])
}

impl BoundedKernel for StVenantKirchhoffMetric {
    #[inline(always)]
    fn invariants<R: Real>(c: &[R], d: &Mat3<R>) -> [R; 3] {
        let [sum, deviator] = isotropic_invariants(c, lower(c).orthogonal_edges(d).gram());
        [sum, deviator, sum.zero_like()]
    }

    #[inline(always)]
    fn stiffness_bound<R: Real>(c: &[R], _: &[R], invariants: &[R; 3]) -> R {
        isotropic_bound(c, invariants[0], stretch_bound(invariants))
    }
}

/// Constants: those of [`StVenantKirchhoffMetric`], then β and 2Vκ_a/q.
#[derive(Clone, Debug)]
pub(super) struct TransverseMetric;

impl TransverseMetric {
    pub(super) fn constants(rest: &RestTet, stiffness: &RestStiffness) -> Vec<f64> {
        let mut constants = StVenantKirchhoffMetric::constants(rest, stiffness);
        let Vec3 { x, y, z } = lower(&constants).solve(rest.inverse * stiffness.direction);
        constants.extend([x, y, z, 2.0 * rest.volume * stiffness.fibre_stiffness / constants[6]]);
        constants
    }
}

#[inline(always)]
fn fibre<R: Real>(c: &[R]) -> Vec3<R> {
    Vec3::new(c[8], c[9], c[10])
}

/// s = ½(β·M β − 1).
#[inline(always)]
fn fibre_strain<R: Real>(beta: Vec3<R>, m: Sym3<R>) -> R {
    (m.quadratic(beta) + beta.x.like(-1.0)).half()
}

/// 2Vκ_a.
#[inline(always)]
fn fibre_stiffness<R: Real>(c: &[R]) -> R {
    c[11] * c[6]
}

/// What is in brackets with fibres.
#[inline(always)]
fn fibre_stress<R: Real>(c: &[R], m: Sym3<R>) -> Sym3<R> {
    let beta = fibre(c);
    Sym3::square(beta).mul_add(fibre_stiffness(c) * fibre_strain(beta, m), stress(c, m))
}

/// Its derivative along dM.
#[inline(always)]
fn fibre_stress_along<R: Real>(c: &[R], dm: Sym3<R>) -> Sym3<R> {
    let beta = fibre(c);
    Sym3::square(beta).mul_add(fibre_stiffness(c) * dm.quadratic(beta).half(), stress_along(c, dm))
}

impl BoundedKernel for TransverseMetric {
    #[inline(always)]
    fn invariants<R: Real>(c: &[R], d: &Mat3<R>) -> [R; 3] {
        let m = lower(c).orthogonal_edges(d).gram();
        let [sum, deviator] = isotropic_invariants(c, m);
        [sum, deviator, fibre_strain(fibre(c), m)]
    }

    #[inline(always)]
    fn stiffness_bound<R: Real>(c: &[R], _: &[R], invariants: &[R; 3]) -> R {
        let stretch = stretch_bound(invariants);
        isotropic_bound(c, invariants[0], stretch) + Fibre::bound_of(c[11], stretch, c[6] * invariants[2])
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

    // Fibres add 2 V κ_a (Lβ)_i² (s I + B β (B β)ᵀ) to the block of corner i.
    #[inline(always)]
    fn diagonal<R: Real>(constants: &[R], d: &Mat3<R>) -> [Sym3<R>; 4] {
        let (lower, beta) = (lower(constants), fibre(constants));
        let b = lower.orthogonal_edges(d);
        let m = b.gram();
        let mut blocks = isotropic_diagonal(constants, &b, stress(constants, m));
        let along = Sym3::square(b * beta) + Sym3::diagonal(fibre_strain(beta, m));
        let shares = at_corners(lower.around(Sym3::square(beta)));
        for corner in 0..4 {
            blocks[corner] = along.mul_add(fibre_stiffness(constants) * shares[corner], blocks[corner]);
        }
        blocks
    }

    #[inline(always)]
    fn mean_forces<R: Real>(constants: &[R], from: &Mat3<R>, to: &Mat3<R>) -> Mat3<R> {
        let lower = lower(constants);
        let (from, to) = (lower.orthogonal_edges(from), lower.orthogonal_edges(to));
        lower.back_to_edges(&(middle(&from, &to) * fibre_stress(constants, mean_metric(&from, &to))))
    }

    #[inline(always)]
    fn energy<R: Real>(constants: &[R], d: &Mat3<R>) -> R {
        let m = lower(constants).orthogonal_edges(d).gram();
        let s = fibre_strain(fibre(constants), m);
        isotropic_energy(constants, m) + (fibre_stiffness(constants) * s.squared()).half()
    }

    #[inline(always)]
    fn forces<R: Real>(constants: &[R], d: &Mat3<R>) -> Mat3<R> {
        let lower = lower(constants);
        let b = lower.orthogonal_edges(d);
        lower.back_to_edges(&(b * fibre_stress(constants, b.gram())))
    }

    #[inline(always)]
    fn product<R: Real>(constants: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        let lower = lower(constants);
        let (b, db) = (lower.orthogonal_edges(d), lower.orthogonal_edges(dd));
        let along = fibre_stress_along(constants, metric_along(&b, &db));
        lower.back_to_edges(&(db * fibre_stress(constants, b.gram()) + b * along))
    }
}
