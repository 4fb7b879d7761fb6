//! Total-Lagrangian elements: forces straight from the law at the deformation gradient, over the rest shape.
//!
//! f_p = Σ_e V P(F) α_p, one point for a tetrahedron, 2×2×2 Gauss points for a hexahedron. St Venant–Kirchhoff and
//! stable neo-Hookean tetrahedra use the metric form, in which F never appears: about 130 and 125 flops an element.

mod direct;
pub(super) mod hex;
mod hex_mean;
mod metric;
mod orthogonal;
mod stable_neo_hookean;

use self::direct::Direct;
use self::hex::HexLoop;
use self::metric::{StVenantKirchhoffMetric, TransverseMetric};
use self::stable_neo_hookean::StableNeoHookeanMetric;
use super::frequency::{FrequencyBound, frequency_bound};
use super::kernel_bound::kernel_bound;
use super::tet_loop::{TetKernel, TetLoop};
use super::{
    BlockSink, ForceModel, GenericRecipe, MeanForces, ModelError, ModelInfo, ModelKind, Patches, Precision, Scratch,
    recipe,
};
use crate::material::{
    LawFamily, LawKind, LawVisitor, StVenantKirchhoff, StableNeoHookean, Tissue, TransverseStVenantKirchhoff,
};
use crate::math::{Scalar, Vec3};
use crate::mesh::{GaussRule, TetMesh, VolumeMesh};
use crate::solver::Turn;

/// The direct model of any law, on tetrahedra or hexahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct TotalLagrangian {
    tissue: Tissue,
    rule: GaussRule,
    plain: bool,
}

impl TotalLagrangian {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "total-lagrangian",
        purpose: "the fastest full model, for every law, on tetrahedra and hexahedra",
        hexahedra: true,
        laws: LawKind::ALL,
        moves: true,
        no_implicit: None,
        no_cutting: None,
        tool_limits: None,
    };

    /// A model of `tissue`.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue, rule: GaussRule::Two, plain: false }
    }

    /// Integrates hexahedra with another rule than 2×2×2 points. Tetrahedra need one point in any case.
    pub fn gauss(self, rule: GaussRule) -> Self {
        Self { rule, ..self }
    }

    /// Computes F and P(F) in so many words where a faster form of the same law exists: the reference for that form.
    pub fn plain(self) -> Self {
        Self { plain: true, ..self }
    }
}

impl GenericRecipe for TotalLagrangian {
    const KIND: ModelKind = ModelKind::TotalLagrangian;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        self.tissue.check_count(mesh.cell_count())?;
        let law = self.tissue.kind();
        match mesh {
            VolumeMesh::Tet(mesh) if !self.plain && law == LawKind::StVenantKirchhoff => {
                tets(mesh, |rest| StVenantKirchhoffMetric::constants(rest, &self.tissue.at_rest(rest.cell)))
                    .map(|model: TetModel<T, StVenantKirchhoffMetric>| model.boxed())
            }
            VolumeMesh::Tet(mesh) if !self.plain && law == LawKind::TransverseStVenantKirchhoff => {
                tets(mesh, |rest| TransverseMetric::constants(rest, &self.tissue.at_rest(rest.cell)))
                    .map(|model: TetModel<T, TransverseMetric>| model.boxed())
            }
            VolumeMesh::Tet(mesh) if !self.plain && law == LawKind::StableNeoHookean => {
                tets(mesh, |rest| StableNeoHookeanMetric::constants(rest, self.tissue.values(rest.cell)))
                    .map(|model: TetModel<T, StableNeoHookeanMetric>| model.boxed())
            }
            _ => law.visit(Build { recipe: self, mesh, scalar: std::marker::PhantomData }),
        }
    }

    /// That of the law, by the constants of the kernel where it has its own.
    fn bound<T: Precision>(
        &self,
        mesh: &VolumeMesh,
        density: &[f64],
        keep_volume: f64,
    ) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
        let (tissue, law) = (&self.tissue, self.tissue.kind());
        let of_law = || frequency_bound(mesh, tissue, density, keep_volume);
        let VolumeMesh::Tet(tets) = mesh else { return of_law() };
        let density = |cell: usize| density[if density.len() == 1 { 0 } else { cell }];
        match law {
            _ if self.plain || keep_volume > 0.0 => of_law(),
            LawKind::StVenantKirchhoff => kernel_bound::<T, StVenantKirchhoffMetric, _>(tets, density, |rest| {
                let constants = StVenantKirchhoffMetric::constants(rest, &tissue.at_rest(rest.cell));
                (StVenantKirchhoff::from_values(tissue.values(rest.cell)), constants)
            }),
            LawKind::TransverseStVenantKirchhoff => kernel_bound::<T, TransverseMetric, _>(tets, density, |rest| {
                let constants = TransverseMetric::constants(rest, &tissue.at_rest(rest.cell));
                (TransverseStVenantKirchhoff::from_values(tissue.values(rest.cell)), constants)
            }),
            LawKind::StableNeoHookean => kernel_bound::<T, StableNeoHookeanMetric, _>(tets, density, |rest| {
                let values = tissue.values(rest.cell);
                (StableNeoHookean::from_values(values), StableNeoHookeanMetric::constants(rest, values))
            }),
            _ => of_law(),
        }
    }
}

