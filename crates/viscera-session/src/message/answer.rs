use serde::{Deserialize, Serialize};

use super::{Bytes, Catalogue, FrameMessage, SceneMessage, SurfaceMessage};

/// What a page hears; `docs/protocol.md` explains each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case")]
pub enum Answer {
    /// To `hello`.
    Welcome(Welcome),
    /// Who controls.
    Role(RoleMessage),
    /// What there is to choose from.
    Catalogue(Catalogue),
    /// The scene as it is now.
    Scene(SceneMessage),
    /// The surface of a body.
    Surface(SurfaceMessage),
    /// Where everything is.
    Frame(FrameMessage),
    /// Something to know.
    Notice(Notice),
    /// A command that was not carried out.
    Refusal(Refusal),
    /// A file that was asked for.
    File(FileMessage),
}

/// Who serves, and what one may do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Welcome {
    /// [`VERSION`](super::VERSION) of the session.
    pub version: u32,
    /// Name and version of the program.
    pub program: String,
    /// `native` or `wasm`.
    pub engine: String,
    /// Tells runs of the program apart.
    pub session: u64,
    /// What the connection may do.
    pub role: Role,
    /// Threads that steps may use.
    pub threads: usize,
}

/// What a connection may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Give commands.
    Controller,
    /// Look on.
    Watcher,
}

/// What the connection may do from now on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct RoleMessage {
    /// Its role.
    pub role: Role,
    /// How many connections there are.
    pub clients: usize,
}

/// Something to know.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Notice {
    /// How grave it is.
    pub level: Level,
    /// What happened, in a sentence.
    pub text: String,
    /// What to do; may be empty.
    pub help: String,
}

/// How grave a notice is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// Good to know.
    Info,
    /// Something is other than it was asked for.
    Warning,
    /// The simulation stopped.
    Error,
}

/// Why a command was not carried out. Nothing has changed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Refusal {
    /// Its type; empty where that could not be read.
    pub command: String,
    /// Why.
    pub reason: String,
    /// How to mend it; may be empty.
    pub help: String,
    /// The parameter that it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// Number that the page gave the command.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub request: Option<u64>,
    /// Where in a text something is wrong.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub excerpt: Option<Excerpt>,
}

/// A line of a text with something wrong in it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Excerpt {
    /// Name of the text.
    pub source: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
    /// The line.
    pub text: String,
    /// How many characters are meant.
    pub length: usize,
}

/// A file that was asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct FileMessage {
    /// What is in it.
    pub purpose: Purpose,
    /// What to call it.
    pub name: String,
    /// Media type.
    pub mime: String,
    /// Its bytes.
    pub bytes: Bytes,
    /// Number that the page gave the command.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub request: Option<u64>,
}

/// What is in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// Observables over time.
    Observables,
    /// The state of a moment.
    State,
    /// The scene.
    Scene,
    /// What was done, to be played again.
    Recording,
}
