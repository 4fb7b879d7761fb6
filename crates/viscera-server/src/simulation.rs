//! The thread on which the session lives.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::time::{Duration, Instant};

use tokio::sync::{OwnedSemaphorePermit, Semaphore, broadcast, watch};
use viscera_session::message::{Answer, LONGEST_SHORT};
use viscera_session::{Picture, Session};

use crate::connection::LONGEST_MESSAGE;
use crate::haptics::Reins;
use crate::room::Room;

/// Time from one picture to the next.
const FRAME: Duration = Duration::from_micros(16_667);
/// How often somebody who waits for nothing looks up.
const IDLE: Duration = Duration::from_millis(100);
/// Commands that wait for the thread; whoever sends more waits too.
const WAITING: usize = 64;
/// The most bytes of commands that wait for the thread, all together: one of the longest, and the others short.
const WAITING_BYTES: usize = LONGEST_MESSAGE + WAITING * LONGEST_SHORT;
/// Their space is given away in pieces of so many bytes.
const PIECE: usize = 1 << 10;
/// How soon a command that found no room is offered again.
const AGAIN: Duration = Duration::from_millis(2);
/// Answers that wait for a slow connection; what is older is lost to it.
const ANSWERS: usize = 256;

/// Whom an answer is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Audience {
    Controller,
    Everybody,
}

/// An answer as it goes out.
#[derive(Clone, Debug)]
pub(crate) struct Outgoing {
    pub(crate) audience: Audience,
    pub(crate) bytes: Arc<[u8]>,
}

/// A command that waits for the thread, and the space that it takes.
struct Waiting {
    bytes: Vec<u8>,
    _space: OwnedSemaphorePermit,
}

/// The ways to the thread and back.
#[derive(Clone)]
pub(crate) struct Stage {
    commands: SyncSender<Waiting>,
    space: Arc<Semaphore>,
    pub(crate) pictures: watch::Receiver<Option<Picture>>,
    pub(crate) answers: broadcast::Sender<Outgoing>,
    pub(crate) catalogue: Arc<[u8]>,
    pub(crate) threads: usize,
}

impl Stage {
    /// Starts the thread, which leads an instrument by `reins` if there are some. It ends when nobody can send commands any more.
    pub(crate) fn start(session: Session, room: Room, reins: Option<Reins>) -> std::io::Result<Self> {
        let (commands, received) = sync_channel(WAITING);
        let (show, pictures) = watch::channel(None);
        let answers = broadcast::Sender::new(ANSWERS);
        let (catalogue, threads) = (session.catalogue(), session.threads());
        let player = Player { session, received, show, answers: answers.clone(), room, reins };
        std::thread::Builder::new().name("simulation".into()).spawn(move || player.run())?;
        let space = Arc::new(Semaphore::new(WAITING_BYTES / PIECE));
        Ok(Self { commands, space, pictures, answers, catalogue, threads })
    }

    /// Hands a command to the thread, when it has room for one; gives whether the thread is still there.
    pub(crate) async fn send(&self, bytes: Vec<u8>) -> bool {
        // What is longer than all of the space would wait for ever; connections read nothing so long.
        let pieces = bytes.len().div_ceil(PIECE).min(WAITING_BYTES / PIECE) as u32;
        let Ok(space) = Arc::clone(&self.space).acquire_many_owned(pieces).await else { return false };
        let mut command = Waiting { bytes, _space: space };
        loop {
            match self.commands.try_send(command) {
                Ok(()) => return true,
                Err(TrySendError::Disconnected(_)) => return false,
                Err(TrySendError::Full(back)) => command = back,
            }
            // The thread takes all that wait between two steps.
            tokio::time::sleep(AGAIN).await;
        }
    }
}

struct Player {
    session: Session,
    received: Receiver<Waiting>,
    show: watch::Sender<Option<Picture>>,
    answers: broadcast::Sender<Outgoing>,
    room: Room,
    reins: Option<Reins>,
}

