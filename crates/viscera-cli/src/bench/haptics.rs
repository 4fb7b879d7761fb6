//! `viscera bench haptics`: a force channel of 1 kHz beside a scene that is being simulated.

use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

use viscera::math::Vec3;
use viscera::model::Precision;
use viscera::world::InstrumentId;
use viscera_haptics::{
    ChannelSettings, EmulatedDevice, End, Hand, HapticThread, Priority, Rating, Report, SimulationSide, Statistics,
    Tool, Workspace,
};
use viscera_io::grouped;
use viscera_scene::{BuiltScene, file};

use super::arguments::HapticsArguments;
use super::viewer::Viewer;
use crate::built_in::OpenScene;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::tables::{table, table_text};
use crate::terminal::say;

/// Share of the periods that must be no longer than 1.2 of their nominal length.
const PUNCTUAL: f64 = 0.999;
/// The hand trembles by this much [m], at this frequency [1/s], as hands do.
const TREMOR: (f64, f64) = (0.3e-3, 9.0);

pub(super) fn haptics(arguments: &HapticsArguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    let mut open = OpenScene::open(&arguments.scene_arguments())?;
    if let Some((key, value)) = arguments.default_size() {
        open.scene.set(key, value).map_err(Failure::scene)?;
    }
    match open.file()?.precision {
        file::Precision::Single => haptics_in::<f32>(arguments, &open, &interrupt),
        file::Precision::Double => haptics_in::<f64>(arguments, &open, &interrupt),
    }
}

/// What the simulation did meanwhile.
#[derive(Clone, Copy, Debug, Default)]
struct Simulated {
    steps: u64,
    refused: u64,
    /// Time that steps took [s], and the longest of them.
    busy: f64,
    longest: f64,
    /// How far the simulation was behind the clock at the end [s].
    behind: f64,
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
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    say(&format!(
        "{}, {} cells, steps of {:.3} ms; a hand leads `{name}`, {}; {} a page; {cores} cores; {:.0} s",
        open.name,
        grouped(cells),
        1e3 * built.file.step.0,
        arguments.extrapolation.name(),
        if arguments.page { "60 surfaces a second go to" } else { "without" },
        arguments.duration
    ));
    let (device, settings) = in_hand(&built, instrument, arguments);
    let priority = if arguments.ordinary { Priority::Ordinary } else { Priority::RealTime };
    let (thread, side) = HapticThread::start(device, settings, priority).map_err(Failure::problem)?;
    let simulated = simulate(built, instrument, side, &thread, arguments, interrupt)?;
    judge(&thread.stop(), &simulated, arguments)
}

/// A device in a hand that goes along the path of the instrument in the scene, to its end and back.
fn in_hand<T: Precision>(
    built: &BuiltScene<T>,
    instrument: InstrumentId,
    arguments: &HapticsArguments,
) -> (EmulatedDevice, ChannelSettings) {
    let (path, duration) = (built.world.instrument(instrument).path().clone(), built.file.duration.0);
    let origin = path.at(0.0);
    let hand = Hand::on_rails(move |time| path.at(to_and_fro(time, duration)) - origin + tremor(time));
    let workspace = Workspace { origin, ..Workspace::default() };
    let settings = ChannelSettings { workspace, extrapolation: arguments.extrapolation, ..ChannelSettings::default() };
    (EmulatedDevice::new(Rating::TOUCH, hand).trigger(1.0), settings)
}

fn to_and_fro(time: f64, duration: f64) -> f64 {
    let phase = time % (2.0 * duration);
    phase.min(2.0 * duration - phase)
}

fn tremor(time: f64) -> Vec3<f64> {
    let (amplitude, frequency) = TREMOR;
    let angle = std::f64::consts::TAU * frequency * time;
    Vec3::new(angle.sin(), (1.3 * angle).sin(), (0.7 * angle).sin()) * amplitude
}

