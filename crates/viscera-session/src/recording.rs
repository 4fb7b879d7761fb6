//! What was done to a scene, step by step, to be done again.
//!
//! A recording holds the scene, the commands with the numbers of their steps, and marks: at intervals, a checksum of the state and a
//! few numbers about each body. Played on the same kind of processor it comes to the same bits; on another, whose vectors are
//! longer or whose products are rounded otherwise, to the same numbers within a tolerance. Either way it is told.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::message::size::fits;
use crate::message::{Bytes, Command, LONGEST};
use crate::simulation::tools::Tool;

/// Grows with every change of what is written.
const FORMAT: u32 = 3;
/// The oldest format that is read: it knew no trocars.
const OLDEST: u32 = 2;
/// The longest recording [steps]: an hour at 100 steps a second.
pub(crate) const MOST_STEPS: u64 = 360_000;
/// The most that is done in one: in every step of that hour something, and more.
pub(crate) const MOST_EVENTS: usize = 400_000;
/// The most values in the recording, in its lists, in what they list, and in what that consists of: 256 bodies in a mark, and nothing else
/// than numbers and names in a command.
const WIDEST: [u64; 6] = [32, MOST_EVENTS as u64, 16, 256, 16, 16];
/// Steps between marks.
pub(crate) const INTERVAL: u64 = 50;
/// By how much numbers may differ from those recorded on another processor, over the largest of them. Contact and cuts multiply
/// roundings: a cell more or less is cut at once, and shows in the motion later.
const TOLERANCE: f64 = 0.05;

/// What was done to a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Recording {
    format: u32,
    /// What it shows.
    pub title: String,
    /// Name of its scene.
    pub scene: String,
    /// The kind of processor that it was made on, see [`processor`].
    pub processor: String,
    /// The scene as TOML.
    pub(crate) text: String,
    /// The files that it names.
    pub(crate) files: BTreeMap<String, Bytes>,
    /// Instruments at the start, by number.
    pub(crate) tools: Vec<Tool>,
    /// The state at the start, unless it is the beginning of the scene.
    pub(crate) state: Option<Bytes>,
    /// What was done, in order.
    pub(crate) events: Vec<Event>,
    /// How it went.
    pub(crate) marks: Vec<Mark>,
    /// How many steps it has.
    pub(crate) steps: u64,
    /// Length of a step at the start [s].
    pub(crate) step: f64,
}

/// A command and when it took effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub(crate) struct Event {
    /// Steps of the recording before it.
    pub(crate) at: u64,
    pub(crate) command: Command,
}

/// How a recording stood after some steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub(crate) struct Mark {
    /// After how many steps.
    pub(crate) at: u64,
    /// CRC-32 of the bits of all places and velocities and of the cells that are gone.
    pub(crate) checksum: u32,
    pub(crate) bodies: Vec<BodyMark>,
}

/// How a body stood.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub(crate) struct BodyMark {
    /// Cells that are left.
    pub(crate) cells: u64,
    /// Largest displacement [m].
    pub(crate) displacement: f64,
    /// Mean displacement of all nodes [m].
    pub(crate) mean: [f64; 3],
}

/// How far two marks are the same.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Agreement {
    /// To the last bit.
    Bits,
    /// Within what another processor's roundings make of them.
    Numbers,
    /// Not, and in what.
    None(String),
}

/// The kind of this processor: its family and the vectors that kernels use on it. On the same kind a recording comes to the same bits.
pub fn processor() -> String {
    let vectors = format!("{:?}", viscera::math::dispatch_level());
    let vectors = vectors.split(['(', ' ', '{']).next().unwrap_or_default().to_lowercase();
    format!("{} {vectors}", std::env::consts::ARCH)
}

