//! What is said of a haptic channel in the end: did it keep time, and what did the simulation do for it?

use viscera_haptics::{End, Report, Statistics};
use viscera_io::grouped;
use viscera_server::StepTimes;

use crate::failure::Failure;
use crate::tables::{table, table_text};
use crate::terminal::say;

/// Says the figures of a channel that came to its end, and gives them.
///
/// # Errors
/// Where it did not end because it was asked to.
pub(crate) fn say_figures<D>(report: &Report<D>, done: &StepTimes, ordinary: bool) -> Result<Statistics, Failure> {
    let Some(figures) = report.statistics else {
        return Err(Failure::problem("the channel came to a bad end; its message stands above"));
    };
    say(&times(&figures));
    let asked = match (ordinary, report.real_time) {
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
        1e3 * done.busy / (done.steps + done.refused).max(1) as f64,
        1e3 * done.longest,
        1e3 * done.behind,
        figures.silent
    ));
    say(&format!("limited in {} periods, damped in {}", figures.limited, figures.damped));
    match &report.end {
        End::Device(error) => Err(Failure::problem(error)),
        End::Stopped | End::Panicked => Ok(figures),
    }
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
