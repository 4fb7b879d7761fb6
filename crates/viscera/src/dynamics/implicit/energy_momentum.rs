//! The energy–momentum step: δ = Δt (v + v⁺)/2, a = (v⁺ − v)/Δt, with F taken at mid-step and the stress S at the mean of the two
//! strains, which the model provides ([`MeanForces`](crate::model::MeanForces)).
//!
//! δ·F = W(x⁺) − W(x) exactly, and F has neither net force nor torque about the middle of the step.
//!
//! Source: Simo, Tarnow, The discrete energy-momentum method (1992).

use super::scheme::{Coast, Numbers, Start};
use crate::math::Scalar;

pub(super) const NUMBERS: Numbers = Numbers { inertia: 2.0, velocity: 2.0, place: 0.5, impulse: 1.0 };

pub(super) fn coast<T: Scalar>(start: &Start<T>, dt: T) -> Coast<T> {
    Coast { increment: start.velocity * dt, velocity: start.velocity }
}