impl Player {
    fn run(mut self) {
        let mut before = Instant::now();
        let mut next_picture = before;
        loop {
            let now = Instant::now();
            // Nobody looks on, nobody feels: time stands still.
            if self.is_anybody_there() {
                self.session.elapse((now - before).as_secs_f64());
            }
            before = now;
            while self.work() && Instant::now() < now + FRAME {
                self.take_waiting_commands();
            }
            self.session.give_up();
            self.answer();
            if Instant::now() >= next_picture {
                if let Some(picture) = self.session.picture() {
                    self.show.send_replace(Some(picture));
                }
                // Evenly, but not faster to make up for what came late.
                next_picture = (next_picture + FRAME).max(Instant::now());
            }
            if !self.wait(next_picture) {
                return;
            }
        }
    }

    fn is_anybody_there(&self) -> bool {
        !self.room.is_empty() || self.reins.as_ref().is_some_and(Reins::is_held)
    }

    /// Does what is due, with the instrument where the hand is; gives whether there may be more to do.
    fn work(&mut self) -> bool {
        let Some(reins) = self.reins.as_mut().filter(|_| self.session.is_step_due()) else {
            return self.session.work();
        };
        let told = reins.lead(&mut self.session);
        let before = Instant::now();
        let more = self.session.work();
        reins.answer(&self.session, before.elapsed());
        if let Some(notice) = told {
            self.say(&Answer::Notice(notice));
        }
        more
    }

    fn take_waiting_commands(&mut self) {
        while let Ok(command) = self.received.try_recv() {
            self.session.receive(&command.bytes);
        }
    }

    /// Waits for a command, a step or a picture, whichever comes first; gives whether anybody can still send commands.
    fn wait(&mut self, next_picture: Instant) -> bool {
        let until_picture = next_picture.saturating_duration_since(Instant::now());
        let pause = match self.session.time_to_next_step() {
            _ if !self.is_anybody_there() => IDLE,
            Some(due) => until_picture.min(Duration::from_secs_f64(due.min(1.0))),
            None => until_picture.max(Duration::from_millis(1)),
        };
        match self.received.recv_timeout(pause) {
            Err(RecvTimeoutError::Disconnected) => return false,
            Ok(command) => self.session.receive(&command.bytes),
            Err(RecvTimeoutError::Timeout) => {}
        }
        self.take_waiting_commands();
        true
    }

    fn answer(&mut self) {
        for answer in self.session.take_answers() {
            self.say(&answer);
        }
    }

    fn say(&self, answer: &Answer) {
        let audience = match answer {
            Answer::Refusal(_) | Answer::File(_) => Audience::Controller,
            _ => Audience::Everybody,
        };
        // Nobody may be listening.
        let _ = self.answers.send(Outgoing { audience, bytes: answer.encode().into() });
    }
}

#[cfg(test)]
mod tests {
    use tokio::time::timeout;

    use super::*;

    /// Two messages of the longest do not wait side by side: the second one comes when the first is taken, and with short ones it is the
    /// number that counts.
    #[test]
    fn what_waits_for_the_simulation_is_bounded_in_bytes() {
        let (commands, received) = sync_channel(WAITING);
        let stage = Stage {
            commands,
            space: Arc::new(Semaphore::new(WAITING_BYTES / PIECE)),
            pictures: watch::channel(None).1,
            answers: broadcast::Sender::new(1),
            catalogue: Arc::from([]),
            threads: 1,
        };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            assert!(stage.send(vec![0; LONGEST_MESSAGE]).await);
            assert!(stage.send(vec![0; LONGEST_SHORT]).await, "short ones find room beside it");
            let soon = Duration::from_millis(20);
            assert!(timeout(soon, stage.send(vec![0; LONGEST_MESSAGE])).await.is_err(), "another long one waits");
            drop((received.recv().unwrap(), received.recv().unwrap()));
            assert!(stage.send(vec![0; LONGEST_MESSAGE]).await);
            drop(received);
            assert!(!stage.send(Vec::new()).await, "nobody takes any more");
        });
    }
}
