//! A session of Viscera behind a WebSocket, and the page that drives it.
//!
//! [`Server::start`] binds to an address and serves the page at `/` and the session at `/ws`. The simulation runs on a thread of its
//! own; connections share its pictures, and each shows the newest when it has shown the last. `docs/protocol.md` describes the
//! messages. With [`Server::start_with`] a haptic device leads an instrument, and its hand feels the tissue.

mod connection;
mod guard;
mod haptics;
mod page;
mod room;
mod server;
mod simulation;

pub use haptics::{Haptics, HapticsError, HapticsReport, StepTimes, instrument_for_a_hand};
pub use server::{ServeError, Server, Settings};
