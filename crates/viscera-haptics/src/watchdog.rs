use crate::SettingError;
use crate::setting::{not_negative, positive_and_finite};

/// When a silent simulation is no longer believed, and how its force goes away and comes back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watchdog {
    /// Time without a new sample that is put up with [s, ≥ 0].
    pub patience: f64,
    /// Time in which the force then fades to nothing [s, > 0].
    pub fade: f64,
    /// Time in which it comes back [s, > 0], at the start as well.
    pub recovery: f64,
}

impl Default for Watchdog {
    /// 100 ms of silence, then 200 ms to nothing, and 200 ms back: slow enough not to be felt as a knock.
    fn default() -> Self {
        Self { patience: 0.1, fade: 0.2, recovery: 0.2 }
    }
}

impl Watchdog {
    /// # Errors
    /// [`SettingError::OutOfRange`].
    pub fn check(&self) -> Result<(), SettingError> {
        not_negative("watchdog.patience", self.patience)?;
        positive_and_finite("watchdog.fade", self.fade)?;
        positive_and_finite("watchdog.recovery", self.recovery)
    }
}

/// Whether the simulation is alive, and how much of its force is given.
#[derive(Clone, Debug)]
pub struct WatchdogState {
    settings: Watchdog,
    /// When the last sample came [s].
    heard: Option<f64>,
    /// When it was last asked [s].
    asked: f64,
    gain: f64,
}

impl WatchdogState {
    /// Has heard nothing yet, and gives nothing.
    pub fn new(settings: Watchdog) -> Self {
        Self { settings, heard: None, asked: f64::NEG_INFINITY, gain: 0.0 }
    }

    /// How much of the force to give, from 0 to 1, at the time `now` [s]; `fresh` says that a sample has come. After the last sample
    /// the gain is 1 for the patience at most, and 0 once patience and fade are over, however late the question comes.
    pub fn gain(&mut self, now: f64, fresh: bool) -> f64 {
        let Watchdog { patience, fade, recovery } = self.settings;
        if fresh {
            self.heard = Some(now);
        }
        let since = now - self.asked.min(now);
        self.asked = now;
        self.gain = match self.heard {
            None => 0.0,
            Some(heard) if now - heard > patience => {
                // The part of the period that lies behind the end of patience.
                let silent = (now - heard - patience).min(since);
                (self.gain - silent / fade).max(0.0)
            }
            // The first question comes after no time.
            Some(_) if since.is_infinite() => self.gain,
            Some(_) => (self.gain + since / recovery).min(1.0),
        };
        self.gain
    }

    /// Whether the simulation has been silent for longer than is put up with.
    pub fn is_late(&self) -> bool {
        self.heard.is_none_or(|heard| self.asked - heard > self.settings.patience)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_silent_simulation_fades_over_the_stated_time_and_comes_back_over_its_own() {
        let settings = Watchdog { patience: 0.05, fade: 0.1, recovery: 0.2 };
        let mut watchdog = WatchdogState::new(settings);
        let mut gains = Vec::new();
        for tick in 0..1000 {
            // Samples every 10 ms, but for a silence from 400 ms on and until 700 ms.
            let fresh = tick % 10 == 0 && !(401..700).contains(&tick);
            gains.push(watchdog.gain(f64::from(tick) * 1e-3, fresh));
        }
        let expected =
            [(0, 0.0), (100, 0.5), (200, 1.0), (400, 1.0), (450, 1.0), (500, 0.5), (550, 0.0), (699, 0.0), (800, 0.5)];
        for (tick, gain) in expected {
            // At 700 ms the sample comes, and the gain rises by the millisecond since.
            assert!((gains[tick] - gain).abs() < 0.0051, "{} at {tick} ms", gains[tick]);
        }
        assert!(gains.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 1e-3 / 0.1 + 1e-12), "no jump");
    }

    #[test]
    fn a_channel_that_was_late_itself_finds_the_force_gone() {
        let mut watchdog = WatchdogState::new(Watchdog { patience: 0.05, fade: 0.1, recovery: 0.2 });
        (0..300).for_each(|tick| {
            watchdog.gain(f64::from(tick) * 1e-3, true);
        });
        assert!(watchdog.gain(0.299 + 0.1, false) > 0.4 && watchdog.is_late());
        assert_eq!(watchdog.gain(0.299 + 0.1501, false), 0.0);
    }

    #[test]
    fn before_the_first_sample_there_is_no_force() {
        let mut watchdog = WatchdogState::new(Watchdog::default());
        assert_eq!(watchdog.gain(5.0, false), 0.0);
        assert!(watchdog.is_late());
    }
}
