use std::fs;
use std::path::{Path, PathBuf};

use viscera_session::message::*;

/// One command of each kind.
fn commands() -> Vec<(&'static str, Request)> {
    let plain = |command: Command| Request { command, request: None };
    vec![
        ("hello", plain(Command::Hello { version: VERSION, client: Some("page".into()) })),
        ("open-scene", Request { command: Command::OpenScene { name: "liver".into() }, request: Some(7) }),
        ("open-text", plain(Command::OpenText { text: "duration = 1".into(), name: None })),
        (
            "open-mesh",
            plain(Command::OpenMesh {
                name: "a.stl".into(),
                bytes: Bytes(vec![1, 2, 3]),
                unit: Some(MeshUnit::Millimetre),
                edge: Some(0.01),
            }),
        ),
        ("set-number", plain(Command::Set { key: "body.liver.law.young".into(), value: Value::Number(5000.5) })),
        ("set-vector", plain(Command::Set { key: "gravity".into(), value: Value::Vector([0.0, -9.81, 0.5]) })),
        ("set-text", plain(Command::Set { key: "integrator.kind".into(), value: Value::Text("newmark".into()) })),
        (
            "add-instrument",
            plain(Command::AddInstrument {
                kind: "probe".into(),
                tip: None,
                direction: Some([0.0, -1.0, 0.5]),
                trocar: Some(Trocar::Wanted(true)),
            }),
        ),
        ("set-trocar", plain(Command::SetTrocar { instrument: 1, trocar: Trocar::At([0.0, 0.25, 0.125]) })),
        ("remove-instrument", plain(Command::RemoveInstrument { instrument: 3 })),
        (
            "move-instrument",
            plain(Command::MoveInstrument {
                instrument: 1,
                tip: [0.125, 0.25, -0.5],
                direction: [0.0, -1.0, 0.25],
                roll: 0.5,
                trigger: 1.0,
                stamp: Some(1234.5),
            }),
        ),
        ("pause", plain(Command::Pause {})),
        ("play", plain(Command::Play {})),
        ("step", plain(Command::Step { count: 10 })),
        ("reset", plain(Command::Reset {})),
        ("take-snapshot", plain(Command::TakeSnapshot { slot: 2 })),
        ("restore-snapshot", plain(Command::RestoreSnapshot { slot: 2 })),
        ("colour", plain(Command::Colour { by: "von-mises".into() })),
        ("ghost", plain(Command::Ghost { on: true })),
        ("start-recording", plain(Command::StartRecording {})),
        ("stop-recording", Request { command: Command::StopRecording {}, request: Some(9) }),
        ("replay", plain(Command::Replay { name: Some("grasp-and-lift".into()), bytes: None })),
        ("stop-replay", plain(Command::StopReplay {})),
        ("export", Request { command: Command::Export { what: Export::State }, request: Some(10) }),
    ]
}

