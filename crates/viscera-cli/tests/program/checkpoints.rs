//! Runs that are killed, and go on.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use serde_json::Value;

use crate::{CUBE, Desk};

/// Keys of the summary that tell of the clock on the wall.
const OF_THE_CLOCK: [&str; 3] = ["computing_time_s", "wall_time_s", "real_time_factor"];

/// A resection in short: the cautery goes straight through the left lobe between 0.1 s and 0.5 s.
const RESECTION: [&str; 10] = [
    "run",
    "liver-resection",
    "--time",
    "0.6 s",
    "--set",
    "body.liver.mesh.edge=30 mm",
    "--set",
    "instrument.cautery.on=0.1 s",
    "--set",
    "instrument.cautery.path=[[0.1, [0.08, -0.08, 0]], [0.5, [0.08, 0.08, 0.02]]]",
];

/// Every file of a run but its checkpoints, by name; the summary without what the clock said.
fn results(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for folder in [folder.to_owned(), folder.join("frames")] {
        for entry in fs::read_dir(&folder).expect("the folder of the run") {
            let path = entry.expect("an entry").path();
            if !path.is_file() {
                continue;
            }
            let mut bytes = fs::read(&path).expect("a file of the run");
            if path.ends_with("summary.json") {
                let mut summary: Value = serde_json::from_slice(&bytes).expect("JSON");
                let summary = summary.as_object_mut().expect("a summary");
                OF_THE_CLOCK.iter().for_each(|key| assert!(summary.remove(*key).is_some(), "{key}"));
                bytes = serde_json::to_vec(summary).expect("JSON");
            }
            let parent = folder.file_name().filter(|name| *name == "frames").unwrap_or_default();
            files.insert(Path::new(parent).join(path.file_name().expect("a name")), bytes);
        }
    }
    files
}

/// Two runs left the same files with the same bytes.
#[track_caller]
fn assert_same_results(one: &Path, other: &Path) {
    let (one, other) = (results(one), results(other));
    assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
    for (name, bytes) in &one {
        assert!(other[name] == *bytes, "{} differs", name.display());
    }
}

fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder.join("checkpoints")).expect("checkpoints");
    let mut files: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    files
}

fn with<'a>(arguments: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [arguments, more].concat()
}

/// Starts a run, kills it after so many milliseconds, starts it again to go on, and so on, until it comes to its end by itself;
/// gives how often it was killed.
fn run_among_kills(desk: &Desk, arguments: &[&str], first: u64, longer: u64) -> u32 {
    let mut kills = 0;
    loop {
        let mut child = desk
            .command(&with(arguments, &["--resume"]))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        std::thread::sleep(Duration::from_millis(first + longer * u64::from(kills)));
        if let Some(status) = child.try_wait().expect("a child") {
            let ended = crate::outcome(child.wait_with_output().expect("it ends"));
            assert!(status.success(), "after {kills} kills:\n{}", ended.err);
            return kills;
        }
        child.kill().expect("it can be killed");
        child.wait().expect("it ends");
        kills += 1;
    }
}

/// A resection with grasp and cut, killed again and again at moments of chance, with a checkpoint after every other step, so that most
/// kills fall into the writing of something: frames, tables, checkpoints. What it leaves is what an undisturbed run leaves.
#[cfg(unix)]
#[test]
fn a_run_among_kills_leaves_the_bytes_of_an_undisturbed_one() {
    for precision in ["single", "double"] {
        let desk = Desk::new();
        let scene = with(&RESECTION, &["--precision", precision, "--pictures", "4", "--set", "output.size=[160, 120]"]);
        desk.viscera(&with(&scene, &["--out", "whole"])).ends_with(0);
        let kills = run_among_kills(&desk, &with(&scene, &["--out", "killed", "--checkpoint", "20 ms"]), 60, 15);
        assert!(kills >= 2, "killed only {kills} times");
        let removed = &desk.json("killed/summary.json")["removed_cells"];
        assert!(removed.as_u64().expect("a number") > 0, "it must have cut");
        assert_same_results(&desk.path("whole"), &desk.path("killed"));
        assert_eq!(checkpoints(&desk.path("killed")).len(), 2, "the last two are kept");
    }
}

