//! Stable neo-Hookean tetrahedra in metric form: F is never formed.
//!
//! With D the current edge matrix, A0 = Dm⁻¹Dm⁻ᵀ, I_C = A0:DᵀD and J = det D / det Dm:
//!
//! [f1 f2 f3] = V μ' (1 − 1/(I_C + 1)) D A0 + V [λ' (J − 1) − ¾μ'] cof D / det Dm
//!
//! because P Dm⁻ᵀ needs F Dm⁻ᵀ = D A0 and cof F Dm⁻ᵀ = cof D / det Dm only. Along [edges that are orthogonal at rest](super::orthogonal)
//! D A0 = B Δ Lᵀ and cof D = cof B Lᵀ. About 125 flops.

use super::super::block_table::BlockTable;
use super::super::kernel_bound::BoundedKernel;
use super::super::tet_loop::{RestTet, TetConstants, TetKernel};
use super::orthogonal::{self, at_corners, columns_at_corners, lower, weighted};
use crate::material::{LawFamily, StableNeoHookean};
use crate::math::{Mat3, Real, Scalar, Sym3};

/// Constants: L (yx, zx, zy), δ (x, y, z), 1/det Dm, Vλ', Vμ'.
#[derive(Clone, Debug)]
pub(super) struct StableNeoHookeanMetric;

impl StableNeoHookeanMetric {
    pub(super) fn constants(rest: &RestTet, law: &[f64]) -> Vec<f64> {
        let (lambda, mu) = StableNeoHookean::from_values(law).rescaled();
        let inverse_determinant = 1.0 / (6.0 * rest.volume);
        let mut constants = orthogonal::constants(rest, 1.0);
        constants.extend([inverse_determinant, rest.volume * lambda, rest.volume * mu]);
        constants
    }
}

/// I_C = Σ δ_i |b_i|².
#[inline(always)]
fn first_invariant<R: Real>(c: &[R], b: &Mat3<R>) -> R {
    let [x, y, z] = b.columns;
    c[3].mul_add(x.dot(x), c[4].mul_add(y.dot(y), c[5] * z.dot(z)))
}

/// V [λ' (J − 1) − ¾μ'] / det Dm.
#[inline(always)]
fn pressure<R: Real>(c: &[R], determinant: R) -> R {
    let change = determinant.mul_add(c[6], c[6].like(-1.0));
    (c[7] * change - c[8] * c[8].like(0.75)) * c[6]
}

/// Vλ'/det Dm². In this order: the square alone leaves the range at edges of 1e-51 m.
#[inline(always)]
fn over_squared_determinant<R: Real>(c: &[R]) -> R {
    c[7] * c[6] * c[6]
}

// ‖cof F‖² = Σ δ_j δ_k |b_j × b_k|².
impl BoundedKernel for StableNeoHookeanMetric {
    #[inline(always)]
    fn invariants<R: Real>(c: &[R], d: &Mat3<R>) -> [R; 3] {
        let b = lower(c).orthogonal_edges(d);
        let [x, y, z] = b.cofactor().columns;
        let area = (c[4] * c[5]) * x.dot(x) + (c[3] * c[5]) * y.dot(y) + (c[3] * c[4]) * z.dot(z);
        [first_invariant(c, &b), area, b.columns[0].dot(x) * c[6]]
    }

    #[inline(always)]
    fn stiffness_bound<R: Real>(c: &[R], &[square, area, determinant]: &[R; 3]) -> R {
        StableNeoHookean::<R>::bound_of((c[7], c[8]), square, area, determinant)
    }
}

impl TetConstants for StableNeoHookeanMetric {
    const CONSTANTS: usize = 9;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        *constants.get_mut(row, 7) = T::ZERO;
        *constants.get_mut(row, 8) = T::ZERO;
    }
}

impl TetKernel for StableNeoHookeanMetric {
    const HAS_DIAGONAL: bool = true;

    // The area vector cof D_i of a face does not change with the corner opposite to it: the pressure adds nothing.
    #[inline(always)]
    fn diagonal<R: Real>(c: &[R], d: &Mat3<R>) -> [Sym3<R>; 4] {
        let (lower, one) = (lower(c), c[0].like(1.0));
        let b = lower.orthogonal_edges(d);
        let share = one / (first_invariant(c, &b) + one);
        let own = columns_at_corners(&lower.back_to_edges(&weighted(c, &b, one)));
        let areas = columns_at_corners(&lower.back_to_edges(&b.cofactor()));
        let metric = orthogonal::metric(c);
        let (metrics, volume) = (at_corners(metric), over_squared_determinant(c));
        let mut blocks = [metric; 4];
        for corner in 0..4 {
            blocks[corner] = Sym3::square(own[corner]) * (c[8] * share.squared()).double()
                + Sym3::square(areas[corner]) * volume
                + Sym3::diagonal(c[8] * (one - share) * metrics[corner]);
        }
        blocks
    }

    #[inline(always)]
    fn energy<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let (b, one) = (lower(c).orthogonal_edges(d), c[0].like(1.0));
        let excess = first_invariant(c, &b) - one.like(3.0);
        let change = b.determinant().mul_add(c[6], one.like(-1.0));
        let logarithm = excess.mul_add(one.like(0.25), one).ln();
        let shape = (excess - logarithm).half() - change * one.like(0.75);
        c[8] * shape + (c[7] * change.squared()).half()
    }

    #[inline(always)]
    fn forces<R: Real>(c: &[R], d: &Mat3<R>) -> Mat3<R> {
        let (lower, one) = (lower(c), c[0].like(1.0));
        let b = lower.orthogonal_edges(d);
        let cofactor = b.cofactor();
        let shape = c[8] * (one - one / (first_invariant(c, &b) + one));
        let pressure = pressure(c, b.columns[0].dot(cofactor.columns[0]));
        lower.back_to_edges(&cofactor.mul_add(pressure, weighted(c, &b, shape)))
    }

    // dI_C = 2 Σ δ_i b_i·db_i
    #[inline(always)]
    fn product<R: Real>(c: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        let (lower, one) = (lower(c), c[0].like(1.0));
        let (b, db) = (lower.orthogonal_edges(d), lower.orthogonal_edges(dd));
        let cofactor = b.cofactor();
        let share = one / (first_invariant(c, &b) + one);
        let direction = weighted(c, &b, one);
        let d_shape = (c[8] * share.squared() * direction.contract(db)).double();
        let d_pressure = over_squared_determinant(c) * cofactor.contract(db);
        let forces = weighted(c, &db, c[8] * (one - share))
            + direction * d_shape
            + cofactor * d_pressure
            + b.cofactor_along(db) * pressure(c, b.columns[0].dot(cofactor.columns[0]));
        lower.back_to_edges(&forces)
    }
}
