use serde::{Deserialize, Serialize};

use super::{Bytes, F32s, U32s, Value};

/// What there is to choose from, taken from the registries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Catalogue {
    /// Scenes that are built in.
    pub scenes: Vec<SceneEntry>,
    /// Recordings that are built in.
    pub recordings: Vec<RecordingEntry>,
    /// Laws.
    pub laws: Vec<Entry>,
    /// Force models.
    pub models: Vec<Entry>,
    /// Integrators.
    pub integrators: Vec<Entry>,
    /// Kinds of instruments.
    pub instruments: Vec<InstrumentEntry>,
    /// What vertices can be coloured by.
    pub colourings: Vec<ColouringEntry>,
    /// Extensions of mesh files that can be read.
    pub mesh_formats: Vec<String>,
}

/// A scene that is built in.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SceneEntry {
    /// By which it is opened.
    pub name: String,
    /// What it shows.
    pub title: String,
}

/// A recording that is built in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct RecordingEntry {
    /// By which it is played.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// Name of its scene.
    pub scene: String,
    /// How long it is [s].
    pub seconds: f64,
}

/// A law, a model or an integrator.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Entry {
    /// As it stands in scenes.
    pub name: String,
    /// As a person reads it.
    pub title: String,
    /// What it is good for.
    pub summary: String,
}

/// A kind of instrument.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct InstrumentEntry {
    /// By which it is brought in.
    pub kind: String,
    /// As a person reads it.
    pub title: String,
    /// What it is good for.
    pub summary: String,
    /// What its trigger does; empty if it has none.
    pub trigger: String,
}

/// What vertices can be coloured by.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ColouringEntry {
    /// By which it is chosen.
    pub name: String,
    /// As a person reads it.
    pub title: String,
    /// Unit of its numbers; empty for pure ones.
    pub unit: String,
    /// What it shows.
    pub summary: String,
}

/// The scene as it is now.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SceneMessage {
    /// Grows when bodies change their number or meshes.
    pub epoch: u64,
    /// Name.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// Step of the world [s].
    pub step: f64,
    /// `single` or `double`.
    pub precision: String,
    /// Centre of a ball around all bodies at rest [m].
    pub centre: [f64; 3],
    /// Its radius [m].
    pub radius: f64,
    /// From where the scene is best seen.
    pub camera: Camera,
    /// Bodies; others name them by their place here.
    pub bodies: Vec<BodyEntry>,
    /// Instruments.
    pub instruments: Vec<InstrumentShape>,
    /// What can be changed.
    pub parameters: Vec<Parameter>,
    /// States that are kept.
    pub snapshots: Vec<Option<SnapshotEntry>>,
    /// Whether the linear model is shown beside each body.
    pub ghost: bool,
    /// What vertices are coloured by.
    pub colouring: String,
}

/// From where a scene is best seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Camera {
    /// Direction in which the camera looks.
    pub look: [f64; 3],
    /// Direction that is upwards.
    pub up: [f64; 3],
}

/// A body.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct BodyEntry {
    /// Name.
    pub name: String,
    /// The body that this is the ghost of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ghost_of: Option<usize>,
    /// Cells at the beginning.
    pub cells: usize,
    /// Nodes.
    pub nodes: usize,
    /// Vertices of its surface at the beginning.
    pub vertices: usize,
    /// Name of its law.
    pub law: String,
    /// Name of its force model.
    pub model: String,
}

/// An instrument, as it is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct InstrumentShape {
    /// Its number.
    pub instrument: u32,
    /// Its kind.
    pub kind: String,
    /// What the scene calls it, or its kind and number.
    pub name: String,
    /// Whether the scene moves it until a hand does.
    pub scripted: bool,
    /// What pressing does with it.
    pub manner: Manner,
    /// How far from its tip it takes hold or burns [m].
    pub reach: f64,
    /// Its rigid parts, in the order in which frames say where they are; none where it touches nothing.
    pub parts: Vec<Part>,
}

/// What pressing does with an instrument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Manner {
    /// It takes hold.
    Hold,
    /// It burns.
    Burn,
    /// It pushes.
    Push,
}

/// A rigid part of an instrument: a rod with round ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Part {
    /// What it is.
    pub kind: PartKind,
    /// [m]
    pub radius: f64,
    /// Between the middles of its ends [m].
    pub length: f64,
}

/// What a part of an instrument is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PartKind {
    /// The rod behind the tip.
    Shaft,
    /// One of those that hold.
    Jaw,
}

/// Something that can be changed while it runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Parameter {
    /// By which it is set: the key of the scene file.
    pub key: String,
    /// Heading under which it stands.
    pub group: String,
    /// The body that it belongs to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<usize>,
    /// As a person reads it.
    pub title: String,
    /// What it does.
    pub summary: String,
    /// SI unit; empty for pure numbers and names.
    pub unit: String,
    /// What it is now.
    pub value: Value,
    /// What it is in the scene as it was opened.
    pub default: Value,
    /// What a change does to the motion.
    pub effect: Effect,
    /// What values it takes.
    #[serde(flatten)]
    pub kind: ParameterKind,
}

/// What a change of a parameter does to the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effect {
    /// It goes on from the present positions.
    Continues,
    /// It begins again.
    Restarts,
}

/// What values a parameter takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", rename_all_fields = "camelCase")]
pub enum ParameterKind {
    /// A number.
    Number {
        /// Not below it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        least: Option<f64>,
        /// Not at `least` either.
        least_excluded: bool,
        /// Not above it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        most: Option<f64>,
        /// Not at `most` either.
        most_excluded: bool,
        /// How a slider should go.
        scale: Scale,
        /// Where a slider should begin.
        low: f64,
        /// Where it should end.
        high: f64,
    },
    /// One of several names.
    Choice {
        /// The names.
        choices: Vec<Choice>,
    },
    /// Three numbers.
    Vector {},
    /// Yes or no.
    Flag {},
}

/// How a slider should go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// By equal steps.
    Linear,
    /// By equal factors.
    Logarithmic,
}

/// One of several names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Choice {
    /// As it stands in scenes.
    pub name: String,
    /// As a person reads it.
    pub title: String,
    /// Whether it can be chosen now.
    pub available: bool,
    /// Why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// A state that is kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SnapshotEntry {
    /// When it was taken [s].
    pub time: f64,
}

/// The whole outer surface of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SurfaceMessage {
    /// Epoch of the scene.
    pub scene: u64,
    /// Which body.
    pub body: usize,
    /// Grows with every change.
    pub epoch: u64,
    /// How many vertices there are.
    pub vertices: usize,
    /// How many of them, the first ones, were on the skin at rest.
    pub skin: usize,
    /// Three vertices to each triangle, counter-clockwise from outside.
    pub triangles: U32s,
    /// Of each triangle, 1 where a cut laid it open.
    pub cut: Bytes,
    /// Of each vertex, its place at rest [m].
    pub rest: F32s,
}
