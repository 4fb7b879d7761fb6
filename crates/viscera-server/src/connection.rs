//! One connection: what comes in goes to the session, if it may; what is new goes out, the newest only.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message, WebSocket};
use serde::Deserialize;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{MissedTickBehavior, interval, sleep, timeout};
use viscera_session::Seen;
use viscera_session::message::{
    Answer, Command, LONGEST, LONGEST_SHORT, Refusal, Request, Role, RoleMessage, VERSION, Welcome,
};

use crate::room::{Room, Seat};
use crate::simulation::{Audience, Outgoing, Stage};

/// How long a connection may take to say hello.
const GREETING: Duration = Duration::from_secs(10);
/// How long a connection may take to accept a message, before it counts as lost.
const PATIENCE: Duration = Duration::from_secs(20);

/// How many pings in a row may stay unanswered before a connection counts as lost.
const UNANSWERED: u32 = 3;
/// How long a connection that was closed stays open for the other side to read why: with bytes unread, its end would be a reset, which
/// may overtake the reason.
const FAREWELL: Duration = Duration::from_secs(1);

/// RFC 6455, section 7.4.1: against the rules of the server.
const POLICY: u16 = 1008;
/// RFC 6455, section 7.4.1: a message that is too long.
const TOO_LONG: u16 = 1009;

/// What every connection knows.
#[derive(Clone)]
pub(crate) struct House {
    pub(crate) stage: Stage,
    pub(crate) room: Room,
    /// Tells runs of the program apart.
    pub(crate) number: u64,
    /// Time from one ping to the next.
    pub(crate) ping: Duration,
}

/// How a connection ends.
enum Parting {
    /// It is lost, or the other side has closed it.
    Gone,
    /// The server closes it, and says why.
    Shown { code: u16, reason: String },
}

impl Parting {
    /// After a message that could not be read.
    fn after(error: &axum::Error) -> Self {
        // The error itself is of a crate that axum keeps to itself.
        if error.to_string().contains("Message too long") {
            let reason = format!("a message has at most {} MiB", LONGEST >> 20);
            return Self::Shown { code: TOO_LONG, reason };
        }
        Self::Gone
    }

    /// Says why, if there is something to say.
    async fn tell(self, mut socket: WebSocket) {
        let Self::Shown { code, reason } = self else { return };
        // A close frame holds 123 bytes.
        let reason: String = reason.chars().take(100).collect();
        let reason = reason.chars().map(|letter| if letter.is_ascii() { letter } else { '?' }).collect::<String>();
        let close = Message::Close(Some(CloseFrame { code, reason: reason.into() }));
        if matches!(timeout(FAREWELL, socket.send(close)).await, Ok(Ok(()))) {
            sleep(FAREWELL).await;
        }
    }
}

/// Serves a connection until it ends.
pub(crate) async fn serve(mut socket: WebSocket, house: House) {
    let parting = match greet(&mut socket).await {
        Err(parting) => parting,
        Ok(()) => {
            let guest =
                Guest { seat: house.room.enter(), stage: house.stage, socket: &mut socket, seen: Seen::default() };
            // The seat is free again when this is over, before the reason is told.
            let Err(parting) = guest.stay(house.number, house.ping).await;
            parting
        }
    };
    parting.tell(socket).await;
}

/// Hears a hello of the right version.
async fn greet(socket: &mut WebSocket) -> Result<(), Parting> {
    let hello = async {
        loop {
            match socket.recv().await {
                Some(Ok(Message::Binary(bytes))) => return Ok(bytes),
                Some(Ok(Message::Text(_))) => {
                    return Err(Parting::Shown { code: POLICY, reason: "messages are binary".into() });
                }
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                Some(Err(error)) => return Err(Parting::after(&error)),
                Some(Ok(Message::Close(_))) | None => return Err(Parting::Gone),
            }
        }
    };
    let reason = match timeout(GREETING, hello).await {
        Err(_) => "no hello came in time".to_owned(),
        Ok(Err(parting)) => return Err(parting),
        // Longer ones are not even decoded.
        Ok(Ok(bytes)) if bytes.len() > LONGEST_SHORT => {
            let reason = format!("the first message has to be hello, of at most {} KiB", LONGEST_SHORT >> 10);
            return Err(Parting::Shown { code: TOO_LONG, reason });
        }
        Ok(Ok(bytes)) => match Request::decode(&bytes).map(|request| request.command) {
            Ok(Command::Hello { version: VERSION, .. }) => return Ok(()),
            Ok(Command::Hello { version, .. }) => {
                format!("the page speaks version {version}, this program version {VERSION}: load the page again")
            }
            Ok(_) => "the first message has to be hello".into(),
            Err(refusal) => refusal.reason,
        },
    };
    Err(Parting::Shown { code: POLICY, reason })
}

