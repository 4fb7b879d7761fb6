//! A net of springs along the edges of the cells: the usual baseline of surgical simulation.
//!
//! W = Σ_e ½ k_e (l_e − L_e)²,   k_e = Σ_c w_e E_c V_c/L_e²          (the cells c around spring e)
//!
//! Spread over all directions, springs of m to a cell store ½ m w E ⟨(n·ε n)²⟩ in each unit of volume, and
//! ⟨(n·ε n)²⟩ = (tr² ε + 2 ε:ε)/15. Every net of central springs has Poisson's ratio 1/4 (Cauchy's relation λ = μ); pulled
//! along one axis with that contraction it stores ½ E ε² for m w = 6. So w = 1 on the six edges of a tetrahedron, which is
//! van Gelder's formula. A hexahedron has springs along its diagonals too, else it would shear freely: with w = 18/65 on these and
//! 17/130 on edges, cubes are isotropic and have the tissue's E exactly. The tissue's own ν counts for nothing.
//!
//! Springs do not know inside from outside: a node pushed through its cells stays there. Under compression their stiffness
//! across is negative, as that of any net that may buckle.
//!
//! Source: van Gelder, *Approximate simulation of elastic membranes by triangulated spring meshes*, J. Graphics Tools 3(2)
//! (1998), 21.

mod net;

use self::net::{Net, NetBound};
use super::frequency::FrequencyBound;
use super::penalty_frequency::with_penalty;
use super::{ForceModel, GenericRecipe, ModelError, ModelInfo, ModelKind, Precision, recipe};
use crate::material::{LawKind, Tissue};
use crate::mesh::VolumeMesh;

/// Springs along the edges of tetrahedra, and along edges and diagonals of hexahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct MassSpring {
    tissue: Tissue,
}

impl MassSpring {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "mass-spring",
        purpose: "for comparison: springs along the edges, with Poisson's ratio 1/4 whatever the tissue's; stays folded",
        hexahedra: true,
        laws: &[LawKind::LinearElastic],
        moves: true,
        no_implicit: None,
        no_cutting: None,
        tool_limits: None,
    };

    /// A model of `tissue`, of which Young's modulus counts.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue }
    }

    fn check(&self, mesh: &VolumeMesh) -> Result<(), ModelError> {
        self.tissue.check_count(mesh.cell_count())?;
        let advice = "springs know Young's modulus alone; take the law `linear`, or the model `total-lagrangian`";
        Self::KIND.check_law(self.tissue.kind(), advice)
    }
}

impl GenericRecipe for MassSpring {
    const KIND: ModelKind = ModelKind::MassSpring;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        self.check(mesh)?;
        Ok(Box::new(Net::new(mesh, &self.tissue)?))
    }

    fn bound<T: Precision>(
        &self,
        mesh: &VolumeMesh,
        density: &[f64],
        keep_volume: f64,
    ) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
        self.check(mesh)?;
        with_penalty(Box::new(NetBound::new(mesh, &self.tissue, density)?), mesh, density, keep_volume)
    }
}

recipe!(MassSpring);
