use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::RegionFile;
use crate::quantity::{Length, Pressure};

/// How a law and a mesh become forces.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "model")]
pub struct ModelFile {
    /// Which model.
    pub kind: ModelName,
    /// Stiffness κ against changes of the volume of a cell [Pa] (INRIA RR-4028, section 4).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub keep_volume: Option<Pressure>,
    /// Displacement [m] below which a node follows the linear law alone (INRIA RR-4028, section 6); `tensor-mass` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub adaptive: Option<Length>,
    /// Share of the shear modulus that `nodally-integrated` leaves in the cells, against wrinkles; by default 0.01.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 1))]
    pub stabilise: Option<f64>,
    /// How `corotational` finds the rotation of a cell; by default "polar".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<RotationName>,
    /// The shape over which `corotational` differentiates displacements; by default "at-rest".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strain_displacement: Option<StrainDisplacementName>,
    /// The volume over which `corotational` integrates stress; by default "initial".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volume: Option<VolumeName>,
    /// What `corotational` gives implicit steps as its stiffness; by default "frozen".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tangent: Option<TangentName>,
    /// The file of responses that `viscera precompute` wrote for `precomputed`; by default they are computed at every start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub responses: Option<PathBuf>,
    /// The part of `hybrid` that moves and can be cut: every cell with a corner in it; by default all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dynamic: Option<RegionFile>,
}

/// The force models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ModelName {
    /// Precomputed tensors of the linear law; tetrahedra.
    LinearTensorMass,
    /// Precomputed tensors of the non-linear law; tetrahedra.
    TensorMass,
    /// Stress from the deformation of each cell; every law, tetrahedra and hexahedra.
    TotalLagrangian,
    /// Stress from the mean deformation at each node: does not lock, however close to incompressible; tetrahedra, every
    /// law but the linear ones.
    NodallyIntegrated,
    /// The linear law turned with each cell (Nesme et al. 2005); tetrahedra and hexahedra. Turns back when inverted.
    Corotational,
    /// The linear law turned at each node (Müller et al. 2002); tetrahedra. For comparison: its forces do not balance.
    StiffnessWarping,
    /// Springs along the edges of the cells (van Gelder 1998); tetrahedra and hexahedra. For comparison: Poisson's ratio is 1/4,
    /// and what is folded stays folded.
    MassSpring,
    /// Nodes that return to their place among their neighbours (Promayon et al. 1996); tetrahedra and hexahedra. Comes back
    /// where springs stay folded, and is no law of matter.
    ShapeMemory,
    /// Responses of the linear law found beforehand (Cotin et al. 1999); rests at every step, feels tools without friction, and cannot
    /// be cut. Tetrahedra and hexahedra.
    Precomputed,
    /// One region moves and can be cut, the rest follows by the law at rest, pre-computed (Cotin et al. 2000); every law, tetrahedra
    /// and hexahedra.
    Hybrid,
}

/// How the rotation of a cell is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RotationName {
    /// The nearest rotation.
    Polar,
    /// Along the first two edges: cheapest, and dependent on the order of the corners.
    Qr,
    /// The nearest rotation by singular values.
    Svd,
}

/// The shape over which displacements are differentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StrainDisplacementName {
    /// The rest shape.
    AtRest,
    /// The current shape.
    Updated,
}

/// The volume over which stress is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VolumeName {
    /// That at rest.
    Initial,
    /// The current one.
    Current,
}

/// What an implicit step takes for the stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TangentName {
    /// The linear one, turned: symmetric, never negative, cheap.
    Frozen,
    /// The derivative of the forces.
    Exact,
}
