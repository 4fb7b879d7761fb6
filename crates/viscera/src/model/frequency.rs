//! The highest frequency of a body, bounded cell by cell: what the stable time step of an explicit scheme follows from.
//!
//! With lumped masses, ω_max² ≤ max_e λ_max(M_e⁻¹K_e) (Irons, Treharne 1971): no mode of the body is faster than the
//! fastest mode of its worst cell, and cutting cells away never raises the bound. At rest λ_max(M_e⁻¹K_e) is found for
//! every cell, from above by at most 3 %; under deformation it grows with the law's bound of ∂P/∂F and with the stiffness
//! 2κ|δ| of the volume penalty.

use std::any::Any;

use crate::material::{Law, LawFamily, LawVisitor, Tissue};
use crate::math::{Mat3, Real, Scalar, Vec3};
use crate::mesh::{GaussRule, HexMesh, TetMesh, VolumeMesh};

use super::block_table::BlockTable;
use super::tet_loop::{RestTet, TetConstants, TetLoop, TetMeasure};
use super::{ModelError, Patches, Scratch};

/// Bounds ω_max² of a body.
pub trait FrequencyBound<T: Scalar>: Send + Sync {
    /// Upper bound of ω_max² at positions `x` [1/s²]; 0 for a body without cells.
    fn squared_frequency(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> f64;
    /// Takes cells out.
    fn remove(&mut self, cells: &[u32]);
    /// A copy, for snapshots.
    fn clone_box(&self) -> Box<dyn FrequencyBound<T>>;
    /// Sums the forces of `tets`, and gives the bound at `x` [m] on the way. None, and nothing is done, where those are not the tetrahedra whose
    /// bound it is, or it has to be found alone.
    fn sum_forces<'a>(
        &self,
        _tets: &'a dyn Any,
        _x: &[Vec3<T>],
        _scratch: &mut Scratch<T>,
    ) -> Option<(&'a Patches, f64)> {
        None
    }
}

/// The bound for a mesh of `tissue` with one density [kg/m³] for all cells or one for each, and the volume-keeping
/// stiffness κ [Pa].
///
/// # Errors
/// [`ModelError::Mesh`] for a cell without volume.
pub fn frequency_bound<T: Scalar>(
    mesh: &VolumeMesh,
    tissue: &Tissue,
    density: &[f64],
    keep_volume: f64,
) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
    tissue.kind().visit(Build { mesh, tissue, density, keep_volume, scalar: std::marker::PhantomData })
}

struct Build<'a, T> {
    mesh: &'a VolumeMesh,
    tissue: &'a Tissue,
    density: &'a [f64],
    keep_volume: f64,
    scalar: std::marker::PhantomData<T>,
}

impl<T: Scalar> LawVisitor for Build<'_, T> {
    type Output = Result<Box<dyn FrequencyBound<T>>, ModelError>;

    fn visit<L: LawFamily>(self) -> Self::Output {
        let density = |cell: usize| self.density[if self.density.len() == 1 { 0 } else { cell }];
        match self.mesh {
            VolumeMesh::Tet(mesh) => Ok(Box::new(tet_bound::<T, L>(mesh, self.tissue, density, self.keep_volume)?)),
            VolumeMesh::Hex(mesh) => Ok(Box::new(HexBound::<L>::new(mesh, self.tissue, density)?)),
        }
    }
}

/// λ_max(K_e)/m at rest [1/s²] for a cell with these points and corner mass, from above by at most 3 %.
pub(crate) fn squared_frequency_at_rest<L: Law<f64>>(law: &L, points: &[(&[Vec3<f64>], f64)], corner_mass: f64) -> f64 {
    let size = 3 * points[0].0.len();
    let mut stiffness = vec![0.0; size * size];
    for &(gradients, volume) in points {
        for (b, gradient) in gradients.iter().enumerate() {
            for axis in 0..3 {
                let mut unit = Vec3::ZERO;
                unit[axis] = 1.0;
                let stress = law.tangent(&Mat3::IDENTITY, &unit.outer(*gradient));
                for (a, gradient) in gradients.iter().enumerate() {
                    let force = stress * *gradient * (volume / corner_mass);
                    for row in 0..3 {
                        stiffness[(3 * a + row) * size + 3 * b + axis] += force[row];
                    }
                }
            }
        }
    }
    largest_eigenvalue_bound(stiffness, size)
}

