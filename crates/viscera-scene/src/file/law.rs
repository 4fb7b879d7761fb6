use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::quantity::{Length, Pressure};

/// How tissue resists deformation. Give `young` and `poisson`, or `lambda` and `mu`; or `tissue`, which stands for all of them.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(
    title = "law",
    extend("x-exactly-one-of" = [["young", "poisson"], ["lambda", "mu"]]),
    transform = crate::tissue::with_tissue
)]
pub struct LawFile {
    /// Which law.
    pub kind: LawName,
    /// Young's modulus E [Pa]; liver about 5 kPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: Option<Pressure>,
    /// Poisson's ratio ν, above −1 and below 0.5; soft tissue lies between 0.4 and 0.49.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
    pub poisson: Option<f64>,
    /// First Lamé parameter λ [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda: Option<Pressure>,
    /// Shear modulus μ [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu: Option<Pressure>,
    /// A direction along which the tissue is stiffer (or softer) than across it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fibre: Option<FibreFile>,
}

/// The laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LawName {
    /// Linear elasticity: for displacements that are small against the body.
    Linear,
    /// St Venant–Kirchhoff: right under large rotations, for moderate strain.
    StVenantKirchhoff,
    /// Neo-Hookean, shape and volume apart: for large strain, and for nearly incompressible tissue.
    NeoHookean,
    /// Stable neo-Hookean: bears any strain, and turns back when it is inverted.
    StableNeoHookean,
}

/// Fibres: where they run, and how stiff the tissue is along them.
///
/// Give one of `direction`, `along`, `file`; and one of `young`, `factor`, `lambda` with `mu`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(
    title = "fibre",
    extend("x-exactly-one-of" = [["direction"], ["along"], ["file"]], "x-exactly-one-of-2" = [["young"], ["factor"], ["lambda", "mu"]])
)]
pub struct FibreFile {
    /// The same direction everywhere, in the coordinates of the scene; any length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Points of a curve [m], in the coordinates of the scene: each cell takes the direction of the nearest stretch of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 2))]
    pub along: Option<Vec<[Length; 3]>>,
    /// CSV file, from the scene file's folder: one row x, y, z for each cell of the mesh, turned with the mesh's place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Young's modulus along the fibres [Pa], with the law's Poisson ratio.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: Option<Pressure>,
    /// How many times stiffer the tissue is along the fibres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub factor: Option<f64>,
    /// First Lamé parameter along the fibres, λL [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda: Option<Pressure>,
    /// Shear modulus along the fibres, μL [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu: Option<Pressure>,
}
