//! Corotational elements: linear elasticity in a frame that turns with each element.
//!
//! R is taken from the deformation J of the element (F of a tetrahedron; from the averages of its parallel edges in a
//! hexahedron, which is F at its centre), and the linear law is asked in the frame of the rest shape:
//!
//! | B | strain | internal force on corner p |
//! |---|---|---|
//! | at rest | ε = sym(Rᵀ ∇_X x) − I | R V0 σ(ε) α_p |
//! | updated | ε = sym(∇_{x_l} u_l), x_l = Rᵀx, u_l = x_l − X | R V σ(ε) α_p(x_l) |
//!
//! In every variant the forces on an element add up to nothing. They turn nothing where B is updated; with B at rest, only
//! on tetrahedra of an isotropic law with the rotation `Polar` or `Svd`. With the initial volume, this is also the only
//! variant that derives from an energy, V0 [μ ‖S − I‖² + λ/2 tr²(S − I)]; what the others report as energy is ½ V ε:σ(ε)
//! of their own strain, a measure of deformation that their forces do not conserve.
//!
//! Source: Nesme, Marchal, Promayon, Chabanas, Payan, Faure, *Physically realistic interactive simulation for biological
//! soft tissues* (2005), section 3, with J, the place of R, and the volume in K corrected.

mod formulation;
mod frequency;
mod hex;
mod hex_linearized;
mod hooke;
mod tet;
mod turned;
mod warping;

pub use warping::StiffnessWarping;

pub use formulation::{IntegrationVolume, Rotation, StrainDisplacement, Tangent};

use self::formulation::Formulation;
use self::hex::CorotationalHexes;
use self::tet::CorotationalTets;
use super::frequency::FrequencyBound;
use super::registry::Claims;
use super::{ForceModel, GenericRecipe, ModelError, ModelInfo, ModelKind, Precision, recipe};
use crate::material::{LawKind, Tissue};
use crate::mesh::VolumeMesh;

pub(super) const LAWS: &[LawKind] = &[LawKind::LinearElastic, LawKind::TransverseLinear];

/// The corotational model of linear tissue, with or without fibres.
#[derive(Clone, Debug, PartialEq)]
pub struct Corotational {
    tissue: Tissue,
    formulation: Formulation,
}

impl Corotational {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "corotational",
        purpose: "large rotations at the price of small strains; steady in large implicit steps, turns back when inverted",
        hexahedra: true,
        laws: LAWS,
        moves: true,
        no_implicit: None,
        no_cutting: None,
        tool_limits: None,
    };

    pub(crate) fn claims(law: LawKind, hexahedra: bool) -> Claims {
        let has_energy = law == LawKind::LinearElastic && !hexahedra;
        Claims {
            of_the_law: false,
            objective: true,
            force_free: true,
            torque_free: has_energy,
            passes_patch_test: true,
            conservative: has_energy,
            exact_products: false,
        }
    }

    /// A model of `tissue`: polar decomposition, B at rest, initial volume, frozen tangent.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue, formulation: Formulation::default() }
    }

    /// How the rotation is found.
    pub fn rotation(mut self, rotation: Rotation) -> Self {
        self.formulation.rotation = rotation;
        self
    }

    /// Over which shape displacements are differentiated.
    pub fn strain_displacement(mut self, strain_displacement: StrainDisplacement) -> Self {
        self.formulation.strain = strain_displacement;
        self
    }

    /// The volume over which the stress is integrated.
    pub fn volume(mut self, volume: IntegrationVolume) -> Self {
        self.formulation.volume = volume;
        self
    }

    /// What a product with the stiffness is.
    pub fn tangent(mut self, tangent: Tangent) -> Self {
        self.formulation.tangent = tangent;
        self
    }
}

pub(super) fn has_fibres(tissue: &Tissue) -> bool {
    tissue.kind() == LawKind::TransverseLinear
}

/// What to take for other laws.
pub(super) const OTHER_LAWS: &str =
    "it turns small strains; take the law `linear` or `transverse-linear`, or the model `total-lagrangian`";

impl GenericRecipe for Corotational {
    const KIND: ModelKind = ModelKind::Corotational;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        Self::KIND.check_law(self.tissue.kind(), OTHER_LAWS)?;
        self.tissue.check_count(mesh.cell_count())?;
        match mesh {
            VolumeMesh::Tet(mesh) => Ok(Box::new(CorotationalTets::new(mesh, &self.tissue, self.formulation)?)),
            VolumeMesh::Hex(mesh) => Ok(Box::new(CorotationalHexes::new(mesh, &self.tissue, self.formulation)?)),
        }
    }

    fn bound<T: Precision>(
        &self,
        mesh: &VolumeMesh,
        density: &[f64],
        keep_volume: f64,
    ) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
        frequency::bound(mesh, &self.tissue, density, keep_volume, self.formulation)
    }
}

recipe!(Corotational);
