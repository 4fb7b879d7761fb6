//! A page that is served, as far as it costs time: surfaces over a socket, 60 times a second.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::time::Duration;

use viscera::math::Scalar;
use viscera::world::World;

use crate::failure::Failure;

/// From one frame to the next.
const FRAME: Duration = Duration::from_micros(16_667);

/// Sends frames to a reader on the same machine. One that is not ready for a frame does without it.
pub(super) struct Viewer {
    frames: SyncSender<Vec<u8>>,
    next: Duration,
}

impl Viewer {
    pub(super) fn connect() -> Result<Self, Failure> {
        let connect = || {
            let listener = TcpListener::bind(("127.0.0.1", 0))?;
            let there = TcpStream::connect(listener.local_addr()?)?;
            let (here, _) = listener.accept()?;
            Ok((here, there))
        };
        let (mut here, mut there) = connect().map_err(|error: std::io::Error| {
            Failure::problem(format!("a socket on this machine cannot be opened: {error}"))
        })?;
        let (frames, waiting) = sync_channel::<Vec<u8>>(1);
        // Both end when the viewer is dropped: the first with the frames, the second with the socket.
        std::thread::spawn(move || {
            for frame in waiting {
                if here.write_all(&frame).is_err() {
                    return;
                }
            }
        });
        std::thread::spawn(move || {
            let mut memory = vec![0; 1 << 16];
            while there.read(&mut memory).is_ok_and(|count| count > 0) {}
        });
        Ok(Self { frames, next: Duration::ZERO })
    }

    /// Sends the surfaces of all bodies, if a frame is due at this time of the run.
    pub(super) fn show<T: Scalar>(&mut self, world: &World<T>, time: Duration) {
        if time < self.next {
            return;
        }
        self.next = time + FRAME;
        let mut frame = Vec::new();
        for id in world.body_ids() {
            let body = world.body(id);
            for x in body.positions() {
                let place = x.cast::<f32>().to_array();
                frame.extend(place.iter().flat_map(|number| number.to_le_bytes()));
            }
            for triangle in body.surface() {
                frame.extend(triangle.nodes.iter().flat_map(|node| node.to_le_bytes()));
            }
        }
        // A reader that is slow, or gone, gets this frame not.
        if let Err(TrySendError::Full(frame) | TrySendError::Disconnected(frame)) = self.frames.try_send(frame) {
            drop(frame);
        }
    }
}
