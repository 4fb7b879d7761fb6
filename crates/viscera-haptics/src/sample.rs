use crate::{Matrix, Vector};

/// What the simulation says of the tissue at a tool, in the scene's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The channel's time of the [`Pose`] which the simulation moved the tool to [s]. Not the time at which the sample was ready:
    /// what lies between is latency, and the extrapolation makes up for it.
    pub time: f64,
    /// Where the tool was [m].
    pub position: Vector,
    /// The force of the tissue on the tool [N]: what the hand is to feel.
    pub force: Vector,
    /// K = −∂F/∂x [N/m], how the force falls with the place of the tool, where the simulation knows it; found from the change
    /// between samples otherwise. Positive definite for tissue that resists.
    pub stiffness: Option<Matrix>,
    /// How the tissue has hold of the tool.
    pub contact: Contact,
}

/// How tissue has hold of a tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contact {
    /// In any direction, as between the jaws of a grasper.
    #[default]
    Holding,
    /// By pressing against it: the force can end, and cannot turn round.
    Pressing,
}

/// Where a tool is to be, in the scene's frame: what the simulation reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The channel's time of the reading [s].
    pub time: f64,
    /// Of its tip [m].
    pub position: Vector,
    /// Axes of the handle as columns; the third points from the handle to its tip.
    pub orientation: Matrix,
    /// Of its tip [m/s].
    pub velocity: Vector,
    /// 0 is open, 1 is closed.
    pub trigger: f64,
}

/// A sample that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SampleError {
    /// A number of it is infinite or none: the simulation has diverged, or divided by zero on the way. The sample is left out, and
    /// the watchdog sees to the force if more of them follow.
    #[error(
        "the sample's {what} is not a finite number: it is left out, as what the simulation gave for it cannot be felt"
    )]
    NotFinite {
        /// Which.
        what: &'static str,
    },
    /// It is of an earlier time than the one before it: two simulations feed one channel, or its own numbers run backwards.
    #[error("the sample is of {time} s, after one of {before} s: samples go forward in time")]
    Backwards {
        /// Its time [s].
        time: f64,
        /// Of the one before it [s].
        before: f64,
    },
}

impl Sample {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`SampleError::NotFinite`].
    pub fn check(&self) -> Result<(), SampleError> {
        let finite = [
            ("time", self.time.is_finite()),
            ("position", self.position.is_finite()),
            ("force", self.force.is_finite()),
            ("stiffness", self.stiffness.is_none_or(Matrix::is_finite)),
        ];
        match finite.into_iter().find(|(_, finite)| !finite) {
            Some((what, _)) => Err(SampleError::NotFinite { what }),
            None => Ok(()),
        }
    }
}
