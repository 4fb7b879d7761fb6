use serde::{Deserialize, Serialize};

use super::F32s;

/// Where everything is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct FrameMessage {
    /// Epoch of the scene.
    pub scene: u64,
    /// Number of the frame.
    pub sequence: u64,
    /// Simulated time [s].
    pub time: f64,
    /// Steps since the start of the scene.
    pub steps: u64,
    /// Whether it runs.
    pub state: RunState,
    /// How it keeps up with the clock.
    pub pace: Pace,
    /// Of each body, where its vertices are.
    pub bodies: Vec<BodyFrame>,
    /// What the scalars are.
    pub colouring: ColourRange,
    /// Of each instrument, where it is and what it feels.
    pub instruments: Vec<InstrumentFrame>,
    /// Of each body, numbers about it; not in every frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observables: Option<Vec<Observables>>,
    /// The last command that this frame knows of, by the number that the page gave it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub request: Option<u64>,
    /// While recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<RecordingState>,
    /// While replaying.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub replay: Option<ReplayState>,
}

/// Whether the simulation runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunState {
    /// It follows the clock.
    Running,
    /// The user stopped it.
    Paused,
    /// A step was refused.
    Stopped,
}

/// How the simulation keeps up with the clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Pace {
    /// Steps in the last second of the clock.
    pub steps_per_second: f64,
    /// Simulated time over that of the clock: 1 in real time.
    pub real_time: f64,
    /// By how much simulated time has fallen behind [s].
    pub lag: f64,
}

/// Where the vertices of a body are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct BodyFrame {
    /// Epoch of the surface to which the vertices belong.
    pub epoch: u64,
    /// Three coordinates to each vertex [m].
    pub positions: F32s,
    /// Of each vertex, a number in the unit of the colouring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scalars: Option<F32s>,
    /// Of each vertex, how burnt it is [0 … 1].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seared: Option<F32s>,
}

/// What the scalars are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ColourRange {
    /// Name of the colouring.
    pub by: String,
    /// Unit of the numbers.
    pub unit: String,
    /// The lower end of the scale.
    pub low: f64,
    /// The upper end of the scale.
    pub high: f64,
}

/// Where an instrument is and what it feels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct InstrumentFrame {
    /// Its number.
    pub instrument: u32,
    /// Its tip [m].
    pub tip: [f64; 3],
    /// From handle to tip, a unit vector.
    pub direction: [f64; 3],
    /// About the direction [rad].
    pub roll: f64,
    /// The point that its shaft passes through [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trocar: Option<[f64; 3]>,
    /// 0 open or off, 1 closed or on.
    pub trigger: f64,
    /// Whether jaws are closed, or the current is on.
    pub active: bool,
    /// Whether it holds tissue.
    pub holds: bool,
    /// Of the tissue on the tool [N].
    pub force: [f64; 3],
    /// Of that force about the tip [N m].
    pub torque: [f64; 3],
    /// Its rigid parts: from, to [m], radius [m], seven numbers to each.
    pub parts: F32s,
    /// `stamp` of the last `move-instrument` that this place follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stamp: Option<f64>,
}

/// Numbers about a body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Observables {
    /// Kinetic energy [J].
    pub kinetic: f64,
    /// Elastic energy [J].
    pub elastic: f64,
    /// Energy in the field of gravity [J].
    pub gravity: f64,
    /// (V − V0)/V0.
    pub volume_variation: f64,
    /// Largest distance of a node from its place at rest [m].
    pub largest_displacement: f64,
    /// Cells that are left.
    pub cells: usize,
    /// Cells that were removed.
    pub removed: usize,
    /// Cells that are turned inside out.
    pub inverted: usize,
    /// Shape of the worst cell, 1 for a perfect one.
    pub worst_quality: f64,
    /// Nodes at which the full law acts.
    pub nonlinear_nodes: usize,
    /// Whether it has come to rest.
    pub at_rest: bool,
    /// Where volumes are kept exactly, the largest |V − V0|/V0 of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volume_error: Option<f64>,
    /// Where a part is pre-computed, how much its reaction changed in the last step, over its size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface_residual: Option<f64>,
}

/// While recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct RecordingState {
    /// How long it is [s].
    pub seconds: f64,
}

/// While replaying.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ReplayState {
    /// What is played.
    pub name: String,
    /// How far it has come [s].
    pub seconds: f64,
    /// How long it is [s].
    pub of: f64,
    /// Whether the simulation has gone as recorded so far.
    pub agrees: bool,
}
