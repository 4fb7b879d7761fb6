mod commands;
mod hand;
mod picture;
mod replay;
mod steps;

pub use picture::{Picture, Seen};

use std::sync::Arc;

use viscera::executor::Executor;

use crate::catalogue::catalogue;
use crate::clock::Clock;
use crate::export::History;
use crate::library;
use crate::message::{Answer, Level, Notice, Refusal, Request, RunState, SLOTS, Value};
use crate::refuse;
use crate::simulation::colour::Colouring;
use crate::simulation::{Kept, Play};
use hand::InHand;
use picture::Gallery;
use replay::{Recorder, Replayer};

/// A world being played: commands in ([`Session::receive`]), answers ([`Session::take_answers`]) and pictures
/// ([`Session::picture`]) out. Time passes when the caller says so ([`Session::elapse`]), and steps are made when it calls
/// [`Session::work`].
///
/// ```
/// use viscera::executor::Executor;
/// use viscera_session::message::Command;
/// use viscera_session::{Seen, Session};
///
/// let mut session = Session::new(Executor::serial());
/// session.receive(&viscera_session::message::Request::from(Command::Step { count: 3 }).encode());
/// while session.work() {}
/// // What a page that has seen nothing yet has to hear: the scene, surfaces, a frame.
/// let picture = session.picture().expect("something is new");
/// assert_eq!(picture.parts_for(&mut Seen::default()).len(), 3);
/// ```
pub struct Session {
    executor: Executor,
    catalogue: Arc<[u8]>,
    play: Play,
    state: RunState,
    clock: Clock,
    /// Steps that were asked for one by one.
    asked: u32,
    /// Changes of parameters that were not made yet: of those of one key, which a slider sends by the dozen, the last.
    pending: Vec<(String, Value, Option<u64>)>,
    colouring: Colouring,
    slots: [Option<Kept>; SLOTS],
    recorder: Option<Recorder>,
    replayer: Option<Replayer>,
    in_hand: Option<InHand>,
    history: History,
    answers: Vec<Answer>,
    gallery: Gallery,
    /// The last command carried out or refused that had a number.
    last_request: Option<u64>,
}

impl Session {
    /// A session with the first of the scenes that are built in, on the threads of `executor`. It is paused.
    ///
    /// # Panics
    /// Where that scene cannot be built, which the tests exclude.
    pub fn new(executor: Executor) -> Self {
        let scene = library::scene(library::FIRST).and_then(Result::ok);
        let play = scene.and_then(|scene| Play::open(library::FIRST, &scene).ok());
        let (play, _) = play.expect("the first scene is built in and tested");
        Self {
            executor,
            catalogue: Answer::Catalogue(catalogue()).encode().into(),
            play,
            state: RunState::Paused,
            clock: Clock::default(),
            asked: 0,
            pending: Vec::new(),
            colouring: Colouring::None,
            slots: Default::default(),
            recorder: None,
            replayer: None,
            in_hand: None,
            history: History::default(),
            answers: Vec::new(),
            gallery: Gallery::default(),
            last_request: None,
        }
    }

    /// The catalogue, as a page hears it once.
    pub fn catalogue(&self) -> Arc<[u8]> {
        Arc::clone(&self.catalogue)
    }

    /// Threads that steps may use.
    pub fn threads(&self) -> usize {
        self.executor.thread_count()
    }

    /// Takes a command. What is malformed or cannot be done is answered by a refusal, and nothing changes.
    pub fn receive(&mut self, bytes: &[u8]) {
        match Request::decode(bytes) {
            Ok(request) => self.handle(request),
            Err(refusal) => self.refuse(*refusal),
        }
    }

    /// Takes a command that was read already.
    pub fn handle(&mut self, Request { command, request }: Request) {
        self.last_request = request.or(self.last_request);
        let name = command.name();
        let done = match self.held_by_another(&command) {
            Some(refusal) => Err(refusal),
            None => self.carry_out(command, request),
        };
        if let Err(refusal) = done {
            self.refuse(Refusal { command: name.into(), request, ..*refusal });
        }
    }

    /// Opens a scene that was read by the caller, such as one from a file.
    ///
    /// # Errors
    /// What is wrong with it, with its line.
    pub fn open(&mut self, name: &str, scene: &viscera_scene::Scene) -> Result<(), Box<Refusal>> {
        let (play, notices) = Play::open(name, scene)?;
        self.begin(play, notices);
        Ok(())
    }

    /// What there is to answer since the last call, in order.
    pub fn take_answers(&mut self) -> Vec<Answer> {
        self.make_pending_changes();
        std::mem::take(&mut self.answers)
    }

    /// Makes the changes of parameters that wait.
    fn make_pending_changes(&mut self) {
        for (key, value, request) in std::mem::take(&mut self.pending) {
            if let Err(refusal) = self.change(&key, &value) {
                self.refuse(Refusal { command: "set".into(), request, key: Some(key), ..*refusal });
            }
        }
    }

    fn refuse(&mut self, refusal: Refusal) {
        self.gallery.touch();
        self.answers.push(Answer::Refusal(refusal));
    }

    fn notify(&mut self, level: Level, text: impl Into<String>, help: impl Into<String>) {
        self.answers.push(Answer::Notice(Notice { level, text: text.into(), help: help.into() }));
    }

    /// Puts a scene that was opened in the place of the present one.
    fn begin(&mut self, play: Play, notices: Vec<String>) {
        if self.recorder.take().is_some() {
            self.notify(Level::Warning, "the recording ended with its scene and was not kept", "");
        }
        self.play = play;
        self.in_hand = None;
        self.slots = Default::default();
        self.history.clear();
        self.clock.forgive();
        self.asked = 0;
        self.gallery.new_epoch();
        if self.state == RunState::Stopped {
            self.state = RunState::Running;
        }
        for notice in notices {
            self.notify(Level::Info, notice, "");
        }
    }

    /// The number of an epoch begins when bodies are others than before.
    fn restarted(&mut self) {
        self.history.clear();
        self.clock.forgive();
        self.gallery.new_epoch();
        if self.state == RunState::Stopped {
            self.state = RunState::Paused;
        }
    }
}

/// A refusal of what a replay does not bear.
fn while_replaying() -> Box<Refusal> {
    refuse::with_help("a recording is being replayed", "`stop-replay` ends it where it is")
}
