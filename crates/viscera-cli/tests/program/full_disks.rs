//! Outputs that cannot be written: what went wrong with which file, what stands, what to do.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use crate::{CUBE, Desk, outcome};

/// No file that was begun and not finished is left in the folder.
fn assert_nothing_half_written(folder: &Path) {
    for folder in [folder.to_owned(), folder.join("frames"), folder.join("checkpoints")] {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let name = entry.expect("an entry").file_name();
            assert!(!name.to_string_lossy().contains(".part"), "{}", name.display());
        }
    }
}

/// A small disk in memory, where the system lets the tests have one.
#[cfg(target_os = "linux")]
struct SmallDisk<'a> {
    place: &'a Path,
}

#[cfg(target_os = "linux")]
impl<'a> SmallDisk<'a> {
    fn mount(place: &'a Path, size: &str) -> Option<Self> {
        fs::create_dir_all(place).expect("a folder");
        let options = format!("size={size}");
        let mut mount = std::process::Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", &options, "viscera-test"]).arg(place).stderr(Stdio::null());
        mount.status().is_ok_and(|status| status.success()).then_some(Self { place })
    }
}

#[cfg(target_os = "linux")]
impl Drop for SmallDisk<'_> {
    fn drop(&mut self) {
        let _ = std::process::Command::new("umount").arg(self.place).status();
    }
}

/// The frames of a run fill a disk. The frame that did not fit is not there, all before it are whole and in the collection, the
/// table has its rows; and with room, the run goes on from its checkpoint to the bytes of one that was never short of it.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_a_run_with_all_that_fitted_and_room_lets_it_go_on() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE.replace("0.1 s", "0.4 s").replace("[2, 2, 2]", "[8, 8, 8]"));
    let run = ["run", "cube.toml", "--pictures", "0", "--checkpoint", "60 ms"];
    let place = desk.path("small");
    let Some(disk) = SmallDisk::mount(&place, "1200k") else {
        eprintln!("skipped: no small disk can be mounted here");
        return;
    };
    let ended = desk
        .viscera(&[&run[..], &["--out", "small/cube"]].concat())
        .ends_with(1)
        .complains("No space left on device")
        .complains("what stands in small/cube: ")
        .complains("with --resume goes on from the checkpoint at 0.");
    assert!(ended.err.contains("frames/cube-") || ended.err.contains(".checkpoint"), "{}", ended.err);
    let out = desk.path("small/cube");
    assert_nothing_half_written(&out);
    let frames = fs::read_dir(out.join("frames")).expect("frames").count();
    assert!(frames > 1);
    assert_eq!(desk.read("small/cube/bodies.pvd").matches("<DataSet").count(), frames);
    assert!(ended.err.contains(&format!("{frames} frames up to ")), "{}", ended.err);
    let rows = desk.read("small/cube/observables.csv").lines().count() - 1;
    assert!(ended.err.contains(&format!("observables.csv with {rows} rows up to ")), "{}", ended.err);

    let copied = std::process::Command::new("cp").arg("-r").arg(&out).arg(desk.path("large")).status();
    assert!(copied.expect("cp").success());
    drop(disk);
    desk.viscera(&[&run[..], &["--out", "large", "--resume"]].concat()).ends_with(0);
    desk.viscera(&[&run[..], &["--out", "whole"]].concat()).ends_with(0);
    for name in ["bodies.pvd", "observables.csv", "frames/cube-000010.vtu"] {
        assert!(desk.read_bytes(&format!("large/{name}")) == desk.read_bytes(&format!("whole/{name}")), "{name}");
    }
}

/// What is said into a file on a full disk was not said.
#[cfg(target_os = "linux")]
#[test]
fn a_result_that_cannot_be_said_is_a_failure() {
    let desk = Desk::new();
    for arguments in [&["schema"][..], &["scenes"]] {
        let full = fs::File::options().write(true).open("/dev/full").expect("the device that is always full");
        let mut command = desk.command(arguments);
        let ended = outcome(command.stdout(Stdio::from(full)).stderr(Stdio::piped()).output().expect("it starts"));
        ended.ends_with(1).complains("could not be written: No space left on device");
    }
}

/// Permissions do not bind everybody; a file where a folder has to be does.
#[test]
fn a_folder_that_cannot_be_made_is_named_before_anything_is_computed() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE);
    desk.write("taken", "a file");
    desk.viscera(&["run", "cube.toml", "--out", "taken"])
        .ends_with(2)
        .complains("taken: results cannot be written there")
        .complains("--out");
    desk.viscera(&["run", "cube.toml", "--out", "taken/below"])
        .ends_with(2)
        .complains("taken/below: results cannot be");
    desk.write("out/frames-are-a-file/frames", "a file");
    desk.viscera(&["run", "cube.toml", "--out", "out/frames-are-a-file"])
        .ends_with(2)
        .complains("cannot be written there");
    desk.write("out/checkpoints-are-a-file/checkpoints", "a file");
    desk.viscera(&["run", "cube.toml", "--out", "out/checkpoints-are-a-file", "--checkpoint", "0.05"])
        .ends_with(2)
        .complains("out/checkpoints-are-a-file: results cannot be written there");
}

/// Each output in turn cannot be written, because a folder has its name: the message names it, and what came before it stands.
#[test]
fn every_output_that_cannot_be_written_is_named_and_the_others_stand() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE);
    for name in ["frames/cube-000001.vtu", "bodies.pvd", "observables.csv", "end.png", "summary.json"] {
        let out = format!("without-{}", name.replace('/', "-"));
        fs::create_dir_all(desk.path(&format!("{out}/{name}"))).expect("a folder");
        let ended = desk
            .viscera(&["run", "cube.toml", "--out", &out])
            .ends_with(1)
            .complains(&format!("{out}/{name}: the "))
            .complains("cannot be written")
            .complains(&format!("what stands in {out}: "));
        assert_nothing_half_written(&desk.path(&out));
        assert!(!desk.path(&out).join("summary.json").is_file(), "no summary of a run that did not end well");
        if name != "bodies.pvd" && name != "observables.csv" {
            assert!(ended.err.contains("frames up to") && ended.err.contains("rows up to"), "{}", ended.err);
        }
    }
}

/// The folder of a run is taken away while it goes.
#[cfg(unix)]
#[test]
fn a_folder_that_goes_away_ends_the_run_and_is_named() {
    let desk = Desk::new();
    desk.write("long.toml", CUBE.replace("0.1 s", "1000000 s"));
    let child =
        desk.command(&["run", "long.toml"]).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("it starts");
    while !desk.path("out/long/frames/cube-000002.vtu").exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    fs::rename(desk.path("out/long"), desk.path("elsewhere")).expect("it can be moved");
    let ended = outcome(child.wait_with_output().expect("it ends"));
    ended.ends_with(1).complains("cannot be written").complains("the folder out/long is gone");
    assert!(desk.path("elsewhere/frames/cube-000002.vtu").exists());
}
