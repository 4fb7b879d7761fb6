//! What a run leaves behind, and what it shows.

use serde_json::Value;
use viscera_io::{ImportedMesh, read_mesh};

use crate::{CUBE, Desk, sample};

/// The rows of a CSV file of numbers, by the name of the column.
fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let head: Vec<_> = lines.next().expect("a header").split(',').collect();
    let place =
        head.iter().position(|column| *column == name).unwrap_or_else(|| panic!("no column {name} in {head:?}"));
    lines.map(|line| line.split(',').nth(place).expect("a value").parse().expect("a number")).collect()
}

fn body<'a>(summary: &'a Value, name: &str) -> &'a Value {
    summary["bodies"].as_array().expect("bodies").iter().find(|body| body["name"] == name).expect("the body")
}

/// A resection in short: what is burnt away is missing in the last frame, in the mass and in the summary alike.
#[test]
fn what_is_cut_away_is_missing_in_every_record() {
    let desk = Desk::new();
    let arguments = ["run", "liver-resection", "--time", "1.2 s", "--set", "body.liver.mesh.edge=26 mm"];
    desk.viscera(&[&arguments[..], &["--out", "cut"]].concat()).ends_with(0).says("removed").says("real-time factor");

    let summary = desk.json("cut/summary.json");
    let liver = body(&summary, "liver");
    let (cells, removed) = (liver["cells"].as_u64().unwrap(), liver["removed_cells"].as_u64().unwrap());
    assert!(removed > 0);
    assert_eq!(summary["interrupted"], false);
    assert_eq!(summary["failure"], Value::Null);

    let csv = desk.read("cut/observables.csv");
    assert_eq!(column(&csv, "time [s]").len(), 121);
    assert_eq!(column(&csv, "liver: removed cells [1]").last().copied(), Some(removed as f64));
    let force = column(&csv, "grasper: force y [N]");
    assert_eq!(force[0], 0.0, "nothing is held before the jaws close");
    assert!(
        summary["instruments"][0]["peak_force_N"].as_f64().unwrap() >= force.iter().fold(0.0, |a, &b| a.max(b.abs()))
    );

    // 1.2 s in frames of 40 ms, both ends among them.
    let pvd = desk.read("cut/bodies.pvd");
    assert_eq!(pvd.matches("<DataSet").count(), 31);
    assert!(pvd.contains("timestep=\"1.2\" group=\"\" part=\"0\" file=\"frames/liver-000030.vtu\""), "{pvd}");
    let ImportedMesh::Tet(last) = read_mesh(desk.path("cut/frames/liver-000030.vtu"), 1.0).expect("the frame").mesh
    else {
        panic!("tetrahedra")
    };
    assert_eq!(last.cells.len() as u64, cells - removed);
    assert!((last.volume() / liver["volume_m3"].as_f64().unwrap() - 1.0).abs() < 1e-5, "in single precision");
    for picture in ["start.png", "middle.png", "end.png"] {
        assert!(desk.read_bytes(&format!("cut/{picture}")).starts_with(b"\x89PNG"), "{picture}");
    }
}

/// Cells that turn inside out, the worst shape, and what the internal forces come to stand in the table and in the summary;
/// the corotational model of an isotropic law keeps Newton's third law and angular momentum to rounding, inverted or not.
#[test]
fn the_health_of_the_cells_is_on_record() {
    let desk = Desk::new();
    let arguments = ["run", "liver-inversion", "--time", "1.2 s", "--precision", "double", "--pictures=0"];
    let coarse = ["--set", "body.liver.mesh.edge=26 mm", "--set", "step=20 ms", "--out", "inside-out"];
    desk.viscera(&[&arguments[..], &coarse].concat()).ends_with(0).says("inverted").says("by backward-euler");

    let summary = desk.json("inside-out/summary.json");
    let liver = body(&summary, "liver");
    let csv = desk.read("inside-out/observables.csv");
    let inverted = column(&csv, "liver: inverted cells [1]");
    let quality = column(&csv, "liver: worst quality [1]");
    let most = inverted.iter().fold(0.0, |a: f64, &b| a.max(b));
    assert!(most > 0.0);
    assert_eq!(liver["peak_inverted_cells"].as_f64(), Some(most));
    let lowest = quality.iter().fold(1.0, |a: f64, &b| a.min(b));
    assert!(lowest < 0.0);
    // Reading JSON may take the last digit.
    assert!((liver["lowest_quality"].as_f64().unwrap() - lowest).abs() < 1e-15);
    // Forces of newtons over decimetres; sixteen digits.
    let elastic = column(&csv, "liver: elastic energy [J]").iter().fold(0.0, |a: f64, &b| a.max(b));
    assert!(elastic > 0.1, "{elastic} J");
    for axis in ["x", "y", "z"] {
        for column_of in
            [format!("liver: net internal force {axis} [N]"), format!("liver: net internal torque {axis} [N m]")]
        {
            let largest = column(&csv, &column_of).iter().fold(0.0, |a: f64, &b| a.max(b.abs()));
            assert!(largest < 1e-9 * elastic, "{column_of}: {largest}");
        }
    }
    assert!(liver["peak_net_internal_force_N"].as_f64().unwrap() < 1e-9 * elastic);
    assert!(liver["peak_net_internal_torque_Nm"].as_f64().unwrap() < 1e-9 * elastic);
    assert_eq!(summary["integrator"], "backward-euler");
    assert!(summary["implicit"]["linear_iterations"].as_u64().unwrap() > summary["steps"].as_u64().unwrap());
}

