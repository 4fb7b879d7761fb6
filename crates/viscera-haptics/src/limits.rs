use crate::setting::{positive, positive_and_finite};
use crate::{Rating, SettingError, Vector};

/// The last part of the heat that the motors bear, over which the largest force goes down to the continuous one.
const WARM: f64 = 0.2;

/// What the force at the hand stays within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The largest force [N, > 0].
    pub peak_force: f64,
    /// The largest force for ever [N, > 0].
    pub continuous_force: f64,
    /// Time in which motors grow hot [s, > 0].
    pub thermal_time: f64,
    /// Power given to the hand [W, > 0].
    pub power: f64,
    /// How fast the force may change [N/s, > 0].
    pub rate: f64,
}

impl Limits {
    /// Those of a device. Its peak force comes and goes within 10 ms at the soonest: a step in force is a knock on the hand.
    pub fn of(rating: &Rating) -> Self {
        Self {
            peak_force: rating.peak_force,
            continuous_force: rating.continuous_force,
            thermal_time: rating.thermal_time,
            power: rating.power,
            rate: rating.peak_force / 10e-3,
        }
    }

    /// # Errors
    /// [`SettingError`].
    pub fn check(&self) -> Result<(), SettingError> {
        positive_and_finite("limits.peak_force", self.peak_force)?;
        positive("limits.continuous_force", self.continuous_force)?;
        positive("limits.thermal_time", self.thermal_time)?;
        positive("limits.power", self.power)?;
        positive("limits.rate", self.rate)
    }
}

/// Keeps the force within limits.
///
/// Motors are heated by the square of their force. Its mean over the thermal time, q' = (F² − q)/τ, never passes the square of
/// the continuous force: in the last fifth below it the largest force goes down from the peak to the continuous one, so that nothing
/// ends with a jerk.
#[derive(Clone, Debug)]
pub struct Limiter {
    limits: Limits,
    /// q [N²].
    heat: f64,
    last: Vector,
}

impl Limiter {
    /// Cold and without force.
    pub fn new(limits: Limits) -> Self {
        Self { limits, heat: 0.0, last: Vector::ZERO }
    }

    /// The largest force now [N].
    pub fn largest(&self) -> f64 {
        let Limits { peak_force, continuous_force, .. } = self.limits;
        let most = continuous_force * continuous_force;
        if continuous_force >= peak_force {
            return peak_force;
        }
        let cool = ((most - self.heat) / (WARM * most)).clamp(0.0, 1.0);
        continuous_force + (peak_force - continuous_force) * cool
    }

    /// The wanted `force` [N], as near as the limits allow, on a hand that moves at `velocity` [m/s], `dt` [s] after the last.
    pub fn limit(&self, force: Vector, velocity: Vector, dt: f64) -> Vector {
        let (change, most) = (force - self.last, self.limits.rate * dt);
        let force = if change.norm() <= most { force } else { self.last + shortened(change, most) };
        self.within_force(self.within_power(force, velocity))
    }

    /// No more than the largest force, and finite.
    pub fn within_force(&self, force: Vector) -> Vector {
        shortened(force, self.largest())
    }

    /// Takes from the part along the motion what is above the power.
    fn within_power(&self, force: Vector, velocity: Vector) -> Vector {
        let given = force.dot(velocity);
        if given <= self.limits.power {
            force
        } else {
            force - velocity * ((given - self.limits.power) / velocity.squared_norm())
        }
    }

    /// The force that was given last heats the motors for `dt` [s].
    pub fn heat_for(&mut self, dt: f64) {
        // Over a long period the mean goes to the square of the force, and not past it.
        let share = 1.0 - (-dt / self.limits.thermal_time).exp();
        self.heat += (self.last.squared_norm() - self.heat) * share;
    }

    /// Takes note of the force that is given [N].
    pub fn gave(&mut self, force: Vector) {
        self.last = force;
    }

    /// Mean of the squared force over that of the continuous force: at 1 the motors are as hot as they bear.
    pub fn warmth(&self) -> f64 {
        self.heat / (self.limits.continuous_force * self.limits.continuous_force)
    }
}

/// The same vector, no longer than `length`; zero in place of one that is not finite.
fn shortened(vector: Vector, length: f64) -> Vector {
    let norm = vector.norm();
    if !norm.is_finite() {
        Vector::ZERO
    } else if norm > length {
        vector * (length / norm)
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits =
        Limits { peak_force: 3.0, continuous_force: 1.0, thermal_time: 2.0, power: f64::INFINITY, rate: f64::INFINITY };

    fn along(x: f64) -> Vector {
        Vector::new(x, 0.0, 0.0)
    }

    /// q' = (F² − q)/τ from zero reaches 0.8 c² after τ ln(F²/(F² − 0.8 c²)).
    #[test]
    fn full_force_lasts_until_the_motors_are_warm_and_ends_at_the_continuous_force() {
        let mut limiter = Limiter::new(LIMITS);
        let full = 2.0 * (9.0_f64 / 8.2).ln();
        let mut last_full = 0.0;
        for tick in 0..60_000 {
            let force = limiter.limit(along(5.0), Vector::ZERO, 1e-3);
            if force.x > 3.0 - 1e-9 {
                last_full = f64::from(tick) * 1e-3;
            }
            limiter.gave(force);
            limiter.heat_for(1e-3);
            assert!(limiter.warmth() <= 1.0, "{} at tick {tick}", limiter.warmth());
        }
        assert!((last_full - full).abs() < 2e-3, "{last_full} s, not {full} s");
        assert!((limiter.last.x - 1.0).abs() < 1e-3, "{}", limiter.last.x);
        // A hand that lets go for long finds the full force again.
        limiter.gave(Vector::ZERO);
        limiter.heat_for(60.0);
        assert!((limiter.largest() - 3.0).abs() < 1e-12);
    }

    #[test]
    fn no_more_power_goes_into_the_hand_than_the_device_may_give_and_resistance_is_left_alone() {
        let limiter = Limiter::new(Limits { power: 0.2, ..LIMITS });
        let velocity = Vector::new(0.3, 0.4, 0.0);
        let pushing = limiter.limit(Vector::new(1.0, 2.0, 0.5), velocity, 1e-3);
        assert!((pushing.dot(velocity) - 0.2).abs() < 1e-12);
        // Across the motion nothing is taken.
        assert!((pushing.cross(velocity) - Vector::new(1.0, 2.0, 0.5).cross(velocity)).norm() < 1e-12);
        let resisting = Vector::new(-1.0, -1.0, 0.0);
        assert_eq!(limiter.limit(resisting, velocity, 1e-3), resisting);
    }

    #[test]
    fn force_comes_no_faster_than_its_rate() {
        let mut limiter = Limiter::new(Limits { rate: 100.0, ..LIMITS });
        for tick in 1..=20 {
            let force = limiter.limit(along(2.0), Vector::ZERO, 1e-3);
            assert!((force.x - 0.1 * f64::from(tick)).abs() < 1e-12);
            limiter.gave(force);
        }
        assert!((limiter.limit(along(2.0), Vector::ZERO, 1e-3).x - 2.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_number_is_no_force() {
        let limiter = Limiter::new(LIMITS);
        assert_eq!(limiter.limit(along(f64::NAN), Vector::ZERO, 1e-3), Vector::ZERO);
        assert_eq!(limiter.within_force(along(f64::INFINITY)), Vector::ZERO);
    }
}
