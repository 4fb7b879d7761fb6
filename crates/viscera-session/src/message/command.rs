use serde::{Deserialize, Serialize};

use super::{Bytes, Value};

/// What a page asks of a session; `docs/protocol.md` says what each does. The first four kinds of scene-changing commands take
/// effect at once, instruments at the next step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", deny_unknown_fields, rename_all = "kebab-case", rename_all_fields = "camelCase")]
pub enum Command {
    /// Begins; whoever carries messages answers it.
    Hello {
        /// [`VERSION`](super::VERSION) of the page.
        version: u32,
        /// What the page calls itself.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        client: Option<String>,
    },
    /// Starts a scene that is built in.
    OpenScene {
        /// Its name.
        name: String,
    },
    /// Starts a scene of the user's.
    OpenText {
        /// TOML.
        text: String,
        /// What to call it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// Starts a default scene around a mesh of the user's.
    OpenMesh {
        /// File name with extension.
        name: String,
        /// What is in it.
        bytes: Bytes,
        /// Unit of its coordinates; by default what makes it as large as an organ.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        unit: Option<MeshUnit>,
        /// Edge of the cells with which a surface is filled [m].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        edge: Option<f64>,
    },
    /// Changes a parameter.
    Set {
        /// Its key.
        key: String,
        /// Its new value.
        value: Value,
    },
    /// Brings an instrument in.
    AddInstrument {
        /// Its kind.
        kind: String,
        /// Where its tip is [m]; by default in front of the bodies.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        tip: Option<[f64; 3]>,
        /// From handle to tip; by default away from who looks.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<[f64; 3]>,
        /// The point that its shaft passes through; by default none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        trocar: Option<Trocar>,
    },
    /// Leads the shaft of an instrument through a point, or lets it go.
    SetTrocar {
        /// Its number.
        instrument: u32,
        /// The point.
        trocar: Trocar,
    },
    /// Takes an instrument away.
    RemoveInstrument {
        /// Its number.
        instrument: u32,
    },
    /// Says where an instrument should be at the end of the next step.
    MoveInstrument {
        /// Its number.
        instrument: u32,
        /// Its tip [m].
        tip: [f64; 3],
        /// From handle to tip, of any length but zero.
        direction: [f64; 3],
        /// About the direction [rad].
        roll: f64,
        /// 0 open or off, 1 closed or on.
        trigger: f64,
        /// What the page calls this moment.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        stamp: Option<f64>,
    },
    /// Stops the clock.
    Pause {},
    /// Lets it go on.
    Play {},
    /// Makes steps while paused.
    Step {
        /// How many [1 … 1000].
        #[serde(default = "one")]
        count: u32,
    },
    /// Goes back to the beginning of the scene.
    Reset {},
    /// Keeps the state.
    TakeSnapshot {
        /// Where, see [`SLOTS`](super::SLOTS).
        slot: usize,
    },
    /// Goes back to a state that was kept.
    RestoreSnapshot {
        /// Where it is.
        slot: usize,
    },
    /// Chooses what vertices are coloured by.
    Colour {
        /// Name of the colouring.
        by: String,
    },
    /// Shows or hides the linear model beside each body.
    Ghost {
        /// Whether it is there.
        on: bool,
    },
    /// Begins a recording.
    StartRecording {},
    /// Ends it and asks for the file.
    StopRecording {},
    /// Plays a recording.
    Replay {
        /// Name of one that is built in.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
        /// Or one that was kept.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        bytes: Option<Bytes>,
    },
    /// Ends the replay where it is.
    StopReplay {},
    /// Asks for a file.
    Export {
        /// What is to be in it.
        what: Export,
    },
}

fn one() -> u32 {
    1
}

/// The point that the shaft of an instrument passes through.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Trocar {
    /// One that the session chooses above the bodies, or none.
    Wanted(bool),
    /// This one [m].
    At([f64; 3]),
}

/// Unit of the coordinates of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MeshUnit {
    /// Metres.
    #[serde(rename = "m")]
    Metre,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetre,
}

/// What can be taken home.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Export {
    /// Observables over time, as CSV.
    Observables,
    /// Places, displacements and stress now, as VTU.
    State,
    /// The scene with the present parameters, as TOML.
    Scene,
}

impl Command {
    /// Its `type`. Asked of the encoding, it would cost a mesh dropped on the page forty times its bytes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Hello { .. } => "hello",
            Self::OpenScene { .. } => "open-scene",
            Self::OpenText { .. } => "open-text",
            Self::OpenMesh { .. } => "open-mesh",
            Self::Set { .. } => "set",
            Self::AddInstrument { .. } => "add-instrument",
            Self::SetTrocar { .. } => "set-trocar",
            Self::RemoveInstrument { .. } => "remove-instrument",
            Self::MoveInstrument { .. } => "move-instrument",
            Self::Pause { .. } => "pause",
            Self::Play { .. } => "play",
            Self::Step { .. } => "step",
            Self::Reset { .. } => "reset",
            Self::TakeSnapshot { .. } => "take-snapshot",
            Self::RestoreSnapshot { .. } => "restore-snapshot",
            Self::Colour { .. } => "colour",
            Self::Ghost { .. } => "ghost",
            Self::StartRecording { .. } => "start-recording",
            Self::StopRecording { .. } => "stop-recording",
            Self::Replay { .. } => "replay",
            Self::StopReplay { .. } => "stop-replay",
            Self::Export { .. } => "export",
        }
    }

    /// Whether it may be as long as a mesh.
    pub(super) fn may_be_long(name: &str) -> bool {
        matches!(name, "open-mesh" | "open-text" | "replay")
    }

    /// Whether recordings have it: what hands do to the scene that was there when they began.
    pub(crate) fn is_recorded(&self) -> bool {
        matches!(
            self,
            Self::Set { .. }
                | Self::AddInstrument { .. }
                | Self::SetTrocar { .. }
                | Self::RemoveInstrument { .. }
                | Self::MoveInstrument { .. }
                | Self::Reset {}
        )
    }

    /// Whether it changes what is simulated: a replay does not bear that.
    pub(crate) fn changes_the_scene(&self) -> bool {
        !matches!(
            self,
            Self::Hello { .. }
                | Self::Pause {}
                | Self::Play {}
                | Self::Step { .. }
                | Self::Colour { .. }
                | Self::Ghost { .. }
                | Self::StopReplay {}
                | Self::Export { .. }
                | Self::TakeSnapshot { .. }
        )
    }
}
