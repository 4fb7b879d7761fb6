//! Backward differentiation of second order: v⁺ = (3 x⁺ − 4 x + x⁻)/2Δt, a = (3 v⁺ − 4 v + v⁻)/2Δt.
//!
//! Without forces, 3 v̂ = 4 v − v⁻ and 3 δ̂ = 2Δt v̂ + (x − x⁻).

use super::scheme::{Coast, Numbers, Past, Start};
use crate::math::Scalar;

pub(super) const NUMBERS: Numbers = Numbers { inertia: 2.25, velocity: 1.5, place: 1.0, impulse: 1.0 };

pub(super) fn coast<T: Scalar>(start: &Start<T>, past: Past<T>, dt: T) -> Coast<T> {
    let third = T::from_f64(1.0 / 3.0);
    let velocity = (start.velocity * T::from_f64(4.0) - past.velocity) * third;
    Coast { increment: (velocity * (dt + dt) + past.increment) * third, velocity }
}
