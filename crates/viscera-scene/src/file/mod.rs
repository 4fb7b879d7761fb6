//! What stands in a scene file: the only list of keys.
//!
//! A new key is one field here. Its doc comment, type, dimension and range become the schema; editors, the check and its
//! messages follow from that. `exclusiveMinimum` and the like hold for the value in SI.

mod action;
mod body;
mod curve;
mod instrument;
mod integrator;
mod law;
mod mesh;
mod model;
mod output;
mod region;

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::quantity::{Acceleration, Time};

pub use action::{ActiveFibreFile, ActuatorFile, AttractionFile, LoadFile};
pub use body::{
    AttachFile, BodyFile, ExactVolumeFile, LoosePiecesFile, MuscleFile, PartFile, PrescribeFile, SlideFile,
};
pub use curve::{CurveFile, CurvePath};
pub use instrument::{InstrumentFile, JawsFile, ShaftFile};
pub use integrator::{
    FullNewtonFile, IntegratorFile, IntegratorName, LinearFile, MatrixFile, NewtonFile, NewtonName, PreconditionerFile,
    SolverFile,
};
pub use law::{FibreFile, LawFile, LawName};
pub use mesh::{
    CellShape, CutFile, GenerateFile, LengthUnit, MeshFile, PlaceFile, RotateFile, SurfaceFile, VolumeFile,
};
pub use model::{ModelFile, ModelName, RotationName, StrainDisplacementName, TangentName, VolumeName};
pub use output::{CameraFile, OutputFile};
pub use region::{RegionFile, RegionShape};

/// A scene: bodies of tissue, the instruments that touch them, and how it is all stepped through time.
///
/// Numbers are SI; a string carries its unit ("5 kPa", "30 cm", "20 ms").
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "scene")]
pub struct SceneFile {
    /// What the scene shows, in a line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// Gravity [m/s²]; by default 9.81 m/s² along −y.
    #[serde(default = "earth")]
    pub gravity: [Acceleration; 3],
    /// How long the scene runs [s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub duration: Time,
    /// Time from one step of the world to the next [s]; by default 5 ms. The explicit integrator cuts each into stable
    /// substeps.
    #[serde(default = "five_milliseconds")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub step: Time,
    /// The explicit integrator's own step: "auto" (the default) takes the largest stable one, a time [s] sets it.
    #[serde(default)]
    pub substep: SubstepFile,
    /// Numbers of the simulation: "single" (the default, twice as fast) or "double" (for comparisons).
    #[serde(default)]
    pub precision: Precision,
    /// How the equations of motion are stepped.
    #[serde(default)]
    pub integrator: IntegratorFile,
    /// Pictures and results.
    #[serde(default)]
    pub output: OutputFile,
    /// Bodies of tissue, by name.
    #[serde(default)]
    pub body: IndexMap<String, BodyFile>,
    /// Instruments, by name.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub instrument: IndexMap<String, InstrumentFile>,
}

fn earth() -> [Acceleration; 3] {
    [0.0, -9.81, 0.0].map(Acceleration)
}

fn five_milliseconds() -> Time {
    Time(0.005)
}

/// The integrator's own step.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum SubstepFile {
    /// The largest stable one.
    Automatic(Automatic),
    /// A time [s].
    Fixed(#[schemars(extend("exclusiveMinimum" = 0))] Time),
}

impl Default for SubstepFile {
    fn default() -> Self {
        Self::Automatic(Automatic::Auto)
    }
}

/// The word "auto".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub enum Automatic {
    /// Chosen by the program.
    #[serde(rename = "auto")]
    Auto,
}

/// Single or double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 32 bits, about 7 digits: for play.
    #[default]
    Single,
    /// 64 bits, about 16 digits: for comparisons.
    Double,
}

impl SceneFile {
    /// The scene as TOML, quantities as SI numbers. Reading it again gives an equal scene.
    ///
    /// # Errors
    /// [`toml::ser::Error`] where a number is not one that TOML can hold.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }
}
