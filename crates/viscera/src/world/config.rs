use super::step::MAX_SUBSTEPS;
use super::{World, WorldError};
use crate::body::SimulatedBody;
use crate::math::Scalar;

/// Settings of a world.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldConfig {
    /// Gravity [m/s²]; (0, −9.81, 0) by default: y points up.
    pub gravity: [f64; 3],
    /// Time that [`World::step`] advances [s, > 0]; 5 ms by default, 200 pictures per second.
    pub step: f64,
    /// How a step is divided.
    pub substep: Substep,
}

/// How a step is divided into sub-steps of the explicit scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Substep {
    /// As few as are stable, found anew in every step.
    #[default]
    Automatic,
    /// Sub-steps no longer than this [s, > 0, at least a hundred-thousandth of the step]. One that is not stable is refused when a body is added, and when the
    /// tissue stiffens so much that it stops being so.
    Fixed(f64),
}

impl Default for WorldConfig {
    fn default() -> Self {
        Self { gravity: [0.0, -9.81, 0.0], step: 5e-3, substep: Substep::Automatic }
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
        match self.substep {
            Substep::Fixed(value) if !(value.is_finite() && value > 0.0) => {
                out_of_range("substep", value, "positive [s]")
            }
            Substep::Fixed(value) if self.step / value > MAX_SUBSTEPS => {
                out_of_range("substep", value, "at least a hundred-thousandth of the step [s]")
            }
            _ => Ok(()),
        }
    }
}

impl<T: Scalar> World<T> {
    /// Refuses a fixed sub-step at which the body would blow up.
    pub(super) fn check_substep(&self, body: &SimulatedBody<T>) -> Result<(), WorldError> {
        let stable = body.stable_step();
        match self.config.substep {
            Substep::Fixed(substep) if substep > stable => {
                Err(WorldError::UnstableSubstep { body: body.name().into(), substep, stable })
            }
            _ => Ok(()),
        }
    }
}
