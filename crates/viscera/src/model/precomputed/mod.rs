//! Pre-computed quasi-static tissue: how a linear body answers a unit force on each node of its surface, found off-line, so that
//! on-line only the few nodes count that something takes hold of.
//!
//! With the fixed nodes held, C = K⁻¹ has a column of 3×3 blocks for each free node of the surface (a handle). Nodes k of a set that
//! are imposed at u*_k feel the forces f of a small system, and everything else follows:
//!
//! Σ_l C_kl f_l = u*_k,   u_i = Σ_k C_ik f_k,   F_k = f_k
//!
//! In the symbols of the source, whose unit is a displacement: T^u_ik = C_ik C_kk⁻¹, T^f_kk = C_kk⁻¹, w_k = C_kk f_k. C is symmetric and T
//! is not, so that the small system has a Cholesky factorisation, and a push along a normal is one number of it.
//!
//! Linear, for small displacements, without inertia or damping. It cannot be cut: a cut changes every response.
//!
//! Source: Cotin, Delingette, Ayache, Real-time elastic deformations of soft tissues for surgery simulation (1999), section 4.

mod bytes;
mod contact_system;
mod error;
mod responses;
mod supports;

use std::sync::Arc;

pub use contact_system::{ContactError, ContactSystem};
pub use error::ResponsesError;
pub use responses::Responses;
pub(crate) use responses::stiffness;
pub use supports::Supports;

use super::linear_tensor_mass::LAWS;
use super::{
    ForceModel, GenericRecipe, LinearTensorMass, ModelError, ModelInfo, ModelKind, ModelRecipe, Precision,
    TotalLagrangian, recipe,
};
use crate::executor::Executor;
use crate::material::Tissue;
use crate::mesh::VolumeMesh;
use crate::solver::Envelope;

/// The pre-computed quasi-static model of linear tissue: at the end of every step the body is where it rests under its loads and under
/// what takes hold of it. Something has to hold it, and it cannot be cut.
#[derive(Clone)]
pub struct Precomputed {
    tissue: Tissue,
    responses: Option<Arc<Responses>>,
}

/// Without the responses, which follow from the rest.
impl std::fmt::Debug for Precomputed {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Precomputed").field("tissue", &self.tissue).finish_non_exhaustive()
    }
}

impl Precomputed {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "precomputed",
        purpose: "small displacements at thousands of steps a second, from responses found beforehand; rests at every step, and \
                  cannot be cut",
        hexahedra: true,
        laws: LAWS,
        moves: false,
        no_implicit: None,
        no_cutting: Some(
            "a cut changes every response; take the model `hybrid`, whose one part can be cut, or `linear-tensor-mass`",
        ),
        tool_limits: Some("tools slide on it without friction, which an equilibrium does not know"),
    };

    /// A model of `tissue`, whose responses are computed when a body is made of it.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue, responses: None }
    }

    /// Takes responses that were computed before, by [`Body::precompute`](crate::body::Body::precompute). Those of another body are
    /// refused.
    pub fn responses(self, responses: Arc<Responses>) -> Self {
        Self { responses: Some(responses), ..self }
    }

    fn check(&self) -> Result<(), ModelError> {
        let advice = "its responses add up, as those of small strains do; take the law `linear`, or the model `hybrid`";
        Self::KIND.check_law(self.tissue.kind(), advice)
    }
}

/// What computes the forces of linear tissue on cells of this kind.
pub(super) fn linear_model(tissue: &Tissue, mesh: &VolumeMesh) -> Box<dyn ModelRecipe> {
    match mesh {
        VolumeMesh::Tet(_) => Box::new(LinearTensorMass::new(tissue.clone())),
        VolumeMesh::Hex(_) => Box::new(TotalLagrangian::new(tissue.clone())),
    }
}

impl GenericRecipe for Precomputed {
    const KIND: ModelKind = ModelKind::Precomputed;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        self.check()?;
        T::build_model(linear_model(&self.tissue, mesh).as_ref(), mesh)
    }

    fn responses(&self, supports: &Supports<'_>) -> Result<Option<Arc<Responses>>, ModelError> {
        self.check()?;
        if let Some(responses) = &self.responses {
            responses.check(&self.tissue, supports)?;
            return Ok(Some(responses.clone()));
        }
        let (solver, executor) = (&mut Envelope::default(), Executor::serial());
        Ok(Some(Arc::new(Responses::compute(&self.tissue, supports, solver, &executor, &|_, _| ())?)))
    }
}

recipe!(Precomputed);