/// Why bytes are no recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// They are something else, or damaged.
    #[error("this is no recording of Viscera, or it is damaged: {0}")]
    Unreadable(String),
    /// It is longer than one can be that is made here: nothing of it was kept.
    #[error("the recording has {bytes} bytes, and at most {LONGEST} are read: record less")]
    TooLong {
        /// Its length.
        bytes: usize,
    },
    /// It breaks off, or promises more than a recording has: nothing of it was kept.
    #[error(
        "this is no recording of Viscera, or it is damaged: its {bytes} bytes break off, or promise more than they have"
    )]
    Unsound {
        /// Its length.
        bytes: usize,
    },
    /// It asks for what is never recorded.
    #[error("the recording is not of this program: at step {at} it has `{command}`, which is never recorded")]
    Foreign {
        /// At which step.
        at: u64,
        /// The `type` of the command.
        command: &'static str,
    },
    /// It has more steps than one can have that is made here.
    #[error("the recording has {steps} steps, and at most {MOST_STEPS} are played: it is damaged")]
    TooManySteps {
        /// How many.
        steps: u64,
    },
    /// They are of another version.
    #[error(
        "the recording has format {found}, and this program reads formats {OLDEST} to {FORMAT}: record it again, or take the program it is of"
    )]
    OtherFormat {
        /// Its format.
        found: u32,
    },
}

impl Recording {
    /// An empty one.
    pub(crate) fn new(title: String, scene: String, text: String, step: f64) -> Self {
        Self {
            format: FORMAT,
            title,
            scene,
            processor: processor(),
            text,
            files: BTreeMap::new(),
            tools: Vec::new(),
            state: None,
            events: Vec::new(),
            marks: Vec::new(),
            steps: 0,
            step,
        }
    }

    /// Reads one. Bytes are never trusted: what they promise is held against what is there before anything is kept, and what is
    /// kept takes at most some times their length.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn decode(bytes: &[u8]) -> Result<Self, RecordingError> {
        #[derive(Deserialize)]
        struct Head {
            format: u32,
        }
        if bytes.len() > LONGEST {
            return Err(RecordingError::TooLong { bytes: bytes.len() });
        }
        if !fits(&WIDEST, bytes) {
            return Err(RecordingError::Unsound { bytes: bytes.len() });
        }
        let unreadable = |error: rmp_serde::decode::Error| RecordingError::Unreadable(error.to_string());
        let Head { format } = rmp_serde::from_slice(bytes).map_err(unreadable)?;
        if !(OLDEST..=FORMAT).contains(&format) {
            return Err(RecordingError::OtherFormat { found: format });
        }
        let recording: Self = rmp_serde::from_slice(bytes).map_err(unreadable)?;
        if recording.steps > MOST_STEPS {
            return Err(RecordingError::TooManySteps { steps: recording.steps });
        }
        match recording.events.iter().find(|event| !event.command.is_recorded()) {
            Some(Event { at, command }) => Err(RecordingError::Foreign { at: *at, command: command.name() }),
            None => Ok(recording),
        }
    }

    /// Its bytes.
    pub fn encode(&self) -> Vec<u8> {
        rmp_serde::to_vec_named(self).expect("numbers, texts and lists of known length always have an encoding")
    }

    /// How long it is [s].
    pub fn seconds(&self) -> f64 {
        self.steps as f64 * self.step
    }
}

impl Mark {
    /// How far this is what was recorded.
    pub(crate) fn agreement(&self, recorded: &Self) -> Agreement {
        if self.checksum == recorded.checksum {
            return Agreement::Bits;
        }
        if self.bodies.len() != recorded.bodies.len() {
            return Agreement::None("it has another number of bodies".into());
        }
        for (index, (now, then)) in self.bodies.iter().zip(&recorded.bodies).enumerate() {
            let cells = then.cells.abs_diff(now.cells) as f64;
            if cells > TOLERANCE * then.cells as f64 {
                return Agreement::None(format!("body {index} has {} cells, recorded were {}", now.cells, then.cells));
            }
            let off = (0..3).map(|axis| (now.mean[axis] - then.mean[axis]).abs()).fold(0.0, f64::max);
            let scale = then.displacement.max(now.displacement);
            if off > TOLERANCE * scale {
                let text =
                    format!("nodes of body {index} are {off:.3e} m off on average, at displacements of {scale:.3e} m");
                return Agreement::None(text);
            }
        }
        Agreement::Numbers
    }
}
