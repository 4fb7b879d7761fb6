//! Hybrid tissue: the part where it is operated on moves by a force model and can be cut; the rest is linear, pre-computed, and follows.
//!
//! The nodes of the pre-computed part are its boundary B, which it shares with the moving part or by which it is held, and followers I.
//! These have no mass of their own: they rest where the boundary and the loads on them, f_I, let them.
//!
//! u_I = T u_B + K_II⁻¹ f_I,   T = −K_II⁻¹ K_IB,   f_B = S u_B − Tᵀ f_I,   S = K_BB + K_BI T
//!
//! S is found once, and stands for the whole part: what the source sends to and fro in every step, displacements of the interface one way
//! and reactions the other way, are the two sides of one product, taken at the same moment. It resists no more than the cells that
//! touch the boundary, so that these alone count for the stable step.
//!
//! The pre-computed part is for small displacements, has no inertia but on its boundary, and cannot be cut; tools act on what moves.
//!
//! Source: Cotin, Delingette, Ayache, A hybrid elastic model for real-time cutting, deformations, and force feedback (2000), section 5;
//! Guyan (1965) for the condensation.

mod condensation;
mod force;

use std::sync::Arc;

pub use condensation::Condensation;
pub(crate) use condensation::part_stiffness;
use force::HybridModel;

use super::frequency::{FrequencyBound, frequency_bound};
use super::precomputed::{Supports, linear_model};
use super::{
    ForceModel, GenericRecipe, ModelError, ModelInfo, ModelKind, ModelRecipe, Precision, TensorMass, TotalLagrangian,
    recipe,
};
use crate::executor::Executor;
use crate::material::{LawKind, Tissue};
use crate::mesh::{Mesh, Region, VolumeMesh};
use crate::solver::{Envelope, Filter};

/// The hybrid model of any law: tensor-mass where there are tables for the law and total-Lagrangian elsewhere, and beyond the region that
/// moves the law at rest, pre-computed.
#[derive(Clone)]
pub struct Hybrid {
    tissue: Tissue,
    dynamic: Option<Region>,
    condensation: Option<Arc<Condensation>>,
}

/// Without the condensation, which follows from the rest.
impl std::fmt::Debug for Hybrid {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { tissue, dynamic, .. } = self;
        formatter.debug_struct("Hybrid").field("tissue", tissue).field("dynamic", dynamic).finish_non_exhaustive()
    }
}

impl Hybrid {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "hybrid",
        purpose: "one region moves and can be cut, the rest is linear, pre-computed, and follows; tools act on the region",
        hexahedra: true,
        laws: LawKind::ALL,
        moves: true,
        no_implicit: None,
        no_cutting: None,
        tool_limits: Some("tools pass through its pre-computed part; let a larger region move"),
    };

    /// A model of `tissue`, all of which moves until [`Hybrid::dynamic`] says which part does.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue, dynamic: None, condensation: None }
    }

    /// The part that moves by itself and can be cut: every cell with a corner in `region`. The rest is pre-computed.
    pub fn dynamic(self, region: Region) -> Self {
        Self { dynamic: Some(region), condensation: None, ..self }
    }

    fn condense(&self, supports: &Supports<'_>) -> Result<Arc<Condensation>, ModelError> {
        self.tissue.check_count(supports.mesh.cell_count())?;
        let (solver, executor) = (&mut Envelope::default(), Executor::serial());
        let region = self.dynamic.as_ref();
        Condensation::compute(&self.tissue, supports, region, solver, &executor).map(Arc::new)
    }

    /// What was found for the body, or would be for one that nothing holds.
    fn condensed(&self, mesh: &VolumeMesh) -> Result<Arc<Condensation>, ModelError> {
        match &self.condensation {
            Some(known) => Ok(known.clone()),
            None => self.condense(&Supports { mesh, filters: &vec![Filter::Free; mesh.nodes().len()] }),
        }
    }
}

/// What computes the forces of the part that moves.
fn moving_model(tissue: &Tissue, mesh: &VolumeMesh) -> Box<dyn ModelRecipe> {
    let tets = matches!(mesh, VolumeMesh::Tet(_));
    match tissue.kind() {
        LawKind::LinearElastic | LawKind::TransverseLinear => linear_model(tissue, mesh),
        law if tets && TensorMass::INFO.laws.contains(&law) => Box::new(TensorMass::new(tissue.clone())),
        _ => Box::new(TotalLagrangian::new(tissue.clone())),
    }
}

/// A mesh of some cells; nodes keep their numbers.
fn part(mesh: &VolumeMesh, cells: &[u32]) -> VolumeMesh {
    match mesh {
        VolumeMesh::Tet(mesh) => {
            Mesh::new(mesh.nodes.clone(), cells.iter().map(|&cell| mesh.cells[cell as usize]).collect()).into()
        }
        VolumeMesh::Hex(mesh) => {
            Mesh::new(mesh.nodes.clone(), cells.iter().map(|&cell| mesh.cells[cell as usize]).collect()).into()
        }
    }
}

impl GenericRecipe for Hybrid {
    const KIND: ModelKind = ModelKind::Hybrid;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        let condensation = self.condensed(mesh)?;
        let tissue = self.tissue.of_cells(condensation.dynamic_cells());
        let part = part(mesh, condensation.dynamic_cells());
        let moving = T::build_model(moving_model(&tissue, &part).as_ref(), &part)?;
        Ok(Box::new(HybridModel::new(moving, condensation, mesh)))
    }

    /// The cells that vibrate: those that move, and those of the rest that move with the boundary.
    fn bound<T: Precision>(
        &self,
        mesh: &VolumeMesh,
        density: &[f64],
        keep_volume: f64,
    ) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
        let mut bound = frequency_bound(mesh, &self.tissue, density, keep_volume)?;
        bound.remove(&self.condensed(mesh)?.inner_cells(mesh));
        Ok(bound)
    }

    fn supported(&self, supports: &Supports<'_>) -> Result<Option<Box<dyn ModelRecipe>>, ModelError> {
        let condensation = Some(self.condense(supports)?);
        Ok(Some(Box::new(Self { condensation, ..self.clone() })))
    }

    fn condensation(&self) -> Option<&Arc<Condensation>> {
        self.condensation.as_ref()
    }
}

recipe!(Hybrid);