/// Stops a run after half of its time by a failure of its folder, and lets it go on: implicit steps over two steps, tables with
/// cells subtracted in the order of the cuts, adaptive tables. The same bytes as in one go.
#[cfg(unix)]
#[test]
fn integrators_and_tables_of_cut_cells_go_on_with_the_same_bytes() {
    for (name, changes) in [
        ("bdf2", vec!["--set", "integrator.kind=bdf2", "--set", "integrator.newton=linearised"]),
        ("newmark", vec!["--set", "integrator.kind=newmark", "--set", "integrator.newton=linearised"]),
        ("tensor-mass", vec!["--set", "body.liver.model.kind=tensor-mass"]),
        ("adaptive", vec!["--set", "body.liver.model={kind=\"tensor-mass\", adaptive=\"5 mm\"}"]),
    ] {
        let desk = Desk::new();
        let scene = [&RESECTION[..], &["--pictures", "0"], &changes].concat();
        desk.viscera(&with(&scene, &["--out", "whole"])).ends_with(0);
        // A frame in the middle of the cut cannot be written where a folder has its name.
        fs::create_dir_all(desk.path("halved/frames/liver-000008.vtu")).expect("a folder");
        let halved = with(&scene, &["--out", "halved", "--checkpoint", "0.1 s"]);
        desk.viscera(&halved)
            .ends_with(1)
            .complains("liver-000008.vtu")
            .complains("goes on from the checkpoint at 0.3");
        fs::remove_dir(desk.path("halved/frames/liver-000008.vtu")).expect("the folder goes away");
        desk.viscera(&with(&scene, &["--out", "halved", "--resume"]))
            .ends_with(0)
            .complains("going on from the checkpoint at 0.3");
        let removed = &desk.json("halved/summary.json")["removed_cells"];
        assert!(removed.as_u64().expect("a number") > 0, "{name}: it must have cut");
        assert_same_results(&desk.path("whole"), &desk.path("halved"));
    }
}

/// A run with checkpoints that has come to its end, in a folder of its own.
fn finished(desk: &Desk) -> Vec<&'static str> {
    desk.write("cube.toml", CUBE);
    let run = vec!["run", "cube.toml", "--pictures", "0", "--checkpoint", "40 ms"];
    desk.viscera(&run).ends_with(0);
    run
}

/// At 40 ms, 80 ms and the end; the first is gone. Going on from the end writes the last files again and changes none.
#[test]
fn a_finished_run_that_goes_on_is_finished() {
    let desk = Desk::new();
    let run = finished(&desk);
    let files = checkpoints(&desk.path("out/cube"));
    let names: Vec<_> = files.iter().map(|path| path.file_name().expect("a name")).collect();
    assert_eq!(names, ["step-000000008.checkpoint", "step-000000010.checkpoint"]);
    let before = results(&desk.path("out/cube"));
    desk.viscera(&with(&run, &["--resume"]))
        .ends_with(0)
        .complains("going on from the checkpoint at 0.1000 s, after 10 steps");
    assert!(results(&desk.path("out/cube")) == before);
}

/// A checkpoint that was cut short, or of which one bit is another, is told and the one before it is taken; when that is damaged too,
/// the message says what is left to do, and nothing is touched.
#[test]
fn a_damaged_checkpoint_is_told_and_the_one_before_it_serves() {
    let desk = Desk::new();
    let run = with(&finished(&desk), &["--resume"]);
    let before = results(&desk.path("out/cube"));
    let files = checkpoints(&desk.path("out/cube"));
    let good = fs::read(&files[1]).expect("a checkpoint");
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 4;
    let message =
        |why: &str| format!("out/cube/checkpoints/step-000000010.checkpoint: the checkpoint is damaged: {why}");
    for (bytes, why) in [
        (&good[..good.len() / 3], "its checksum does not fit"),
        (&good[..5], "it does not begin as one does"),
        (&flipped, "its checksum does not fit"),
    ] {
        fs::write(&files[1], bytes).expect("a damaged checkpoint");
        desk.viscera(&run)
            .ends_with(0)
            .complains(&message(why))
            .complains("the one before it is tried")
            .complains("going on from the checkpoint at 0.0800 s");
        assert!(results(&desk.path("out/cube")) == before);
    }
    files.iter().for_each(|file| fs::write(file, &flipped).expect("a damaged checkpoint"));
    desk.viscera(&run).ends_with(2).complains("can be gone on from; run without --resume to begin anew");
    assert!(results(&desk.path("out/cube")) == before, "nothing is touched");
}

