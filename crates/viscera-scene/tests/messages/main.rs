//! What a person reads when a scene file is wrong.

use std::fmt::Write;

use viscera_scene::Scene;

const SCENE: &str = include_str!("scene.toml");
const READ: &str = include_str!("messages.txt");

/// What stands in the right scene, what stands there instead, and nothing else.
const SLIPS: &[(&str, &str)] = &[
    // Keys.
    ("young = \"5 kPa\"", "youngs = \"5 kPa\""),
    ("close", "clse"),
    ("gravity", "Gravity"),
    ("[body.liver]", "[bodies.liver]"),
    ("[body.liver]", "[body]"),
    ("radius = \"3 cm\"", "radius = \"3 cm\", colour = 3"),
    ("file = \"paths/resection.csv\"", "fil = \"paths/resection.csv\""),
    ("density = 1060", "density = 1060\ndensity = 1000"),
    ("duration = \"4 s\"\n", ""),
    ("kind = \"grasper\"\n", ""),
    ("poisson = 0.45, ", ""),
    ("young = \"5 kPa\", poisson = 0.45, ", ""),
    ("poisson = 0.45", "poisson = 0.45, lambda = 3"),
    (", young = \"12 kPa\" }", " }"),
    // Alternatives.
    ("kind = \"grasper\"", "kind = \"graspr\""),
    ("kind = \"tensor-mass\"", "kind = \"tensormass\""),
    ("kind = \"st-venant-kirchhoff\"", "kind = \"st-venant\""),
    ("generate = \"liver\"", "generate = \"lier\""),
    ("generate = \"liver\"", "generat = \"liver\""),
    ("generate = \"liver\", length = \"30 cm\"", "file = \"liver.msh\""),
    ("precision = \"double\"", "precision = \"dubble\""),
    ("sphere = {", "spher = {"),
    ("{ sphere = { centre = [0, 0.02, -0.03], radius = \"3 cm\" } }", "{}"),
    ("{ sphere = { centre = [0, 0.02, -0.03], radius = \"3 cm\" } }", "3"),
    ("radius = \"3 cm\" }", "radius = \"3 cm\" }, group = \"back\""),
    ("substep = \"auto\"", "substep = \"aut\""),
    // Integrators and models.
    ("precision = \"double\"", "integrator = { kind = \"backwards-euler\" }"),
    ("precision = \"double\"", "integrator = { kind = \"newmark\", gama = 0.6 }"),
    ("precision = \"double\"", "integrator = { kind = \"newmark\", gamma = 0.4 }"),
    ("precision = \"double\"", "integrator = { kind = \"bdf2\", newton = \"ful\" }"),
    ("precision = \"double\"", "integrator = { kind = \"bdf2\", newton = { tolerance = 1, iterations = 9 } }"),
    ("precision = \"double\"", "integrator = { kind = \"bdf2\", linear = 25 }"),
    ("precision = \"double\"", "integrator = { kind = \"bdf2\", linear = { iterations = 0 } }"),
    ("precision = \"double\"", "integrator = { kind = \"bdf2\", matrix = \"free\" }"),
    ("precision = \"double\"", "integrator = { kind = \"bdf2\", preconditioner = \"jacobi\" }"),
    ("precision = \"double\"", "integrator = { kind = \"quasi-static\", solver = \"cholesky\" }"),
    ("kind = \"tensor-mass\"", "kind = \"corotational\", rotation = \"quaternion\""),
    ("kind = \"tensor-mass\"", "kind = \"corotational\", strain-displacement = \"current\""),
    ("damping = 0.5", "stiffness-damping = \"0.5 1/s\""),
    ("model = { kind = \"tensor-mass\", keep-volume = \"20 kPa\" }", "model = \"corotationl\""),
    (
        "law = { kind = \"st-venant-kirchhoff\", young = \"5 kPa\", poisson = 0.45, fibre = { direction = [1, 0, 0], young = \"12 kPa\" } }",
        "law = \"linear\"",
    ),
    ("precision = \"double\"", "integrator = \"newmark\""),
    ("damping = 0.5", "integrator = \"explicit\""),
    ("damping = 0.5", "durations = \"2 s\""),
    ("close = \"0.2 s\"", "body = \"liver\""),
    // Quantities.
    ("edge = \"12 mm\"", "edge = \"5 kg\""),
    ("edge = \"12 mm\"", "edge = \"12 furlongs\""),
    ("edge = \"12 mm\"", "edge = \"12\""),
    ("edge = \"12 mm\"", "edge = \"fine\""),
    ("edge = \"12 mm\"", "edge = \"1e999 mm\""),
    ("edge = \"12 mm\"", "edge = true"),
    ("edge = \"12 mm\"", "edge = 1979-01-01"),
    ("edge = \"12 mm\"", "edge = nan"),
    ("edge = \"12 mm\"", "edge = 0"),
    ("density = 1060", "density = \"-1060 kg/m^3\""),
    ("poisson = 0.45", "poisson = 0.5"),
    ("poisson = 0.45", "poisson = -1"),
    ("damping = 0.5", "damping = -0.5"),
    ("size = [640, 360]", "size = [640, 3]"),
    // Lists.
    ("centre = [0, 0.02, -0.03]", "centre = [0, 0.02]"),
    ("centre = [0, 0.02, -0.03]", "centre = 0.3"),
    (
        "{ sphere = { centre = [0, 0.02, -0.03], radius = \"3 cm\" } }",
        "[\"surface\", { nodes = [-1, 0.5, 5000000000] }]",
    ),
    ("[\"2 s\", [0.19, 0.03, 0]]", "[\"2 s\", [0.19, 0.03, \"5 N\"]]"),
    ("[\"2 s\", [0.19, 0.03, 0]]", "[\"2 m\", [0.19, 0.03, 0]]"),
    ("[[\"0 s\", [0.14, 0, 0]], [\"2 s\", [0.19, 0.03, 0]]]", "[0.14, 0, \"0 N\"]"),
    ("direction = [1, 0, 0]", "along = [[0, 0, 0]]"),
    ("[instrument.grasper]", "[[instrument]]"),
    // TOML itself.
    ("duration = \"4 s\"", "duration = 4 s"),
    ("[body.liver]", "[body.liver"),
];

