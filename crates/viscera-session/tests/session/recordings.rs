use std::fs;
use std::path::Path;

use viscera_session::message::{Bytes, Command, RunState};
use viscera_session::{library, recording::Recording};

use crate::support::{BAR, Page};

/// A minute of a user's work, in half a second: lifts the end of the bar, softens it on the way, cuts it.
fn work(page: &mut Page) {
    let grasper = page.add("grasper", [0.02, 0.043, 0.115], [0.0, -1.0, 0.0]);
    page.lead(grasper, [0.02, 0.043, 0.115], 1.0);
    page.step(2);
    for lift in 1..=30 {
        page.lead(grasper, [0.02, 0.043 + 0.001 * f64::from(lift), 0.115], 1.0);
        page.step(1);
        if lift == 10 {
            page.set("body.bar.law.young", 12e3);
        }
    }
    let cautery = page.add("cautery", [0.02, 0.1, 0.06], [0.0, -1.0, 0.0]);
    for step in 0..30 {
        page.lead(cautery, [0.02, 0.1 - 0.002 * f64::from(step), 0.06], 1.0);
        page.step(1);
    }
    page.say(Command::RemoveInstrument { instrument: grasper });
    page.step(20);
}

/// Plays a recording to its end; gives what was told about it.
fn play(page: &mut Page, bytes: Vec<u8>) -> Vec<String> {
    page.say(Command::Replay { name: None, bytes: Some(Bytes(bytes)) });
    assert_eq!(page.refusals(), []);
    let mut turns = 0;
    while page.frame().state == RunState::Running {
        page.session.elapse(0.05);
        while page.session.work() {}
        page.listen();
        turns += 1;
        assert!(turns < 10_000, "the replay ends");
    }
    page.notices()
}

#[test]
fn a_recording_replays_to_the_same_bits() {
    let mut page = Page::open(BAR);
    page.say(Command::StartRecording {});
    work(&mut page);
    let places = page.positions(0);
    page.say(Command::StopRecording {});
    let bytes = page.file();
    // Somebody else, who coloured and looked on otherwise.
    let mut other = Page::open(BAR);
    other.say(Command::Colour { by: "von-mises".into() });
    let notices = play(&mut other, bytes);
    assert_eq!(notices, ["replayed 82 steps to the same bits"]);
    assert_eq!(other.positions(0), places);
}

#[test]
fn a_recording_may_begin_in_the_middle() {
    let mut page = Page::open(BAR);
    page.add("probe", [0.02, 0.08, 0.06], [0.0, -1.0, 0.0]);
    page.step(20);
    page.say(Command::StartRecording {});
    page.lead(0, [0.02, 0.04, 0.06], 0.0);
    page.step(30);
    let places = page.positions(0);
    page.say(Command::StopRecording {});
    let bytes = page.file();
    let mut other = Page::open(BAR);
    assert_eq!(play(&mut other, bytes), ["replayed 30 steps to the same bits"]);
    assert_eq!(other.positions(0), places);
}

/// A hand that meddles with a replay is refused; what departs is told with its step.
#[test]
fn a_replay_says_where_it_departs() {
    let mut page = Page::open(BAR);
    page.say(Command::StartRecording {});
    page.step(120);
    page.say(Command::StopRecording {});
    let bytes = page.file();
    // The same recording of a stiffer bar.
    let place = bytes.windows(7).position(|window| window == b"20000.0").expect("the scene stands in the recording");
    let mut stiffer = bytes.clone();
    stiffer[place] = b'9';
    let notices = play(&mut page, stiffer);
    assert!(notices[0].starts_with("by step 50 (0.50 s) the replay has departed from the recording"), "{notices:?}");
    assert_eq!(notices.last().unwrap(), "replayed 120 steps, with a difference");
    page.say(Command::Replay { name: None, bytes: Some(Bytes(bytes)) });
    page.say(Command::Reset {});
    assert!(page.refusals()[0].reason.contains("being replayed"));
    page.say(Command::StopReplay {});
    page.say(Command::Reset {});
    assert_eq!(page.refusals(), []);
}

