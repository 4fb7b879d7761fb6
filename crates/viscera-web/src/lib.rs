//! Viscera's session as WebAssembly: the same messages as over a socket, bytes in and bytes out, for a worker of a page.
//! `docs/protocol.md` says how the page uses it; `web/build-engine.sh` builds it.

use js_sys::{Array, Date, Uint8Array};
use viscera::executor::Executor;
use viscera_session::Seen;
use viscera_session::message::{Answer, Command, Request, Role, VERSION, Welcome};
use wasm_bindgen::prelude::wasm_bindgen;

/// A session, and what its only page has been shown.
#[wasm_bindgen]
pub struct Session {
    session: viscera_session::Session,
    seen: Seen,
    /// Answers of this module, before those of the session.
    answers: Vec<Vec<u8>>,
    number: u64,
}

#[wasm_bindgen]
impl Session {
    /// A session with the first of the scenes that are built in, at play.
    #[wasm_bindgen(constructor)]
    #[allow(clippy::new_without_default, reason = "JavaScript knows no default")]
    pub fn new() -> Self {
        let mut session = viscera_session::Session::new(Executor::serial());
        session.handle(Request::from(Command::Play {}));
        Self { session, seen: Seen::default(), answers: Vec::new(), number: Date::now() as u64 }
    }

    /// Takes a command.
    pub fn receive(&mut self, bytes: &[u8]) {
        if let Ok(Request { command: Command::Hello { version: VERSION, .. }, .. }) = Request::decode(bytes) {
            return self.welcome();
        }
        self.session.receive(bytes);
    }

    /// So many seconds have passed: makes the steps that are due, for about `budget` seconds at most.
    pub fn advance(&mut self, elapsed: f64, budget: f64) {
        let start = Date::now();
        self.session.elapse(elapsed);
        while self.session.work() && Date::now() - start < 1000.0 * budget {}
        self.session.give_up();
    }

    /// All answers since the last call, in order.
    pub fn messages(&mut self) -> Array {
        let own = std::mem::take(&mut self.answers);
        let of_session = self.session.take_answers();
        let all = own.into_iter().chain(of_session.iter().map(Answer::encode));
        all.map(|bytes| Uint8Array::from(bytes.as_slice())).collect()
    }

    /// What is new to be seen, in order; empty where nothing is.
    pub fn frame(&mut self) -> Array {
        let parts = self.session.picture().map(|picture| picture.parts_for(&mut self.seen)).unwrap_or_default();
        parts.iter().map(|bytes| Uint8Array::from(&**bytes)).collect()
    }

    /// Answers a hello: the page has seen nothing yet.
    fn welcome(&mut self) {
        let welcome = Welcome {
            version: VERSION,
            program: concat!("viscera ", env!("CARGO_PKG_VERSION")).into(),
            engine: "wasm".into(),
            session: self.number,
            role: Role::Controller,
            threads: self.session.threads(),
        };
        self.answers.push(Answer::Welcome(welcome).encode());
        self.answers.push(self.session.catalogue().to_vec());
        self.seen = Seen::default();
        self.session.look_again();
    }
}
