use crate::Vector;

/// Readings that are looked at, at most.
const WINDOW: usize = 16;

/// Velocity of the hand from its positions: over the longest time in which they lie on a line but for noise. Slow motion is measured
/// over many readings and smoothly, quick motion over few and without delay.
///
/// Source: Janabi-Sharifi, Hayward, Chen, *Discrete-time adaptive windowing for velocity estimation*, IEEE Trans. Control Systems
/// Technology 8(6), 2000 (end-fit).
#[derive(Clone, Debug)]
pub struct VelocityEstimate {
    /// Distance from the line that noise explains [m].
    noise: f64,
    /// Time [s] and place [m], in a ring.
    readings: [(f64, Vector); WINDOW],
    /// Where the newest is, and how many there are.
    newest: usize,
    count: usize,
}

impl VelocityEstimate {
    /// For positions that are good to `noise` [m, ≥ 0]: the resolution of the device.
    pub fn new(noise: f64) -> Self {
        Self { noise, readings: [(0.0, Vector::ZERO); WINDOW], newest: 0, count: 0 }
    }

    /// The velocity [m/s] at the time `now` [s], where the hand is at `position` [m]; zero at the first reading.
    pub fn update(&mut self, now: f64, position: Vector) -> Vector {
        if self.count > 0 && now <= self.readings[self.newest].0 {
            return Vector::ZERO;
        }
        self.newest = (self.newest + 1) % WINDOW;
        self.readings[self.newest] = (now, position);
        self.count = (self.count + 1).min(WINDOW);
        let mut velocity = Vector::ZERO;
        for age in 1..self.count {
            let (then, start) = self.aged(age);
            let along = (position - start) / (now - then);
            let on_line = |age: usize| {
                let (moment, place) = self.aged(age);
                (start + along * (moment - then) - place).norm() <= self.noise
            };
            if !(1..age).all(on_line) {
                break;
            }
            velocity = along;
        }
        velocity
    }

    /// The reading that is so many readings old.
    fn aged(&self, age: usize) -> (f64, Vector) {
        self.readings[(self.newest + WINDOW - age) % WINDOW]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts of an encoder every millisecond, at 10 mm/s and 0.05 mm a count: one reading's difference is 0 or 50 mm/s.
    #[test]
    fn slow_motion_is_smooth_between_the_counts_of_an_encoder() {
        let count = 50e-6;
        let mut estimate = VelocityEstimate::new(count);
        let velocity = |millisecond: u32| {
            let x = f64::from(millisecond) * 1e-3 * 10e-3;
            (f64::from(millisecond) * 1e-3, Vector::new((x / count).floor() * count, 0.0, 0.0))
        };
        for millisecond in 0..100 {
            let (now, position) = velocity(millisecond);
            let found = estimate.update(now, position).x;
            if millisecond > 20 {
                // One count over the window of 15 ms.
                assert!((found - 10e-3).abs() <= count / 15e-3 + 1e-12, "{found} m/s at {millisecond} ms");
            }
        }
    }

    /// A hand that is stopped by a wall stands still in the next reading but one: the window closes at the bend.
    #[test]
    fn a_stop_is_seen_within_two_readings() {
        let mut estimate = VelocityEstimate::new(1e-6);
        let mut found = Vector::ZERO;
        for millisecond in 0..40 {
            let moving = f64::from(millisecond.min(30)) * 1e-3;
            found = estimate.update(f64::from(millisecond) * 1e-3, Vector::new(0.2 * moving, 0.0, 0.0));
            let expected = if millisecond == 0 || millisecond > 30 { 0.0 } else { 0.2 };
            assert!((found.x - expected).abs() < 1e-9, "{} m/s at {millisecond} ms", found.x);
        }
        assert!(found.norm() < 1e-9);
    }
}
