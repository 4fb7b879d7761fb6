//! From scene to world: what is built, and what is refused with the line that it stands in.

use std::fmt::Write;
use std::path::Path;

use viscera_scene::{BuiltScene, Scene, SceneErrors};

const SCENE: &str = include_str!("box.toml");
const READ: &str = include_str!("refusals.txt");

fn build(text: &str) -> Result<BuiltScene<f64>, SceneErrors> {
    Scene::parse(text, Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/build"))?.build()
}

fn built(text: &str) -> BuiltScene<f64> {
    build(text).unwrap_or_else(|errors| panic!("{errors}"))
}

/// What stands in the right scene, and what stands there instead.
const SLIPS: &[(&str, &str)] = &[
    // Regions.
    ("fix = \"z-min\"", "fix = { sphere = { centre = [0, 0, \"1 m\"], radius = \"5 cm\" } }"),
    ("fix = \"z-min\"", "fix = \"bottom\""),
    ("fix = \"z-min\"", "fix = [\"z-min\", { nodes = [1000] }]"),
    ("fix = \"z-min\"", "fix = { box = { low = [0, \"1 m\", 0], high = [1, 0, 1] } }"),
    ("fix = \"z-min\"", "fix = { plane = { point = [0, 0, 0], normal = [0, 0, 0] } }"),
    ("fix = \"z-min\"", "slide = [{ region = \"z-min\", normal = [0, 0, 0] }]"),
    ("region = \"x-max\"", "region = { nearest = [0, 0, 0] }"),
    ("normal = [0, 0, 1] }", "normal = [0, 0, 1] }, intersection = []"),
    ("point = [0, 0, 0.2]", "point = [0, 0, 0.35]"),
    // Laws and models.
    ("kind = \"tensor-mass\"", "kind = \"linear-tensor-mass\""),
    ("kind = \"tensor-mass\" }", "kind = \"total-lagrangian\", adaptive = \"2 cm\" }"),
    ("cells = [1, 1, 4]", "cells = [1, 1, 4], shape = \"hexahedra\""),
    ("young = \"20 kPa\"", "young = \"20 kPa\", lambda = 3"),
    ("law = { kind = \"st-venant-kirchhoff\", young = \"20 kPa\"", "law = { kind = \"linear\", young = \"20 kPa\""),
    ("young = \"10 kPa\", poisson = 0.3", "lambda = -700, mu = \"1 kPa\""),
    ("direction = [0, 0, 1]", "direction = [0, 0, 0]"),
    ("direction = [0, 0, 1]", "along = [[0, 0, 0], [0, 0, 0]]"),
    ("direction = [0, 0, 1]", "file = \"two-directions.csv\""),
    ("factor = 3", "lambda = 1, mu = 1"),
    // Meshes.
    ("cells = [1, 1, 4]", "cells = [5000, 5000, 5000]"),
    ("cells = [1, 1, 4]", "cells = [1, 1, 4], shape = \"hexahedra\", cut = \"five\""),
    ("size = [\"10 cm\"", "size = [\"-10 cm\""),
    ("generate = \"box\", size = [\"10 cm\", \"10 cm\", \"40 cm\"], cells = [1, 1, 4]", "file = \"no-such.msh\""),
    (
        "generate = \"box\", size = [\"10 cm\", \"10 cm\", \"40 cm\"], cells = [1, 1, 4]",
        "generate = \"tube\", inner-radius = \"2 cm\", outer-radius = \"1 cm\", height = \"4 cm\", edge = \"5 mm\"",
    ),
    ("density = 1000", "density = 1000\nplace = { rotate = { axis = [0, 0, 0], angle = \"90 deg\" } }"),
    // Curves and instruments.
    ("[\"1 s\", [0, 0, \"1 cm\"]]", "[\"0 s\", [0, 0, \"1 cm\"]]"),
    ("way.csv", "no-such.csv"),
    ("way.csv", "short.csv"),
    ("off = \"2 s\"", "off = \"1 s\""),
    (
        "size = [\"10 cm\", \"10 cm\", \"40 cm\"], cells = [1, 1, 4] }\ndensity = 1000\nlaw = { kind = \"st-venant-kirchhoff\", young = \"10 kPa\", poisson = 0.3 }\nmodel = { kind = \"tensor-mass\" }",
        "size = [\"10 cm\", \"10 cm\", \"40 cm\"], cells = [1, 1, 4], shape = \"hexahedra\" }\ndensity = 1000\nlaw = { kind = \"st-venant-kirchhoff\", young = \"10 kPa\", poisson = 0.3 }",
    ),
    // Steps.
    ("substep = \"1e-4 s\"", "substep = \"1 s\""),
    ("substep = \"1e-4 s\"", "integrator = { kind = \"explicit\", newton = \"full\" }"),
    ("substep = \"1e-4 s\"", "integrator = { kind = \"explicit\", matrix = \"assembled\" }"),
    ("substep = \"1e-4 s\"", "integrator = { kind = \"explicit\", preconditioner = \"multigrid\" }"),
    ("substep = \"1e-4 s\"", "integrator = { kind = \"quasi-static\", linear = { iterations = 5 } }"),
    ("substep = \"1e-4 s\"", "integrator = { kind = \"bdf2\", solver = \"direct\" }"),
    ("substep = \"1e-4 s\"", "integrator = { kind = \"bdf2\", beta = 0.3 }"),
    ("substep = \"1e-4 s\"", "integrator = { kind = \"bdf2\", linear = {} }"),
    ("substep = \"1e-4 s\"", "substep = \"1 ms\"\nintegrator = { kind = \"backward-euler\" }"),
    ("substep = \"1e-4 s\"", "integrator = { kind = \"energy-momentum\", newton = \"linearised\" }"),
    // The model is `tensor-mass`.
    ("substep = \"1e-4 s\"", "integrator = { kind = \"energy-momentum\" }"),
    ("density = 1000\n", "density = 1000\nstiffness-damping = \"10 ms\"\n"),
    // Models of other laws, settings of other models.
    ("kind = \"tensor-mass\" }", "kind = \"corotational\" }"),
    ("kind = \"tensor-mass\" }", "kind = \"stiffness-warping\", rotation = \"qr\" }"),
    ("kind = \"tensor-mass\" }", "kind = \"total-lagrangian\", tangent = \"exact\" }"),
    ("kind = \"tensor-mass\" }", "kind = \"tensor-mass\", volume = \"current\" }"),
    ("kind = \"tensor-mass\" }", "kind = \"total-lagrangian\", stabilise = 0.1 }"),
    ("kind = \"tensor-mass\" }", "kind = \"nodally-integrated\", stabilise = 2 }"),
    ("kind = \"tensor-mass\" }", "kind = \"shape-memory\" }"),
    // Constraints and muscles.
    ("fix = \"z-min\"", "fix = \"z-min\"\nrigid = [\"z-min\"]"),
    ("fix = \"z-min\"", "rigid = [{ nodes = [0, 1] }]"),
    ("fix = \"z-min\"", "exact-volume = [{ name = \"base\", region = \"z-min\" }]"),
    (
        "fix = \"z-min\"",
        "muscle = [{ region = { nearest = [0, 0, 0] }, stiffness = \"5 N/m\", contraction = 0.3, activation = 1 }]",
    ),
    ("fix = \"z-min\"", "muscle = [{ region = \"z-min\", stiffness = \"5 N/m\", contraction = 0.3, activation = 2 }]"),
    ("fix = \"z-min\"", "muscle = [{ region = \"z-min\", stiffness = \"5 N\", contraction = 1, activation = 1 }]"),
];

/// What cannot be built is refused in its line, with what is near or what would do: `refusals.txt` is what people read.
#[test]
fn what_cannot_be_built_is_refused_in_its_line() {
    let mut shown = String::new();
    for (from, to) in SLIPS {
        let text = SCENE.replacen(from, to, 1);
        assert_ne!(text, SCENE, "the scene has no {from}");
        let errors = match build(&text) {
            Ok(_) => panic!("{to} is accepted"),
            Err(errors) => errors.to_string(),
        };
        write!(shown, "{}\n\n", errors.replace(env!("CARGO_MANIFEST_DIR"), "…")).unwrap();
    }
    if shown != READ {
        let fresh = std::env::temp_dir().join("viscera-refusals.txt");
        std::fs::write(&fresh, &shown).unwrap();
        let differs = shown.lines().zip(READ.lines()).find(|(now, before)| now != before);
        panic!("the refusals read otherwise now, first {differs:#?}; all of them: {}", fresh.display());
    }
}

/// The bar is 4 kg per half at 2000 kg/m³ and 2 kg at 1000: 6 kg, and the substep asked for is kept.
#[test]
fn a_part_has_its_own_density() {
    let summary = built(SCENE).summary();
    approx::assert_relative_eq!(summary.bodies[0].mass, 2.0 + 4.0, max_relative = 1e-12);
    assert_eq!(summary.bodies[0].fixed, (4, "`z-min`".to_owned()));
    assert_eq!(summary.bodies[0].prescribed, 4);
    assert_eq!(summary.instruments[1].path, 0.01);
}

/// Every setting of a scene is one of the engine, and arrives there.
#[test]
fn integrators_and_models_are_those_that_the_scene_asks_for() {
    use viscera::dynamics::implicit::{Implicit, MatrixForm, Newton, Preconditioning, Scheme};
    use viscera::solver::Stop;
    use viscera::world::Integrator;

    let integrator = |text: &str| {
        let text = SCENE.replacen("substep = \"1e-4 s\"", &format!("integrator = {{ {text} }}"), 1);
        match built(&text.replacen("\"tensor-mass\"", "\"total-lagrangian\"", 1)).world.config().integrator {
            Integrator::Implicit(settings) => settings,
            other => panic!("{text} is {other:?}"),
        }
    };
    assert_eq!(integrator("kind = \"backward-euler\""), Implicit::default());
    let full = Newton::Full { relative: 1e-6, at_most: 30 };
    let linear = Stop::Iterations(25);
    let expected = Implicit {
        scheme: Scheme::BackwardEuler,
        newton: full,
        linear,
        matrix: MatrixForm::Assembled,
        preconditioner: Preconditioning::Multigrid,
    };
    let ways = "matrix = \"assembled\", preconditioner = \"multigrid\"";
    let text = format!("newton = {{ tolerance = 1e-6 }}, linear = {{ iterations = 25 }}, {ways}");
    assert_eq!(integrator(&format!("kind = \"backward-euler\", {text}")), expected);
    let newmark = Scheme::Newmark { beta: 0.25, gamma: 0.6 };
    assert_eq!(integrator("kind = \"newmark\", gamma = 0.6"), Implicit::accurate(newmark));
    let linear = Stop::Tolerance { relative: 1e-9, at_most: 2000 };
    let expected = Implicit { linear, ..Implicit::accurate(Scheme::Bdf2) };
    assert_eq!(integrator("kind = \"bdf2\", newton = \"full\", linear = { tolerance = 1e-9 }"), expected);
    assert_eq!(integrator("kind = \"energy-momentum\""), Implicit::accurate(Scheme::EnergyMomentum));
}

/// What only explicit steps know is refused in the line of the integrator.
#[test]
fn implicit_integrators_refuse_volumes_that_are_kept_exactly() {
    let text = SCENE.replacen("substep = \"1e-4 s\"", "integrator = { kind = \"bdf2\" }", 1).replacen(
        "density = 1000",
        "density = 1000\nexact-volume = [{ name = \"bar\", region = \"all\" }]",
        1,
    );
    let error = build(&text).err().map(|errors| errors.to_string()).unwrap_or_default();
    assert!(error.contains("this integrator cannot step body `bar`: it has volumes kept exactly"), "{error}");
    assert!(error.contains("integrator = { kind = \"bdf2\" }") && error.contains("take `explicit`"), "{error}");
}

/// A bar that hangs under its weight, from rest to rest: what fixes it carries that weight from the first step on.
#[test]
fn equilibria_can_be_asked_for_in_every_way() {
    let hang = |settings: &str| {
        let text = format!(
            r#"
            duration = "20 ms"
            step = "10 ms"
            gravity = [0, 0, -0.5]
            integrator = {{ kind = "quasi-static"{settings} }}
            [body.bar]
            mesh = {{ generate = "box", size = [0.1, 0.1, 0.4], cells = [1, 1, 4] }}
            density = 1000
            law = {{ kind = "neo-hookean", young = "10 kPa", poisson = 0.3 }}
            fix = "z-max"
            "#
        );
        let mut built = built(&text);
        assert_eq!(built.world.static_solver().factorises(), settings.contains("direct"));
        for _ in 0..built.steps() {
            built.world.step().unwrap_or_else(|error| panic!("{error}"));
        }
        let seen = built.world.observe(built.bodies["bar"]);
        (seen.max_displacement, seen.reaction.z)
    };
    let (full, carried) = hang("");
    assert!((carried - 2.0).abs() < 1e-5, "{carried} N of 2 N");
    assert_eq!(hang(", newton = \"full\"").0, full);
    assert!((hang(", newton = { tolerance = 1e-6, iterations = 10 }").0 / full - 1.0).abs() < 1e-5);
    let (linear, _) = hang(", newton = \"linearised\"");
    assert!(1e-3 < (linear / full - 1.0).abs(), "{linear} m at small strain, {full} m");
    assert_eq!(hang(", solver = \"iterative\"").0, full);
    for newton in ["", ", newton = \"linearised\""] {
        let (factored, iterated) = (hang(&format!("{newton}, solver = \"direct\"")).0, hang(newton).0);
        assert!((factored / iterated - 1.0).abs() < 1e-9, "{factored} m by a factorisation, {iterated} m");
    }
}

/// A load that St Venant–Kirchhoff tissue cannot bear ends the run with the body, its law, the share that was borne and what to do; the
/// steps before it tell how each share of the load came to rest.
#[test]
fn a_load_beyond_what_the_law_bears_is_told_with_the_share_that_it_bore() {
    use viscera::dynamics::quasi_static::StaticError;
    use viscera::world::StepError;

    for solver in ["iterative", "direct"] {
        let mut built = built(&format!(
            r#"
            duration = "1 s"
            step = "0.1 s"
            gravity = [0, 0, 0]
            integrator = {{ kind = "quasi-static", solver = "{solver}" }}
            [body.bar]
            mesh = {{ generate = "box", size = [0.1, 0.1, 0.05], cells = [2, 2, 1] }}
            density = 1000
            law = {{ kind = "st-venant-kirchhoff", young = "10 kPa", poisson = 0.3 }}
            model = {{ kind = "total-lagrangian" }}
            fix = "z-min"
            load = [{{ region = "z-max", force = [["0 s", [0, 0, 0]], ["1 s", [0, 0, -60]]] }}]
            "#
        ));
        let bar = built.bodies["bar"];
        let error = loop {
            match built.world.step() {
                Ok(_) => {
                    let report = built.world.body(bar).static_report().unwrap();
                    let last = report.steps.last().unwrap();
                    assert_eq!(last.share, 1.0);
                    assert!(report.iterations() > 0 && report.steps.iter().all(|step| step.residuals.len() > 1));
                    assert!(last.residuals[last.residuals.len() - 1] < 1e-6 * last.residuals[0], "{last:?}");
                }
                Err(error) => break error,
            }
            assert!(built.world.time() < 1.0, "nothing gave way");
        };
        let StepError::NoEquilibrium { error: StaticError::NoEquilibrium { body, law, load_factor, .. }, .. } = &error
        else {
            panic!("{error}");
        };
        assert_eq!((body.as_str(), *law), ("bar", "st-venant-kirchhoff"));
        assert!((0.0..1.0).contains(load_factor) && error.to_string().contains("stable-neo-hookean"), "{error}");
        // Pressed evenly the law bears E A/√27 = 19 N; forces that are alike on all nodes press twice as hard on the corners.
        let borne = 60.0 * (built.world.time() + 0.1 * load_factor);
        assert!((9.6..19.3).contains(&borne), "{borne} N");
        assert!(built.world.body(bar).static_report().is_none());
    }
}

/// Every combination of the settings of `corotational` steps, on both kinds of cells, and its name and effect are its own: bars
/// that hang under their weight are pulled out to different lengths.
#[test]
fn every_variant_of_the_corotational_model_can_be_asked_for() {
    let hang = |shape: &str, model: &str| {
        let text = format!(
            r#"
            duration = "20 ms"
            step = "10 ms"
            integrator = {{ kind = "backward-euler", linear = {{ tolerance = 1e-10 }} }}
            [body.bar]
            mesh = {{ generate = "box", size = [0.1, 0.1, 0.4], cells = [1, 1, 4], shape = "{shape}" }}
            density = 1000
            stiffness-damping = "10 ms"
            law = {{ kind = "linear", young = "10 kPa", poisson = 0.3 }}
            model = {{ {model} }}
            fix = "z-min"
            prescribe = [{{ region = "z-max", displacement = [[0, [0, 0, 0]], [0.01, [0.05, 0.02, 0.1]]] }}]
            "#
        );
        let mut built = built(&text);
        for _ in 0..built.steps() {
            built.world.step().unwrap_or_else(|error| panic!("{error}"));
        }
        let bar = built.bodies["bar"];
        (built.world.body(bar).model().to_string(), built.world.observe(bar).elastic_energy)
    };
    for shape in ["tetrahedra", "hexahedra"] {
        let mut energies = Vec::new();
        for rotation in ["polar", "qr", "svd"] {
            for strain in ["at-rest", "updated"] {
                for volume in ["initial", "current"] {
                    for tangent in ["frozen", "exact"] {
                        let settings = format!(
                            "rotation = \"{rotation}\", strain-displacement = \"{strain}\", volume = \"{volume}\", \
                             tangent = \"{tangent}\""
                        );
                        let (model, energy) = hang(shape, &format!("kind = \"corotational\", {settings}"));
                        assert_eq!(model, "corotational");
                        energies.push((settings, energy));
                    }
                }
            }
        }
        for (settings, energy) in &energies {
            for (others, other) in &energies {
                // Singular values find the polar rotation; all else differs.
                let as_polar = |settings: &str| settings.replace("svd", "polar");
                let same = as_polar(settings) == as_polar(others);
                let difference = (energy / other - 1.0).abs();
                assert_eq!(difference < 1e-9, same, "{shape}, {settings} and {others}: {difference:e}");
            }
        }
    }
    assert_eq!(hang("tetrahedra", "kind = \"stiffness-warping\"").0, "stiffness-warping");
}

/// A turn by 90° about x takes z to −y; then the body is moved.
#[test]
fn a_body_is_turned_about_the_origin_and_then_moved() {
    let place =
        "place = { rotate = { axis = [2, 0, 0], angle = \"90 deg\" }, translate = [0, \"1 m\", 0] }\n[[body.bar.part]]";
    let text = SCENE.replacen("[[body.bar.part]]", place, 1).replacen("point = [0, 0, 0.2]", "point = [0, 0, 0]", 1);
    let built = built(&text);
    let (low, high) = built.world.body(built.bodies["bar"]).mesh().bounds();
    for (found, expected) in [(low, [0.0, 0.6, 0.0]), (high, [0.1, 1.0, 0.1])] {
        (0..3).for_each(|axis| approx::assert_abs_diff_eq!(found[axis], expected[axis], epsilon = 1e-12));
    }
}

/// A force on every node of a region of n nodes is n times as much as one on the region.
#[test]
fn a_force_per_node_is_a_total_force_times_the_nodes() {
    let with = |load: &str| {
        let text =
            SCENE.replacen("pressure = \"1 kPa\"", load, 1).replacen("duration", "gravity = [0, 0, 0]\nduration", 1);
        let mut built = built(&text);
        built.world.step().unwrap();
        built.world.body(built.bodies["bar"]).positions().to_vec()
    };
    assert_eq!(with("force-per-node = [0, \"10 mN\", 0]"), with("force = [0, \"100 mN\", 0]"), "10 nodes on the side");
}

/// A bar gives way by σ l/E where the curve that its fibres follow runs across it, and by a quarter of that where it runs
/// along the bar and the fibres are four times as stiff.
#[test]
fn fibres_along_a_curve_take_its_direction_at_each_place() {
    let stretch = |along: &str| {
        let text = format!(
            r#"
            gravity = [0, 0, 0]
            duration = "2 s"
            step = "10 ms"
            [body.bar]
            mesh = {{ generate = "box", size = [0.1, 0.1, 0.4], cells = [1, 1, 4] }}
            density = 1000
            damping = "10 1/s"
            law = {{ kind = "linear", young = "10 kPa", poisson = 0, fibre = {{ along = {along}, factor = 4 }} }}
            fix = "z-min"
            load = [{{ region = "z-max", traction = [0, 0, "100 Pa"] }}]
            "#
        );
        let mut built = built(&text);
        for _ in 0..built.steps() {
            built.world.step().unwrap();
        }
        built.world.observe(built.bodies["bar"]).max_displacement
    };
    // u = σ l/E = 100 Pa · 0.4 m / 10 kPa = 4 mm across, a quarter of it along; poisson 0 and free of locking.
    approx::assert_relative_eq!(stretch("[[0, 0, 0], [1, 0, 0]]"), 4e-3, max_relative = 0.01);
    approx::assert_relative_eq!(stretch("[[0, 0, 0], [0, 0, 1]]"), 1e-3, max_relative = 0.01);
    // Up to half the height nearest to a stretch along the bar, above to one across it: (2 mm)/4 + 2 mm.
    approx::assert_relative_eq!(
        stretch("[[0.05, 0.05, 0.1], [0.05, 0.05, -10], [10, 0.05, -10], [10, 0.05, 0.3], [-10, 0.05, 0.3]]"),
        2.5e-3,
        max_relative = 0.05
    );
}

/// At the density of water, Gmsh's bar of 1 × 1 × 2 cm weighs 2 g. VTK's cube of 1 cm, of which the file holds only the skin,
/// weighs 1 g, less what the lattice cuts off its edges: with ten cells along an edge, under 5 % of it.
#[test]
fn a_mesh_in_millimetres_has_its_true_mass() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../viscera-io/tests/data");
    let mass = |mesh: &str| {
        let text = format!(
            "duration = 1\n[body.cube]\nmesh = {mesh}\ndensity = \"1 g/cm^3\"\n\
             law = {{ kind = \"linear\", young = \"1 kPa\", poisson = 0.3 }}"
        );
        let built = Scene::parse(&text, &data).and_then(|scene| scene.build::<f64>());
        let summary = built.unwrap_or_else(|errors| panic!("{errors}")).summary();
        assert!(!summary.bodies[0].notices.is_empty(), "what was found in the file is told");
        summary.bodies[0].mass
    };
    let bar = mass("{ file = \"bar-22-ascii.msh\", unit = \"mm\", scale = 10 }");
    approx::assert_relative_eq!(bar, 2e-3, max_relative = 1e-9);
    let cube = mass("{ surface = \"cube-ascii.stl\", unit = \"mm\", scale = 10, edge = \"1 mm\" }");
    approx::assert_relative_eq!(cube, 1e-3, max_relative = 0.05);
}
