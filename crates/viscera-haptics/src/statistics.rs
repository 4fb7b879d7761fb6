use std::fmt;

use hdrhistogram::Histogram;

/// A period counts as punctual up to this many of its nominal length.
const PUNCTUAL: f64 = 1.2;
/// The longest time that is told from a longer one [ns].
const LONGEST: u64 = 10_000_000_000;
/// Times are kept to three digits.
const DIGITS: u8 = 3;

/// What the channel did, and how regularly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// From the first period to the last [s].
    pub duration: f64,
    /// Periods begun.
    pub ticks: u64,
    /// Periods in a second [1/s].
    pub rate: f64,
    /// From the beginning of one period to that of the next.
    pub period: Spread,
    /// Share of the periods that were no longer than 1.2 of their nominal length.
    pub punctual: f64,
    /// Periods that were left out, as their time was over before they began.
    pub missed: u64,
    /// From the time at which a period was due to its beginning.
    pub lateness: Spread,
    /// Time that a period's work took.
    pub busy: Spread,
    /// From the time of a pose until its sample was there.
    pub latency: Spread,
    /// Samples taken.
    pub samples: u64,
    /// Samples that were refused: no numbers, or backwards in time.
    pub refused: u64,
    /// Periods in which the simulation was silent for longer than the watchdog puts up with.
    pub silent: u64,
    /// Periods in which a limit took from the force.
    pub limited: u64,
    /// Periods in which the passivity controller added damping.
    pub damped: u64,
    /// Readings and commands to which the device gave no answer.
    pub faults: u64,
    /// Energy that the hand has put in and not got back [J].
    pub energy: f64,
    /// Mean of the squared force over what the motors bear for ever.
    pub warmth: f64,
}

impl fmt::Display for Statistics {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { ticks, rate, missed, samples, refused, silent, limited, damped, faults, .. } = self;
        let punctual = 100.0 * self.punctual;
        writeln!(formatter, "{ticks} periods, {rate:.2} a second; {missed} left out; {punctual:.3} % punctual")?;
        for (name, spread) in [
            ("period", self.period),
            ("lateness", self.lateness),
            ("work", self.busy),
            ("latency of samples", self.latency),
        ] {
            writeln!(formatter, "{name}: {spread}")?;
        }
        writeln!(formatter, "{samples} samples, {refused} refused; {faults} times without an answer of the device")?;
        write!(formatter, "silent in {silent} periods, limited in {limited}, damped in {damped}")
    }
}

/// Times, from the most common to the longest [s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Half are no longer.
    pub median: f64,
    /// 99 of 100 are no longer.
    pub p99: f64,
    /// 999 of 1000 are no longer.
    pub p999: f64,
    /// None is longer.
    pub longest: f64,
}

impl fmt::Display for Spread {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [median, p99, p999, longest] =
            [self.median, self.p99, self.p999, self.longest].map(|time| format!("{:.3}", 1e3 * time));
        write!(formatter, "median {median} ms, 99 % {p99} ms, 99.9 % {p999} ms, longest {longest} ms")
    }
}

/// What a channel counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Counts {
    pub(crate) samples: u64,
    pub(crate) refused: u64,
    pub(crate) silent: u64,
    pub(crate) limited: u64,
    pub(crate) damped: u64,
}

/// Keeps the times of a run. It asks for memory once, at the start.
#[derive(Clone, Debug)]
pub struct Recorder {
    nominal: f64,
    first: f64,
    last: f64,
    ticks: u64,
    punctual: u64,
    pub(crate) missed: u64,
    pub(crate) faults: u64,
    periods: Times,
    lateness: Times,
    busy: Times,
    latency: Times,
}

impl Recorder {
    /// For periods of `nominal` length [s].
    pub fn new(nominal: f64) -> Self {
        Self {
            nominal,
            first: 0.0,
            last: 0.0,
            ticks: 0,
            punctual: 0,
            missed: 0,
            faults: 0,
            periods: Times::default(),
            lateness: Times::default(),
            busy: Times::default(),
            latency: Times::default(),
        }
    }

    /// A period begins `now` that was `due` [s].
    pub fn begin(&mut self, now: f64, due: f64) {
        if self.ticks == 0 {
            self.first = now;
        } else {
            let period = now - self.last;
            self.periods.add(period);
            self.punctual += u64::from(period <= PUNCTUAL * self.nominal);
        }
        self.lateness.add(now - due);
        self.last = now;
        self.ticks += 1;
    }

    /// Its work is done at `now` [s].
    pub fn end(&mut self, now: f64) {
        self.busy.add(now - self.last);
    }

    /// A sample came `latency` [s] after its pose was read.
    pub fn sample(&mut self, latency: f64) {
        self.latency.add(latency);
    }

    /// The figures so far.
    pub(crate) fn statistics(&self, counts: Counts, energy: f64, warmth: f64) -> Statistics {
        let periods = self.ticks.saturating_sub(1);
        let duration = self.last - self.first;
        let Counts { samples, refused, silent, limited, damped } = counts;
        Statistics {
            duration,
            ticks: self.ticks,
            rate: if duration > 0.0 { periods as f64 / duration } else { 0.0 },
            period: self.periods.spread(),
            punctual: if periods > 0 { self.punctual as f64 / periods as f64 } else { 1.0 },
            missed: self.missed,
            lateness: self.lateness.spread(),
            busy: self.busy.spread(),
            latency: self.latency.spread(),
            samples,
            refused,
            silent,
            limited,
            damped,
            faults: self.faults,
            energy,
            warmth,
        }
    }
}

/// Times in counters that grow with them, as wide as three digits.
#[derive(Clone, Debug)]
struct Times(Option<Histogram<u64>>);

impl Default for Times {
    fn default() -> Self {
        // The bounds are constants that the crate takes; it would refuse more than five digits.
        Self(Histogram::new_with_bounds(1, LONGEST, DIGITS).ok())
    }
}

impl Times {
    fn add(&mut self, seconds: f64) {
        if let Some(histogram) = &mut self.0 {
            histogram.saturating_record((seconds * 1e9).max(0.0) as u64);
        }
    }

    fn spread(&self) -> Spread {
        let Some(histogram) = self.0.as_ref().filter(|histogram| !histogram.is_empty()) else {
            return Spread::default();
        };
        let quantile = |share: f64| histogram.value_at_quantile(share) as f64 * 1e-9;
        Spread {
            median: quantile(0.5),
            p99: quantile(0.99),
            p999: quantile(0.999),
            longest: histogram.max() as f64 * 1e-9,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of ten thousand periods, ten are 1.5 ms long and each has a short one after it.
    #[test]
    fn percentiles_are_those_of_the_periods_that_were_recorded() {
        let mut recorder = Recorder::new(1e-3);
        for tick in 0..=10_000_u32 {
            let due = f64::from(tick) * 1e-3;
            let late = if tick % 1000 == 500 { 0.5e-3 } else { 0.0 };
            recorder.begin(due + late, due);
            recorder.end(due + late + 20e-6);
        }
        let found = recorder.statistics(Counts::default(), 0.0, 0.0);
        assert_eq!(found.ticks, 10_001);
        assert!((found.rate - 1000.0).abs() < 1e-6);
        assert!((found.punctual - 0.999).abs() < 1e-12);
        // Three digits.
        for (time, expected) in [
            (found.period.median, 1e-3),
            (found.period.p999, 1e-3),
            (found.period.longest, 1.5e-3),
            (found.lateness.longest, 0.5e-3),
            (found.busy.p999, 20e-6),
        ] {
            assert!((time / expected - 1.0).abs() < 1e-3, "{time} s, not {expected} s");
        }
    }
}
