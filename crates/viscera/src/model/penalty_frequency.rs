//! What the volume penalty adds to the bound of the highest frequency, for models whose own bound knows no strain.

use super::ModelError;
use super::Scratch;
use super::block_table::BlockTable;
use super::frequency::{FrequencyBound, squared_frequency_of_tet, volume_stiffness};
use super::tet_loop::{RestTet, TetConstants, TetLoop, TetMeasure};
use crate::material::{Lame, Law, LinearElastic};
use crate::math::{Mat3, Real, Scalar, Vec3};
use crate::mesh::VolumeMesh;

/// `own` and the volume penalty of stiffness κ [Pa] on tetrahedra, for one density [kg/m³] or one for each cell:
/// λ_max(A + B) ≤ λ_max(A) + λ_max(B).
pub(super) fn with_penalty<T: Scalar>(
    own: Box<dyn FrequencyBound<T>>,
    mesh: &VolumeMesh,
    density: &[f64],
    keep_volume: f64,
) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
    let VolumeMesh::Tet(mesh) = mesh else { return Ok(own) };
    if keep_volume == 0.0 {
        return Ok(own);
    }
    // λ_max(M_e⁻¹K_e) of a cell over its bound of ∂P/∂F is a matter of shape and density: that of any law will do.
    let law = LinearElastic::new(Lame::new(1.0, 1.0).expect("both moduli are positive"));
    let numbers = |rest: &RestTet| {
        let corner_mass = density[if density.len() == 1 { 0 } else { rest.cell }] * rest.volume / 4.0;
        let at_rest = squared_frequency_of_tet(&law, rest, corner_mass);
        let inverse = rest.inverse.columns.into_iter().flat_map(Vec3::to_array);
        inverse.chain([at_rest / law.stiffness_bound(&Mat3::IDENTITY), keep_volume]).collect()
    };
    Ok(Box::new(Both { own, penalty: TetLoop::new(mesh, numbers)? }))
}

/// Constants: Dm⁻¹ by columns, ω² over the bound of ∂P/∂F, κ.
#[derive(Clone, Debug)]
struct PenaltyMeasure;

impl TetConstants for PenaltyMeasure {
    const CONSTANTS: usize = 11;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        *constants.get_mut(row, 9) = T::ZERO;
    }
}

impl TetMeasure for PenaltyMeasure {
    #[inline(always)]
    fn measure<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let column = |i: usize| Vec3::new(c[3 * i], c[3 * i + 1], c[3 * i + 2]);
        let f = *d * Mat3::from_columns(column(0), column(1), column(2));
        c[9] * volume_stiffness(c[10], &f)
    }
}

struct Both<T: Scalar> {
    own: Box<dyn FrequencyBound<T>>,
    penalty: TetLoop<T, PenaltyMeasure>,
}

impl<T: Scalar> FrequencyBound<T> for Both<T> {
    fn squared_frequency(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> f64 {
        self.own.squared_frequency(x, scratch) + self.penalty.largest(x, scratch).to_f64()
    }

    fn remove(&mut self, cells: &[u32]) {
        self.own.remove(cells);
        self.penalty.remove(cells);
    }

    fn clone_box(&self) -> Box<dyn FrequencyBound<T>> {
        Box::new(Self { own: self.own.clone_box(), penalty: self.penalty.clone() })
    }
}
