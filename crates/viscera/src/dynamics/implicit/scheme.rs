use super::{backward_euler, bdf2, energy_momentum, newmark};
use crate::math::{Scalar, Vec3};

/// How an implicit step is formed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Scheme {
    /// Of first order; damps what it cannot resolve, and never gains energy when it is solved in full.
    #[default]
    BackwardEuler,
    /// Of second order for γ = ½; γ > ½ damps high frequencies. Unconditionally stable for 2β ≥ γ ≥ ½ in linear tissue.
    Newmark {
        /// Share of the end in the position [> 0, ≤ ½]; ¼ is the average acceleration.
        beta: f64,
        /// Share of the end in the velocity [≥ ½, ≤ 1].
        gamma: f64,
    },
    /// Backward differentiation over two steps: of second order, damps high frequencies strongly. Its first step, and the
    /// first one after positions or velocities were set, is backward Euler.
    Bdf2,
    /// Keeps energy, momentum and angular momentum of undamped St Venant–Kirchhoff tissue exactly. Of second order.
    EnergyMomentum,
}

impl Scheme {
    /// Newmark's average acceleration, β = ¼, γ = ½: the trapezoidal rule.
    pub const AVERAGE_ACCELERATION: Self = Self::Newmark { beta: 0.25, gamma: 0.5 };

    /// The three numbers of the scheme; `has_past` tells whether the state before the last step is known.
    pub(super) fn numbers(self, has_past: bool) -> Numbers {
        match self {
            Self::BackwardEuler => backward_euler::NUMBERS,
            Self::Newmark { beta, gamma } => newmark::numbers(beta, gamma),
            Self::Bdf2 if has_past => bdf2::NUMBERS,
            Self::Bdf2 => backward_euler::NUMBERS,
            Self::EnergyMomentum => energy_momentum::NUMBERS,
        }
    }

    /// Where a node would go in `dt` [s] without forces.
    #[inline]
    pub(super) fn coast<T: Scalar>(self, start: &Start<T>, dt: T) -> Coast<T> {
        match (self, start.past) {
            (Self::Newmark { beta, gamma }, _) => newmark::coast(start, dt, T::from_f64(beta), T::from_f64(gamma)),
            (Self::Bdf2, Some(past)) => bdf2::coast(start, past, dt),
            (Self::EnergyMomentum, _) => energy_momentum::coast(start, dt),
            (Self::BackwardEuler | Self::Bdf2, _) => backward_euler::coast(start, dt),
        }
    }

    /// Whether a node without forces goes on as fast as it was.
    pub(super) fn coasts_by_velocity(self, has_past: bool) -> bool {
        match self {
            Self::BackwardEuler | Self::EnergyMomentum => true,
            Self::Bdf2 => !has_past,
            Self::Newmark { .. } => false,
        }
    }

    pub(super) fn needs_acceleration(self) -> bool {
        matches!(self, Self::Newmark { .. })
    }

    pub(crate) fn needs_past(self) -> bool {
        self == Self::Bdf2
    }

    pub(crate) fn needs_mean_forces(self) -> bool {
        self == Self::EnergyMomentum
    }

    pub(super) fn first_out_of_range(self) -> Option<(&'static str, f64, &'static str)> {
        match self {
            Self::Newmark { beta, .. } if !(beta > 0.0 && beta <= 0.5) => {
                Some(("newmark beta", beta, "above 0 and at most 1/2"))
            }
            Self::Newmark { gamma, .. } if !(0.5..=1.0).contains(&gamma) => {
                Some(("newmark gamma", gamma, "between 1/2 and 1"))
            }
            _ => None,
        }
    }
}

/// What makes a scheme: r, s, θ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers {
    /// r: a = r/Δt² (δ − δ̂).
    pub(super) inertia: f64,
    /// s: v⁺ = v̂ + s/Δt (δ − δ̂).
    pub(super) velocity: f64,
    /// θ: forces act at x + θ δ.
    pub(super) place: f64,
    /// Impulse of a force that is in the equation once, over Δt: Newmark's method takes 1 − γ of a force from the beginning of the
    /// step, where tools are left out, because what touches there need not touch at the end.
    pub(super) impulse: f64,
}

/// A node at the beginning of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start<T> {
    pub(super) velocity: Vec3<T>,
    /// Zero unless the scheme needs it.
    pub(super) acceleration: Vec3<T>,
    /// The displacement over the last step and the velocity before it.
    pub(super) past: Option<Past<T>>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Past<T> {
    /// x − x⁻ [m].
    pub(super) increment: Vec3<T>,
    /// v⁻ [m/s].
    pub(super) velocity: Vec3<T>,
}

/// What a node does without forces: its displacement δ̂ and its velocity v̂.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coast<T> {
    pub(super) increment: Vec3<T>,
    pub(super) velocity: Vec3<T>,
}