/// Steps the scene by the clock on the wall, round after round, and answers the hand.
fn simulate<T: Precision>(
    mut built: BuiltScene<T>,
    instrument: InstrumentId,
    mut side: SimulationSide,
    thread: &HapticThread<EmulatedDevice>,
    arguments: &HapticsArguments,
    interrupt: &Interrupt,
) -> Result<Simulated, Failure> {
    let (step, round) = (built.file.step.0, 2.0 * built.file.duration.0);
    let start = built.world.snapshot();
    let mut tool = Tool::new(instrument);
    let mut viewer = if arguments.page { Some(Viewer::connect()?) } else { None };
    let (begin, mut done) = (Instant::now(), Simulated::default());
    while begin.elapsed().as_secs_f64() < arguments.duration && thread.is_running() {
        if interrupt.is_asked() {
            return Err(Failure::Interrupted("interrupted; the device is released".into()));
        }
        let due = done.steps as f64 * step;
        let early = due - begin.elapsed().as_secs_f64();
        if early > 0.0 {
            std::thread::sleep(Duration::from_secs_f64(early));
        }
        let Some(pose) = side.pose() else { continue };
        let before = Instant::now();
        match tool.step(&mut built.world, &pose) {
            Ok(sample) => side.send(&sample).map_err(Failure::problem)?,
            Err(error) => {
                // The channel fades the force; the scene begins anew.
                done.refused += 1;
                if done.refused == 1 {
                    say(&format!("a step was refused, and the scene begins anew: {error}"));
                }
                built.world.restore(&start).map_err(Failure::problem)?;
            }
        }
        let took = before.elapsed().as_secs_f64();
        done.steps += 1;
        done.busy += took;
        done.longest = done.longest.max(took);
        if let Some(viewer) = &mut viewer {
            viewer.show(&built.world, begin.elapsed());
        }
        if built.world.time() >= round {
            built.world.restore(&start).map_err(Failure::problem)?;
        }
    }
    done.behind = (begin.elapsed().as_secs_f64() - done.steps as f64 * step).max(0.0);
    Ok(done)
}

/// Says the figures, and fails if the channel did not hold its rate.
fn judge(report: &Report<EmulatedDevice>, done: &Simulated, arguments: &HapticsArguments) -> Result<(), Failure> {
    let Some(figures) = &report.statistics else {
        return Err(Failure::problem("the channel came to a bad end; its message stands above"));
    };
    if let End::Device(error) = &report.end {
        return Err(Failure::problem(error));
    }
    say(&times(figures));
    let asked = match (arguments.ordinary, report.real_time) {
        (true, _) => "ordinary priority, as asked for",
        (false, true) => "real-time priority",
        (false, false) => "ordinary priority: the system gives no other (see `Priority::RealTime`)",
    };
    say(&format!(
        "{} periods, {:.2} a second, {asked}; {} left out; {:.3} % within 1.2 ms",
        grouped(figures.ticks as usize),
        figures.rate,
        figures.missed,
        100.0 * figures.punctual
    ));
    say(&format!(
        "{} samples of {} steps ({} refused), {:.3} ms a step, longest {:.3} ms, {:.0} ms behind the clock at the end; silent in {} periods",
        grouped(figures.samples as usize),
        grouped(done.steps as usize),
        done.refused,
        1e3 * done.busy / done.steps.max(1) as f64,
        1e3 * done.longest,
        1e3 * done.behind,
        figures.silent
    ));
    say(&format!("limited in {} periods, damped in {}", figures.limited, figures.damped));
    if figures.punctual < PUNCTUAL {
        return Err(Failure::problem(format!(
            "{:.3} % of the periods were within 1.2 ms, and it should be {:.1} %: something else needs the processor",
            100.0 * figures.punctual,
            100.0 * PUNCTUAL
        )));
    }
    Ok(())
}

fn times(figures: &Statistics) -> String {
    let mut rows = table(&["ms", "median", "99 %", "99.9 %", "longest"]);
    for (name, spread) in [
        ("period", figures.period),
        ("lateness", figures.lateness),
        ("work", figures.busy),
        ("latency of samples", figures.latency),
    ] {
        let times = [spread.median, spread.p99, spread.p999, spread.longest];
        rows.add_row([&[name.to_owned()][..], &times.map(|time| format!("{:.3}", 1e3 * time))].concat());
    }
    table_text(&rows)
}
