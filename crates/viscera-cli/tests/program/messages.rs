//! What the program says when something is wrong, and the code it ends with.

use std::fs;

use crate::{CUBE, Desk, outcome, sample};

/// Runs the cube with one text in place of another.
fn run_with(wanted: &str, given: &str) -> crate::Outcome {
    assert!(CUBE.contains(wanted), "the scene has no `{wanted}`");
    let desk = Desk::new();
    desk.write("cube.toml", CUBE.replace(wanted, given));
    let outcome = desk.viscera(&["run", "cube.toml"]);
    assert!(!desk.path("out").exists(), "a scene that is refused leaves nothing behind");
    outcome
}

#[test]
fn the_help_lists_the_commands_and_the_exit_codes() {
    let desk = Desk::new();
    let outcome = desk.viscera(&["--help"]).ends_with(0).says("Usage: viscera").says("130  interrupted by Ctrl-C");
    assert_eq!(outcome.err, "");
    desk.viscera(&["run", "--help"]).ends_with(0).says("0    it went well").says("--set <KEY=VALUE>");
    let version = format!("viscera {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(desk.viscera(&["--version"]).ends_with(0).out, version);
}

#[test]
fn wrong_usage_ends_with_2() {
    let desk = Desk::new();
    desk.viscera(&["run"]).ends_with(2).complains("<SCENE>");
    desk.viscera(&["runn", "x"]).ends_with(2).complains("'run'");
    desk.viscera(&["run", "liver-pull", "--set", "step"]).ends_with(2).complains("--set step: there is no `=`");
    desk.viscera(&["run", "liver-pull", "--precision", "half"]).ends_with(2).complains("single, double");
}

#[test]
fn a_missing_scene_is_named_and_the_built_in_ones_are_listed() {
    Desk::new()
        .viscera(&["run", "liver-resektion"])
        .ends_with(2)
        .complains("error: liver-resektion: there is no such file, and no built-in scene of that name")
        .complains("liver-pull, liver-resection");
}

#[test]
fn an_unknown_key_is_shown_in_its_line() {
    let outcome = run_with("young = ", "youngs = ").ends_with(2);
    let lines = [
        "error: unknown key `youngs`, did you mean `young`?",
        "  ┌─ cube.toml:8:39",
        "8 │ law = { kind = \"st-venant-kirchhoff\", youngs = \"10 kPa\", poisson = 0.4 }",
        "  │                                       ^^^^^^ a law knows: young, poisson, lambda, mu, fibre, tissue",
    ];
    assert_eq!(outcome.err.lines().collect::<Vec<_>>(), lines);
    assert_eq!(outcome.out, "");
}

#[test]
fn colour_is_for_terminals_and_no_color_wins() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE.replace("young = ", "youngs = "));
    let with = |variables: &[(&str, &str)]| {
        let mut command = desk.command(&["run", "cube.toml"]);
        command.envs(variables.iter().copied());
        outcome(command.output().expect("the program starts")).err
    };
    assert!(!with(&[]).contains('\x1b'), "a pipe is no terminal");
    assert!(with(&[("CLICOLOR_FORCE", "1")]).contains("\x1b[1;31merror:"));
    assert!(!with(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]).contains('\x1b'));
}

#[test]
fn impossible_values_are_shown_in_their_line() {
    run_with("density = 1000", "density = -1000")
        .ends_with(2)
        .complains("`density` is -1000 kg/m^3, and must be above 0 kg/m^3")
        .complains("cube.toml:7:11");
    run_with("poisson = 0.4", "poisson = 0.5")
        .ends_with(2)
        .complains("`poisson` is 0.5, and must be below 0.5")
        .complains("0.5 makes lambda infinite");
}

#[test]
fn a_fixed_region_that_selects_nothing_says_which_node_is_near() {
    run_with("fix = \"y-max\"", "fix = { sphere = { centre = [0, \"20 cm\", 0], radius = \"1 cm\" } }")
        .ends_with(2)
        .complains("selects nothing")
        .complains("the nearest node is")
        .complains("cube.toml:9:7");
}

#[test]
fn a_mistake_in_an_override_is_shown_in_the_override() {
    Desk::new()
        .viscera(&["run", "liver-pull", "--set", "body.linear.density=5 kg"])
        .ends_with(2)
        .complains("expected a density, found the mass \"5 kg\"")
        .complains("--set");
}

