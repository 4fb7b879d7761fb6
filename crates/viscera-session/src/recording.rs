//! What was done to a scene, step by step, to be done again.
//!
//! A recording holds the scene, the commands with the numbers of their steps, and marks: at intervals, a checksum of the state and a
//! few numbers about each body. Played on the same kind of processor it comes to the same bits; on another, whose vectors are
//! longer or whose products are rounded otherwise, to the same numbers within a tolerance. Either way it is told.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::message::{Bytes, Command};
use crate::simulation::tools::Tool;

/// Grows with every change of what is written.
const FORMAT: u32 = 2;
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
    /// They are of another version.
    #[error(
        "the recording has format {found}, and this program reads format {FORMAT}: record it again, or take the program it is of"
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

    /// Reads one.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn decode(bytes: &[u8]) -> Result<Self, RecordingError> {
        #[derive(Deserialize)]
        struct Head {
            format: u32,
        }
        let unreadable = |error: rmp_serde::decode::Error| RecordingError::Unreadable(error.to_string());
        let Head { format } = rmp_serde::from_slice(bytes).map_err(unreadable)?;
        if format != FORMAT {
            return Err(RecordingError::OtherFormat { found: format });
        }
        rmp_serde::from_slice(bytes).map_err(unreadable)
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
