//! A page that looks on: the browser's end of a served session, without the browser.

use std::net::{Shutdown, SocketAddr, TcpStream};
use std::thread::JoinHandle;

use tokio_tungstenite::tungstenite::{Error, Message, WebSocket, client};
use viscera_io::grouped;
use viscera_session::message::{Answer, Command, FrameMessage, Request, RunState, VERSION};

use crate::failure::Failure;

/// A connection that takes what a page would take, and begins the scene anew when a round is over or a step was refused.
pub(super) struct Page {
    stream: TcpStream,
    thread: JoinHandle<(Taken, Error)>,
}

/// What a page was given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Taken {
    frames: u64,
    surfaces: u64,
    bytes: u64,
    /// Of the largest surface.
    triangles: usize,
    rounds: u64,
}

impl Page {
    /// Connects to a server. A round of the scene lasts `round` [s] of simulated time.
    pub(super) fn open(address: SocketAddr, round: f64) -> Result<Self, Failure> {
        let lost = |what: &dyn std::fmt::Display| Failure::problem(format!("the page cannot reach the server: {what}"));
        let stream = TcpStream::connect(address).map_err(|error| lost(&error))?;
        let own = stream.try_clone().map_err(|error| lost(&error))?;
        let (mut socket, _) = client(format!("ws://{address}/ws"), own).map_err(|error| lost(&error))?;
        say(&mut socket, Command::Hello { version: VERSION, client: Some("bench".into()) })
            .map_err(|error| lost(&error))?;
        let thread = std::thread::spawn(move || {
            let mut taken = Taken::default();
            // It has no other end.
            let Err(error) = taken.look_on(&mut socket, round);
            (taken, error)
        });
        Ok(Self { stream, thread })
    }

    /// Whether the connection has come to its end.
    pub(super) fn is_closed(&self) -> bool {
        self.thread.is_finished()
    }

    /// Leaves, and says what was taken until then.
    ///
    /// # Errors
    /// Where the connection was lost before, or there never was a frame.
    pub(super) fn close(self) -> Result<Taken, Failure> {
        let was_lost = self.is_closed();
        // One that is closed already needs no closing.
        let _ = self.stream.shutdown(Shutdown::Both);
        match self.thread.join() {
            Ok((_, error)) if was_lost => Err(Failure::problem(format!("the page lost its connection: {error}"))),
            Ok((taken, _)) if taken.frames == 0 => Err(Failure::problem("the page was given no frame")),
            Ok((taken, _)) => Ok(taken),
            Err(_) => Err(Failure::problem("the page came to a bad end; its message stands above")),
        }
    }
}

fn say(socket: &mut WebSocket<TcpStream>, command: Command) -> Result<(), Error> {
    socket.send(Message::Binary(Request::from(command).encode().into()))
}

impl Taken {
    /// Takes all that comes, as a page does, until the connection ends.
    fn look_on(&mut self, socket: &mut WebSocket<TcpStream>, round: f64) -> Result<std::convert::Infallible, Error> {
        let mut begins_anew = false;
        loop {
            let Message::Binary(bytes) = socket.read()? else { continue };
            self.bytes += bytes.len() as u64;
            match Answer::decode(&bytes) {
                Ok(Answer::Surface(surface)) => {
                    self.surfaces += 1;
                    self.triangles = self.triangles.max(surface.triangles.0.len() / 3);
                }
                Ok(Answer::Frame(frame)) => {
                    self.frames += 1;
                    let over = is_over(&frame, round);
                    if over && !begins_anew {
                        self.rounds += 1;
                        say(socket, Command::Reset {})?;
                        say(socket, Command::Play {})?;
                    }
                    begins_anew = over;
                }
                _ => {}
            }
        }
    }

    /// What was served, in `seconds` [s].
    pub(super) fn in_words(&self, seconds: f64) -> String {
        let Self { frames, surfaces, bytes, triangles, rounds } = *self;
        format!(
            "served to 1 client: {} frames ({:.1} a second), {} surfaces of up to {} triangles, {:.1} MB ({:.2} MB/s); the scene began anew {} times",
            grouped(frames as usize),
            frames as f64 / seconds,
            grouped(surfaces as usize),
            grouped(triangles),
            bytes as f64 / 1e6,
            bytes as f64 / 1e6 / seconds,
            rounds
        )
    }
}

/// Whether a round is over, or cannot go on.
fn is_over(frame: &FrameMessage, round: f64) -> bool {
    frame.time >= round || frame.state == RunState::Stopped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_served_is_told_with_frames_bytes_and_clients() {
        let taken = Taken { frames: 1200, surfaces: 31, bytes: 45_000_000, triangles: 2468, rounds: 2 };
        assert_eq!(
            taken.in_words(20.0),
            "served to 1 client: 1 200 frames (60.0 a second), 31 surfaces of up to 2 468 triangles, 45.0 MB (2.25 MB/s); \
             the scene began anew 2 times"
        );
    }
}
