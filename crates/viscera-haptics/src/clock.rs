use std::time::{Duration, Instant};

use spin_sleep::{SpinSleeper, SpinStrategy};

/// Time, and waiting for it.
pub trait Clock {
    /// The time [s]; never runs backwards.
    fn now(&mut self) -> f64;
    /// Comes back at `time` [s] or as soon after it as possible; at once if it is over.
    fn wait_until(&mut self, time: f64);
}

/// Time before the end of a wait at which the system's sleep is no longer trusted [ns]. Sleeps of Linux end 50 to 60 µs late, under real-time
/// priority a few, and more where the cores have other work: beside a simulation whose page is served, on two cores, 99.77 to 99.91 % of the
/// periods were within 1.2 ms with a trust of 100 µs, and 99.97 to 99.99 % with this one.
const TRUST: u32 = 400_000;

/// The clock on the wall. It sleeps as long as the system can be trusted to wake it in time, and looks at the clock for the rest.
#[derive(Debug)]
pub struct WallClock {
    begin: Instant,
    sleeper: SpinSleeper,
}

impl WallClock {
    /// Starts at zero.
    pub fn start() -> Self {
        // To yield would hand the last of the wait to whoever computes, for milliseconds.
        let sleeper = SpinSleeper::new(TRUST).with_spin_strategy(SpinStrategy::SpinLoopHint);
        Self { begin: Instant::now(), sleeper }
    }
}

impl Clock for WallClock {
    fn now(&mut self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    fn wait_until(&mut self, time: f64) {
        let left = time - self.now();
        if left > 0.0 {
            self.sleeper.sleep(Duration::from_secs_f64(left));
        }
    }
}

/// A clock that stands still but for waiting, so that a run takes no time and has the same bits every time.
#[derive(Clone, Debug, Default)]
pub struct ManualClock {
    now: f64,
    /// By how much waits end late [s], one after the other.
    late: std::collections::VecDeque<f64>,
}

impl ManualClock {
    /// At zero, and its next waits end late by so much [s, ≥ 0] each; those after them in time.
    pub fn late_by(late: impl IntoIterator<Item = f64>) -> Self {
        Self { now: 0.0, late: late.into_iter().collect() }
    }

    /// Lets time pass [s, ≥ 0].
    pub fn pass(&mut self, time: f64) {
        self.now += time;
    }
}

impl Clock for ManualClock {
    fn now(&mut self) -> f64 {
        self.now
    }

    fn wait_until(&mut self, time: f64) {
        self.now = self.now.max(time) + self.late.pop_front().unwrap_or(0.0);
    }
}