/// A quasi-static run tells how each equilibrium was found: residuals of every share of the load, that fall to what was asked for. Newton's
/// method falls quadratically at the end, whichever solver it has; at small strain one solve has one row before and one after.
#[test]
fn a_quasi_static_run_leaves_the_residuals_of_every_load_step() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE.replace("duration", "precision = \"double\"\nduration").replace("10 kPa", "2 kPa"));
    let runs = [("iterative", "full"), ("direct", "full"), ("direct", "linearised")];
    let displacements = runs.map(|(solver, newton)| {
        let set = format!("integrator={{ kind = \"quasi-static\", solver = \"{solver}\", newton = \"{newton}\" }}");
        let folder = format!("{solver}-{newton}");
        let outcome = desk.viscera(&["run", "cube.toml", "--pictures=0", "--set", &set, "--out", &folder]).ends_with(0);
        outcome.says("equilibria, 10.0 ms apart").says("equilibria.csv");

        let csv = desk.read(&format!("{folder}/equilibria.csv"));
        assert!(csv.starts_with("time [s],body [0 cube],share of the load [1],iteration [1],residual [1]\n"), "{csv}");
        let [times, shares, counts, residuals] =
            ["time [s]", "share of the load [1]", "iteration [1]", "residual [1]"].map(|name| column(&csv, name));
        let first: Vec<usize> = (0..times.len()).take_while(|&row| times[row] == times[0]).collect();
        let ends: Vec<usize> =
            (0..times.len()).filter(|&row| row + 1 == times.len() || counts[row + 1] == 0.0).collect();
        assert!((times[times.len() - 1] - 0.1).abs() < 1e-12 && shares[shares.len() - 1] == 1.0);
        if newton == "full" {
            assert!(first.len() > 3 && ends.iter().all(|&row| residuals[row] <= 1e-10), "{csv}");
            // The next residual is of the order of the square of the one before.
            let last = first.len() - 1;
            assert!(residuals[last] < 10.0 * residuals[last - 1].powi(2) + 1e-10, "{csv}");
        } else {
            assert_eq!(first.len(), 2);
        }
        body(&desk.json(&format!("{folder}/summary.json")), "cube")["max_displacement_m"].as_f64().unwrap()
    });
    assert!((displacements[0] / displacements[1] - 1.0).abs() < 1e-8, "{displacements:?} m");
    assert!((displacements[2] / displacements[1] - 1.0).abs() > 1e-3, "{displacements:?} m");

    // More than the law can bear: what stands, and how much it bore.
    let heavy = ["run", "cube.toml", "--pictures=0", "--set", "integrator={ kind = \"quasi-static\" }", "--set"];
    let heavy = [&heavy[..], &["gravity=[0, 200, 0]", "--out", "heavy"]].concat();
    desk.viscera(&heavy).ends_with(1).complains("has an equilibrium at").complains("stable-neo-hookean");
}

