//! Rigid parts of tools.

use super::{InstrumentError, ToolPose};
use crate::contact::Capsule;

/// A round rod that ends at the tip, or at the hinge of the jaws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaft {
    /// Its radius [m, > 0]; 2.5 mm by default, as of tools for trocars of 5 mm.
    pub radius: f64,
    /// Its length [m, > 0]; 0.3 m by default.
    pub length: f64,
}

impl Default for Shaft {
    fn default() -> Self {
        Self { radius: 2.5e-3, length: 0.3 }
    }
}

impl Shaft {
    /// The rod, its end at a distance behind the tip [m].
    pub(super) fn capsule(&self, pose: &ToolPose, behind: f64) -> Capsule {
        let to = pose.tip - pose.direction * behind;
        Capsule { from: to - pose.direction * self.length, to, radius: self.radius }
    }

    pub(super) fn check(&self, kind: &'static str) -> Result<(), InstrumentError> {
        super::check_length(kind, "shaft radius", self.radius)?;
        super::check_length(kind, "shaft length", self.length)
    }
}

/// Two rods on a hinge. Closed, they meet at the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jaws {
    /// From hinge to tip [m, > 0]; 20 mm by default.
    pub length: f64,
    /// Radius of a jaw [m, > 0]; 1.5 mm by default.
    pub radius: f64,
    /// Angle between the open jaws [rad, > 0, < π]; 1 by default.
    pub opening: f64,
}

impl Default for Jaws {
    fn default() -> Self {
        Self { length: 0.02, radius: 1.5e-3, opening: 1.0 }
    }
}

impl Jaws {
    /// Both jaws. Closed they lie side by side, axes a diameter apart at the tip.
    pub(super) fn capsules(&self, pose: &ToolPose, trigger: f64) -> [Capsule; 2] {
        let [across, ..] = pose.turn().columns;
        let hinge = pose.tip - pose.direction * self.length;
        let (sin, cos) = (0.5 * self.opening * (1.0 - trigger)).sin_cos();
        [1.0, -1.0].map(|side| {
            let along = pose.direction * cos + across * (side * sin);
            Capsule {
                from: hinge,
                to: hinge + along * self.length + across * (side * self.radius),
                radius: self.radius,
            }
        })
    }

    pub(super) fn check(&self, kind: &'static str) -> Result<(), InstrumentError> {
        super::check_length(kind, "jaw length", self.length)?;
        super::check_length(kind, "jaw radius", self.radius)?;
        let (value, range) = (self.opening, "between 0 and π [rad]");
        if value > 0.0 && value < std::f64::consts::PI {
            Ok(())
        } else {
            Err(InstrumentError::OutOfRange { kind, name: "opening", value, range })
        }
    }
}
