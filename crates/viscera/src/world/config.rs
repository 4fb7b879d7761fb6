use super::step_explicit::MAX_SUBSTEPS;
use super::{World, WorldError};
use crate::body::SimulatedBody;
use crate::dynamics::implicit::{Implicit, Newton, Scheme};
use crate::dynamics::quasi_static::QuasiStatic;
use crate::math::Scalar;

/// Settings of a world.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldConfig {
    /// Gravity [m/s²]; (0, −9.81, 0) by default: y points up.
    pub gravity: [f64; 3],
    /// Time that [`World::step`] advances [s, > 0]; 5 ms by default, 200 pictures per second.
    pub step: f64,
    /// How bodies move in a step.
    pub integrator: Integrator,
}

/// How bodies move in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator {
    /// By central differences, in as many sub-steps as that takes: cheap where the tissue is soft or its cells are large.
    Explicit(Substep),
    /// By one step that the forces at its end decide: stiff tissue and small cells bear long steps.
    Implicit(Implicit),
    /// From one equilibrium to the next: loads and prescribed motions go on with time, and inertia and damping have no part in it. Every
    /// body has to be held by something, and tools that touch are refused.
    QuasiStatic(QuasiStatic),
}

impl Default for Integrator {
    fn default() -> Self {
        Self::Explicit(Substep::Automatic)
    }
}

/// How a step is divided into sub-steps of the explicit scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Substep {
    /// As few as are stable, found anew in every step.
    #[default]
    Automatic,
    /// Sub-steps no longer than this [s, > 0, at least a millionth of the step]. One that is not stable is refused when a body is added, and when the
    /// tissue stiffens so much that it stops being so.
    Fixed(f64),
}

impl Default for WorldConfig {
    fn default() -> Self {
        Self { gravity: [0.0, -9.81, 0.0], step: 5e-3, integrator: Integrator::default() }
    }
}

impl WorldConfig {
    pub(super) fn check(&self) -> Result<(), WorldError> {
        let out_of_range = |name, value, range| Err(WorldError::OutOfRange { name, value, range });
        if let Some(&value) = self.gravity.iter().find(|value| !value.is_finite()) {
            return out_of_range("gravity", value, "finite [m/s²]");
        }
        if !(self.step.is_finite() && self.step > 0.0) {
            return out_of_range("step", self.step, "positive [s]");
        }
        match self.integrator {
            Integrator::Explicit(Substep::Fixed(value)) if !(value.is_finite() && value > 0.0) => {
                out_of_range("substep", value, "positive [s]")
            }
            Integrator::Explicit(Substep::Fixed(value)) if self.step / value > MAX_SUBSTEPS => {
                out_of_range("substep", value, "at least a millionth of the step [s]")
            }
            Integrator::Implicit(settings) => match settings.first_out_of_range() {
                Some((name, value, range)) => out_of_range(name, value, range),
                None if settings.scheme == Scheme::EnergyMomentum && settings.newton == Newton::Linearised => {
                    Err(WorldError::LinearisedEnergyMomentum)
                }
                None => Ok(()),
            },
            Integrator::QuasiStatic(settings) => match settings.first_out_of_range() {
                Some((name, value, range)) => out_of_range(name, value, range),
                None => Ok(()),
            },
            Integrator::Explicit(_) => Ok(()),
        }
    }
}

impl<T: Scalar> World<T> {
    /// Refuses a body that the integrator cannot move: one that would blow up at the fixed sub-step, or that lacks what the
    /// scheme needs, or has what it does not know.
    pub(super) fn check_integrator(&self, body: &SimulatedBody<T>) -> Result<(), WorldError> {
        if let (Integrator::Implicit(_) | Integrator::QuasiStatic(_), Some(advice)) =
            (self.config.integrator, body.model.info().no_implicit)
        {
            return Err(WorldError::ModelNeedsExplicit { body: body.name().into(), model: body.model, advice });
        }
        if let (Integrator::Implicit(_) | Integrator::QuasiStatic(_), Some(feature)) =
            (self.config.integrator, body.explicit_feature())
        {
            return Err(WorldError::FeatureNeedsExplicit { body: body.name().into(), feature });
        }
        match self.config.integrator {
            Integrator::Explicit(_) | Integrator::QuasiStatic(_) if body.stiffness_damping > T::ZERO => {
                Err(WorldError::StiffnessDampingNeedsImplicit { body: body.name().into() })
            }
            Integrator::Explicit(Substep::Fixed(substep)) if substep > body.stable_step() => {
                let stable = body.stable_step();
                Err(WorldError::UnstableSubstep { body: body.name().into(), substep, stable })
            }
            Integrator::Implicit(settings) if settings.scheme.needs_mean_forces() => {
                match body.state.models.iter().find(|model| model.mean_forces().is_none()) {
                    Some(model) => {
                        Err(WorldError::NoMeanForces { body: body.name().into(), model: model.name(), law: body.law() })
                    }
                    None => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }
}
