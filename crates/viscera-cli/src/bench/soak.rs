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

/// The most samples of the memory that are kept. With one for each round they would be memory that grows: 0.4 MB in an hour.
const SAMPLES: usize = 512;

/// What was played, and how much memory the program took.
#[derive(Clone, Debug)]
struct Played {
    rounds: usize,
    steps: u64,
    time: Duration,
    /// After the first round and every `stride`-th from there on [bytes].
    memory: Vec<usize>,
    stride: usize,
}

impl Played {
    fn nothing() -> Self {
        Self { rounds: 0, steps: 0, time: Duration::ZERO, memory: Vec::with_capacity(SAMPLES), stride: 1 }
    }

    /// One more round, of so many steps, after so much time, with so much memory at its end [bytes].
    fn add_round(&mut self, steps: u64, time: Duration, resident: usize) {
        if self.rounds.is_multiple_of(self.stride) {
            if self.memory.len() == SAMPLES {
                self.keep_every_second();
            }
            self.memory.push(resident);
        }
        self.rounds += 1;
        self.steps += steps;
        self.time = time;
    }

    fn keep_every_second(&mut self) {
        let mut is_kept = false;
        self.memory.retain(|_| {
            is_kept = !is_kept;
            is_kept
        });
        self.stride *= 2;
    }
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
    let (begin, mut played, mut told) = (Instant::now(), Played::nothing(), 0);
    let is_cut_short = Cell::new(false);
    while begin.elapsed() < duration && !is_cut_short.get() {
        // A round is played to its end, whatever the clock says, so that the last sample is as good as the others.
        let steps = rounds.play(|| {
            is_cut_short.set(interrupt.is_asked());
            is_cut_short.get()
        })?;
        let resident = resident()?;
        played.add_round(steps, begin.elapsed(), resident);
        let line = (f64::from(LINES) * played.time.as_secs_f64() / arguments.duration) as u32;
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
fn judge(Played { rounds, steps, time, memory, .. }: &Played) -> Result<(), Failure> {
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

    fn played(rounds: usize, memory: impl Fn(usize) -> usize) -> Played {
        let mut played = Played::nothing();
        (1..=rounds).for_each(|round| played.add_round(10, Duration::from_secs(round as u64), memory(round)));
        played
    }

    #[test]
    fn memory_that_grows_all_the_time_is_a_failure_and_a_start_that_settles_is_not() {
        let leak = played(100, |second| 20_000_000 + 50_000 * second);
        let failure = judge(&leak).expect_err("it grows").to_string();
        assert!(failure.contains("the memory grows by more than 5 %"), "{failure}");
        assert!(judge(&played(100, |second| if second == 1 { 10_000_000 } else { 20_000_000 })).is_ok());
        assert!(judge(&played(100, |second| 15_300_000 + 130_000 * (second * 7 % 11))).is_ok());
    }

    /// A soak of days must not be what it looks for.
    #[test]
    fn samples_stay_few_and_evenly_spread_however_many_rounds_there_are() {
        for rounds in [1, 511, 512, 513, 1024, 1025, 100_000] {
            let Played { rounds: counted, steps, memory, stride, .. } = played(rounds, |round| round);
            assert_eq!((counted, steps), (rounds, 10 * rounds as u64));
            let expected: Vec<usize> = (1..=rounds).step_by(stride).collect();
            assert_eq!(memory, expected, "{rounds} rounds");
            assert!(memory.len() <= SAMPLES, "{rounds} rounds");
            assert!(memory.len() > SAMPLES / 2 || stride == 1, "{rounds} rounds keep {} samples", memory.len());
        }
        let leak = played(100_000, |round| 20_000_000 + 50 * round);
        assert!(judge(&leak).is_err(), "5 MB in 100 000 rounds");
    }
}
