use std::collections::VecDeque;

use crate::{Device, DeviceError, Hand, Rating, Reading, Vector};

/// What an emulated device does less well than an ideal one. All zero by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Imperfections {
    /// Time from a motion to its reading, and from a command to its force [s, ≥ 0].
    pub latency: f64,
    /// Standard deviation of a reading in each direction [m, ≥ 0].
    pub noise: f64,
    /// Readings are multiples of this [m, ≥ 0].
    pub resolution: f64,
    /// Share of readings that get no answer [0 to 1].
    pub lost: f64,
    /// When the cable is pulled out [s].
    pub unplugged: Option<f64>,
    /// Of the random numbers: the same seed gives the same bits.
    pub seed: u64,
}

/// A device without hardware: a hand that goes a way, seen through latency, noise and counts.
///
/// Its time is the channel's, so that it is as fast or as slow as the clock.
#[derive(Debug)]
pub struct EmulatedDevice {
    rating: Rating,
    hand: Hand,
    imperfections: Imperfections,
    random: fastrand::Rng,
    now: f64,
    trigger: f64,
    /// Times [s] and true places [m] that are not seen yet, but for the first.
    seen_later: VecDeque<(f64, Vector)>,
    /// Times [s] and forces [N] that do not act yet.
    acts_later: VecDeque<(f64, Vector)>,
    /// The force that acts [N].
    felt: Vector,
    released: bool,
}

impl EmulatedDevice {
    /// An ideal device of this rating in a hand.
    pub fn new(rating: Rating, hand: Hand) -> Self {
        Self::imperfect(rating, hand, Imperfections::default())
    }

    /// A device in a hand, with imperfections.
    pub fn imperfect(rating: Rating, hand: Hand, imperfections: Imperfections) -> Self {
        let seen_later = VecDeque::from([(0.0, hand.position())]);
        Self {
            rating,
            hand,
            imperfections,
            random: fastrand::Rng::with_seed(imperfections.seed),
            now: 0.0,
            trigger: 0.0,
            seen_later,
            acts_later: VecDeque::new(),
            felt: Vector::ZERO,
            released: false,
        }
    }

    /// The same device with its trigger pressed: 0 is open, 1 is closed.
    pub fn trigger(mut self, trigger: f64) -> Self {
        self.trigger = trigger;
        self
    }

    /// The hand.
    pub fn hand(&self) -> &Hand {
        &self.hand
    }

    /// The force that the hand feels [N].
    pub fn felt(&self) -> Vector {
        self.felt
    }

    /// Whether the channel has let go of it.
    pub fn is_released(&self) -> bool {
        self.released
    }

    /// Moves the hand to `now`, each force from when it acts.
    fn advance(&mut self, now: f64) {
        while let Some(&(time, force)) = self.acts_later.front().filter(|(time, _)| *time <= now) {
            self.hand.advance(time.max(self.now), self.felt);
            self.now = time.max(self.now);
            self.felt = force;
            self.acts_later.pop_front();
        }
        self.hand.advance(now, self.felt);
        self.now = now;
        self.seen_later.push_back((now, self.hand.position()));
    }

    /// Where the hand was at `time`, on the line between the places around it.
    fn place_at(&mut self, time: f64) -> Vector {
        while self.seen_later.len() > 1 && self.seen_later[1].0 <= time {
            self.seen_later.pop_front();
        }
        match (self.seen_later.front(), self.seen_later.get(1)) {
            (Some(&(t0, a)), Some(&(t1, b))) if t1 > t0 => a + (b - a) * ((time - t0) / (t1 - t0)).clamp(0.0, 1.0),
            (Some(&(_, a)), _) => a,
            (None, _) => self.hand.position(),
        }
    }

    /// A number of the standard normal distribution (Box, Muller 1958).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.random.f64()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.random.f64()).cos()
    }

    fn is_unplugged(&self) -> bool {
        self.imperfections.unplugged.is_some_and(|time| self.now >= time)
    }
}

impl Device for EmulatedDevice {
    fn rating(&self) -> Rating {
        self.rating
    }

    fn read(&mut self, now: f64) -> Result<Reading, DeviceError> {
        self.advance(now);
        if self.is_unplugged() {
            return Err(DeviceError::Lost { what: "its cable was pulled out".into() });
        }
        let Imperfections { latency, noise, resolution, lost, .. } = self.imperfections;
        let mut position = self.place_at(now - latency);
        if noise > 0.0 {
            position += Vector::new(self.normal(), self.normal(), self.normal()) * noise;
        }
        if resolution > 0.0 {
            position = Vector::from(position.to_array().map(|x| (x / resolution).round() * resolution));
        }
        if lost > 0.0 && self.random.f64() < lost {
            return Err(DeviceError::Transient { what: "this reading was lost".into() });
        }
        Ok(Reading { position, trigger: self.trigger, ..Reading::default() })
    }

    fn command(&mut self, force: Vector) -> Result<(), DeviceError> {
        if self.is_unplugged() {
            return Err(DeviceError::Lost { what: "its cable was pulled out".into() });
        }
        self.released = false;
        if self.imperfections.latency > 0.0 {
            self.acts_later.push_back((self.now + self.imperfections.latency, force));
        } else {
            self.felt = force;
        }
        Ok(())
    }

    fn release(&mut self) {
        self.acts_later.clear();
        self.felt = Vector::ZERO;
        self.released = true;
    }
}
