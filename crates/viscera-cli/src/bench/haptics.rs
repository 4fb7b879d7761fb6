//! `viscera bench haptics`: a force channel of 1 kHz beside a scene that is being simulated.

use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

use viscera::curve::Curve;
use viscera::executor::Executor;
use viscera::math::Vec3;
use viscera::model::Precision;
use viscera::world::InstrumentId;
use viscera_haptics::{
    ChannelSettings, EmulatedDevice, HapticThread, Priority, Report, SimulationSide, Tool, Workspace,
};
use viscera_io::grouped;
use viscera_scene::{BuiltScene, file};
use viscera_server::{Haptics, Server, Settings, StepTimes, instrument_for_a_hand};
use viscera_session::Session;
use viscera_session::message::{Command, Request};

use super::arguments::HapticsArguments;
use super::page::Page;
use crate::built_in::OpenScene;
use crate::emulated::{closed, to_and_fro, tremor};
use crate::failure::Failure;
use crate::haptic_figures::say_figures;
use crate::interrupt::Interrupt;
use crate::serve::said;
use crate::terminal::say;

/// Share of the periods that must be no longer than 1.2 of their nominal length.
const PUNCTUAL: f64 = 0.999;

pub(super) fn haptics(arguments: &HapticsArguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    let mut open = OpenScene::open(&arguments.scene_arguments())?;
    if let Some((key, value)) = arguments.default_size() {
        open.scene.set(key, value).map_err(Failure::scene)?;
    }
    if arguments.page {
        return served(arguments, &open, &interrupt);
    }
    match open.file()?.precision {
        file::Precision::Single => haptics_in::<f32>(arguments, &open, &interrupt),
        file::Precision::Double => haptics_in::<f64>(arguments, &open, &interrupt),
    }
}

fn haptics_in<T: Precision>(
    arguments: &HapticsArguments,
    open: &OpenScene,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let built = open.scene.build::<T>().map_err(Failure::scene)?;
    let Some((name, &instrument)) =
        built.instruments.iter().find(|(_, id)| built.world.instrument(**id).kind() != "cautery")
    else {
        return Err(Failure::input(format!(
            "{}: the scene has no instrument that a hand could feel: add a grasper or a probe",
            open.name
        )));
    };
    let cells: usize = built.bodies.values().map(|&id| built.world.body(id).cell_count()).sum();
    say(&what(&open.name, cells, built.file.step.0, name, arguments));
    let path = built.world.instrument(instrument).path().clone();
    let (device, settings) = in_hand(path, built.file.duration.0, arguments);
    let (thread, side) = HapticThread::start(device, settings, priority(arguments)).map_err(Failure::problem)?;
    let simulated = simulate(built, instrument, side, &thread, arguments, interrupt)?;
    judge(&thread.stop(), &simulated, arguments)
}

/// The same with a session behind a server, and a page that looks on.
fn served(arguments: &HapticsArguments, open: &OpenScene, interrupt: &Interrupt) -> Result<(), Failure> {
    let mut session = Session::new(Executor::serial());
    session.open(&open.name, &open.scene).map_err(|refusal| Failure::input(said(&refusal)))?;
    session.handle(Request::from(Command::Play {}));
    let shape =
        instrument_for_a_hand(&session, None).map_err(|error| Failure::input(format!("{}: {error}", open.name)))?;
    let scene = session.scene();
    let cells = scene.bodies.iter().map(|body| body.cells).sum();
    say(&what(&open.name, cells, scene.step, &shape.name, arguments));
    let still = (Curve::constant(Vec3::ZERO), 1.0);
    let (path, duration) = session.path(shape.instrument).unwrap_or(still);
    let (device, settings) = in_hand(path, duration, arguments);
    let haptics =
        Haptics { device: Box::new(device), instrument: shape.instrument, settings, priority: priority(arguments) };
    let at = Settings { port: 0, ..Settings::default() };
    let mut server = Server::start_with(at, session, Some(haptics)).map_err(Failure::problem)?;
    let page = Page::open(server.address(), 2.0 * duration)?;
    let begin = Instant::now();
    let is_over = || begin.elapsed().as_secs_f64() >= arguments.duration || interrupt.is_asked() || page.is_closed();
    server.serve_until(is_over);
    let (taken, seconds) = (page.close(), begin.elapsed().as_secs_f64());
    let Some(report) = server.stop() else { unreachable!("a device was given to the server") };
    if interrupt.is_asked() {
        return Err(Failure::Interrupted("interrupted; the device is released".into()));
    }
    say(&taken?.in_words(seconds));
    judge(&report.channel, &report.steps, arguments)
}

