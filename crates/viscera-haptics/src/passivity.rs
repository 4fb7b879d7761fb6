//! The channel gives the hand no energy that the hand has not put in.
//!
//! A force that is held over a period lags behind the hand: pressing feels too little of it, letting go too much, and the
//! difference is energy out of nothing, which makes stiff contacts tremble. An observer counts energy at the port between device and
//! hand, exactly: a force that was held while the hand went from x_{n−1} to x_n did the work F_{n−1}·(x_n − x_{n−1}). When the next
//! period would leave less than nothing, a controller adds a damper for just what is missing: F_n = F − α v, α = −E_{n+1}/(T v²).
//!
//! Sources: Hannaford, Ryu, *Time-domain passivity control of haptic interfaces*, IEEE Trans. Robotics and Automation 18(1), 2002
//! (impedance form, eqs. 14–18); the exact count of sampled systems: Ryu, Kim, Hannaford, *Stability guaranteed control: time domain
//! passivity approach*, IEEE Trans. Control Systems Technology 12(6), 2004; Stramigioli et al., IEEE Trans. Robotics 21(4), 2005.

use crate::setting::{not_negative, positive};
use crate::{Rating, SettingError, Vector};

/// How much energy may stand between the hand and the tissue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passivity {
    /// Energy that the hand may get beyond what it has brought [J, ≥ 0].
    pub allowance: f64,
    /// The most that is remembered of what the hand has brought [J, > 0]. Tissue keeps what dissipates in it; without an end to the
    /// count, a long rub would pay for an hour of trembling.
    pub capacity: f64,
    /// The strongest damper, beyond what takes away the push [N s/m, > 0]: the device must bear it without trembling itself.
    pub damping: f64,
}

impl Passivity {
    /// For a device: no allowance; the capacity of a spring that is pressed to the peak force over the whole workspace; and a damper
    /// of b = m/2T. On a mass m that moves freely, a damper that acts a period later on the mean velocity over the period
    /// before is stable below b = 2m/T; a velocity that was measured over several readings lags further.
    pub fn of(rating: &Rating, period: f64) -> Self {
        Self {
            allowance: 0.0,
            capacity: 0.5 * rating.peak_force * rating.workspace,
            damping: 0.5 * rating.mass / period,
        }
    }

    /// # Errors
    /// [`SettingError::OutOfRange`].
    pub fn check(&self) -> Result<(), SettingError> {
        not_negative("passivity.allowance", self.allowance)?;
        positive("passivity.capacity", self.capacity)?;
        positive("passivity.damping", self.damping)
    }
}

/// Observer and controller at the port between device and hand.
#[derive(Clone, Debug)]
pub struct PassivityController {
    settings: Passivity,
    /// What the hand has put in [J].
    energy: f64,
    /// Force on the hand since, and where that began.
    last: Option<(Vector, Vector)>,
}

impl PassivityController {
    /// With nothing on either side.
    pub fn new(settings: Passivity) -> Self {
        Self { settings, energy: 0.0, last: None }
    }

    /// Energy that the hand has put in and not got back [J]; below zero, what it got out of nothing.
    pub fn energy(&self) -> f64 {
        self.energy
    }

    /// Counts the work of the force that was given last, over which the hand came to `position` [m].
    pub fn observe(&mut self, position: Vector) {
        if let Some((force, from)) = self.last.take() {
            self.energy = (self.energy - force.dot(position - from)).min(self.settings.capacity);
        }
    }

    /// The wanted `force` on the hand [N] and a damper as far as it takes, for a hand at `velocity` [m/s] and the next `dt` [s].
    pub fn control(&mut self, force: Vector, velocity: Vector, dt: f64) -> Vector {
        let squared_speed = velocity.squared_norm();
        if force.squared_norm() <= 0.0 {
            // A tool that touches nothing has nothing to give back: the rest was dissipated.
            self.energy = self.energy.min(0.0);
        }
        let given = force.dot(velocity) * dt;
        let missing = given - self.energy - self.settings.allowance;
        // A debt is paid back by motion alone; a hand that rests, or is pushed on within what it has brought, feels nothing of it.
        if missing <= 0.0 || squared_speed <= 0.0 {
            return force;
        }
        // To push less is safe at any strength; what brakes beyond that is bounded.
        let push = (force.dot(velocity) / squared_speed).max(0.0);
        force - velocity * (missing / (dt * squared_speed)).min(push + self.settings.damping)
    }

    /// Takes note of the force that was given, to a hand at `position` [m].
    pub fn gave(&mut self, force: Vector, position: Vector) {
        self.last = Some((force, position));
    }
}
