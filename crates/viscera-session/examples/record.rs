//! Records the sessions of `scenes/recordings`: what a hand does in the liver that the simulator begins with, one pose a step, as the
//! page says them. To be run again where a change of the engine is to change them.
//!
//!     cargo run --release -p viscera-session --example record

use std::path::Path;

use viscera::executor::Executor;
use viscera_session::message::{Answer, Command, FrameMessage, Request, Value};
use viscera_session::recording::Recording;
use viscera_session::{Seen, Session};

/// How fast a hand goes [m/s].
const SPEED: f64 = 0.25;
/// Length of a step of the scene [s].
const STEP: f64 = 0.01;
/// Numbers of the scene's instruments.
const GRASPER: u32 = 0;
const CAUTERY: u32 = 1;

/// What a hand does while it is recorded.
type Work = fn(&mut Hand);

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/recordings");
    let all: [(&str, &str, Work); 2] = [
        ("lobe-pulled", "The left lobe is grasped, pulled and let go", pull),
        ("edge-cut", "The edge of the left lobe is cut, and the liver softens meanwhile", cut),
    ];
    for (name, title, work) in all {
        let bytes = record(title, work);
        let path = folder.join(format!("{name}.viscera-recording"));
        println!("{}: {} bytes", path.display(), bytes.len());
        std::fs::write(path, bytes).expect("the folder is there");
    }
}

/// Takes the edge of the lobe, pulls it up and towards the eye, lets it go, and watches it swing.
fn pull(hand: &mut Hand) {
    hand.take(GRASPER, [-0.04, 0.09, 0.1]);
    hand.go([0.12, 0.08, 0.06], 0.0);
    // Its outermost point; the jaws come from above, and take it a little within.
    let edge = hand.skin_near([1.0, 0.0, 0.0]);
    hand.go(off(edge, [-0.01, 0.02, 0.01]), 0.0);
    let edge = hand.skin_near([1.0, 0.0, 0.0]);
    hand.go(off(edge, [-0.01, 0.0, 0.0]), 0.0);
    hand.wait(0.1, 1.0);
    hand.go(off(edge, [0.0, 0.08, 0.04]), 1.0);
    hand.wait(0.3, 1.0);
    hand.wait(0.8, 0.0);
}

/// Burns down along the edge of the lobe; half-way the tissue is made softer.
fn cut(hand: &mut Hand) {
    hand.take(CAUTERY, [0.14, 0.08, 0.09]);
    let edge = hand.skin_near([0.1, 0.02, 0.04]);
    hand.go(off(edge, [0.0, 0.02, 0.02]), 0.0);
    hand.go(edge, 1.0);
    hand.wait(0.3, 1.0);
    hand.say(Command::Set { key: "body.liver.law.young".into(), value: Value::Number(4e3) });
    let further = hand.skin_near(off(edge, [0.0, -0.03, 0.0]));
    hand.go(further, 1.0);
    hand.wait(0.5, 1.0);
    hand.go(off(further, [0.03, 0.05, 0.05]), 0.0);
    hand.wait(0.5, 0.0);
}

fn off(place: [f64; 3], by: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| place[axis] + by[axis])
}

fn distance(from: [f64; 3], to: [f64; 3]) -> f64 {
    (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f64>().sqrt()
}

/// Records what a hand does from the beginning of the first scene.
fn record(title: &str, work: fn(&mut Hand)) -> Vec<u8> {
    let session = Session::new(Executor::serial());
    let mut hand = Hand { session, seen: Seen::default(), frame: None, instrument: 0, tip: [0.0; 3] };
    hand.look();
    hand.say(Command::StartRecording {});
    work(&mut hand);
    hand.say(Command::StopRecording {});
    let mut files = hand.session.take_answers().into_iter().filter_map(|answer| match answer {
        Answer::File(file) => Some(file.bytes.0),
        Answer::Refusal(refusal) => panic!("{}: {}", refusal.command, refusal.reason),
        _ => None,
    });
    let bytes = files.next_back().expect("a recording that is stopped comes as a file");
    let mut recording = Recording::decode(&bytes).expect("it was just written");
    recording.title = title.into();
    recording.encode()
}

/// A hand on an instrument.
struct Hand {
    session: Session,
    /// What it was shown, and the last frame of that.
    seen: Seen,
    frame: Option<FrameMessage>,
    instrument: u32,
    tip: [f64; 3],
}

impl Hand {
    fn say(&mut self, command: Command) {
        self.session.handle(Request::from(command));
    }

    /// Takes an instrument where the scene has it.
    fn take(&mut self, instrument: u32, tip: [f64; 3]) {
        (self.instrument, self.tip) = (instrument, tip);
    }

    /// Goes straight to a place.
    fn go(&mut self, to: [f64; 3], trigger: f64) {
        let from = self.tip;
        let steps = (distance(from, to) / (SPEED * STEP)).ceil().max(1.0);
        for step in 1..=steps as u32 {
            let share = f64::from(step) / steps;
            self.tip = std::array::from_fn(|axis| from[axis] + share * (to[axis] - from[axis]));
            self.lead(trigger);
        }
    }

    /// Stays where it is for so long [s].
    fn wait(&mut self, seconds: f64, trigger: f64) {
        for _ in 0..(seconds / STEP).round() as u32 {
            self.lead(trigger);
        }
    }

    /// Sees how things are now.
    fn look(&mut self) {
        let Some(picture) = self.session.picture() else { return };
        for part in picture.parts_for(&mut self.seen) {
            if let Ok(Answer::Frame(frame)) = Answer::decode(&part) {
                self.frame = Some(frame);
            }
        }
    }

    /// The vertex of the surface that is nearest to a place now.
    fn skin_near(&self, place: [f64; 3]) -> [f64; 3] {
        let frame = self.frame.as_ref().expect("it was looked at");
        let vertices = frame.bodies[0].positions.0.chunks_exact(3);
        let vertices = vertices.map(|vertex| std::array::from_fn(|axis| f64::from(vertex[axis])));
        let nearest = |a: &[f64; 3], b: &[f64; 3]| distance(*a, place).total_cmp(&distance(*b, place));
        vertices.min_by(nearest).expect("a surface has vertices")
    }

    fn lead(&mut self, trigger: f64) {
        let (instrument, tip) = (self.instrument, self.tip);
        // The scene's trocars say where it points.
        let direction = [0.0, -1.0, 0.0];
        self.say(Command::MoveInstrument { instrument, tip, direction, roll: 0.0, trigger, stamp: None });
        self.say(Command::Step { count: 1 });
        while self.session.work() {}
        self.look();
    }
}