/// The same for a tetrahedron.
///
/// K_e = V Gᵀ A G, where A = ∂P/∂F and G takes displacements of the corners to dF = Σ u_a ⊗ g_a, so that G Gᵀ = I ⊗ Q with
/// Q = Σ g_a g_aᵀ = R Rᵀ (Cholesky). Its eigenvalues that are not zero are those of (I ⊗ Rᵀ) V A (I ⊗ R): nine rows in place of twelve.
pub(crate) fn squared_frequency_of_tet<L: Law<f64>>(law: &L, rest: &RestTet, corner_mass: f64) -> f64 {
    let root =
        lower_root(rest.gradients().into_iter().fold(Mat3::ZERO, |sum, gradient| sum + gradient.outer(gradient)));
    let mut matrix = [0.0; 81];
    for column in 0..9 {
        let (axis, along) = (column % 3, root.columns[column / 3]);
        let mut unit = Vec3::ZERO;
        unit[axis] = 1.0;
        let stress = law.tangent(&Mat3::IDENTITY, &unit.outer(along)) * root * (rest.volume / corner_mass);
        for row in 0..9 {
            matrix[9 * row + column] = stress.columns[row / 3][row % 3];
        }
    }
    power_bound(&mut matrix, &mut [0.0; 81], 9)
}

/// R with R Rᵀ = A, below the diagonal, of a positive definite matrix.
fn lower_root(a: Mat3<f64>) -> Mat3<f64> {
    let [x, y, z] = a.columns;
    let first = x / x.x.sqrt();
    let rest = y - first * first.y;
    let second = rest / rest.y.sqrt();
    let last = (z.z - first.z * first.z - second.z * second.z).max(0.0).sqrt();
    Mat3::from_columns(first, Vec3::new(0.0, second.y, second.z), Vec3::new(0.0, 0.0, last))
}

/// Largest eigenvalue of a positive semi-definite matrix, bounded from above: λ_max ≤ (tr Aⁿ)^(1/n) ≤ size^(1/n) λ_max,
/// with n = 128 after seven squarings.
pub(crate) fn largest_eigenvalue_bound(mut matrix: Vec<f64>, size: usize) -> f64 {
    let mut squared = vec![0.0; matrix.len()];
    power_bound(&mut matrix, &mut squared, size)
}

/// The same in memory of the caller's: a size that the compiler knows takes a third of the time.
#[inline(always)]
fn power_bound<'a>(mut matrix: &'a mut [f64], mut squared: &'a mut [f64], size: usize) -> f64 {
    let (mut logarithm, mut power) = (0.0, 1.0);
    for _ in 0..7 {
        let scale = matrix.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
        if scale == 0.0 {
            return 0.0;
        }
        logarithm += scale.ln() / power;
        matrix.iter_mut().for_each(|value| *value /= scale);
        for row in 0..size {
            for column in row..size {
                let (a, b) = (&matrix[row * size..][..size], &matrix[column * size..][..size]);
                let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                squared[row * size + column] = sum;
                squared[column * size + row] = sum;
            }
        }
        std::mem::swap(&mut matrix, &mut squared);
        power *= 2.0;
    }
    let trace: f64 = (0..size).map(|i| matrix[i * size + i]).sum();
    (logarithm + trace.ln() / power).exp()
}

/// Constants: Dm⁻¹ by columns, ω² at rest over the law's bound at rest, κ, then the law's parameters.
#[derive(Debug)]
struct FrequencyMeasure<L>(std::marker::PhantomData<L>);

impl<L> Clone for FrequencyMeasure<L> {
    fn clone(&self) -> Self {
        Self(std::marker::PhantomData)
    }
}

impl<L: LawFamily> TetConstants for FrequencyMeasure<L> {
    const CONSTANTS: usize = 11 + L::PARAMETERS.len();

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        *constants.get_mut(row, 9) = T::ZERO;
    }
}

impl<L: LawFamily> TetMeasure for FrequencyMeasure<L> {
    #[inline(always)]
    fn measure<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let column = |i: usize| Vec3::new(c[3 * i], c[3 * i + 1], c[3 * i + 2]);
        let f = *d * Mat3::from_columns(column(0), column(1), column(2));
        c[9] * (L::at(&c[11..]).stiffness_bound(&f) + volume_stiffness(c[10], &f))
    }
}

/// Bound of what W = κ V0 |δ|³/3 adds to ∂P/∂F: 2κ|δ| ‖cof F‖² along the change of volume, κδ²‖F‖ across it.
#[inline(always)]
pub(crate) fn volume_stiffness<R: Real>(kappa: R, f: &Mat3<R>) -> R {
    if !R::any(kappa.zero_like().less_than(kappa)) {
        return kappa;
    }
    let cofactor = f.cofactor();
    let delta = (f.columns[0].dot(cofactor.columns[0]) + kappa.like(-1.0)).abs();
    kappa * delta * (cofactor.squared_norm().double() + delta * f.squared_norm().sqrt())
}

fn tet_bound<T: Scalar, L: LawFamily>(
    mesh: &TetMesh,
    tissue: &Tissue,
    density: impl Fn(usize) -> f64,
    keep_volume: f64,
) -> Result<TetLoop<T, FrequencyMeasure<L>>, ModelError> {
    TetLoop::new(mesh, |rest: &RestTet| {
        let values = tissue.values(rest.cell);
        let law = L::from_values(values);
        let corner_mass = density(rest.cell) * rest.volume / 4.0;
        let at_rest = squared_frequency_of_tet(&law, rest, corner_mass);
        let inverse = rest.inverse.columns.into_iter().flat_map(Vec3::to_array);
        let per_stiffness = at_rest / law.stiffness_bound(&Mat3::IDENTITY);
        inverse.chain([per_stiffness, keep_volume]).chain(values.iter().copied()).collect()
    })
}

