//! The highest frequency of corotational bodies: the linear law's at rest, times what the stretch of a cell does to it.
//!
//! In P = s R σ(ε) A the law's stiffness C meets, with f = ‖F‖₂, c = ‖cof F‖₂, J = det F and e = ‖FᵀF − I‖ ≥ ‖G − I‖:
//!
//! * B at rest: C, and from the turning of R up to λ tr(S − I)·2/(σi + σj), which is below C ‖F‖²/3 wherever ‖F‖² > 3
//!   and the rotation is well defined; times J, plus C e c, for the current volume
//! * B updated: ε0 ≤ e c, dε0 ≤ (c + 2 e f) dF and d cof F ≤ 2 f dF, so c (c + 2 e f) + 2 e c f times C; for the current
//!   volume this over J, plus e c³/J²

use super::formulation::{Formulation, IntegrationVolume, SMALLEST_VOLUME_RATIO, StrainDisplacement};
use crate::material::{Fibre, Law, LinearElastic, RestStiffness, Tissue, TransverseLinear};
use crate::math::{Mat3, Real, Scalar, Sym3, Vec3};
use crate::mesh::{GaussRule, VolumeMesh};
use crate::model::block_table::BlockTable;
use crate::model::frequency::{FrequencyBound, squared_frequency_at_rest, squared_frequency_of_tet, volume_stiffness};
use crate::model::tet_loop::{RestTet, TetConstants, TetLoop, TetMeasure};
use crate::model::total_lagrangian::hex::deformation;
use crate::model::{ModelError, Scratch};

/// The bound of a body of corotational cells.
pub(super) fn bound<T: Scalar>(
    mesh: &VolumeMesh,
    tissue: &Tissue,
    density: &[f64],
    keep_volume: f64,
    formulation: Formulation,
) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
    let density = |cell: usize| density[if density.len() == 1 { 0 } else { cell }];
    let updated = formulation.strain == StrainDisplacement::Updated;
    let current = formulation.volume == IntegrationVolume::Current;
    match mesh {
        VolumeMesh::Tet(mesh) => {
            let numbers = |rest: &RestTet| {
                let law = linear(&tissue.at_rest(rest.cell));
                let corner_mass = density(rest.cell) * rest.volume / 4.0;
                let at_rest = squared_frequency_of_tet(&law, rest, corner_mass);
                let penalty = keep_volume / law.stiffness_bound(&Mat3::IDENTITY);
                let inverse = rest.inverse.columns.into_iter().flat_map(Vec3::to_array);
                inverse.chain([at_rest, penalty, f64::from(updated), f64::from(current)]).collect()
            };
            Ok(Box::new(TetLoop::<T, StretchMeasure>::new(mesh, numbers)?))
        }
        VolumeMesh::Hex(mesh) => {
            let cell = |cell: usize| {
                let points = mesh.gauss_points(cell, GaussRule::Two)?;
                let corner_mass = density(cell) * points.iter().map(|point| point.volume).sum::<f64>() / 8.0;
                let weighted: Vec<_> = points.iter().map(|point| (&point.gradients[..], point.volume)).collect();
                Ok(HexCell {
                    corners: mesh.cells[cell],
                    at_rest: squared_frequency_at_rest(&linear(&tissue.at_rest(cell)), &weighted, corner_mass),
                    gradients: points.iter().map(|point| point.gradients).collect(),
                })
            };
            let cells = (0..mesh.cells.len()).map(cell).collect::<Result<_, ModelError>>()?;
            Ok(Box::new(HexBound { cells, updated: f64::from(updated), current: f64::from(current) }))
        }
    }
}

/// The law of a cell, its fibres without stiffness where it has none.
fn linear(stiffness: &RestStiffness) -> TransverseLinear {
    TransverseLinear {
        matrix: LinearElastic::new(stiffness.lame),
        fibre: Fibre { direction: stiffness.direction, stiffness: stiffness.fibre_stiffness },
    }
}

/// By how much the stiffness of a cell at F exceeds that at rest.
#[inline(always)]
fn growth<R: Real>(f: &Mat3<R>, updated: R, current: R) -> R {
    let (one, half) = (updated.like(1.0), updated.like(0.5));
    let cofactor = f.cofactor();
    let metric = f.gram();
    let volume_ratio = f.columns[0].dot(cofactor.columns[0]).abs();
    let stretch = metric.largest_eigenvalue_bound().sqrt();
    let area = cofactor.gram().largest_eigenvalue_bound().sqrt();
    let strain = (metric - Sym3::diagonal(one)).squared_norm().sqrt();

    let twist = (f.squared_norm() * one.like(1.0 / 3.0)).max(one);
    let twist = R::select(half.less_than(current), volume_ratio * twist + strain * area, twist);
    let along = strain * stretch;
    let moved = area * (area + along.double().double());
    let divisor = volume_ratio.max(one.like(SMALLEST_VOLUME_RATIO));
    let divided = moved / divisor + strain * area * area * area / divisor.squared();
    let moved = R::select(half.less_than(current), divided, moved);
    R::select(half.less_than(updated), moved, twist)
}

/// Constants: Dm⁻¹ by columns, ω² at rest, κ over the law's stiffness, whether B is updated, whether V is current.
#[derive(Clone, Debug)]
struct StretchMeasure;

impl TetConstants for StretchMeasure {
    const CONSTANTS: usize = 13;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        *constants.get_mut(row, 9) = T::ZERO;
    }
}

impl TetMeasure for StretchMeasure {
    #[inline(always)]
    fn measure<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let column = |i: usize| Vec3::new(c[3 * i], c[3 * i + 1], c[3 * i + 2]);
        let f = *d * Mat3::from_columns(column(0), column(1), column(2));
        c[9] * (growth(&f, c[11], c[12]) + volume_stiffness(c[10], &f))
    }
}

impl<T: Scalar> FrequencyBound<T> for TetLoop<T, StretchMeasure> {
    fn squared_frequency(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> f64 {
        self.largest(x, scratch).to_f64()
    }

    fn remove(&mut self, cells: &[u32]) {
        TetLoop::remove(self, cells);
    }

    fn clone_box(&self) -> Box<dyn FrequencyBound<T>> {
        Box::new(self.clone())
    }
}

/// Hexahedra: the worst Gauss point counts for the whole cell.
#[derive(Clone, Debug)]
struct HexBound {
    cells: Vec<HexCell>,
    updated: f64,
    current: f64,
}

#[derive(Clone, Debug)]
struct HexCell {
    corners: [u32; 8],
    /// ω² at rest [1/s²]; 0 for a cell that is removed.
    at_rest: f64,
    gradients: Vec<[Vec3<f64>; 8]>,
}

impl<T: Scalar> FrequencyBound<T> for HexBound {
    fn squared_frequency(&self, x: &[Vec3<T>], _scratch: &mut Scratch<T>) -> f64 {
        let measure = |cell: &HexCell| {
            let corners = cell.corners.map(|node| x[node as usize].cast::<f64>());
            let at = |gradients| growth(&deformation(&corners, gradients), self.updated, self.current);
            cell.at_rest * cell.gradients.iter().map(at).fold(0.0, f64::max)
        };
        self.cells.iter().filter(|cell| cell.at_rest > 0.0).map(measure).fold(0.0, f64::max)
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            self.cells[cell as usize].at_rest = 0.0;
        }
    }

    fn clone_box(&self) -> Box<dyn FrequencyBound<T>> {
        Box::new(self.clone())
    }
}
