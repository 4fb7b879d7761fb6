//! What a page and a session say to each other: MessagePack maps with a `type`. `docs/protocol.md` is their description.

mod answer;
mod bulk;
mod command;
mod frame;
mod scene;
pub(crate) mod size;

pub use answer::{Answer, Excerpt, FileMessage, Level, Notice, Purpose, Refusal, Role, RoleMessage, Welcome};
pub use bulk::{Bytes, F32s, U32s};
pub use command::{Command, Export, MeshUnit, Trocar};
pub use frame::{
    BodyFrame, ColourRange, FrameMessage, InstrumentFrame, Observables, Pace, RecordingState, ReplayState, RunState,
};
pub use scene::{
    BodyEntry, Camera, Catalogue, Choice, ColouringEntry, Effect, Entry, InstrumentEntry, InstrumentShape, Manner,
    Parameter, ParameterKind, Part, PartKind, RecordingEntry, Scale, SceneEntry, SceneMessage, SnapshotEntry,
    SurfaceMessage,
};

use serde::{Deserialize, Serialize};

/// Version of the protocol.
pub const VERSION: u32 = 2;
/// How many states can be kept.
pub const SLOTS: usize = 8;
/// The longest command [bytes].
pub const LONGEST: usize = 64 << 20;
/// The longest command but for meshes, scenes and recordings [bytes].
pub const LONGEST_SHORT: usize = 64 << 10;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Yes or no.
    Flag(bool),
    /// A number, SI.
    Number(f64),
    /// A name.
    Text(String),
    /// Three numbers.
    Vector([f64; 3]),
}

/// A command and the number that the page gave it.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// What to do.
    pub command: Command,
    /// What answers carry.
    pub request: Option<u64>,
}

impl Request {
    /// Reads a command. Bytes are never trusted: lengths are held against what is there, and values are counted before they are kept.
    ///
    /// # Errors
    /// A [`Refusal`] that says what is wrong, to be sent back.
    pub fn decode(bytes: &[u8]) -> Result<Self, Box<Refusal>> {
        let refuse = |command: &str, request, reason: String, help: &str| {
            Box::new(Refusal { command: command.into(), reason, help: help.into(), request, ..Refusal::default() })
        };
        if bytes.len() > LONGEST {
            return Err(refuse("", None, format!("the message has {} bytes", bytes.len()), "at most 64 MiB are read"));
        }
        let help = "a message is one MessagePack map with the key `type`";
        if size::has_more_values_than(MOST_VALUES, bytes) {
            let reason = format!("the message cannot be read: it has more than {MOST_VALUES} values");
            return Err(refuse("", None, reason, help));
        }
        let mut rest = bytes;
        let value = rmpv::decode::read_value_with_max_depth(&mut rest, DEEPEST)
            .map_err(|error| refuse("", None, format!("the message cannot be read: {error}"), help))?;
        let rmpv::Value::Map(mut entries) = value else {
            return Err(refuse("", None, "the message is not a map".into(), help));
        };
        if !rest.is_empty() {
            return Err(refuse("", None, format!("{} bytes follow the message", rest.len()), help));
        }
        let place = entries.iter().position(|(key, _)| key.as_str() == Some("request"));
        let request = place.and_then(|place| entries.swap_remove(place).1.as_u64());
        let of_type = entries.iter().find(|(key, _)| key.as_str() == Some("type"));
        let name = of_type.and_then(|(_, value)| value.as_str()).unwrap_or_default().to_owned();
        if bytes.len() > LONGEST_SHORT && !Command::may_be_long(&name) {
            let reason = format!("the message has {} bytes", bytes.len());
            return Err(refuse(&name, request, reason, "only meshes, scenes and recordings may have more than 64 KiB"));
        }
        let command = rmpv::ext::from_value(rmpv::Value::Map(entries)).map_err(|error| {
            let text = error.to_string();
            refuse(&name, request, text.strip_prefix("error while decoding value: ").unwrap_or(&text).into(), "")
        })?;
        Ok(Self { command, request })
    }

    /// The bytes of a command, as a page would send it.
    pub fn encode(&self) -> Vec<u8> {
        #[derive(Serialize)]
        struct Numbered<'a> {
            #[serde(flatten)]
            command: &'a Command,
            #[serde(skip_serializing_if = "Option::is_none")]
            request: Option<u64>,
        }
        encode(&Numbered { command: &self.command, request: self.request })
    }
}

/// Keys, values and what is in lists, the map itself included: a command has half as many.
const MOST_VALUES: u64 = 64;
/// Maps within maps: a command has two.
const DEEPEST: usize = 16;

impl From<Command> for Request {
    fn from(command: Command) -> Self {
        Self { command, request: None }
    }
}

impl Answer {
    /// Its bytes.
    pub fn encode(&self) -> Vec<u8> {
        encode(self)
    }

    /// Reads an answer, as a page does.
    ///
    /// # Errors
    /// Where the bytes are no answer.
    pub fn decode(bytes: &[u8]) -> Result<Self, rmp_serde::decode::Error> {
        rmp_serde::from_slice(bytes)
    }
}

fn encode(message: &impl Serialize) -> Vec<u8> {
    rmp_serde::to_vec_named(message).expect("numbers, texts and lists of known length always have an encoding")
}