/// One answer of each kind.
fn answers() -> Vec<(&'static str, Answer)> {
    let number = ParameterKind::Number {
        least: Some(0.0),
        least_excluded: true,
        most: None,
        most_excluded: false,
        scale: Scale::Logarithmic,
        low: 250.0,
        high: 100_000.0,
    };
    let parameter = |key: &str, value: Value, kind: ParameterKind| Parameter {
        key: key.into(),
        group: "liver".into(),
        body: Some(0),
        title: "Young's modulus".into(),
        summary: "How stiff the tissue is.".into(),
        unit: "Pa".into(),
        value: value.clone(),
        default: value,
        effect: Effect::Continues,
        kind,
    };
    let choice = Choice { name: "linear".into(), title: "Linear".into(), available: false, reason: Some("why".into()) };
    let entry = |name: &str| Entry { name: name.into(), title: "Title".into(), summary: "Summary".into() };
    vec![
        (
            "welcome",
            Answer::Welcome(Welcome {
                version: VERSION,
                program: "viscera 0.1.0".into(),
                engine: "native".into(),
                session: 1_234_567_890_123,
                role: Role::Controller,
                threads: 2,
            }),
        ),
        ("role", Answer::Role(RoleMessage { role: Role::Watcher, clients: 2 })),
        (
            "catalogue",
            Answer::Catalogue(Catalogue {
                scenes: vec![SceneEntry { name: "liver".into(), title: "A liver".into() }],
                recordings: vec![RecordingEntry {
                    name: "r".into(),
                    title: "R".into(),
                    scene: "liver".into(),
                    seconds: 1.5,
                }],
                laws: vec![entry("linear")],
                models: vec![entry("tensor-mass")],
                integrators: vec![entry("explicit")],
                instruments: vec![InstrumentEntry {
                    kind: "grasper".into(),
                    title: "Grasper".into(),
                    summary: "Jaws".into(),
                    trigger: "closes the jaws".into(),
                }],
                colourings: vec![ColouringEntry {
                    name: "displacement".into(),
                    title: "Displacement".into(),
                    unit: "m".into(),
                    summary: "distance".into(),
                }],
                mesh_formats: vec!["stl".into()],
            }),
        ),
        (
            "scene",
            Answer::Scene(SceneMessage {
                epoch: 3,
                name: "liver".into(),
                title: "A liver".into(),
                step: 0.01,
                precision: "single".into(),
                centre: [0.0, 0.05, 0.0],
                radius: 0.16,
                camera: Camera { look: [-0.3, -0.4, -1.0], up: [0.0, 1.0, 0.0] },
                bodies: vec![BodyEntry {
                    name: "liver".into(),
                    ghost_of: Some(0),
                    cells: 1000,
                    nodes: 300,
                    vertices: 200,
                    law: "linear".into(),
                    model: "total-lagrangian".into(),
                }],
                instruments: vec![InstrumentShape {
                    instrument: 0,
                    kind: "grasper".into(),
                    name: "grasper 1".into(),
                    scripted: false,
                    manner: Manner::Hold,
                    reach: 0.012,
                    parts: vec![
                        Part { kind: PartKind::Shaft, radius: 0.0025, length: 0.3 },
                        Part { kind: PartKind::Jaw, radius: 0.0015, length: 0.02 },
                    ],
                }],
                parameters: vec![
                    parameter("body.liver.law.young", Value::Number(5000.0), number),
                    parameter(
                        "body.liver.law.kind",
                        Value::Text("linear".into()),
                        ParameterKind::Choice { choices: vec![choice] },
                    ),
                    parameter("gravity", Value::Vector([0.0, -9.81, 0.0]), ParameterKind::Vector {}),
                    parameter("flag", Value::Flag(true), ParameterKind::Flag {}),
                ],
                snapshots: vec![None, Some(SnapshotEntry { time: 0.5 })],
                ghost: true,
                colouring: "none".into(),
            }),
        ),
        (
            "surface",
            Answer::Surface(SurfaceMessage {
                scene: 3,
                body: 0,
                epoch: 2,
                vertices: 4,
                skin: 3,
                triangles: U32s(vec![0, 1, 2, 0, 3, 1]),
                cut: Bytes(vec![0, 1]),
                rest: F32s(vec![0.0, 0.0, 0.0, 0.125, 0.0, 0.0, 0.0, 0.125, 0.0, 0.0, 0.0, 0.125]),
            }),
        ),
        (
            "frame",
            Answer::Frame(FrameMessage {
                scene: 3,
                sequence: 42,
                time: 0.42,
                steps: 42,
                state: RunState::Running,
                pace: Pace { steps_per_second: 100.0, real_time: 1.0, lag: 0.0 },
                bodies: vec![BodyFrame {
                    epoch: 2,
                    positions: F32s(vec![0.0, -0.5, 0.25]),
                    scalars: Some(F32s(vec![1.5])),
                    seared: Some(F32s(vec![1.0])),
                }],
                colouring: ColourRange { by: "von-mises".into(), unit: "Pa".into(), low: 0.0, high: 2000.0 },
                instruments: vec![InstrumentFrame {
                    instrument: 0,
                    tip: [0.125, 0.25, 0.5],
                    direction: [0.0, -1.0, 0.0],
                    roll: 0.25,
                    trocar: Some([0.0, 0.5, 0.0]),
                    trigger: 0.5,
                    active: true,
                    holds: true,
                    force: [0.0, -1.5, 0.0],
                    torque: [0.0, 0.0, 0.001],
                    parts: F32s(vec![0.0, 0.5, 0.0, 0.0, 0.25, 0.0, 0.0025, 0.0, 0.25, 0.0, 0.0, 0.125, 0.0, 0.0015]),
                    stamp: Some(1234.5),
                }],
                observables: Some(vec![Observables {
                    kinetic: 0.001,
                    elastic: 0.02,
                    gravity: 1.0,
                    volume_variation: -0.01,
                    largest_displacement: 0.03,
                    cells: 990,
                    removed: 10,
                    inverted: 0,
                    worst_quality: 0.3,
                    nonlinear_nodes: 300,
                    at_rest: false,
                    volume_error: Some(1e-12),
                    interface_residual: Some(0.02),
                }]),
                request: Some(7),
                recording: Some(RecordingState { seconds: 1.5 }),
                replay: Some(ReplayState { name: "liver".into(), seconds: 0.5, of: 1.5, agrees: true }),
            }),
        ),
        (
            "notice",
            Answer::Notice(Notice { level: Level::Warning, text: "what happened".into(), help: "what to do".into() }),
        ),
        (
            "refusal",
            Answer::Refusal(Refusal {
                command: "set".into(),
                reason: "Young's modulus is -1 Pa, and must be above 0 Pa".into(),
                help: String::new(),
                key: Some("body.liver.law.young".into()),
                request: Some(7),
                excerpt: Some(Excerpt {
                    source: "scene".into(),
                    line: 3,
                    column: 2,
                    text: "young = -1".into(),
                    length: 2,
                }),
            }),
        ),
        (
            "file",
            Answer::File(FileMessage {
                purpose: Purpose::Observables,
                name: "liver.csv".into(),
                mime: "text/csv".into(),
                bytes: Bytes(b"time [s]\n".to_vec()),
                request: Some(10),
            }),
        ),
    ]
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")
}