recipe!(TotalLagrangian);

/// Builds the plain element of whichever law it is.
struct Build<'a, T> {
    recipe: &'a TotalLagrangian,
    mesh: &'a VolumeMesh,
    scalar: std::marker::PhantomData<T>,
}

impl<T: Scalar> LawVisitor for Build<'_, T> {
    type Output = Result<Box<dyn ForceModel<T>>, ModelError>;

    fn visit<L: LawFamily>(self) -> Self::Output {
        let tissue = &self.recipe.tissue;
        match self.mesh {
            VolumeMesh::Tet(mesh) => tets(mesh, |rest| Direct::<L>::constants(rest, tissue.values(rest.cell)))
                .map(|model: TetModel<T, Direct<L>>| model.boxed()),
            VolumeMesh::Hex(mesh) => Ok(Box::new(HexLoop::<T, L>::new(mesh, tissue, self.recipe.rule)?)),
        }
    }
}

fn tets<T: Scalar, K: TetKernel>(
    mesh: &TetMesh,
    constants: impl Fn(&super::tet_loop::RestTet) -> Vec<f64>,
) -> Result<TetModel<T, K>, ModelError> {
    Ok(TetModel { tets: TetLoop::new(mesh, constants)? })
}

/// Total-Lagrangian tetrahedra with the kernel `K`.
#[derive(Clone, Debug)]
struct TetModel<T: Scalar, K> {
    tets: TetLoop<T, K>,
}

impl<T: Scalar, K: TetKernel> TetModel<T, K> {
    fn boxed(self) -> Box<dyn ForceModel<T>> {
        Box::new(self)
    }
}

impl<T: Scalar, K: TetKernel> MeanForces<T> for TetModel<T, K> {
    fn add_mean_forces(&self, from: &[Vec3<T>], to: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.tets.add_mean_forces(from, to, scratch, out);
    }
}

impl<T: Scalar, K: TetKernel> ForceModel<T> for TetModel<T, K> {
    fn name(&self) -> &'static str {
        TotalLagrangian::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.tets.add_forces(x, scratch, out);
    }

    fn sum_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Option<&Patches> {
        Some(self.tets.sum_forces(x, scratch))
    }

    fn sum_forces_and_bound(
        &self,
        x: &[Vec3<T>],
        bound: &dyn FrequencyBound<T>,
        scratch: &mut Scratch<T>,
    ) -> Option<(&Patches, f64)> {
        bound.sum_forces(&self.tets, x, scratch)
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.tets.add_product(x, dx, scratch, out);
    }

    fn sum_product(
        &self,
        x: &[Vec3<T>],
        turn: &Turn<'_, T>,
        masses: &[T],
        scratch: &mut Scratch<T>,
    ) -> Option<(&Patches, f64)> {
        Some(self.tets.sum_product(x, turn, masses, scratch))
    }

    fn add_blocks(&self, x: &[Vec3<T>], _scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        self.tets.add_blocks(x, sink);
    }

    fn sum_diagonal(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Option<&Patches> {
        Some(self.tets.sum_diagonal(x, scratch))
    }

    fn mean_forces(&self) -> Option<&dyn MeanForces<T>> {
        K::KEEPS_ENERGY.then_some(self)
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        self.tets.energy(x)
    }

    fn remove(&mut self, cells: &[u32]) {
        self.tets.remove(cells);
    }

    fn sum_rows(&self) -> usize {
        self.tets.sum_rows()
    }

    fn bytes(&self) -> usize {
        self.tets.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}
