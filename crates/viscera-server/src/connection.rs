//! One connection: what comes in goes to the session, if it may; what is new goes out, the newest only.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message, WebSocket};
use tokio::sync::broadcast::error::RecvError;
use tokio::time::timeout;
use viscera_session::Seen;
use viscera_session::message::{Answer, Command, LONGEST, Refusal, Request, Role, RoleMessage, VERSION, Welcome};

use crate::room::{Room, Seat};
use crate::simulation::{Audience, Outgoing, Stage};

/// How long a connection may take to say hello.
const GREETING: Duration = Duration::from_secs(10);
/// How long a connection may take to accept a message, before it counts as lost.
const PATIENCE: Duration = Duration::from_secs(20);

/// RFC 6455, section 7.4.1: against the rules of the server.
const POLICY: u16 = 1008;

/// What every connection knows.
#[derive(Clone)]
pub(crate) struct House {
    pub(crate) stage: Stage,
    pub(crate) room: Room,
    /// Tells runs of the program apart.
    pub(crate) number: u64,
}

/// The connection is lost, or was closed.
struct Gone;

/// Serves a connection until it ends.
pub(crate) async fn serve(mut socket: WebSocket, house: House) {
    if greet(&mut socket).await.is_err() {
        return;
    }
    let guest = Guest { seat: house.room.enter(), stage: house.stage, socket, seen: Seen::default() };
    // However it ended, there is nobody left to tell.
    let _ = guest.stay(house.number).await;
}

/// Hears a hello of the right version, or closes with the reason.
async fn greet(socket: &mut WebSocket) -> Result<(), Gone> {
    let hello = async {
        while let Some(Ok(message)) = socket.recv().await {
            match message {
                Message::Binary(bytes) => return Ok(bytes),
                Message::Text(_) => return Err("messages are binary"),
                Message::Close(_) => break,
                Message::Ping(_) | Message::Pong(_) => {}
            }
        }
        Err("")
    };
    let wrong = match timeout(GREETING, hello).await {
        Err(_) => "no hello came in time".to_owned(),
        Ok(Err(text)) => text.to_owned(),
        Ok(Ok(bytes)) => match Request::decode(&bytes).map(|request| request.command) {
            Ok(Command::Hello { version: VERSION, .. }) => return Ok(()),
            Ok(Command::Hello { version, .. }) => {
                format!("the page speaks version {version}, this program version {VERSION}: load the page again")
            }
            Ok(_) => "the first message has to be hello".into(),
            Err(refusal) => refusal.reason,
        },
    };
    // A close frame holds 123 bytes.
    let reason: String = wrong.chars().take(100).collect();
    let reason = reason.chars().map(|letter| if letter.is_ascii() { letter } else { '?' }).collect::<String>();
    let _ = socket.send(Message::Close(Some(CloseFrame { code: POLICY, reason: reason.into() }))).await;
    Err(Gone)
}

/// Somebody who is connected and has said hello.
struct Guest {
    seat: Seat,
    stage: Stage,
    socket: WebSocket,
    seen: Seen,
}

impl Guest {
    async fn stay(mut self, number: u64) -> Result<(), Gone> {
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
        loop {
            tokio::select! {
                message = self.socket.recv() => self.hear(message).await?,
                changed = changes.changed() => {
                    changed.map_err(|_| Gone)?;
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
                    Err(RecvError::Closed) => return Err(Gone),
                },
                changed = pictures.changed() => {
                    changed.map_err(|_| Gone)?;
                    self.show(&mut pictures).await?;
                }
            }
        }
    }

    /// Sends what is new in the newest picture; those that came and went meanwhile are never sent.
    async fn show(
        &mut self,
        pictures: &mut tokio::sync::watch::Receiver<Option<viscera_session::Picture>>,
    ) -> Result<(), Gone> {
        let picture = pictures.borrow_and_update().clone();
        for part in picture.map(|picture| picture.parts_for(&mut self.seen)).unwrap_or_default() {
            self.send(part).await?;
        }
        Ok(())
    }

    async fn hear(&mut self, message: Option<Result<Message, axum::Error>>) -> Result<(), Gone> {
        let bytes = match message {
            Some(Ok(Message::Binary(bytes))) => bytes,
            Some(Ok(Message::Text(_))) => return self.refuse("", None, "messages are binary MessagePack").await,
            Some(Ok(Message::Ping(_) | Message::Pong(_))) => return Ok(()),
            Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(Gone),
        };
        if self.seat.role().0 == Role::Watcher {
            let request = Request::decode(&bytes).ok().and_then(|request| request.request);
            return self
                .refuse("", request, "another page controls the simulation; this one watches until that leaves")
                .await;
        }
        if self.stage.send(bytes.into()).await { Ok(()) } else { Err(Gone) }
    }

    async fn refuse(&mut self, command: &str, request: Option<u64>, reason: &str) -> Result<(), Gone> {
        let refusal = Refusal { command: command.into(), reason: reason.into(), request, ..Refusal::default() };
        self.send(Answer::Refusal(refusal).encode().into()).await
    }

    async fn send(&mut self, bytes: Arc<[u8]>) -> Result<(), Gone> {
        let message = Message::Binary(Bytes::from_owner(bytes));
        timeout(PATIENCE, self.socket.send(message)).await.map_err(|_| Gone)?.map_err(|_| Gone)
    }
}

/// The longest message that is read at all.
pub(crate) const LONGEST_MESSAGE: usize = LONGEST + 1024;
