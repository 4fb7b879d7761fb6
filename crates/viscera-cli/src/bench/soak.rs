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

/// How often it is looked at, however many rounds there are: a list with a place for each would be memory that grows, 0.4 MB in an hour.
const SAMPLES: usize = 300;

/// What was played, and the memory of the program after some of the rounds [bytes].
#[derive(Clone, Debug)]
struct Played {
    rounds: usize,
    steps: u64,
    time: Duration,
    memory: Vec<usize>,
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
    let (begin, mut told) = (Instant::now(), 0);
    let memory = Vec::with_capacity(SAMPLES + 1);
    let mut played = Played { rounds: 0, steps: 0, time: Duration::ZERO, memory };
    let is_cut_short = Cell::new(false);
    while begin.elapsed() < duration && !is_cut_short.get() {
        // A round is played to its end, whatever the clock says, so that the last sample is as good as the others.
        played.steps += rounds.play(|| {
            is_cut_short.set(interrupt.is_asked());
            is_cut_short.get()
        })?;
        played.rounds += 1;
        played.time = begin.elapsed();
        let share = (played.time.as_secs_f64() / arguments.duration).min(1.0);
        if played.memory.len() as f64 > share * SAMPLES as f64 {
            continue;
        }
        let resident = resident()?;
        played.memory.push(resident);
        let line = (f64::from(LINES) * share) as u32;
        if played.rounds == 1 || line > told {
            told = line;
            say(&format!(
                "{:5.0} s {:8} {:>12}   {}",
                played.time.as_secs_f64(),
                played.rounds,
                grouped(played.steps as usize),
                megabytes(resident)
            ));
        }
    }
    judge(&played)?;
    match is_cut_short.get() {
        true => Err(Failure::Interrupted("interrupted; up to then the memory did not grow".into())),
        false => Ok(()),
    }
}

/// Says how the memory went, and fails if it grew.
fn judge(Played { rounds, steps, time, memory }: &Played) -> Result<(), Failure> {
    // The first round brings what every later one uses again.
    let settled = if memory.len() > 3 { &memory[1..] } else { memory };
    let third = settled.len().div_ceil(3);
    if third == 0 {
        return Ok(());
    }
    let (first, end) = (median(&settled[..third]), median(&settled[settled.len() - third..]));
    let growth = end as f64 / first as f64 - 1.0;
    let what = format!(
        "{rounds} rounds, {} steps in {:.0} s; memory {} in the first third, {} in the last: {:+.2} %",
        grouped(*steps as usize),
        time.as_secs_f64(),
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

fn median(memory: &[usize]) -> usize {
    let mut sizes = memory.to_vec();
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

    fn played(memory: impl Fn(usize) -> usize) -> Played {
        Played { rounds: 100, steps: 1000, time: Duration::from_secs(100), memory: (1..=100).map(memory).collect() }
    }

    #[test]
    fn memory_that_grows_all_the_time_is_a_failure_and_a_start_that_settles_is_not() {
        let leak = played(|second| 20_000_000 + 50_000 * second);
        let failure = judge(&leak).expect_err("it grows").to_string();
        assert!(failure.contains("the memory grows by more than 5 %"), "{failure}");
        assert!(judge(&played(|second| if second == 1 { 10_000_000 } else { 20_000_000 })).is_ok());
        assert!(judge(&played(|second| 15_300_000 + 130_000 * (second * 7 % 11))).is_ok());
    }
}