/// Somebody who is connected and has said hello.
struct Guest<'a> {
    seat: Seat,
    stage: Stage,
    socket: &'a mut WebSocket,
    seen: Seen,
}

/// All of a command that a refusal needs.
#[derive(Deserialize)]
struct Numbered {
    request: Option<u64>,
}

impl Guest<'_> {
    async fn stay(mut self, number: u64, ping: Duration) -> Result<Infallible, Parting> {
        let mut answers = self.stage.answers.subscribe();
        let mut pictures = self.stage.pictures.clone();
        let mut changes = self.seat.changes.clone();
        let (mut role, mut clients) = self.seat.role();
        let welcome = Welcome {
            version: VERSION,
            program: concat!("viscera ", env!("CARGO_PKG_VERSION")).into(),
            engine: "native".into(),
            session: number,
            role,
            threads: self.stage.threads,
        };
        self.send(Answer::Welcome(welcome).encode().into()).await?;
        self.send(Arc::clone(&self.stage.catalogue)).await?;
        self.show(&mut pictures).await?;
        let (mut pulse, mut unanswered) = (interval(ping), 0);
        // After a message that took long to send, a whole pause for answers that wait to be read.
        pulse.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                message = self.socket.recv() => {
                    unanswered = 0;
                    self.hear(message).await?;
                }
                _ = pulse.tick() => {
                    if unanswered == UNANSWERED {
                        return Err(Parting::Gone);
                    }
                    unanswered += 1;
                    self.send_message(Message::Ping(Bytes::new())).await?;
                }
                changed = changes.changed() => {
                    changed.map_err(|_| Parting::Gone)?;
                    if self.seat.role() != (role, clients) {
                        (role, clients) = self.seat.role();
                        self.send(Answer::Role(RoleMessage { role, clients }).encode().into()).await?;
                    }
                }
                answer = answers.recv() => match answer {
                    Ok(Outgoing { audience, bytes }) => {
                        if audience == Audience::Everybody || self.seat.role().0 == Role::Controller {
                            self.send(bytes).await?;
                        }
                    }
                    // It was too slow for some: what matters is in the scene.
                    Err(RecvError::Lagged(_)) => {}
                    Err(RecvError::Closed) => return Err(Parting::Gone),
                },
                changed = pictures.changed() => {
                    changed.map_err(|_| Parting::Gone)?;
                    self.show(&mut pictures).await?;
                }
            }
        }
    }

    /// Sends what is new in the newest picture; those that came and went meanwhile are never sent.
    async fn show(
        &mut self,
        pictures: &mut tokio::sync::watch::Receiver<Option<viscera_session::Picture>>,
    ) -> Result<(), Parting> {
        let picture = pictures.borrow_and_update().clone();
        for part in picture.map(|picture| picture.parts_for(&mut self.seen)).unwrap_or_default() {
            self.send(part).await?;
        }
        Ok(())
    }

    async fn hear(&mut self, message: Option<Result<Message, axum::Error>>) -> Result<(), Parting> {
        let bytes = match message {
            Some(Ok(Message::Binary(bytes))) => bytes,
            Some(Ok(Message::Text(_))) => return self.refuse("", None, "messages are binary MessagePack").await,
            Some(Ok(Message::Ping(_) | Message::Pong(_))) => return Ok(()),
            Some(Err(error)) => return Err(Parting::after(&error)),
            Some(Ok(Message::Close(_))) | None => return Err(Parting::Gone),
        };
        if self.seat.role().0 == Role::Watcher {
            // A mesh of 64 MiB is not read for somebody who only looks on.
            let request = rmp_serde::from_slice(&bytes).ok().and_then(|Numbered { request }| request);
            return self
                .refuse("", request, "another page controls the simulation; this one watches until that leaves")
                .await;
        }
        if self.stage.send(bytes.into()).await { Ok(()) } else { Err(Parting::Gone) }
    }

    async fn refuse(&mut self, command: &str, request: Option<u64>, reason: &str) -> Result<(), Parting> {
        let refusal = Refusal { command: command.into(), reason: reason.into(), request, ..Refusal::default() };
        self.send(Answer::Refusal(refusal).encode().into()).await
    }

    async fn send(&mut self, bytes: Arc<[u8]>) -> Result<(), Parting> {
        self.send_message(Message::Binary(Bytes::from_owner(bytes))).await
    }

    async fn send_message(&mut self, message: Message) -> Result<(), Parting> {
        timeout(PATIENCE, self.socket.send(message)).await.map_err(|_| Parting::Gone)?.map_err(|_| Parting::Gone)
    }
}

/// The longest message that is read at all.
pub(crate) const LONGEST_MESSAGE: usize = LONGEST + 1024;
