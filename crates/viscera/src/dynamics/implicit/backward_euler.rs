//! Backward Euler: v⁺ = δ/Δt, a = (v⁺ − v)/Δt.

use super::scheme::{Coast, Numbers, Start};
use crate::math::Scalar;

pub(super) const NUMBERS: Numbers = Numbers { inertia: 1.0, velocity: 1.0, place: 1.0, impulse: 1.0 };

pub(super) fn coast<T: Scalar>(start: &Start<T>, dt: T) -> Coast<T> {
    Coast { increment: start.velocity * dt, velocity: start.velocity }
}
