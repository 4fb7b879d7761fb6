use viscera_session::library;
use viscera_session::message::{Bytes, Command, FrameMessage, LONGEST, RunState, Trocar};
use viscera_session::recording::{Recording, RecordingError, processor};

use crate::support::{BAR, Page, hybrid_bar, light_bar};

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

/// A tool of the scene that was taken away before the recording began does not come back and press on the tissue.
#[test]
fn a_recording_remembers_that_a_tool_was_taken_away_before_it() {
    let rod = r#"
[instrument.rod]
kind = "probe"
path = [["0 s", [0.02, 0.06, 0.1]], ["0.2 s", [0.02, 0.02, 0.1]]]
"#;
    let scene = light_bar() + rod;
    let mut page = Page::open(&scene);
    page.say(Command::RemoveInstrument { instrument: 0 });
    page.say(Command::StartRecording {});
    page.step(30);
    let places = page.positions(0);
    page.say(Command::StopRecording {});
    let bytes = page.file();
    let mut other = Page::open(&scene);
    other.step(30);
    assert_ne!(other.positions(0), places, "the rod presses where it is left");
    assert_eq!(play(&mut other, bytes), ["replayed 30 steps to the same bits"]);
    assert_eq!(other.positions(0), places);
    assert_eq!(other.scene().instruments.len(), 0);
}

/// A replay knows the scene as it was when the recording began, and a model that is chosen meanwhile has the settings of that one.
#[test]
fn a_model_that_is_chosen_while_recording_is_the_same_in_the_replay() {
    let mut page = Page::open(&hybrid_bar());
    page.set("body.bar.model.kind", "total-lagrangian");
    page.step(5);
    page.say(Command::StartRecording {});
    page.set("body.bar.model.kind", "hybrid");
    page.step(20);
    page.say(Command::StopRecording {});
    assert_eq!(page.refusals(), []);
    let bytes = page.file();
    let mut other = Page::open(BAR);
    assert_eq!(play(&mut other, bytes), ["replayed 20 steps to the same bits"]);
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

/// The bytes of a recording that comes with the program.
fn kept(name: &str) -> &'static [u8] {
    library::recordings().find(|(known, _)| *known == name).expect("the recording is built in").1
}

/// A list within a list, each of which promises four billion values: a reader that believes them makes room for some of each, and took
/// a gigabyte for five kilobytes. As few bytes of honest values take thirty times as much in memory, and are counted first.
#[test]
fn what_a_recording_promises_is_counted_before_it_is_kept() {
    let text = |text: &str| [&[0xa0 | text.len() as u8][..], text.as_bytes()].concat();
    let promise = [0xdd, 0xff, 0xff, 0xff, 0xff];
    let head = [&[0x82][..], &text("format"), &[3], &text("events")].concat();
    let event = [&head[..], &[0x91, 0x82], &text("at"), &[0], &text("command")].concat();
    let nils = [&[0xdd][..], &(1_u32 << 20).to_be_bytes(), &[0xc0; 1 << 20]].concat();
    for content in [promise.repeat(1000), nils, vec![0x91; 1000]] {
        for start in [&head, &event] {
            let bytes = [&start[..], &content].concat();
            let refused = Recording::decode(&bytes).unwrap_err();
            assert!(matches!(refused, RecordingError::Unsound { bytes: of } if of == bytes.len()), "{refused}");
        }
    }
}

#[test]
fn a_recording_that_no_program_makes_is_refused_by_what_is_wrong_with_it() {
    type Entries = Vec<(rmpv::Value, rmpv::Value)>;
    let changed = |change: &dyn Fn(&mut Entries)| {
        let mut whole = rmpv::decode::read_value(&mut kept("edge-cut")).unwrap();
        let rmpv::Value::Map(entries) = &mut whole else { panic!("it is a map") };
        change(entries);
        let mut bytes = Vec::new();
        rmpv::encode::write_value(&mut bytes, &whole).unwrap();
        Recording::decode(&bytes)
    };
    let put = |key: &'static str, value: rmpv::Value| {
        changed(&|entries| {
            let place = entries.iter().position(|(known, _)| known.as_str() == Some(key)).unwrap();
            entries[place].1 = value.clone();
        })
    };
    assert!(changed(&|_| {}).is_ok());
    assert!(matches!(put("format", 9.into()), Err(RecordingError::OtherFormat { found: 9 })));
    assert!(matches!(put("steps", u64::MAX.into()), Err(RecordingError::TooManySteps { steps: u64::MAX })));
    let map = |entries: &[(&str, rmpv::Value)]| {
        rmpv::Value::Map(entries.iter().map(|(key, value)| ((*key).into(), value.clone())).collect())
    };
    let exports = map(&[("type", "export".into()), ("what", "state".into())]);
    let events = rmpv::Value::Array(vec![map(&[("at", 7.into()), ("command", exports)])]);
    assert!(matches!(put("events", events), Err(RecordingError::Foreign { at: 7, command: "export" })));
    assert!(matches!(Recording::decode(&vec![0; LONGEST + 1]), Err(RecordingError::TooLong { .. })));
}