#[test]
fn what_is_no_recording_is_refused() {
    let mut page = Page::open(BAR);
    for bytes in [vec![], b"not one".to_vec(), vec![0x81, 0xa6, b'f', b'o', b'r', b'm', b'a', b't', 9]] {
        page.say(Command::Replay { name: None, bytes: Some(Bytes(bytes)) });
        assert_eq!(page.refusals().len(), 1);
    }
    page.say(Command::Replay { name: Some("nothing".into()), bytes: None });
    assert!(page.refusals()[0].reason.contains("no recording `nothing`"));
}

/// The recordings that are kept, on whatever processor this is: to the same bits where it is the one they were made on, to the same
/// numbers elsewhere. With `VISCERA_RECORD=1` they are made anew, by [`hands`].
#[test]
fn kept_recordings_replay() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/recordings");
    for (name, hands) in hands() {
        let path = folder.join(format!("{name}.viscera-recording"));
        if std::env::var_os("VISCERA_RECORD").is_some() {
            let mut page = Page::open(BAR);
            hands(&mut page);
            page.say(Command::StopRecording {});
            fs::create_dir_all(&folder).unwrap();
            fs::write(&path, page.file()).unwrap();
            continue;
        }
        let (_, bytes) = library::recordings().find(|(known, _)| *known == name).expect("the recording is built in");
        assert!(Recording::decode(bytes).unwrap().seconds() > 1.0);
        let mut page = Page::open(BAR);
        let notices = play(&mut page, bytes.to_vec());
        let last = notices.last().unwrap();
        assert!(last.ends_with("to the same bits") || last.ends_with("to the same numbers"), "{name}: {notices:?}");
    }
}

/// Names of the kept recordings, and the emulated users that made them.
fn hands() -> [(&'static str, fn(&mut Page)); 2] {
    [("grasp-and-lift", grasp_and_lift), ("press-and-soften", press_and_soften)]
}

fn coarse_liver(page: &mut Page) {
    page.say(Command::OpenScene { name: "liver".into() });
    page.set("body.liver.mesh.edge", 0.024);
    assert_eq!(page.refusals(), []);
    page.say(Command::StartRecording {});
}

/// The vertex that is farthest along an axis [m]: what the user aims at.
fn farthest(page: &Page, axis: usize) -> [f64; 3] {
    let places = page.positions(0);
    let vertex = places.chunks_exact(3).max_by(|a, b| a[axis].total_cmp(&b[axis])).unwrap();
    [0, 1, 2].map(|axis| f64::from(vertex[axis]))
}

/// Takes the top of the organ, lifts it, and lets go.
fn grasp_and_lift(page: &mut Page) {
    coarse_liver(page);
    let [x, y, z] = farthest(page, 1);
    let grasper = page.add("grasper", [x, y + 0.06, z], [0.0, -1.0, 0.0]);
    for step in 0..=19 {
        page.lead(grasper, [x, y + 0.06 - 0.003 * f64::from(step), z], 0.0);
        page.step(1);
    }
    for step in 0..=60 {
        page.lead(grasper, [x, y + 0.003 + 0.001 * f64::from(step), z], 1.0);
        page.step(1);
    }
    assert!(page.frame().instruments[0].holds, "the jaws hold the organ");
    page.lead(grasper, [x, y + 0.06, z], 0.0);
    page.step(38);
}

/// Presses a probe into the organ from above while its tissue softens.
fn press_and_soften(page: &mut Page) {
    coarse_liver(page);
    let [x, y, z] = farthest(page, 1);
    let probe = page.add("probe", [x, y + 0.03, z], [0.0, -1.0, 0.0]);
    let mut pressed: f64 = 0.0;
    for step in 0..120 {
        page.lead(probe, [x, y + 0.03 - 0.0005 * f64::from(step), z], 0.0);
        if step == 80 {
            page.set("body.liver.law.young", 3e3);
        }
        page.step(1);
        pressed = pressed.max(page.frame().instruments[0].force[1]);
    }
    assert!(pressed > 0.05, "the tissue presses back: {pressed} N");
}
