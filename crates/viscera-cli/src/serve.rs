//! `viscera serve`: the simulator.

use std::num::NonZero;
use std::path::Path;
use std::thread;

use viscera::executor::Executor;
use viscera_haptics::{ChannelSettings, Priority};
use viscera_scene::Scene;
use viscera_server::{Haptics, HapticsError, ServeError, Server, Settings, instrument_for_a_hand};
use viscera_session::message::{Command, Refusal, Request};
use viscera_session::{Session, library};

use crate::arguments::ServeArguments;
use crate::emulated::Emulated;
use crate::failure::Failure;
use crate::haptic_figures::say_figures;
use crate::interrupt::Interrupt;
use crate::terminal;

pub(crate) fn serve(arguments: &ServeArguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    // Connections and the browser want a core too.
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let threads = arguments.threads.map_or(cores.saturating_sub(1).max(1), usize::from);
    let (mut server, in_hand) = listen(arguments, threads)?;
    let address = server.address();
    let shown =
        if address.ip().is_unspecified() { format!("localhost:{}", address.port()) } else { address.to_string() };
    let url = format!("http://{shown}/");
    terminal::say(&format!("the simulator is at {url} (Ctrl-C ends it)"));
    if let Some(in_hand) = in_hand {
        terminal::say(&format!("{in_hand}; how its channel keeps time stands at {url}haptics"));
    }
    if let Some(reason) = server.missing_page() {
        terminal::complain(&format!(
            "this program was built without its page: {reason} Install Node.js 20.19 or newer with npm, and build it again"
        ));
    } else if !arguments.no_open && has_desktop() {
        // Where that fails, the address stands above.
        let _ = open::that_detached(&url);
    }
    server.serve_until(|| interrupt.is_asked());
    server.stop().map_or(Ok(()), |report| say_figures(&report.channel, &report.steps, false).map(|_| ()))
}

/// Listens on the first port that is free. Says what the device in hand does, if there is one.
fn listen(arguments: &ServeArguments, threads: usize) -> Result<(Server, Option<String>), Failure> {
    let mut ports = arguments.ports().into_iter().peekable();
    while let Some(port) = ports.next() {
        let settings = Settings {
            address: arguments.address,
            port,
            allowed_hosts: arguments.allow_host.clone(),
            ..Settings::default()
        };
        let session = session(arguments, threads)?;
        let (haptics, in_hand) = arguments
            .haptics
            .map(|emulated| in_hand(emulated, &session, arguments))
            .transpose()
            .map_err(Failure::input)?
            .unzip();
        match Server::start_with(settings, session, haptics) {
            Ok(server) => return Ok((server, in_hand)),
            Err(ServeError::Bind { .. }) if ports.peek().is_some() => {}
            Err(ServeError::Haptics(error)) => return Err(Failure::input(error)),
            Err(error) => return Err(Failure::problem(error)),
        }
    }
    Err(Failure::problem("there is no port to listen on"))
}

/// A device that takes an instrument of the session over, and what it does in words.
fn in_hand(
    emulated: Emulated,
    session: &Session,
    arguments: &ServeArguments,
) -> Result<(Haptics, String), HapticsError> {
    let shape = instrument_for_a_hand(session, arguments.haptics_instrument)?;
    let Some(tool) = session.instrument(shape.instrument) else { return Err(HapticsError::NoInstruments) };
    let (device, workspace, way) = emulated.device(&tool, session.path(shape.instrument));
    let extrapolation = arguments.haptics_extrapolation.unwrap_or_default();
    let settings = ChannelSettings { workspace, extrapolation, ..ChannelSettings::default() };
    let text = format!("an emulated hand leads instrument {}, `{}`: it {way}", shape.instrument, shape.name);
    let (instrument, priority) = (shape.instrument, Priority::RealTime);
    Ok((Haptics { device: Box::new(device), instrument, settings, priority }, text))
}

/// The session, with its scene, at play.
fn session(arguments: &ServeArguments, threads: usize) -> Result<Session, Failure> {
    let mut session = Session::new(Executor::threads(threads).map_err(Failure::problem)?);
    if let Some(wanted) = &arguments.scene {
        let (name, scene) = find(wanted)?;
        session.open(&name, &scene).map_err(|refusal| Failure::input(said(&refusal)))?;
    }
    session.handle(Request::from(Command::Play {}));
    Ok(session)
}

fn find(wanted: &str) -> Result<(String, Scene), Failure> {
    let path = Path::new(wanted);
    if path.is_file() {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        return Ok((name, Scene::load(path).map_err(Failure::scene)?));
    }
    let name = wanted.strip_suffix(".toml").unwrap_or(wanted);
    match library::scene(name) {
        Some(scene) => Ok((name.to_owned(), scene.map_err(Failure::scene)?)),
        None => {
            let known: Vec<_> = library::scenes().map(|(name, _)| name).collect();
            Err(Failure::input(format!(
                "{wanted}: there is no such file, and no built-in scene of that name; built in are {}",
                known.join(", ")
            )))
        }
    }
}

pub(crate) fn said(refusal: &Refusal) -> String {
    let place =
        refusal.excerpt.as_ref().map_or(String::new(), |at| format!("{}:{}:{}: ", at.source, at.line, at.column));
    let help = if refusal.help.is_empty() { String::new() } else { format!("; {}", refusal.help) };
    format!("{place}{}{help}", refusal.reason)
}

/// Whether a browser would have a screen to appear on.
fn has_desktop() -> bool {
    let set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || set("DISPLAY") || set("WAYLAND_DISPLAY")
}
