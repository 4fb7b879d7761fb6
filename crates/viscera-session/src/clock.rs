//! How simulated time follows the clock on the wall, which others read.

use std::collections::VecDeque;

use crate::message::Pace;

/// The most simulated time that is caught up with after a hitch [s]; what is more is given up and counted as lag. Longer, and a
/// scene that is too heavy for the machine would answer later and later.
const CATCH_UP: f64 = 0.1;
/// Time over which rates are measured [s].
const WINDOW: f64 = 1.0;

/// What simulated time owes to the clock.
#[derive(Debug, Default)]
pub(crate) struct Clock {
    /// Simulated time that is due [s].
    owed: f64,
    /// By how much simulated time has fallen behind for good [s].
    lost: f64,
    /// Time of the clock since the beginning [s].
    wall: f64,
    steps: u64,
    simulated: f64,
    /// Wall, steps and simulated time at moments of the last second.
    moments: VecDeque<(f64, u64, f64)>,
}

impl Clock {
    /// So much time has passed [s].
    pub(crate) fn elapse(&mut self, seconds: f64, runs: bool) {
        self.wall += seconds;
        if runs {
            self.owed += seconds;
        }
        self.moments.push_back((self.wall, self.steps, self.simulated));
        while self.moments.front().is_some_and(|(wall, ..)| self.wall - wall > WINDOW) {
            self.moments.pop_front();
        }
    }

    /// Gives up what can no longer be caught up with, for steps of this length [s].
    pub(crate) fn give_up(&mut self, step: f64) {
        let most = CATCH_UP.max(2.0 * step);
        if self.owed > most {
            self.lost += self.owed - most;
            self.owed = most;
        }
    }

    /// Whether a step of this length [s] is due.
    pub(crate) fn is_due(&self, step: f64) -> bool {
        self.owed >= step
    }

    /// Time until a step of this length is due [s].
    pub(crate) fn time_to(&self, step: f64) -> f64 {
        (step - self.owed).max(0.0)
    }

    /// Time of the clock since the beginning [s].
    pub(crate) fn wall(&self) -> f64 {
        self.wall
    }

    /// A step of this length [s] was made.
    pub(crate) fn stepped(&mut self, step: f64) {
        self.steps += 1;
        self.simulated += step;
        self.owed = (self.owed - step).max(0.0);
    }

    /// Nothing is owed any more: the clock was stopped, or begins anew.
    pub(crate) fn forgive(&mut self) {
        (self.owed, self.lost) = (0.0, 0.0);
    }

    pub(crate) fn pace(&self) -> Pace {
        let lag = self.lost + self.owed;
        match self.moments.front() {
            Some(&(wall, steps, simulated)) if self.wall > wall => {
                let passed = self.wall - wall;
                Pace {
                    steps_per_second: (self.steps - steps) as f64 / passed,
                    real_time: (self.simulated - simulated) / passed,
                    lag,
                }
            }
            _ => Pace { lag, ..Pace::default() },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A machine that makes 60 steps of 10 ms a second keeps up to 0.6, and falls 0.4 s behind every second.
    #[test]
    fn a_slow_machine_says_by_how_much_it_falls_behind() {
        let mut clock = Clock::default();
        for _ in 0..300 {
            clock.elapse(1.0 / 60.0, true);
            clock.give_up(0.01);
            if clock.is_due(0.01) {
                clock.stepped(0.01);
            }
        }
        let Pace { steps_per_second, real_time, lag } = clock.pace();
        // One step in 60 may fall outside the second.
        assert!((steps_per_second - 60.0).abs() < 1.1, "{steps_per_second}");
        assert!((real_time - 0.6).abs() < 0.011, "{real_time}");
        assert!((lag - 5.0 * 0.4).abs() < 0.02, "{lag}");
    }

    #[test]
    fn a_hitch_is_caught_up_with_only_in_part() {
        let mut clock = Clock::default();
        clock.elapse(1.0, true);
        clock.give_up(0.01);
        let mut steps = 0;
        while clock.is_due(0.01) {
            clock.stepped(0.01);
            steps += 1;
        }
        assert!((9..=10).contains(&steps), "0.1 s are caught up with, not {steps} steps");
        assert!((clock.pace().lag - 0.9).abs() < 0.011);
    }
}