/// The table of INRIA RR-4028: bent by F, 2F and 3F, the linear cylinder gains several to tens of per cent of volume, the
/// non-linear one stays below 2.5 %, and the volume-keeping force lowers that further.
#[test]
fn bent_cylinders_keep_their_volume_as_the_report_tabulates() {
    let desk = Desk::new();
    let mut arguments = vec!["run".to_owned(), "cylinder-bend".to_owned(), "--pictures=0".to_owned()];
    arguments.push("--out=bend".to_owned());
    arguments.extend(["--set=output.interval=10 s", "--time=1.5 s"].map(str::to_owned));
    for law in ["linear", "non-linear", "keep-volume"] {
        for force in ["1F", "2F", "3F"] {
            arguments.push(format!("--set=body.{law}-{force}.mesh.edge=5 mm"));
        }
    }
    let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
    let outcome = desk.viscera(&arguments).ends_with(0).says("volume variation");
    let table: Vec<_> = outcome.out.lines().skip_while(|line| !line.starts_with("volume variation")).skip(1).collect();
    assert_eq!(table[0].split_whitespace().collect::<Vec<_>>(), ["1F", "2F", "3F"]);

    let summary = desk.json("bend/summary.json");
    let variation = |name: &str| body(&summary, name)["volume_variation"].as_f64().unwrap();
    for (force, least) in [("1F", 0.03), ("2F", 0.1), ("3F", 0.2)] {
        let linear = variation(&format!("linear-{force}"));
        let free = variation(&format!("non-linear-{force}")).abs();
        let kept = variation(&format!("keep-volume-{force}")).abs();
        assert!(linear > least, "the linear cylinder gains {linear} at {force}");
        assert!(free < 0.025, "the non-linear one changes by {free} at {force}");
        assert!(kept < free, "kept, it changes by {kept}, in place of {free}, at {force}");
        // What the screen shows is what the summary says.
        let shown = format!("{:+.2} %", 100.0 * linear);
        assert!(table[1].contains(&shown), "{shown} is not in {}", table[1]);
    }
    // The linear law swells as the square of the force: (2F)/(F) is 4, (3F)/(F) is 9.
    assert!((variation("linear-2F") / variation("linear-1F") - 4.0).abs() < 0.1);
    assert!((variation("linear-3F") / variation("linear-1F") - 9.0).abs() < 0.2);
}

/// Gravity is carried by what is fixed: a body that has come to rest weighs there what its density and volume say.
#[test]
fn a_bar_by_gmsh_and_a_cube_by_vtk_hang_with_their_weight() {
    let desk = Desk::new();
    let scene = |mesh: &str, fix: &str| {
        format!(
            "duration = \"3 s\"\nstep = \"10 ms\"\nprecision = \"double\"\n[body.hung]\nmesh = {{ {mesh} }}\n\
             density = 1000\ndamping = \"20 1/s\"\nlaw = {{ kind = \"st-venant-kirchhoff\", young = \"20 kPa\", poisson = 0.3 }}\nfix = {fix}\n"
        )
    };
    let file = |name: &str| sample(name).to_str().expect("UTF-8").replace('\\', "/");
    let bar = scene(&format!("file = \"{}\", unit = \"cm\", scale = 5", file("bar-41-binary.msh")), "\"bottom\"");
    let above = "{ half-space = { point = [0, \"4 cm\", 0], normal = [0, 1, 0] } }";
    let cube =
        scene(&format!("surface = \"{}\", unit = \"cm\", scale = 10, edge = \"3 cm\"", file("cube-binary.stl")), above);
    for (name, text) in [("bar", bar), ("cube", cube)] {
        desk.write(&format!("{name}.toml"), text);
        desk.viscera(&["run", &format!("{name}.toml"), "--quiet"]).ends_with(0);
        let summary = desk.json(&format!("out/{name}/summary.json"));
        let hung = body(&summary, "hung");
        let [x, y, z] = [0, 1, 2].map(|axis| hung["reaction_N"][axis].as_f64().unwrap());
        let weight = 9.81 * hung["mass_kg"].as_f64().unwrap();
        // What is left of the swinging after 3 s of damping.
        assert!((y / weight - 1.0).abs() < 1e-4 && x.hypot(z) < 1e-4 * weight, "{name}: {x}, {y}, {z} N, {weight} N");
    }
}

