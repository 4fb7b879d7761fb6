//! Ctrl-C.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::{CUBE, Desk, outcome};

/// A run without end, stopped in the middle: whole files, a summary that says so, and the code of an interrupt.
#[cfg(unix)]
#[test]
fn an_interrupted_run_ends_well_and_keeps_what_it_has() {
    let desk = Desk::new();
    desk.write("long.toml", CUBE.replace("0.1 s", "1000000 s"));
    let mut command = desk.command(&["run", "long.toml"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let patience = Instant::now() + Duration::from_secs(60);
    while !desk.path("out/long/frames/cube-000003.vtu").exists() && Instant::now() < patience {
        std::thread::sleep(Duration::from_millis(10));
    }
    let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(signal.success());
    let ended = outcome(child.wait_with_output().expect("it ends"));
    ended
        .ends_with(130)
        .complains("interrupted at")
        .complains("what was computed up to then is in out/long")
        .says("cube");

    let summary = desk.json("out/long/summary.json");
    assert_eq!(summary["interrupted"], true);
    let time = summary["simulated_time_s"].as_f64().expect("a time");
    assert!(time >= 0.12, "three frames of 40 ms were there, and {time} s are recorded");
    let last = desk.read("out/long/observables.csv");
    let last = last.lines().last().expect("rows").split(',').next().expect("a time");
    assert_eq!(last.parse::<f64>().expect("a number"), time);
    assert!(desk.path("out/long/end.png").exists());
}