/// The bytes of every message are those that are kept, which the page decodes too. With `VISCERA_KEEP=1` they are kept anew: that is
/// another version of the protocol, unless a message only gained a key.
#[test]
fn messages_keep_their_bytes() {
    let commands = commands().into_iter().map(|(name, command)| (format!("command-{name}"), command.encode()));
    let answers = answers().into_iter().map(|(name, answer)| (format!("answer-{name}"), answer.encode()));
    for (name, bytes) in commands.chain(answers) {
        let path = folder().join(format!("{name}.msgpack"));
        if std::env::var_os("VISCERA_KEEP").is_some() {
            fs::create_dir_all(folder()).unwrap();
            fs::write(&path, &bytes).unwrap();
        }
        assert_eq!(fs::read(&path).unwrap_or_default(), bytes, "{name}");
    }
}

#[test]
fn messages_come_back_as_they_went() {
    for (name, command) in commands() {
        let bytes = command.encode();
        assert_eq!(Request::decode(&bytes).unwrap(), command, "{name}");
        let map = rmpv::decode::read_value(&mut &bytes[..]).unwrap();
        let of_type = map.as_map().unwrap().iter().find(|(key, _)| key.as_str() == Some("type")).unwrap();
        assert_eq!(of_type.1.as_str(), Some(command.command.name()));
    }
    for (name, answer) in answers() {
        assert_eq!(Answer::decode(&answer.encode()).unwrap(), answer, "{name}");
    }
}

/// JavaScript has one kind of number: 5000 comes as a whole one, and is meant as 5000.0.
#[test]
fn whole_numbers_are_numbers() {
    let map = rmpv::Value::Map(vec![
        ("type".into(), "set".into()),
        ("key".into(), "body.liver.law.young".into()),
        ("value".into(), 5000.into()),
    ]);
    let mut bytes = Vec::new();
    rmpv::encode::write_value(&mut bytes, &map).unwrap();
    let Command::Set { value, .. } = Request::decode(&bytes).unwrap().command else { panic!("it is a `set`") };
    assert_eq!(value, Value::Number(5000.0));
}
