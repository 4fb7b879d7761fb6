use proptest::prelude::*;
use viscera::executor::Executor;
use viscera_session::Session;
use viscera_session::message::{Command, LONGEST, LONGEST_SHORT, Request};

use crate::support::{BAR, Page};

fn bytes(value: &rmpv::Value) -> Vec<u8> {
    let mut bytes = Vec::new();
    rmpv::encode::write_value(&mut bytes, value).unwrap();
    bytes
}

fn map(entries: &[(&str, rmpv::Value)]) -> Vec<u8> {
    bytes(&rmpv::Value::Map(entries.iter().map(|(key, value)| ((*key).into(), value.clone())).collect()))
}

#[test]
fn malformed_messages_are_refused_with_a_reason_and_the_scene_goes_on() {
    let mut page = Page::open(BAR);
    page.step(2);
    let deep = (0..1000).fold(rmpv::Value::Nil, |inner, _| rmpv::Value::Array(vec![inner]));
    for (message, reason) in [
        (vec![], "cannot be read"),
        (vec![0xc1], "not a map"),
        // An array of 4 billion entries, of which none is there; a text of as many bytes.
        (vec![0xdd, 0xff, 0xff, 0xff, 0xff], "cannot be read"),
        (vec![0xdb, 0xff, 0xff, 0xff, 0xff], "cannot be read"),
        (bytes(&1.into()), "not a map"),
        (bytes(&deep), "cannot be read"),
        (map(&[("kind", "pause".into())]), "missing field `type`"),
        (map(&[("type", "explode".into())]), "unknown variant `explode`"),
        (map(&[("type", "pause".into()), ("for", 5.into())]), "unknown field `for`"),
        (map(&[("type", "set".into()), ("key", "gravity".into())]), "missing field `value`"),
        (map(&[("type", "step".into()), ("count", (-1).into())]), "-1"),
        (map(&[("type", "step".into()), ("count", 1_000_000.into())]), "1 to 1000"),
        ([map(&[("type", "pause".into())]), vec![0]].concat(), "1 bytes follow"),
        (map(&[("type", "colour".into()), ("by", "x".repeat(LONGEST_SHORT).into())]), "bytes"),
        (
            map(&[("type", "move-instrument".into()), ("instrument", 0.into()), ("tip", "here".into())]),
            "expected an array of length 3",
        ),
    ] {
        page.session.receive(&message);
        page.listen();
        let refusals = page.refusals();
        let shown: Vec<u8> = message.iter().copied().take(40).collect();
        assert!(refusals.len() == 1 && refusals[0].reason.contains(reason), "{shown:?}: {refusals:?}");
    }
    page.step(2);
    assert_eq!(page.frame().steps, 4);
}

/// A value of one byte takes forty in memory: as many as the longest message holds would take gigabytes, and are counted first.
#[test]
fn a_message_full_of_small_values_is_refused_before_it_is_kept() {
    let nils = vec![0xc0; LONGEST - 100];
    let count = (nils.len() as u32).to_be_bytes();
    let list = [&[0xdd][..], &count, &nils].concat();
    let start = [&[0x82][..], &bytes(&"type".into()), &bytes(&"open-mesh".into()), &bytes(&"bytes".into())].concat();
    for message in [[&start[..], &list].concat(), list] {
        let refusal = Request::decode(&message).unwrap_err();
        assert!(refusal.reason.contains("more than 64 values"), "{refusal:?}");
    }
}

/// Whatever kind a value has, it counts once: what is in a text or in bytes does not, and what comes behind it does.
#[test]
fn values_of_every_kind_are_counted_once() {
    use rmpv::Value;
    // Each byte of it would be a list of four billion values.
    let content = |length: usize| vec![0xdd_u8; length];
    let texts = [3, 40, 300, 70_000].map(|length| Value::from("\u{7d}".repeat(length)));
    let binaries = [3, 300, 70_000].map(|length| Value::Binary(content(length)));
    let extensions = [1, 2, 4, 8, 16, 3, 300, 70_000].map(|length| Value::Ext(5, content(length)));
    let whole = [5, 200, 60_000, 4_000_000_000, i64::MAX, -5, -100, -30_000, -2_000_000_000, i64::MIN].map(Value::from);
    let others = [Value::Nil, true.into(), Value::F32(f32::MAX), Value::F64(f64::MAX), u64::MAX.into()];
    for value in texts.into_iter().chain(binaries).chain(extensions).chain(whole).chain(others) {
        // The map, its two keys, the type and the list are five. Of a type that may be long, so that nothing else is refused first.
        let reason = |count: usize| {
            let list = Value::Array(vec![value.clone(); count]);
            Request::decode(&map(&[("type", "open-mesh".into()), ("list", list)])).unwrap_err().reason
        };
        let many = "more than 64 values";
        assert!(!reason(59).contains(many) && reason(60).contains(many), "{value:?}: {}; {}", reason(59), reason(60));
    }
}

