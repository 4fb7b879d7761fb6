use std::fmt;

use crate::Vector;

/// A place [m] along time [s].
type Way = Box<dyn Fn(f64) -> Vector + Send>;

/// The hand that holds an emulated device.
pub struct Hand {
    way: Way,
    yields: Option<Yielding>,
    /// Time up to which it has been moved [s].
    time: f64,
    position: Vector,
    velocity: Vector,
}

/// A handle between fingers: m x" = F + k (way − x) − b x'.
#[derive(Clone, Copy, Debug)]
struct Yielding {
    mass: f64,
    stiffness: f64,
    damping: f64,
}

/// Length of the steps in which a hand is moved [s].
const STEP: f64 = 1e-4;

impl Hand {
    /// A hand that goes its way [m] along time [s] whatever force there is.
    pub fn on_rails(way: impl Fn(f64) -> Vector + Send + 'static) -> Self {
        let position = way(0.0);
        Self { way: Box::new(way), yields: None, time: 0.0, position, velocity: Vector::ZERO }
    }

    /// A handle of `mass` [kg, > 0] that yields to the force, between fingers of `stiffness` [N/m, ≥ 0] and `damping` [N s/m, ≥ 0]
    /// which go along `way` [m]. With neither it flies freely.
    pub fn yielding(mass: f64, stiffness: f64, damping: f64, way: impl Fn(f64) -> Vector + Send + 'static) -> Self {
        Self { yields: Some(Yielding { mass, stiffness, damping }), ..Self::on_rails(way) }
    }

    /// The same hand, in motion at the start [m/s].
    pub fn moving(mut self, velocity: Vector) -> Self {
        self.velocity = velocity;
        self
    }

    /// Where the handle is [m].
    pub fn position(&self) -> Vector {
        self.position
    }

    /// Its velocity [m/s]; zero on rails.
    pub fn velocity(&self) -> Vector {
        self.velocity
    }

    /// Moves it to `time` [s] under `force` [N]; on a free handle exactly, as the force is constant.
    pub fn advance(&mut self, time: f64, force: Vector) {
        let Some(Yielding { mass, stiffness, damping }) = self.yields else {
            self.position = (self.way)(time);
            self.time = time;
            return;
        };
        let steps = ((time - self.time) / STEP).ceil().max(1.0);
        let dt = (time - self.time) / steps;
        for step in 0..steps as u64 {
            let target = (self.way)(self.time + dt * step as f64);
            let pull = (target - self.position) * stiffness - self.velocity * damping;
            let acceleration = (force + pull) / mass;
            self.position += self.velocity * dt + acceleration * (0.5 * dt * dt);
            self.velocity += acceleration * dt;
        }
        self.time = time;
    }
}

impl fmt::Debug for Hand {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { yields, time, position, velocity, way: _ } = self;
        formatter
            .debug_struct("Hand")
            .field("yields", yields)
            .field("time", time)
            .field("position", position)
            .field("velocity", velocity)
            .finish_non_exhaustive()
    }
}
