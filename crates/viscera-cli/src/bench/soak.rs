//! `viscera bench soak`: a scene over and over, with an eye on the memory of the program.

use std::cell::Cell;
use std::time::{Duration, Instant};

use viscera::model::Precision;
use viscera_io::grouped;
use viscera_scene::file;

use super::arguments::SoakArguments;
use super::round::Rounds;
use crate::built_in::OpenScene;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::say;

/// How often the memory is told, over the whole time.
const LINES: u32 = 30;
/// Memory counts as grown when its median over the last third of the rounds is above that over the first third by more than this
/// share. Single samples waver by that much, as the system takes pages back and hands them out again: 15.3 to 16.6 MB were seen.
const GROWTH: f64 = 0.05;

/// Memory after a round.
#[derive(Clone, Copy, Debug)]
struct Sample {
    time: Duration,
    /// Of the program in memory [bytes].
    resident: usize,
}

pub(super) fn soak(arguments: &SoakArguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    let open = OpenScene::open(&arguments.scene)?;
    match open.file()?.precision {
        file::Precision::Single => soak_in::<f32>(arguments, &open, &interrupt),
        file::Precision::Double => soak_in::<f64>(arguments, &open, &interrupt),
    }
}

fn soak_in<T: Precision>(arguments: &SoakArguments, open: &OpenScene, interrupt: &Interrupt) -> Result<(), Failure> {
    let mut rounds = Rounds::new(open.scene.build::<T>().map_err(Failure::scene)?);
    let duration = Duration::from_secs_f64(arguments.duration);
    say(&format!(
        "{} in rounds of {} steps for {:.0} s",
        open.name,
        grouped(rounds.steps() as usize),
        arguments.duration
    ));
    say("   time   rounds        steps   memory");
    let (begin, mut steps, mut samples, mut told) = (Instant::now(), 0, Vec::<Sample>::new(), 0);
    let is_cut_short = Cell::new(false);
    while begin.elapsed() < duration && !is_cut_short.get() {
        // A round is played to its end, whatever the clock says, so that the last sample is as good as the others.
        steps += rounds.play(|| {
            is_cut_short.set(interrupt.is_asked());
            is_cut_short.get()
        })?;
        let sample = Sample { time: begin.elapsed(), resident: resident()? };
        samples.push(sample);
        let line = (f64::from(LINES) * sample.time.as_secs_f64() / arguments.duration) as u32;
        if samples.len() == 1 || line > told {
            told = line;
            say(&format!(
                "{:5.0} s {:8} {:>12}   {}",
                sample.time.as_secs_f64(),
                samples.len(),
                grouped(steps as usize),
                megabytes(sample.resident)
            ));
        }
    }
    judge(&samples, steps)?;
    match is_cut_short.get() {
        true => Err(Failure::Interrupted("interrupted; up to then the memory did not grow".into())),
        false => Ok(()),
    }
}

/// Says how the memory went, and fails if it grew.
fn judge(samples: &[Sample], steps: u64) -> Result<(), Failure> {
    let Some(last) = samples.last() else { return Ok(()) };
    // The first round brings what every later one uses again.
    let settled = if samples.len() > 3 { &samples[1..] } else { samples };
    let third = settled.len().div_ceil(3);
    let (first, end) = (median(&settled[..third]), median(&settled[settled.len() - third..]));
    let growth = end as f64 / first as f64 - 1.0;
    let what = format!(
        "{} rounds, {} steps in {:.0} s; memory {} in the first third, {} in the last: {:+.2} %",
        samples.len(),
        grouped(steps as usize),
        last.time.as_secs_f64(),
        megabytes(first),
        megabytes(end),
        100.0 * growth
    );
    if growth > GROWTH {
        return Err(Failure::problem(format!("the memory grows by more than {:.0} %: {what}", 100.0 * GROWTH)));
    }
    say(&format!("{what}\nevery round ended with the bits of the first one"));
    Ok(())
}

fn median(samples: &[Sample]) -> usize {
    let mut sizes: Vec<usize> = samples.iter().map(|sample| sample.resident).collect();
    sizes.sort_unstable();
    sizes[sizes.len() / 2]
}

/// Memory of this program that is not swapped out [bytes].
fn resident() -> Result<usize, Failure> {
    let stats = memory_stats::memory_stats();
    stats
        .map(|stats| stats.physical_mem)
        .ok_or_else(|| Failure::Problem("error: this system does not tell how much memory a program takes".to_owned()))
}

fn megabytes(bytes: usize) -> String {
    format!("{:.2} MB", bytes as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(resident: impl Fn(u64) -> usize) -> Vec<Sample> {
        (1..=100).map(|second| Sample { time: Duration::from_secs(second), resident: resident(second) }).collect()
    }

    #[test]
    fn memory_that_grows_all_the_time_is_a_failure_and_a_start_that_settles_is_not() {
        let leak = samples(|second| 20_000_000 + 50_000 * second as usize);
        let failure = judge(&leak, 1000).expect_err("it grows").to_string();
        assert!(failure.contains("the memory grows by more than 5 %"), "{failure}");
        assert!(judge(&samples(|second| if second == 1 { 10_000_000 } else { 20_000_000 }), 1000).is_ok());
        assert!(judge(&samples(|second| 15_300_000 + 130_000 * (second as usize * 7 % 11)), 1000).is_ok());
    }
}