#[test]
fn tools_that_are_nowhere_are_refused() {
    let mut page = Page::open(BAR);
    let probe = page.add("probe", [0.02, 0.1, 0.06], [0.0, -1.0, 0.0]);
    page.step(1);
    let good = (probe, [0.02, 0.1, 0.06], [0.0, -1.0, 0.0], 0.0, 0.0);
    for (instrument, tip, direction, roll, trigger) in [
        (99, good.1, good.2, good.3, good.4),
        (probe, [f64::NAN, 0.0, 0.0], good.2, good.3, good.4),
        (probe, good.1, [0.0; 3], good.3, good.4),
        (probe, good.1, good.2, f64::INFINITY, good.4),
        (probe, good.1, good.2, good.3, f64::NAN),
    ] {
        page.say(Command::MoveInstrument { instrument, tip, direction, roll, trigger, stamp: None });
        assert_eq!(page.refusals().len(), 1);
    }
    page.say(Command::RemoveInstrument { instrument: probe });
    page.say(Command::RemoveInstrument { instrument: probe });
    assert!(page.refusals()[0].reason.contains("no instrument 0"));
    for _ in 0..16 {
        page.say(Command::AddInstrument { kind: "probe".into(), tip: None, direction: None, trocar: None });
    }
    assert_eq!(page.refusals(), []);
    page.say(Command::AddInstrument { kind: "probe".into(), tip: None, direction: None, trocar: None });
    assert!(page.refusals()[0].reason.contains("16 instruments"));
}

/// A scene of somebody else names files of this machine: none is read.
#[test]
fn scenes_from_a_page_read_no_files() {
    let mut page = Page::open(BAR);
    let text = BAR.replace(
        r#"{ generate = "box", size = [0.04, 0.04, 0.12], cells = [2, 2, 6] }"#,
        r#"{ file = "/etc/hostname" }"#,
    );
    page.say(Command::OpenText { text, name: Some("theirs".into()) });
    let refusals = page.refusals();
    assert!(refusals[0].reason.contains("did not come with the scene"), "{refusals:?}");
    assert_eq!(refusals[0].excerpt.as_ref().unwrap().source, "theirs");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    /// Whatever comes is read or refused.
    #[test]
    fn noise_is_read_or_refused(noise in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = Request::decode(&noise);
    }

    /// A command of which some bytes were changed is read or refused.
    #[test]
    fn damaged_commands_are_read_or_refused(place in 0_usize..200, byte in any::<u8>(), cut in 0_usize..200) {
        let command = Command::MoveInstrument {
            instrument: 1, tip: [0.1, 0.2, 0.3], direction: [0.0, -1.0, 0.0], roll: 0.1, trigger: 1.0, stamp: Some(5.0),
        };
        let mut bytes = Request::from(command).encode();
        let length = bytes.len();
        bytes[place % length] = byte;
        bytes.truncate(length - cut % length);
        let _ = Request::decode(&bytes);
    }
}

/// Commands with wild numbers, each of which may be said by a page: the session answers all of them and goes on.
#[test]
fn wild_numbers_do_not_stop_a_session() {
    let mut session = Session::new(Executor::serial());
    let mut page = Page::open(BAR);
    let keys: Vec<String> = page.scene().parameters.iter().map(|parameter| parameter.key.clone()).collect();
    for key in keys {
        for value in [f64::NAN, f64::NEG_INFINITY, -1e300, -1.0, 0.0, 1e-300, 1e300] {
            page.set(&key, value);
            page.say(Command::Step { count: 1 });
            while page.session.work() {}
        }
        page.say(Command::OpenText { text: BAR.into(), name: None });
    }
    page.listen();
    session.elapse(f64::NAN);
    session.elapse(-5.0);
    session.elapse(f64::INFINITY);
    assert!(!session.work(), "a session that is paused owes nothing");
}
