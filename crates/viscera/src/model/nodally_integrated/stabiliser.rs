//! The share of the stiffness that stays in the cells, so that they cannot change shape against each other unseen by the
//! nodes: the simplest law without stress at rest that is a polynomial of F, with ν = 0 at small strain.
//!
//! ψ_c(F) = μ [½ (F:F − 3) − (J − 1) + ½ (J − 1)²],   P = μ [F + (J − 2) cof F]
//!
//! In metric form, with D the current edge matrix and A0 = Dm⁻¹Dm⁻ᵀ: [f1 f2 f3] = V μ [D A0 + (J − 2) cof D / det Dm].

use super::super::block_table::BlockTable;
use super::super::tet_loop::{RestTet, TetConstants, TetKernel};
use crate::math::{Mat3, Real, Scalar, Sym3};

/// P/μ at F.
#[inline(always)]
pub(super) fn stress<R: Real>(f: &Mat3<R>) -> Mat3<R> {
    let cofactor = f.cofactor();
    let determinant = f.columns[0].dot(cofactor.columns[0]);
    *f + cofactor * (determinant - determinant.like(2.0))
}

/// Derivative of [`stress`] along `df`.
#[inline(always)]
pub(super) fn tangent<R: Real>(f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
    let cofactor = f.cofactor();
    let determinant = f.columns[0].dot(cofactor.columns[0]);
    *df + cofactor * cofactor.contract(*df) + f.cofactor_along(*df) * (determinant - determinant.like(2.0))
}

/// ψ_c/μ at F. With H = F − I the terms of first order are gone: F:F − 3 = 2 tr H + H:H, J − 1 = tr H + tr cof H + det H.
#[inline(always)]
pub(super) fn energy<R: Real>(f: &Mat3<R>) -> R {
    let h = *f - f.identity_like();
    let cofactor = h.cofactor();
    let beyond_trace = cofactor.trace() + h.columns[0].dot(cofactor.columns[0]);
    (h.squared_norm() + (h.trace() + beyond_trace).squared()).half() - beyond_trace
}

/// Constants: A0 (xx, yy, zz, xy, xz, yz), 1/det Dm, V μ.
#[derive(Clone, Debug)]
pub(super) struct Stabiliser;

impl Stabiliser {
    /// For a share of the shear modulus `mu` [Pa].
    pub(super) fn constants(rest: &RestTet, mu: f64) -> Vec<f64> {
        let a0 = rest.inverse.transpose().gram();
        vec![a0.xx, a0.yy, a0.zz, a0.xy, a0.xz, a0.yz, 1.0 / (6.0 * rest.volume), rest.volume * mu]
    }
}

#[inline(always)]
fn metric<R: Real>(c: &[R]) -> Sym3<R> {
    Sym3 { xx: c[0], yy: c[1], zz: c[2], xy: c[3], xz: c[4], yz: c[5] }
}

impl TetConstants for Stabiliser {
    const CONSTANTS: usize = 8;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        *constants.get_mut(row, 7) = T::ZERO;
    }
}

impl TetKernel for Stabiliser {
    #[inline(always)]
    fn energy<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let excess = metric(c).contract(d.gram()) - c[0].like(3.0);
        let change = d.determinant().mul_add(c[6], c[0].like(-1.0));
        c[7] * ((excess + change.squared()).half() - change)
    }

    #[inline(always)]
    fn forces<R: Real>(c: &[R], d: &Mat3<R>) -> Mat3<R> {
        let cofactor = d.cofactor();
        let pressure = d.columns[0].dot(cofactor.columns[0]).mul_add(c[6], c[0].like(-2.0));
        (*d * metric(c) + cofactor * (pressure * c[6])) * c[7]
    }

    #[inline(always)]
    fn product<R: Real>(c: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        let cofactor = d.cofactor();
        let pressure = d.columns[0].dot(cofactor.columns[0]).mul_add(c[6], c[0].like(-2.0));
        let change = cofactor.contract(*dd) * c[6].squared();
        (*dd * metric(c) + cofactor * change + d.cofactor_along(*dd) * (pressure * c[6])) * c[7]
    }
}
