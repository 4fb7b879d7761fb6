//! `viscera serve`: where the page is, and who is shown it.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use crate::{CUBE, Desk};

/// A desktop whose browser only writes down what it is to show.
fn desk_with_a_browser() -> Desk {
    let desk = Desk::new();
    desk.write("programs/xdg-open", "#!/bin/sh\necho \"$1\" >\"$SHOWN.part\" && mv \"$SHOWN.part\" \"$SHOWN\"\n");
    fs::set_permissions(desk.path("programs/xdg-open"), fs::Permissions::from_mode(0o755))
        .expect("its mode can be set");
    desk
}

/// The simulator, and the address that it says; it ends with the test.
struct Simulator {
    child: Child,
    /// Open, so that the program can go on speaking.
    out: BufReader<ChildStdout>,
    address: String,
}

impl Simulator {
    fn start(desk: &Desk, more: &[&str], display: &str) -> Self {
        let path = format!("{}:{}", desk.path("programs").display(), std::env::var("PATH").unwrap_or_default());
        let mut command = desk.command(&[&["serve", "--port", "0"][..], more].concat());
        command
            .env("PATH", path)
            .env("DISPLAY", display)
            .env_remove("WAYLAND_DISPLAY")
            .env("SHOWN", desk.path("shown"));
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("the program starts");
        let (mut out, mut line) = (BufReader::new(child.stdout.take().expect("a pipe")), String::new());
        out.read_line(&mut line).expect("it speaks");
        let address = line.split_whitespace().find(|word| word.starts_with("http://")).expect("an address").to_owned();
        Self { child, out, address }
    }

    /// What it answers to who asks for the page.
    fn page(&self) -> String {
        let host = self.address.trim_start_matches("http://").trim_end_matches('/');
        let mut stream = TcpStream::connect(host).expect("it listens");
        write!(stream, "GET / HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").expect("it takes requests");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("it answers");
        answer
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What the browser was to show, once it was asked to; none when it is not asked in this time.
fn shown(path: &Path, patience: Duration) -> Option<String> {
    let until = Instant::now() + patience;
    while !path.exists() && Instant::now() < until {
        std::thread::sleep(Duration::from_millis(10));
    }
    fs::read_to_string(path).ok().map(|text| text.trim().to_owned())
}

/// A program that was built without its page says so in its place, and shows nobody that.
#[test]
fn the_page_is_opened_where_there_is_a_desktop_unless_told_otherwise() {
    let desk = desk_with_a_browser();
    let simulator = Simulator::start(&desk, &[], ":0");
    let page = simulator.page();
    if page.starts_with("HTTP/1.1 200") {
        assert!(page.contains("<title>Viscera"), "{page}");
        assert_eq!(shown(&desk.path("shown"), Duration::from_secs(60)), Some(simulator.address.clone()));
    } else {
        assert!(page.starts_with("HTTP/1.1 503") && page.contains("without its page"), "{page}");
    }
    for (more, display) in [(&["--no-open"][..], ":0"), (&[][..], "")] {
        let desk = desk_with_a_browser();
        let simulator = Simulator::start(&desk, more, display);
        simulator.page();
        assert_eq!(
            shown(&desk.path("shown"), Duration::from_millis(300)),
            None,
            "with {more:?} on display `{display}`"
        );
    }
}

/// A probe above the cube that hangs, which the scene does not move.
fn cube_with_a_probe() -> String {
    format!("{CUBE}\n[instrument.probe]\nkind = \"probe\"\npath = [0.05, 0.12, 0.05]\n")
}

#[test]
fn a_hand_on_a_device_leads_an_instrument_and_its_figures_are_told_in_the_end() {
    let desk = Desk::new();
    desk.write("cube.toml", cube_with_a_probe());
    let more = ["cube.toml", "--no-open", "--haptics", "emulated:10 mm", "--haptics-instrument", "0"];
    let mut simulator = Simulator::start(&desk, &more, "");
    let mut hand = String::new();
    simulator.out.read_line(&mut hand).expect("it speaks");
    assert!(hand.contains("leads instrument 0, `probe`: it presses by 10 mm"), "{hand}");
    std::thread::sleep(Duration::from_millis(500));
    let ended = Command::new("kill").args(["-TERM", &simulator.child.id().to_string()]).status().expect("kill");
    assert!(ended.success());
    let mut figures = String::new();
    simulator.out.read_to_string(&mut figures).expect("it speaks");
    assert_eq!(simulator.child.wait().expect("it ends").code(), Some(0), "{figures}");
    for words in ["latency of samples", " a second, ", " left out; ", " samples of ", "limited in"] {
        assert!(figures.contains(words), "`{words}` is not in:\n{figures}");
    }
}

#[test]
fn what_no_hand_can_lead_is_refused_before_anything_is_served() {
    let desk = Desk::new();
    desk.write("cube.toml", CUBE);
    desk.write("probe.toml", cube_with_a_probe());
    let serve = |more: &[&str]| desk.viscera(&[&["serve", "--port", "0", "--no-open"][..], more].concat()).ends_with(2);
    serve(&["cube.toml", "--haptics", "emulated"]).complains("add a grasper or a probe");
    serve(&["probe.toml", "--haptics", "emulated", "--haptics-instrument", "3"]).complains("it has 0 (probe)");
    serve(&["probe.toml", "--haptics", "touch"]).complains("`emulated`");
    serve(&["probe.toml", "--haptics-instrument", "0"]).complains("--haptics");
    let direct = ["--haptics", "emulated", "--haptics-extrapolation", "direct"];
    serve(&[&["probe.toml"][..], &direct].concat()).complains("known are hold, time, position, linearised");
}