/// Cut off anywhere, or with any bits turned over, a recording is read or refused: two thousand of each, none of which ends the test.
#[test]
fn damaged_recordings_are_read_or_refused() {
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = |below: usize| {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random % below as u64) as usize
    };
    for name in ["edge-cut", "lobe-pulled"] {
        let whole = kept(name);
        for _ in 0..2000 {
            assert!(Recording::decode(&whole[..next(whole.len())]).is_err(), "what breaks off is no recording");
            let mut damaged = whole.to_vec();
            for _ in 0..=next(4) {
                // Half of the damage to the first bytes, where lists begin.
                let place = if next(2) == 0 { next(400) } else { next(whole.len()) };
                damaged[place] ^= 1 << next(8);
            }
            let _ = Recording::decode(&damaged);
        }
    }
}

/// Tools that are led through points: given at the beginning, moved and taken away meanwhile.
#[test]
fn trocars_are_recorded_and_replayed() {
    let mut page = Page::open(&light_bar());
    page.say(Command::StartRecording {});
    let tip = [0.02, 0.1, 0.06];
    let direction = Some([0.0, -1.0, 0.0]);
    let trocar = Some(Trocar::Wanted(true));
    page.say(Command::AddInstrument { kind: "probe".into(), tip: Some(tip), direction, trocar });
    let mut poses = Vec::new();
    for (number, trocar) in
        [Trocar::At([0.1, 0.2, 0.06]), Trocar::At([-0.1, 0.2, 0.06]), Trocar::Wanted(false)].into_iter().enumerate()
    {
        page.say(Command::SetTrocar { instrument: 0, trocar });
        page.lead(0, [0.02, 0.06 - 0.01 * number as f64, 0.06], 0.0);
        page.step(5);
        let tool = &page.frame().instruments[0];
        poses.push((tool.tip, tool.direction, tool.trocar));
    }
    assert_eq!(page.refusals(), []);
    assert_eq!(poses.iter().map(|pose| pose.2.is_some()).collect::<Vec<_>>(), [true, true, false]);
    let places = page.positions(0);
    page.say(Command::StopRecording {});
    let bytes = page.file();
    let mut other = Page::open(BAR);
    assert_eq!(play(&mut other, bytes), ["replayed 15 steps to the same bits"]);
    assert_eq!(other.positions(0), places);
    let tool = &other.frame().instruments[0];
    assert_eq!((tool.tip, tool.direction, tool.trocar), poses[2]);
}

/// Plays a recording that comes with the program; gives a frame after each of its steps, with what was measured.
fn watch(name: &str) -> Vec<FrameMessage> {
    let recording = Recording::decode(kept(name)).unwrap();
    let mut page = Page::open(BAR);
    page.say(Command::Replay { name: Some(name.into()), bytes: None });
    assert_eq!(page.refusals(), []);
    let mut frames: Vec<FrameMessage> = Vec::new();
    while page.frame().state == RunState::Running {
        page.session.elapse(recording.seconds() / 500.0);
        while page.session.work() {}
        page.listen();
        if page.frame().observables.is_some() && frames.last().is_none_or(|last| last.steps < page.frame().steps) {
            frames.push(page.frame().clone());
        }
    }
    // Elsewhere vectors are longer or shorter, and roundings may be others.
    let notices = page.notices();
    let comes_to = |what: &str| notices.last().is_some_and(|last| last.ends_with(&format!("to the same {what}")));
    assert!(comes_to("bits") || recording.processor != processor() && comes_to("numbers"), "{notices:?}");
    frames
}

/// The lobe follows the jaws, which feel it, and falls when they open.
#[test]
fn the_kept_pull_lifts_the_lobe_and_lets_it_fall() {
    let frames = watch("lobe-pulled");
    let force = |frame: &FrameMessage| frame.instruments[0].force.iter().map(|part| part * part).sum::<f64>().sqrt();
    let lifted = frames.iter().rposition(|frame| frame.instruments[0].holds).expect("the grasper held something");
    let (held, later) = (&frames[lifted], &frames[lifted + 1..]);
    // Some tens of grams of tissue that is bent up by a hand's breadth.
    assert!(force(held) > 0.3 && force(held) < 10.0, "{} N", force(held));
    let place = |frame: &FrameMessage, vertex: usize| -> [f64; 3] {
        std::array::from_fn(|axis| f64::from(frame.bodies[0].positions.0[3 * vertex + axis]))
    };
    let from_tip = |vertex: usize| {
        let (place, tip) = (place(held, vertex), held.instruments[0].tip);
        (0..3).map(|axis| (place[axis] - tip[axis]).powi(2)).sum::<f64>()
    };
    let vertices = 0..held.bodies[0].positions.0.len() / 3;
    let grasped = vertices.min_by(|&a, &b| from_tip(a).total_cmp(&from_tip(b))).unwrap();
    let lowest = later.iter().map(|frame| place(frame, grasped)[1]).fold(f64::INFINITY, f64::min);
    assert!(place(held, grasped)[1] - lowest > 0.03, "it fell by {} m", place(held, grasped)[1] - lowest);
    let last = later.last().unwrap();
    assert!(!last.instruments[0].holds && force(last) == 0.0);
}

/// The hook takes cells away while its current is on and no others.
#[test]
fn the_kept_cut_burns_while_the_current_is_on() {
    let frames = watch("edge-cut");
    let removed = |frame: &FrameMessage| frame.observables.as_ref().unwrap()[0].removed;
    assert!(removed(frames.last().unwrap()) >= 10, "{}", removed(frames.last().unwrap()));
    for pair in frames.windows(2) {
        let on = pair.iter().any(|frame| frame.instruments[1].trigger > 0.0);
        assert!(on || removed(&pair[0]) == removed(&pair[1]), "burnt without current by {} s", pair[1].time);
    }
}
