use viscera::executor::Executor;
use viscera_session::message::{
    Answer, Command, Export, FrameMessage, Refusal, Request, SceneMessage, SurfaceMessage, Value,
};
use viscera_session::{Seen, Session};

/// A bar of 2 × 2 × 6 cubes that is held at one end and bends under its weight: a few hundredths of a second to build.
pub(crate) const BAR: &str = r#"
title = "A bar"
duration = "1 s"
step = "10 ms"
integrator = { kind = "backward-euler" }

[body.bar]
mesh = { generate = "box", size = [0.04, 0.04, 0.12], cells = [2, 2, 6] }
density = 1000
damping = 5
law = { kind = "stable-neo-hookean", young = 20e3, poisson = 0.4 }
model = { kind = "total-lagrangian" }
fix = "z-min"
"#;

/// The same with so little gravity that it stays under the tools: its end sags by a millimetre.
pub(crate) fn light_bar() -> String {
    BAR.replace("[body.bar]", "gravity = [0, -0.1, 0]\n\n[body.bar]")
}

/// The same in explicit steps, of which the outer half moves and the half that is held follows, pre-computed.
pub(crate) fn hybrid_bar() -> String {
    let dynamic = "dynamic = { half-space = { point = [0, 0, 0.06], normal = [0, 0, 1] } }";
    BAR.replace("backward-euler", "explicit")
        .replace(r#"kind = "total-lagrangian""#, &format!(r#"kind = "hybrid", {dynamic}"#))
}

/// A page without a picture.
pub(crate) struct Page {
    pub(crate) session: Session,
    seen: Seen,
    pub(crate) scene: Option<SceneMessage>,
    pub(crate) surfaces: Vec<SurfaceMessage>,
    pub(crate) frame: Option<FrameMessage>,
    pub(crate) heard: Vec<Answer>,
}

impl Page {
    /// Opens a scene of its own.
    pub(crate) fn open(text: &str) -> Self {
        let mut page = Self {
            session: Session::new(Executor::serial()),
            seen: Seen::default(),
            scene: None,
            surfaces: Vec::new(),
            frame: None,
            heard: Vec::new(),
        };
        page.say(Command::OpenText { text: text.into(), name: Some("bar".into()) });
        assert_eq!(page.refusals(), [], "the scene opens");
        page
    }

    /// Says something, and hears what there is to hear.
    pub(crate) fn say(&mut self, command: Command) {
        self.session.receive(&Request::from(command).encode());
        self.listen();
    }

    /// Makes steps by hand.
    pub(crate) fn step(&mut self, count: u32) {
        self.say(Command::Step { count });
        while self.session.work() {}
        self.listen();
    }

    pub(crate) fn set(&mut self, key: &str, value: impl Into<Told>) {
        self.say(Command::Set { key: key.into(), value: value.into().0 });
    }

    pub(crate) fn listen(&mut self) {
        for answer in self.session.take_answers() {
            self.heard.push(Answer::decode(&answer.encode()).expect("every answer can be read"));
        }
        let Some(picture) = self.session.picture() else { return };
        for part in picture.parts_for(&mut self.seen) {
            match Answer::decode(&part).expect("every part of a picture can be read") {
                Answer::Scene(scene) => self.scene = Some(scene),
                Answer::Surface(surface) => {
                    let body = surface.body;
                    self.surfaces.retain(|known| known.body != body && known.scene == surface.scene);
                    self.surfaces.push(surface);
                    self.surfaces.sort_by_key(|surface| surface.body);
                }
                Answer::Frame(frame) => self.frame = Some(frame),
                other => panic!("no part of a picture: {other:?}"),
            }
        }
    }

    pub(crate) fn frame(&self) -> &FrameMessage {
        self.frame.as_ref().expect("a frame came")
    }

    pub(crate) fn scene(&self) -> &SceneMessage {
        self.scene.as_ref().expect("a scene came")
    }

    /// Coordinates of the vertices of a body [m].
    pub(crate) fn positions(&self, body: usize) -> Vec<f32> {
        self.frame().bodies[body].positions.0.clone()
    }

    /// Height of the lowest vertex of a body [m].
    pub(crate) fn lowest(&self, body: usize) -> f32 {
        let heights = self.frame().bodies[body].positions.0.iter().skip(1).step_by(3);
        heights.copied().fold(f32::INFINITY, f32::min)
    }

    /// What was refused since the last call.
    pub(crate) fn refusals(&mut self) -> Vec<Refusal> {
        let (refused, others) = std::mem::take(&mut self.heard)
            .into_iter()
            .partition::<Vec<_>, _>(|answer| matches!(answer, Answer::Refusal(_)));
        self.heard = others;
        refused
            .into_iter()
            .filter_map(|answer| if let Answer::Refusal(refusal) = answer { Some(refusal) } else { None })
            .collect()
    }

    /// Texts of the notices since the last call.
    pub(crate) fn notices(&mut self) -> Vec<String> {
        let heard = std::mem::take(&mut self.heard);
        heard
            .into_iter()
            .filter_map(|answer| if let Answer::Notice(notice) = answer { Some(notice.text) } else { None })
            .collect()
    }

    /// Bytes of the file that came last.
    pub(crate) fn file(&mut self) -> Vec<u8> {
        let heard = std::mem::take(&mut self.heard);
        let mut files = heard
            .into_iter()
            .filter_map(|answer| if let Answer::File(file) = answer { Some(file.bytes.0) } else { None });
        files.next_back().expect("a file came")
    }

    /// The scene with the present parameters.
    pub(crate) fn text(&mut self) -> String {
        self.say(Command::Export { what: Export::Scene });
        String::from_utf8(self.file()).expect("a scene is text")
    }

    /// Brings an instrument in; gives its number.
    pub(crate) fn add(&mut self, kind: &str, tip: [f64; 3], direction: [f64; 3]) -> u32 {
        self.say(Command::AddInstrument {
            kind: kind.into(),
            tip: Some(tip),
            direction: Some(direction),
            trocar: None,
        });
        assert_eq!(self.refusals(), []);
        self.scene().instruments.last().expect("the instrument is there").instrument
    }

    pub(crate) fn lead(&mut self, instrument: u32, tip: [f64; 3], trigger: f64) {
        let direction = [0.0, -1.0, 0.0];
        self.say(Command::MoveInstrument { instrument, tip, direction, roll: 0.0, trigger, stamp: None });
    }
}

/// A value as tests write it.
pub(crate) struct Told(Value);

impl From<f64> for Told {
    fn from(number: f64) -> Self {
        Self(Value::Number(number))
    }
}

impl From<&str> for Told {
    fn from(text: &str) -> Self {
        Self(Value::Text(text.into()))
    }
}

impl From<[f64; 3]> for Told {
    fn from(vector: [f64; 3]) -> Self {
        Self(Value::Vector(vector))
    }
}
