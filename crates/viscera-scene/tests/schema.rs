//! The schema that editors use.

use std::path::Path;

use viscera_scene::{Scene, schema, schema_text};

/// The schema in `scenes/` is the one that the program checks with; `viscera check --schema` writes it.
#[test]
fn the_schema_beside_the_scenes_is_the_one_that_is_checked_with() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/scene.schema.json");
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    if kept != schema_text() {
        let fresh = std::env::temp_dir().join("scene.schema.json");
        std::fs::write(&fresh, schema_text()).unwrap();
        panic!("{} is out of date: copy {} over it", path.display(), fresh.display());
    }
}

/// No key without a word about what it is: the schema is the reference of the format.
#[test]
fn every_key_is_described() {
    fn walk(schema: &serde_json::Value, path: &str, bare: &mut Vec<String>) {
        let Some(members) = schema.as_object() else {
            return schema.as_array().into_iter().flatten().for_each(|item| walk(item, path, bare));
        };
        for (key, property) in members.get("properties").and_then(|keys| keys.as_object()).into_iter().flatten() {
            // A tag and a shape are described where they are chosen.
            let chosen = property.get("const").is_some() || property["type"] == "object";
            let described = property.get("description").is_some() || members.get("description").is_some();
            if !chosen && !described {
                bare.push(format!("{path}.{key}"));
            }
        }
        for (key, member) in members {
            walk(member, &format!("{path}.{key}"), bare);
        }
    }
    let mut bare = Vec::new();
    walk(&schema(), "", &mut bare);
    assert_eq!(bare, Vec::<String>::new());
}

/// TOML has no null, so a schema that offers it misleads.
#[test]
fn the_schema_never_offers_null() {
    assert!(!schema_text().contains("null"));
}

/// What is written as TOML reads as the same scene.
#[test]
fn a_written_scene_reads_as_the_same_scene() {
    let text = r#"
        title = "everything"
        duration = "1 min"
        step = "10 ms"
        substep = "1e-4 s"
        precision = "double"
        integrator = { kind = "newmark", newton = { tolerance = 1e-6, iterations = 9 }, linear = { tolerance = 1e-9 }, matrix = "assembled", preconditioner = "multigrid", beta = 0.3, gamma = 0.6 }
        output = { interval = "20 ms", camera = { look = [0, 0, -1] } }

        [body.a]
        mesh = { file = "a.msh", unit = "mm", scale = 2.0 }
        place = { translate = ["1 cm", 0, 0], rotate = { axis = [0, 0, 1], angle = "90 deg" } }
        density = "1.06 g/cm^3"
        law = { kind = "linear", lambda = "1 kPa", mu = 500, fibre = { along = [[0, 0, 0], [1, 0, 0]], factor = 2 } }
        model = { kind = "total-lagrangian", keep-volume = 1000 }
        fix = ["surface", { box = { low = [0, 0, 0], high = ["1 m", 1, 1] } }, { intersection = ["all", { nodes = [1, 2] }] }]
        loose-pieces = "drop"
        part = [{ region = "tumour", law = { kind = "linear", young = "20 kPa", poisson = 0.3 } }]
        prescribe = [{ region = { nearest = [0, 0, 0] }, displacement = [["0 s", [0, 0, 0]], ["1 s", [0, "1 cm", 0]]] }]
        slide = [
            { region = "surface", normal = [1, 0, 0] },
            { region = "all", normal = [0, 0, 2], displacement = [["0 s", 0], ["1 s", "1 cm"]] },
        ]
        attach = [{ region = "surface", to = "b" }]
        load = [
            { region = { half-space = { point = [0, 0, 0], normal = [1, 0, 0] } }, force = [0, "1 N", 0] },
            { region = "surface", pressure = [[0, 0], [1, "2 kPa"]] },
            { region = { plane = { point = [0, 0, 0], normal = [0, 1, 0] } }, traction = { file = "t.csv" } },
        ]
        [body.b]
        mesh = { generate = "box", size = [1, 1, 1], cells = [2, 2, 2], shape = "hexahedra" }
        density = 1000
        law = { kind = "linear", young = 1000, poisson = 0.3 }
        model = { kind = "corotational", rotation = "qr", strain-displacement = "updated", volume = "current", tangent = "exact" }
        stiffness-damping = "10 ms"

        [body.c]
        mesh = { generate = "box", size = [1, 1, 1], cells = [2, 2, 2] }
        density = 1000
        law = { kind = "stable-neo-hookean", young = 1000, poisson = 0.499 }
        model = { kind = "nodally-integrated", stabilise = 0.05 }

        [instrument.hook]
        kind = "cautery"
        path = [0, 0, 0]
        on = "1 s"
        power = "40 W"
        heat = "2.4 J/mm^3"
        shaft = { radius = "1 mm" }
        trocar = [0, "20 cm", 0]

        [instrument.probe]
        kind = "probe"
        path = [["0 s", [0, 0, 0]], ["1 s", [0, "1 cm", 0]]]
        direction = [0, -1, 1]
        friction = 0.2

        [instrument.jaws]
        kind = "grasper"
        path = [0, 0, 0]
        close = "1 s"
        grip = "2 N"
        jaws = { opening = "50 deg" }
        roll = "90 deg"
    "#;
    let read = |text: &str| Scene::parse(text, "").and_then(|scene| scene.check()).unwrap_or_else(|e| panic!("{e}"));
    let scene = read(text);
    assert_eq!(read(&scene.to_toml().unwrap()), scene);
    assert_eq!(scene.body.keys().collect::<Vec<_>>(), ["a", "b", "c"], "bodies keep their order");
}
