//! A Viscera world being played: commands in, frames out, whatever carries them.
//!
//! [`Session`] knows no transport, no thread and no clock: whoever carries its messages says how much time has passed, so that the
//! same session runs behind a socket and in a page's worker. `docs/protocol.md` describes the messages ([`message`]).

mod catalogue;
mod clock;
mod dropped;
mod export;
pub mod library;
pub mod message;
mod parameter;
pub mod recording;
mod refuse;
mod session;
mod simulation;

pub use session::{Picture, Seen, Session};