impl<T: Scalar, L: LawFamily> FrequencyBound<T> for TetLoop<T, FrequencyMeasure<L>> {
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

/// The bound for hexahedra: the worst of their Gauss points counts for the whole cell.
#[derive(Clone, Debug)]
struct HexBound<L> {
    cells: Vec<HexCell<L>>,
}

#[derive(Clone, Debug)]
struct HexCell<L> {
    corners: [u32; 8],
    gradients: Vec<[Vec3<f64>; 8]>,
    law: L,
    per_stiffness: f64,
}

impl<L: LawFamily> HexBound<L> {
    fn new(mesh: &HexMesh, tissue: &Tissue, density: impl Fn(usize) -> f64) -> Result<Self, ModelError> {
        let cell = |cell: usize| {
            let points = mesh.gauss_points(cell, GaussRule::Two)?;
            let law = L::from_values(tissue.values(cell));
            let corner_mass = density(cell) * points.iter().map(|point| point.volume).sum::<f64>() / 8.0;
            let weighted: Vec<_> = points.iter().map(|point| (&point.gradients[..], point.volume)).collect();
            let at_rest = squared_frequency_at_rest(&law, &weighted, corner_mass);
            Ok(HexCell {
                corners: mesh.cells[cell],
                gradients: points.iter().map(|point| point.gradients).collect(),
                per_stiffness: at_rest / law.stiffness_bound(&Mat3::IDENTITY),
                law,
            })
        };
        Ok(Self { cells: (0..mesh.cells.len()).map(cell).collect::<Result<_, ModelError>>()? })
    }
}

impl<T: Scalar, L: LawFamily> FrequencyBound<T> for HexBound<L> {
    fn squared_frequency(&self, x: &[Vec3<T>], _scratch: &mut Scratch<T>) -> f64 {
        self.cells
            .iter()
            .filter(|cell| cell.per_stiffness > 0.0)
            .map(|cell| {
                let corners = cell.corners.map(|node| x[node as usize].cast::<f64>());
                let bound_at = |gradients: &[Vec3<f64>; 8]| {
                    let f = (0..8).fold(Mat3::ZERO, |f, a| f + corners[a].outer(gradients[a]));
                    cell.law.stiffness_bound(&f)
                };
                cell.per_stiffness * cell.gradients.iter().map(bound_at).fold(0.0, f64::max)
            })
            .fold(0.0, f64::max)
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            self.cells[cell as usize].per_stiffness = 0.0;
        }
    }

    fn clone_box(&self) -> Box<dyn FrequencyBound<T>> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::material::{Lame, TransverseStVenantKirchhoff};

    #[test]
    fn largest_eigenvalue_is_bounded_from_above_within_three_per_cent() {
        // Eigenvalues 1, 2 and 5 in a turned basis.
        let (c, s) = (0.6, 0.8);
        let turn = Mat3::from_columns(Vec3::new(c, s, 0.0), Vec3::new(-s, c, 0.0), Vec3::new(0.0, 0.0, 1.0));
        let diagonal = Mat3::from_columns(Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 5.0, 0.0), Vec3::new(0.0, 0.0, 2.0));
        let matrix = turn * diagonal * turn.transpose();
        let bound = largest_eigenvalue_bound(matrix.columns.into_iter().flat_map(Vec3::to_array).collect(), 3);
        assert!((5.0..5.0 * 1.03).contains(&bound), "{bound}");
        let repeated = largest_eigenvalue_bound(vec![3.0, 0.0, 0.0, 3.0], 2);
        assert!((3.0..3.0 * 1.03).contains(&repeated), "{repeated}");
    }

    /// Nine rows have the eigenvalues of twelve: of cells of any shape, and of tissue that is stiffer along fibres.
    #[test]
    fn tetrahedra_vibrate_as_their_whole_stiffness_does() {
        let (soft, stiff) =
            (Lame::from_young_poisson(5e3, 0.45).unwrap(), Lame::from_young_poisson(40e3, 0.3).unwrap());
        let law = TransverseStVenantKirchhoff::new(soft, [0.6, 0.0, 0.8], stiff).unwrap();
        for height in [1.0, 0.1, 0.01] {
            let corners = [[0.1, 0.0, 0.2], [1.1, 0.3, 0.1], [0.2, 0.9, 0.0], [0.4, 0.2, height]];
            let mesh = TetMesh::new(corners.map(Vec3::from).to_vec(), vec![[0, 1, 2, 3]]);
            let rest = RestTet::measure(&mesh, 0);
            let whole = squared_frequency_at_rest(&law, &[(&rest.gradients(), rest.volume)], 0.02);
            assert_relative_eq!(squared_frequency_of_tet(&law, &rest, 0.02), whole, max_relative = 1e-10);
        }
    }
}