/// Every slip is shown in its line, with what is wrong and what would do: `messages.txt` is what people read.
#[test]
fn every_slip_is_shown_in_its_line_with_what_would_do() {
    let mut shown = String::new();
    for (from, to) in SLIPS {
        let text = SCENE.replacen(from, to, 1);
        assert_ne!(text, SCENE, "the scene has no {from}");
        let errors = match Scene::parse(&text, "").and_then(|scene| scene.check()) {
            Ok(_) => panic!("{to} is accepted"),
            Err(errors) => errors,
        };
        write!(shown, "{errors}\n\n").unwrap();
    }
    if shown != READ {
        let folder = std::env::temp_dir().join("viscera-messages.txt");
        std::fs::write(&folder, &shown).unwrap();
        let differs = shown.lines().zip(READ.lines()).find(|(now, before)| now != before);
        panic!("the messages read otherwise now, first {differs:#?}; all of them: {}", folder.display());
    }
}

/// The scene that the slips are made in is itself right.
#[test]
fn the_scene_without_slips_is_accepted() {
    let checked = Scene::parse(SCENE, "").and_then(|scene| scene.check());
    assert_eq!(checked.map_err(|errors| errors.to_string()).map(|file| file.body.len()), Ok(1));
}

/// An error has its bytes, line and column, for editors and programs.
#[test]
fn an_error_knows_its_bytes_line_and_column() {
    let text = "gravity = [0, 0, 0] # m/s²\nduration = \"5 kg\"";
    let errors = Scene::parse(text, "").and_then(|scene| scene.check()).unwrap_err();
    let place = errors.first().place.as_ref().unwrap();
    assert_eq!(&text[place.span.clone()], "\"5 kg\"");
    assert_eq!(errors.first().line_and_column(), Some((2, 12)));
}

/// All that is wrong is shown at once, in the order of the file.
#[test]
fn all_slips_of_a_file_are_shown_at_once_in_its_order() {
    let text = SCENE.replace("1060", "-1").replace("\"12 mm\"", "\"12 kg\"").replace("close", "clse");
    let errors = Scene::parse(&text, "").and_then(|scene| scene.check()).unwrap_err();
    let lines: Vec<_> = errors.all().iter().filter_map(|error| error.line_and_column()).map(|place| place.0).collect();
    assert_eq!(lines, [8, 9, 17]);
}

/// An override changes the scene; what is wrong with it is shown in the override, not in the file.
#[test]
fn an_override_is_shown_where_it_was_written() {
    let mut scene = Scene::parse(SCENE, "").unwrap();
    scene.set("body.liver.law.young", "8 kPa").unwrap();
    scene.set("body.liver.fix", "[\"back\", \"surface\"]").unwrap();
    scene.set("instrument.grasper.path.1.0", "3").unwrap();
    let file = scene.check().unwrap();
    assert_eq!(file.body["liver"].law.young.map(|young| young.0), Some(8000.0));

    scene.set("body.liver.law.young", "8 kg").unwrap();
    let message = scene.check().unwrap_err().to_string();
    assert_eq!(
        message,
        "error: expected a pressure, found the mass \"8 kg\"\n \
         \u{20}┌─ --set:1:24\n\
         1 │ body.liver.law.young = 8 kg\n\
         \u{20} │                        ^^^^ write a number in Pa, or a string with one of the units Pa, kPa, MPa, GPa, \
         N/m^2, N/m², mmHg"
    );
}

#[test]
fn an_override_that_leads_nowhere_says_so() {
    let mut scene = Scene::parse(SCENE, "").unwrap();
    let mut refusal = |key: &str| scene.set(key, "1").map_err(|errors| errors.first().message.clone());
    assert_eq!(refusal("density.of"), Ok(()), "a new table; the check refuses it");
    assert_eq!(refusal("duration.of"), Err("`duration` is not a table, so it has no key `of`".into()));
    assert_eq!(refusal("instrument.grasper.path.7"), Err("`7` is no place in the list".into()));
    assert_eq!(refusal("body..liver"), Err("a part of the key is empty".into()));
}

#[test]
fn a_scene_file_that_is_not_there_is_named() {
    let message = Scene::load("no/such/scene.toml").unwrap_err().to_string();
    assert!(message.starts_with("error: cannot read the scene no/such/scene.toml: "), "{message}");
}

/// However a scene file is damaged, it is refused with words or accepted: stretches of it are cut out, doubled and moved.
#[test]
fn no_damage_makes_the_check_panic() {
    let mut state = 1_u64;
    // Knuth's linear congruential generator: the same damages on every machine.
    let mut pick = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let letters: Vec<char> = SCENE.chars().collect();
    for _ in 0..2000 {
        let (from, length, to) = (pick(letters.len()), pick(40), pick(letters.len()));
        let stretch = &letters[from..letters.len().min(from + length)];
        let mut damaged = letters.clone();
        if pick(2) == 0 {
            damaged.drain(from..letters.len().min(from + length));
        }
        let to = to.min(damaged.len());
        damaged.splice(to..to, stretch.iter().copied());
        let text: String = damaged.into_iter().collect();
        if let Err(errors) = Scene::parse(&text, "").and_then(|scene| scene.check()) {
            assert!(errors.to_string().starts_with("error: "));
        }
    }
}