/// Another law, another number of pictures, other contents of a file: each is named.
#[test]
fn a_checkpoint_of_another_run_is_refused_by_what_differs() {
    let desk = Desk::new();
    let run = with(&finished(&desk), &["--resume"]);
    let before = results(&desk.path("out/cube"));
    desk.viscera(&with(&run, &["--set", "body.cube.law.young=12 kPa"]))
        .ends_with(2)
        .complains("the checkpoint is of another run: `body.cube.law.young` was 10000.0 and is 12000.0");
    desk.viscera(&["run", "cube.toml", "--resume", "--pictures", "2"])
        .ends_with(2)
        .complains("it takes 0 pictures, not 2")
        .complains("begin anew");
    desk.viscera(&with(&run, &["--precision", "double"])).ends_with(2).complains("`precision` was \"single\"");
    assert!(results(&desk.path("out/cube")) == before, "nothing is touched");

    let moved = |x: f64| format!("time [s], x [m], y [m], z [m]\n0, {x}, 0, 0\n1, {x}, 0, 0\n");
    desk.write("path.csv", moved(0.5));
    let burnt = "[instrument.tool]\nkind = \"cautery\"\nradius = \"1 cm\"\npath = { file = \"path.csv\" }\n";
    desk.write("burnt.toml", format!("{CUBE}\n{burnt}"));
    desk.viscera(&["run", "burnt.toml", "--checkpoint", "0.05"]).ends_with(0);
    desk.write("path.csv", moved(0.6));
    desk.viscera(&["run", "burnt.toml", "--resume"]).ends_with(2).complains("path.csv has changed since");
}

/// A checkpoint of another version of the program, whole in itself, is not believed.
#[test]
fn a_checkpoint_of_another_version_is_refused() {
    let desk = Desk::new();
    let run = with(&finished(&desk), &["--resume"]);
    let path = &checkpoints(&desk.path("out/cube"))[1];
    let mut bytes = fs::read(path).expect("a checkpoint");
    bytes.truncate(bytes.len() - 4);
    bytes[19] = 7;
    let checksum = crc32fast::hash(&bytes);
    bytes.extend(checksum.to_le_bytes());
    fs::write(path, bytes).expect("a checkpoint");
    desk.viscera(&run).ends_with(2).complains("a program of format 7").complains("go on with that program");
}

/// What a killed program had begun to write is cleared away, and a frame that is missing is told.
#[test]
fn remains_of_a_killed_run_are_cleared_and_missing_frames_are_told() {
    let desk = Desk::new();
    let run = with(&finished(&desk), &["--resume"]);
    let remains = [".summary.json.77-3.partial", "frames/.cube-000002.vtu.77-9.partial", "frames/cube-000009.vtu"];
    remains.iter().for_each(|name| desk.write(&format!("out/cube/{name}"), "half"));
    desk.write("out/cube/.mine.partial", "a note");
    desk.viscera(&run).ends_with(0);
    remains.iter().for_each(|name| assert!(!desk.path(&format!("out/cube/{name}")).exists(), "{name}"));
    assert!(desk.path("out/cube/.mine.partial").exists());
    fs::remove_file(desk.path("out/cube/frames/cube-000001.vtu")).expect("a frame");
    desk.viscera(&run).ends_with(2).complains("cube-000001.vtu").complains("put it back");
}

#[test]
fn the_interval_is_a_time_and_a_run_without_checkpoints_begins_at_the_start() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE);
    desk.viscera(&["run", "cube.toml", "--checkpoint", "5 mm"]).ends_with(2).complains("found the length");
    desk.viscera(&["run", "cube.toml", "--checkpoint", "0"]).ends_with(2).complains("must be positive");
    desk.viscera(&["run", "cube.toml", "--resume"]).ends_with(0).complains("the run begins at the start");
    assert!(!desk.path("out/cube/checkpoints").exists());
    desk.viscera(&["run", "--help"]).ends_with(0).says("--checkpoint <TIME>").says("such as \"0.5 s\"");
}

/// Ctrl-C leaves a checkpoint of the moment: nothing of the computing is lost.
#[cfg(unix)]
#[test]
fn an_interrupted_run_goes_on_from_where_it_was() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE.replace("0.1 s", "2 s"));
    let run = ["run", "cube.toml", "--pictures", "2", "--checkpoint", "10 s"];
    desk.viscera(&with(&run, &["--out", "whole"])).ends_with(0);
    let child =
        desk.command(&with(&run, &["--out", "halved"])).stderr(Stdio::piped()).spawn().expect("the program starts");
    while !desk.path("halved/frames/cube-000003.vtu").exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    let ended = crate::outcome(child.wait_with_output().expect("it ends"));
    assert!(ended.code == Some(130) || ended.code == Some(0), "{}", ended.err);
    if ended.code == Some(130) {
        ended.complains("the same command with --resume goes on from there");
    }
    desk.viscera(&with(&run, &["--out", "halved", "--resume"]))
        .ends_with(0)
        .complains("going on from the checkpoint at");
    assert_same_results(&desk.path("whole"), &desk.path("halved"));
}
