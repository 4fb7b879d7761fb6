//! Stable neo-Hookean tetrahedra in metric form: F is never formed.
//!
//! With D the current edge matrix, A0 = Dm⁻¹Dm⁻ᵀ, I_C = A0:DᵀD and J = det D / det Dm:
//!
//! [f1 f2 f3] = V μ' (1 − 1/(I_C + 1)) D A0 + V [λ' (J − 1) − ¾μ'] cof D / det Dm
//!
//! because P Dm⁻ᵀ needs F Dm⁻ᵀ = D A0 and cof F Dm⁻ᵀ = cof D / det Dm only. About 125 flops.

use super::super::block_table::BlockTable;
use super::super::kernel_bound::BoundedKernel;
use super::super::tet_loop::{RestTet, TetConstants, TetKernel};
use super::metric::{at_corners, columns_at_corners};
use crate::material::{LawFamily, StableNeoHookean};
use crate::math::{Mat3, Real, Scalar, Sym3};

/// Constants: A0 (xx, yy, zz, xy, xz, yz), 1/det Dm, Vλ', Vμ'.
#[derive(Clone, Debug)]
pub(super) struct StableNeoHookeanMetric;

impl StableNeoHookeanMetric {
    pub(super) fn constants(rest: &RestTet, law: &[f64]) -> Vec<f64> {
        let a0 = rest.inverse.transpose().gram();
        let (lambda, mu) = StableNeoHookean::from_values(law).rescaled();
        let inverse_determinant = 1.0 / (6.0 * rest.volume);
        let moduli = [inverse_determinant, rest.volume * lambda, rest.volume * mu];
        [a0.xx, a0.yy, a0.zz, a0.xy, a0.xz, a0.yz].into_iter().chain(moduli).collect()
    }
}

#[inline(always)]
fn metric<R: Real>(c: &[R]) -> Sym3<R> {
    Sym3 { xx: c[0], yy: c[1], zz: c[2], xy: c[3], xz: c[4], yz: c[5] }
}

/// I_C = A0:DᵀD, which rounding makes negative in slivers: the energy of some was no number in single precision.
#[inline(always)]
fn not_negative<R: Real>(invariant: R) -> R {
    invariant.max(invariant.like(0.0))
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

// ‖cof F‖² = cof A0 : (cof D)ᵀ cof D, as cof F = cof D cof Dm⁻¹.
impl BoundedKernel for StableNeoHookeanMetric {
    #[inline(always)]
    fn stiffness_bound<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let (a0, cofactor) = (metric(c), d.cofactor());
        let square = not_negative((*d * a0).contract(*d));
        let area = not_negative(a0.cofactor().contract(cofactor.gram()));
        let determinant = d.columns[0].dot(cofactor.columns[0]) * c[6];
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
        let (a0, one) = (metric(c), c[0].like(1.0));
        let stretched = *d * a0;
        let share = one / (not_negative(stretched.contract(*d)) + one);
        let (own, areas) = (columns_at_corners(&stretched), columns_at_corners(&d.cofactor()));
        let (metrics, volume) = (at_corners(a0), over_squared_determinant(c));
        let mut blocks = [a0; 4];
        for corner in 0..4 {
            blocks[corner] = Sym3::square(own[corner]) * (c[8] * share.squared()).double()
                + Sym3::square(areas[corner]) * volume
                + Sym3::diagonal(c[8] * (one - share) * metrics[corner]);
        }
        blocks
    }

    #[inline(always)]
    fn energy<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let one = c[0].like(1.0);
        let excess = not_negative(metric(c).contract(d.gram())) - one.like(3.0);
        let change = d.determinant().mul_add(c[6], one.like(-1.0));
        let logarithm = excess.mul_add(one.like(0.25), one).ln();
        let shape = (excess - logarithm).half() - change * one.like(0.75);
        c[8] * shape + (c[7] * change.squared()).half()
    }

    #[inline(always)]
    fn forces<R: Real>(c: &[R], d: &Mat3<R>) -> Mat3<R> {
        let (a0, one) = (metric(c), c[0].like(1.0));
        let (cofactor, stretched) = (d.cofactor(), *d * a0);
        let shape = c[8] * (one - one / (not_negative(stretched.contract(*d)) + one));
        let pressure = pressure(c, d.columns[0].dot(cofactor.columns[0]));
        cofactor.mul_add(pressure, stretched * shape)
    }

    // dI_C = 2 A0:DᵀdD
    #[inline(always)]
    fn product<R: Real>(c: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        let (a0, one) = (metric(c), c[0].like(1.0));
        let cofactor = d.cofactor();
        let share = one / (not_negative(a0.contract(d.gram())) + one);
        let stretched = *d * a0;
        let d_shape = (c[8] * share.squared() * stretched.contract(*dd)).double();
        let d_pressure = over_squared_determinant(c) * cofactor.contract(*dd);
        *dd * (a0 * (c[8] * (one - share)))
            + stretched * d_shape
            + cofactor * d_pressure
            + d.cofactor_along(*dd) * pressure(c, d.columns[0].dot(cofactor.columns[0]))
    }
}
