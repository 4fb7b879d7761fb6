use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ActiveFibreFile, ActuatorFile, CurveFile, LawFile, LoadFile, MeshFile, ModelFile, PlaceFile, RegionFile};
use crate::quantity::{Density, Length, Rate, Stiffness, Time};

/// A body of tissue.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "body", transform = crate::tissue::with_density_of_tissue)]
pub struct BodyFile {
    /// Where its mesh comes from.
    pub mesh: MeshFile,
    /// Where it stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<PlaceFile>,
    /// Mass density [kg/m³]; soft tissue about 1060. A law that names its tissue gives it too.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: Density,
    /// How it resists deformation.
    pub law: LawFile,
    /// How the law becomes forces; by default the tensor-mass model that fits the law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelFile>,
    /// Damping against the surroundings [1/s]: each node is held back with rate × mass × velocity.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub damping: Rate,
    /// Damping by the stiffness [s], for implicit integrators: a velocity acts as its displacement over this time would.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(extend("minimum" = 0))]
    pub stiffness_damping: Time,
    /// What does not move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fix: Option<RegionFile>,
    /// What becomes of pieces that are cut off: "free" (the default) lets them fall, "drop" takes them away.
    #[serde(default)]
    pub loose_pieces: LoosePiecesFile,
    /// Parts of another law or density; later ones win where they overlap.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub part: Vec<PartFile>,
    /// What moves in a plane only: symmetry planes, rollers, sliding plates.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slide: Vec<SlideFile>,
    /// What is moved along a given way.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub prescribe: Vec<PrescribeFile>,
    /// Where it is grown to other bodies; with any integrator, but not with multigrid.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub attach: Vec<AttachFile>,
    /// Parts whose volume is kept to rounding, as by an incompressible filling; the explicit integrator only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub exact_volume: Vec<ExactVolumeFile>,
    /// Regions of nodes that move as rigid bodies, each for itself; the explicit integrator only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rigid: Vec<RegionFile>,
    /// Membranes of muscle; the explicit integrator only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub muscle: Vec<MuscleFile>,
    /// Linear actuators between two regions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub actuator: Vec<ActuatorFile>,
    /// Linear actuators in the cells of a region, along a direction.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub active_fibre: Vec<ActiveFibreFile>,
    /// What pulls and pushes on it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub load: Vec<LoadFile>,
}

/// What becomes of pieces that are cut off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LoosePiecesFile {
    /// They move on.
    #[default]
    Free,
    /// They are taken away.
    Drop,
}

/// A part of a body with a law or density of its own.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "part")]
pub struct PartFile {
    /// Which cells.
    pub region: RegionFile,
    /// Their law, of the same kind as the body's; it may have fibres of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<LawFile>,
    /// Their mass density [kg/m³].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: Option<Density>,
}

/// A region whose nodes follow the forces across `normal`, and along it stay or go a given way.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "slide")]
pub struct SlideFile {
    /// Which nodes.
    pub region: RegionFile,
    /// Direction in which they are held, of any length but zero.
    pub normal: [f64; 3],
    /// How far along it they are from their place at rest [m]; by default they stay.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<CurveFile<Length>>,
}

/// A region that is grown to another body: each of its nodes to the nearest place of the other's surface.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "attachment")]
pub struct AttachFile {
    /// Which nodes.
    pub region: RegionFile,
    /// Name of the other body.
    pub to: String,
}

/// A part whose volume is kept exactly. A cut takes along the volume that its cells have at that moment.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "exact volume")]
pub struct ExactVolumeFile {
    /// What messages and observables call it.
    pub name: String,
    /// Which cells.
    pub region: RegionFile,
}

/// A membrane of muscle: springs along the edges of the faces in a region, which shorten as it is activated.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "muscle")]
pub struct MuscleFile {
    /// Which nodes: all faces between them, on the surface or inside.
    pub region: RegionFile,
    /// Young's modulus times thickness [N/m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness: Stiffness,
    /// The share of their length by which edges shorten at full activation.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 1))]
    pub contraction: f64,
    /// How far it is activated along time, from 0 to 1.
    pub activation: CurveFile<f64>,
}

/// A region that is moved along a given way.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "prescribed motion")]
pub struct PrescribeFile {
    /// Which nodes.
    pub region: RegionFile,
    /// How far they are from their place at rest [m].
    pub displacement: CurveFile<[Length; 3]>,
}

fn is_zero(time: &Time) -> bool {
    time.0 == 0.0
}
