//! The plain element of any law: F = D Dm⁻¹, [f1 f2 f3] = V P(F) Dm⁻ᵀ.

use std::marker::PhantomData;

use super::super::block_table::BlockTable;
use super::super::tet_loop::{RestTet, TetConstants, TetKernel};
use crate::material::{Law, LawFamily};
use crate::math::{Mat3, Real, Scalar, Vec3};

/// Constants: Dm⁻¹ by columns, V, then the law's parameters.
#[derive(Debug)]
pub(super) struct Direct<L>(PhantomData<L>);

impl<L> Clone for Direct<L> {
    fn clone(&self) -> Self {
        Self(PhantomData)
    }
}

impl<L: LawFamily> Direct<L> {
    pub(super) fn constants(rest: &RestTet, law: &[f64]) -> Vec<f64> {
        let inverse = rest.inverse.columns.into_iter().flat_map(Vec3::to_array);
        inverse.chain([rest.volume]).chain(law.iter().copied()).collect()
    }
}

#[inline(always)]
fn inverse<R: Real>(constants: &[R]) -> Mat3<R> {
    let column = |i: usize| Vec3::new(constants[3 * i], constants[3 * i + 1], constants[3 * i + 2]);
    Mat3::from_columns(column(0), column(1), column(2))
}

impl<L: LawFamily> TetConstants for Direct<L> {
    const CONSTANTS: usize = 10 + L::PARAMETERS.len();

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        *constants.get_mut(row, 9) = T::ZERO;
    }
}

impl<L: LawFamily> TetKernel for Direct<L> {
    #[inline(always)]
    fn energy<R: Real>(constants: &[R], d: &Mat3<R>) -> R {
        constants[9] * L::at(&constants[10..]).energy(&(*d * inverse(constants)))
    }

    #[inline(always)]
    fn forces<R: Real>(constants: &[R], d: &Mat3<R>) -> Mat3<R> {
        let inverse = inverse(constants);
        L::at(&constants[10..]).stress(&(*d * inverse)) * constants[9] * inverse.transpose()
    }

    #[inline(always)]
    fn product<R: Real>(constants: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        let inverse = inverse(constants);
        let law = L::at(&constants[10..]);
        law.tangent(&(*d * inverse), &(*dd * inverse)) * constants[9] * inverse.transpose()
    }
}
