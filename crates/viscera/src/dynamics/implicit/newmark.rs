//! Newmark's family: δ = Δt v + Δt² [(½ − β) a + β a⁺], v⁺ = v + Δt [(1 − γ) a + γ a⁺].
//!
//! a is found anew from the forces at the beginning of each step, so that it belongs to the loads and the cells that there
//! are then.
//!
//! Source: Newmark, A method of computation for structural dynamics (1959).

use super::scheme::{Coast, Numbers, Start};
use crate::math::Scalar;

pub(super) fn numbers(beta: f64, gamma: f64) -> Numbers {
    Numbers { inertia: 1.0 / beta, velocity: gamma / beta, place: 1.0, impulse: gamma }
}

pub(super) fn coast<T: Scalar>(start: &Start<T>, dt: T, beta: T, gamma: T) -> Coast<T> {
    let half = T::from_f64(0.5);
    Coast {
        increment: (start.velocity + start.acceleration * (dt * (half - beta))) * dt,
        velocity: start.velocity + start.acceleration * (dt * (T::ONE - gamma)),
    }
}