/// What is measured.
fn what(name: &str, cells: usize, step: f64, instrument: &str, arguments: &HapticsArguments) -> String {
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    format!(
        "{name}, {} cells, steps of {:.3} ms; a hand leads `{instrument}`, {}; {} a page; {cores} cores; {:.0} s",
        grouped(cells),
        1e3 * step,
        arguments.extrapolation.name(),
        if arguments.page { "60 surfaces a second go to" } else { "without" },
        arguments.duration
    )
}

fn priority(arguments: &HapticsArguments) -> Priority {
    if arguments.ordinary { Priority::Ordinary } else { Priority::RealTime }
}

/// A device in a hand that goes along the path of the instrument in the scene, to its end after `duration` [s] and back.
fn in_hand(path: Curve<Vec3<f64>>, duration: f64, arguments: &HapticsArguments) -> (EmulatedDevice, ChannelSettings) {
    let origin = path.at(0.0);
    let device = closed(move |time| path.at(to_and_fro(time, duration)) - origin + tremor(time));
    let workspace = Workspace { origin, ..Workspace::default() };
    let settings = ChannelSettings { workspace, extrapolation: arguments.extrapolation, ..ChannelSettings::default() };
    (device, settings)
}

/// Steps the scene by the clock on the wall, round after round, and answers the hand.
fn simulate<T: Precision>(
    mut built: BuiltScene<T>,
    instrument: InstrumentId,
    mut side: SimulationSide,
    thread: &HapticThread<EmulatedDevice>,
    arguments: &HapticsArguments,
    interrupt: &Interrupt,
) -> Result<StepTimes, Failure> {
    let (step, round) = (built.file.step.0, 2.0 * built.file.duration.0);
    let start = built.world.snapshot();
    let mut tool = Tool::new(instrument);
    let (begin, mut done) = (Instant::now(), StepTimes::default());
    while begin.elapsed().as_secs_f64() < arguments.duration && thread.is_running() {
        if interrupt.is_asked() {
            return Err(Failure::Interrupted("interrupted; the device is released".into()));
        }
        let due = (done.steps + done.refused) as f64 * step;
        let early = due - begin.elapsed().as_secs_f64();
        if early > 0.0 {
            std::thread::sleep(Duration::from_secs_f64(early));
        }
        let Some(pose) = side.pose() else { continue };
        let before = Instant::now();
        let answer = tool.step(&mut built.world, &pose);
        done.add(before.elapsed().as_secs_f64(), answer.is_ok());
        match answer {
            Ok(sample) => side.send(&sample).map_err(Failure::problem)?,
            Err(error) => {
                // The channel fades the force; the scene begins anew.
                if done.refused == 1 {
                    say(&format!("a step was refused, and the scene begins anew: {error}"));
                }
                built.world.restore(&start).map_err(Failure::problem)?;
            }
        }
        if built.world.time() >= round {
            built.world.restore(&start).map_err(Failure::problem)?;
        }
    }
    done.behind = (begin.elapsed().as_secs_f64() - (done.steps + done.refused) as f64 * step).max(0.0);
    Ok(done)
}

/// Says the figures, and fails if the channel did not hold its rate.
fn judge<D>(report: &Report<D>, done: &StepTimes, arguments: &HapticsArguments) -> Result<(), Failure> {
    let figures = say_figures(report, done, arguments.ordinary)?;
    if figures.punctual < PUNCTUAL {
        return Err(Failure::problem(format!(
            "{:.3} % of the periods were within 1.2 ms, and it should be {:.1} %: something else needs the processor",
            100.0 * figures.punctual,
            100.0 * PUNCTUAL
        )));
    }
    Ok(())
}