/// Two bodies, one file for each in every frame, and one collection over both.
#[test]
fn several_bodies_are_parts_of_one_series() {
    let desk = Desk::new();
    desk.write(
        "two.toml",
        format!("{CUBE}\n{}", CUBE.split_once("\n\n").expect("a body").1.replace("body.cube", "body.\"second cube\"")),
    );
    desk.viscera(&["run", "two.toml", "--out", "two"]).ends_with(0);
    let pvd = desk.read("two/bodies.pvd");
    assert!(pvd.contains("part=\"0\" file=\"frames/cube-000000.vtu\""), "{pvd}");
    assert!(pvd.contains("part=\"1\" file=\"frames/second_cube-000000.vtu\""), "{pvd}");
    assert!(desk.read("two/observables.csv").contains(",second cube: elastic energy [J],"));
}

/// A shorter run into the same folder leaves nothing of the longer one before it.
#[test]
fn a_second_run_replaces_the_first_and_leaves_other_files_alone() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE);
    desk.viscera(&["run", "cube.toml", "--pictures", "5"]).ends_with(0);
    assert!(desk.path("out/cube/picture-000004.png").exists());
    desk.write("out/cube/notes.txt", "mine");
    let outcome = desk.viscera(&["run", "cube.toml", "--time", "0.01", "--quiet", "--pictures", "1"]).ends_with(0);
    assert_eq!((outcome.out.as_str(), outcome.err.as_str()), ("", ""));
    let mut files: Vec<_> =
        std::fs::read_dir(desk.path("out/cube")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    files.sort();
    assert_eq!(files, ["bodies.pvd", "end.png", "frames", "notes.txt", "observables.csv", "summary.json"]);
    // The start and the last step, though the next frame was not due yet.
    assert_eq!(std::fs::read_dir(desk.path("out/cube/frames")).unwrap().count(), 2);
}

/// A step that cannot be made ends the run: the records up to it are whole, and the message says what to change.
#[test]
fn a_step_that_fails_keeps_what_stands_and_says_what_to_change() {
    let desk = Desk::new();
    let force = "[[\"0.05 s\", [0, 0, 0]], [\"0.1 s\", [0, \"-1e15 kN\", 0]]]";
    let crushed = format!("{CUBE}load = [{{ region = \"y-min\", force = {force} }}]\n");
    desk.write("crushed.toml", crushed);
    desk.viscera(&["run", "crushed.toml"])
        .ends_with(1)
        .complains("body `cube`")
        .complains("the step is undone")
        .complains("what was computed up to");
    let summary = desk.json("out/crushed/summary.json");
    assert!(summary["failure"].as_str().expect("why").contains("near cell"));
    let time = summary["simulated_time_s"].as_f64().unwrap();
    assert!(0.0 < time && time < 0.1, "{time} s");
    assert_eq!(column(&desk.read("out/crushed/observables.csv"), "time [s]").last().copied(), Some(time));
    assert!(desk.path("out/crushed/end.png").exists());
}

/// Each closed surface whose volume is kept exactly has columns of its own: what it keeps, what is left of the error, and the pressure that
/// it takes.
#[test]
fn every_volume_that_is_kept_is_on_record() {
    let desk = Desk::new();
    let thorax =
        r#"body.trunk.exact-volume=[{ name = "abdomen", region = "abdomen" }, { name = "all", region = "all" }]"#;
    let arguments = ["run", "breathing-trunk", "--time", "0.8 s", "--pictures=0", "--out", "breath", "--set", thorax];
    desk.viscera(&arguments).ends_with(0);
    let csv = desk.read("breath/observables.csv");
    for name in ["abdomen", "all"] {
        let kept = column(&csv, &format!("trunk: {name}: kept volume [m^3]"));
        let errors = column(&csv, &format!("trunk: {name}: volume error [1]"));
        assert!(kept[0] > 1e-3 && kept.iter().all(|volume| *volume == kept[0]), "{name}: {kept:?}");
        assert!(errors.iter().all(|error| error.abs() < 1e-13), "{name}: {errors:?}");
        let pressure = column(&csv, &format!("trunk: {name}: pressure [Pa]"));
        assert!(pressure[0] == 0.0 && pressure.last().is_some_and(|last| last.abs() > 1.0), "{name}: {pressure:?}");
    }
    let worst = column(&csv, "trunk: volume error [1]");
    let [a, b] = ["abdomen", "all"].map(|name| column(&csv, &format!("trunk: {name}: volume error [1]")));
    assert!(worst.iter().zip(a.iter().zip(&b)).all(|(worst, (a, b))| *worst == a.abs().max(b.abs())));
}
