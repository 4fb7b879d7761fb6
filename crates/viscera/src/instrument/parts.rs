//! Rigid parts of tools.

use super::{InstrumentError, ToolPose};
use crate::contact::Capsule;
use crate::mesh::Point;

/// The most places that are looked at between jaws, along them and across: cells are coarser than a thirtieth of them.
const MOST_PLACES: f64 = 32.0;

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

    /// Half the angle between the axes of the jaws as far as they open [rad], and how long these are [m].
    fn sector(&self) -> (f64, f64) {
        let (sin, cos) = (0.5 * self.opening).sin_cos();
        let (across, along) = (self.length * sin + self.radius, self.length * cos);
        (across.atan2(along), across.hypot(along))
    }

    /// Whether the jaws sweep over a place when they close, from as far as they open.
    pub(super) fn sweep_over(&self, pose: &ToolPose, place: Point) -> bool {
        let (half, length) = self.sector();
        let from_hinge = place - (pose.tip - pose.direction * self.length);
        let [across, ..] = pose.turn().columns;
        let (x, y) = (from_hinge.dot(across), from_hinge.dot(pose.direction));
        let beside = (from_hinge.squared_norm() - x * x - y * y).max(0.0);
        // The nearest place between the axes: on an arc about the hinge, or on an axis.
        let (angle, far) = (x.abs().atan2(y), x.hypot(y));
        let squared = if angle <= half {
            (far - length).max(0.0).powi(2)
        } else {
            let (sin, cos) = (angle - half).sin_cos();
            let along = (far * cos).clamp(0.0, length);
            (far * cos - along).powi(2) + (far * sin).powi(2)
        };
        squared + beside <= self.radius * self.radius
    }

    /// Places between the axes of the jaws as far as they open and a jaw's thickness beyond, a jaw's radius apart: tissue that a jaw touches lies a
    /// radius off its axis, and where its surface is askew on the outer side.
    pub(super) fn each_place_between(&self, pose: &ToolPose, visit: &mut dyn FnMut(Point)) {
        let (half, length) = self.sector();
        let thickness = 2.0 * self.radius;
        let (half, length) = (half + thickness.atan2(length), length + thickness);
        let [across, ..] = pose.turn().columns;
        let hinge = pose.tip - pose.direction * self.length;
        let parts = |way: f64| (way / self.radius).ceil().clamp(1.0, MOST_PLACES) as u32;
        let rings = parts(length);
        for ring in 0..=rings {
            let far = length * f64::from(ring) / f64::from(rings);
            let turns = parts(2.0 * half * far);
            for turn in 0..=turns {
                let (sin, cos) = (half * (2.0 * f64::from(turn) / f64::from(turns) - 1.0)).sin_cos();
                visit(hinge + (pose.direction * cos + across * sin) * far);
            }
        }
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
