//! Stable neo-Hookean tetrahedra in metric form: F is never formed.
//!
//! With D the current edge matrix, A0 = Dm⁻¹Dm⁻ᵀ, I_C = A0:DᵀD and J = det D / det Dm:
//!
//! [f1 f2 f3] = V μ' (1 − 1/(I_C + 1)) D A0 + V [λ' (J − 1) − ¾μ'] cof D / det Dm
//!
//! because P Dm⁻ᵀ needs F Dm⁻ᵀ = D A0 and cof F Dm⁻ᵀ = cof D / det Dm only. Along [edges that are orthogonal at rest](super::orthogonal)
//! D A0 = B Δ Lᵀ. The columns of cof D are y × z, z × x and x × y of the edges x, y, z; along a fan, whose axis is x, two of them and |x|²
//! are found once for several tetrahedra. About 113 flops, where 125 are counted.
//!
//! Stored are Vλ'/det Dm² and V(λ' + ¾μ')/det Dm in place of det Dm: the pressure is one multiply-add of det D.

use super::super::block_table::BlockTable;
use super::super::kernel_bound::BoundedKernel;
use super::super::patch::Shared;
use super::super::tet_loop::{RestTet, TetConstants, TetKernel};
use super::orthogonal::{self, at_corners, columns_at_corners, lower, weighted};
use crate::material::{LawFamily, StableNeoHookean};
use crate::math::{Mat3, Real, Scalar, Sym3};

/// Constants: L (zy, xy, xz), δ (x, y, z), Vμ', Vλ'/det Dm², V(λ' + ¾μ')/det Dm.
#[derive(Clone, Debug)]
pub(super) struct StableNeoHookeanMetric;

impl StableNeoHookeanMetric {
    pub(super) fn constants(rest: &RestTet, law: &[f64]) -> Vec<f64> {
        let (lambda, mu) = StableNeoHookean::from_values(law).rescaled();
        let inverse_determinant = 1.0 / (6.0 * rest.volume);
        let mut constants = orthogonal::constants(rest, 1.0);
        // In this order: the square alone leaves the range at edges of 1e-51 m.
        let slope = rest.volume * lambda * inverse_determinant * inverse_determinant;
        constants.extend([rest.volume * mu, slope, (lambda + 0.75 * mu) / 6.0]);
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
    determinant.mul_add(c[7], -c[8])
}

// ‖cof F‖² = Σ δ_j δ_k |b_j × b_k|². All of it over det Dm², which belongs to Vλ'.
impl BoundedKernel for StableNeoHookeanMetric {
    const BOUND_CONSTANTS: usize = 1;

    /// 1/det Dm.
    fn bound_constants(rest: &RestTet) -> Vec<f64> {
        vec![1.0 / (6.0 * rest.volume)]
    }

    #[inline(always)]
    fn invariants<R: Real>(c: &[R], d: &Mat3<R>) -> [R; 3] {
        let b = lower(c).orthogonal_edges(d);
        let [x, y, z] = b.cofactor().columns;
        let area = (c[4] * c[5]) * x.dot(x) + (c[3] * c[5]) * y.dot(y) + (c[3] * c[4]) * z.dot(z);
        [first_invariant(c, &b), area, b.columns[0].dot(x)]
    }

    #[inline(always)]
    fn stiffness_bound<R: Real>(c: &[R], of_bound: &[R], &[square, area, determinant]: &[R; 3]) -> R {
        let inverse = of_bound[0];
        StableNeoHookean::<R>::bound_of((c[7], c[6] * inverse * inverse), square, area, determinant * inverse)
    }
}

impl TetConstants for StableNeoHookeanMetric {
    const CONSTANTS: usize = 9;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        for column in 6..9 {
            *constants.get_mut(row, column) = T::ZERO;
        }
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
        let (metrics, volume) = (at_corners(metric), c[7]);
        let mut blocks = [metric; 4];
        for corner in 0..4 {
            blocks[corner] = Sym3::square(own[corner]) * (c[6] * share.squared()).double()
                + Sym3::square(areas[corner]) * volume
                + Sym3::diagonal(c[6] * (one - share) * metrics[corner]);
        }
        blocks
    }

    #[inline(always)]
    fn energy<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let (b, one) = (lower(c).orthogonal_edges(d), c[0].like(1.0));
        let excess = first_invariant(c, &b) - one.like(3.0);
        // det Dm² = 1/(δ_x δ_y δ_z), of which the roots do not leave the range.
        let inverse_determinant = c[3].sqrt() * c[4].sqrt() * c[5].sqrt();
        let change = b.determinant().mul_add(inverse_determinant, one.like(-1.0));
        let change_of_determinant = change / inverse_determinant;
        let logarithm = excess.mul_add(one.like(0.25), one).ln();
        let shape = (excess - logarithm).half() - change * one.like(0.75);
        c[6] * shape + (c[7] * change_of_determinant * change_of_determinant).half()
    }

    #[inline(always)]
    fn forces<R: Real>(c: &[R], d: &Mat3<R>) -> Mat3<R> {
        Self::forces_in_fan(c, d, &Shared::of(d))
    }

    const IS_SHARING: bool = true;

    // What waits for the quotient is one multiply-add: with it further ahead there are fewer operations, and processors wait longer.
    #[inline(always)]
    fn forces_in_fan<R: Real>(c: &[R], d: &Mat3<R>, shared: &Shared<R>) -> Mat3<R> {
        let (lower, one) = (lower(c), c[0].like(1.0));
        let b = lower.orthogonal_edges(d);
        let [_, y, z] = d.columns;
        let pulls = weighted(c, &b, one);
        let square =
            c[3].mul_add(shared.axis_square, pulls.columns[1].dot(b.columns[1]) + pulls.columns[2].dot(b.columns[2]));
        let pressure = pressure(c, z.dot(shared.from));
        let pushes = Mat3::from_columns(y.cross(z) * pressure, shared.to * -pressure, shared.from * pressure);
        let shape = c[6] - c[6] / (square + one);
        lower.back_to_edges(&pulls).mul_add(shape, pushes)
    }

    // dI_C = 2 Σ δ_i b_i·db_i
    #[inline(always)]
    fn product<R: Real>(c: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        let (lower, one) = (lower(c), c[0].like(1.0));
        let (b, db) = (lower.orthogonal_edges(d), lower.orthogonal_edges(dd));
        let cofactor = b.cofactor();
        let share = one / (first_invariant(c, &b) + one);
        let direction = weighted(c, &b, one);
        let d_shape = (c[6] * share.squared() * direction.contract(db)).double();
        let d_pressure = c[7] * cofactor.contract(db);
        let forces = weighted(c, &db, c[6] * (one - share))
            + direction * d_shape
            + cofactor * d_pressure
            + b.cofactor_along(db) * pressure(c, b.columns[0].dot(cofactor.columns[0]));
        lower.back_to_edges(&forces)
    }
}