#[test]
fn a_missing_mesh_is_named_in_the_line_that_asks_for_it() {
    run_with("generate = \"box\", size = [\"10 cm\", \"10 cm\", \"10 cm\"], cells = [2, 2, 2]", "file = \"organ.msh\"")
        .ends_with(2)
        .complains("organ.msh: there is no such file")
        .complains("cube.toml:6:");
    Desk::new().viscera(&["mesh", "check", "organ.msh"]).ends_with(2).complains("organ.msh: there is no such file");
}

#[test]
fn a_truncated_mesh_is_said_to_be_cut_off() {
    let desk = Desk::new();
    let whole = fs::read(sample("bar-22-ascii.msh")).expect("the sample");
    desk.write("bar.msh", &whole[..whole.len() / 2]);
    desk.viscera(&["mesh", "check", "bar.msh"])
        .ends_with(1)
        .complains("bar.msh, line")
        .complains("the file was cut off");
    desk.write(
        "bar.toml",
        CUBE.replace(
            "generate = \"box\", size = [\"10 cm\", \"10 cm\", \"10 cm\"], cells = [2, 2, 2]",
            "file = \"bar.msh\"",
        ),
    );
    desk.viscera(&["run", "bar.toml"]).ends_with(2).complains("the file was cut off").complains("bar.toml:6:");
}

#[test]
fn a_coordinate_that_is_no_number_is_named_with_its_line() {
    let desk = Desk::new();
    let text = fs::read_to_string(sample("bar-22-ascii.msh")).expect("the sample");
    // The first node's x.
    let (before, after) = text.split_once("$Nodes\n14\n1 ").expect("the nodes");
    let rest = after.split_once(' ').expect("coordinates").1;
    desk.write("bar.msh", format!("{before}$Nodes\n14\n1 nan {rest}"));
    let outcome = desk.viscera(&["mesh", "check", "bar.msh"]).ends_with(1).complains("bar.msh");
    assert!(outcome.err.to_lowercase().contains("nan"), "{}", outcome.err);
}

#[test]
fn a_folder_that_cannot_be_written_is_refused_before_the_run() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE);
    desk.write("results", "a file where the folder should be");
    desk.viscera(&["run", "cube.toml", "--out", "results"])
        .ends_with(2)
        .complains("results: results cannot be written there")
        .complains("choose another folder with --out");
    assert_eq!(desk.read("results"), "a file where the folder should be");
}

#[test]
fn check_finds_mistakes_and_oddities_and_runs_nothing() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE);
    desk.viscera(&["check", "cube.toml"])
        .ends_with(0)
        .says("body cube")
        .says("48 tetrahedra, 27 nodes")
        .says("stable  explicit steps up to")
        .says("the scene is good");
    desk.write("loose.toml", CUBE.replace("fix = \"y-max\"", ""));
    desk.viscera(&["check", "loose.toml"]).ends_with(0).complains("warning: nothing holds body `cube`: it falls");
    desk.write("wrong.toml", CUBE.replace("young = ", "youngs = "));
    desk.viscera(&["check", "wrong.toml"]).ends_with(1).complains("unknown key `youngs`");
    assert!(!desk.path("out").exists());
}

#[test]
fn the_schema_is_that_of_the_scenes_folder() {
    let schema = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/scene.schema.json");
    let outcome = Desk::new().viscera(&["schema"]).ends_with(0);
    assert_eq!(outcome.out.trim_end(), fs::read_to_string(schema).expect("the schema").trim_end());
}

#[test]
fn every_built_in_scene_is_listed_in_one_line_and_can_be_copied() {
    let desk = Desk::new();
    let outcome = desk.viscera(&["scenes"]).ends_with(0);
    let names: Vec<_> = outcome.out.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(
        names,
        [
            "breathing-trunk",
            "cylinder-bend",
            "fibre-tubes",
            "gallbladder",
            "liver-adaptive",
            "liver-hybrid",
            "liver-inversion",
            "liver-precomputed",
            "liver-probe",
            "liver-pull",
            "liver-resection",
            "liver",
            "magnet",
            "soft-arm"
        ]
    );
    desk.viscera(&["scenes", "--copy-to", "mine"]).ends_with(0).says("mine");
    desk.viscera(&["check", "mine/liver-resection.toml"]).ends_with(0).says("instrument cautery");
}
