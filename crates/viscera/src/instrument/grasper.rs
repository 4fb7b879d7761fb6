use super::{Instrument, InstrumentError, Jaws, Mount, Path, Shaft, ToolPose, check_friction, check_length};
use crate::contact::Capsule;
use crate::curve::Curve;
use crate::math::{Scalar, Vec3};
use crate::mesh::Point;

/// Jaws that take what is between them when they close and carry it along until they open.
///
/// That is what the two rods of the jaws sweep over from as far as they open until they are closed: the nodes in there, and the corners of
/// the cells that reach in between the jaws or that they touch, so that jaws finer than the cells hold the tissue that they close on. Without jaws it is
/// the nodes near the tip.
///
/// A node that needs more than its share of the grip to be carried slips through the jaws, and is dragged with that share.
#[derive(Clone, Debug, PartialEq)]
pub struct Grasper {
    /// Where the jaws are.
    pub path: Path,
    /// How they are led along the path.
    pub mount: Mount,
    /// Without jaws, the tip holds the nodes that are this near to it [m, > 0]; 10 mm by default.
    pub radius: f64,
    /// When they close [s]; never by default: for a hand that pulls the trigger.
    pub close: f64,
    /// When they open [s], if they do; after `close`.
    pub open: Option<f64>,
    /// The jaws, as rods that touch tissue until they hold some; without them the tip alone takes hold, and touches nothing.
    pub jaws: Option<Jaws>,
    /// The shaft behind the jaws, where it may touch tissue.
    pub shaft: Option<Shaft>,
    /// Coefficient of friction of jaws and shaft [≥ 0]; 0.1 by default.
    pub friction: f64,
    /// The most force with which the jaws hold, over all nodes between them [N, > 0]; without bound by default.
    pub grip: f64,
}

impl Default for Grasper {
    fn default() -> Self {
        Self {
            path: Curve::constant(Vec3::ZERO),
            mount: Mount::default(),
            radius: 0.01,
            close: f64::INFINITY,
            open: None,
            jaws: None,
            shaft: None,
            friction: 0.1,
            grip: f64::INFINITY,
        }
    }
}

impl<T: Scalar> Instrument<T> for Grasper {
    fn kind(&self) -> &'static str {
        "grasper"
    }

    fn path(&self) -> &Path {
        &self.path
    }

    fn mount(&self) -> &Mount {
        &self.mount
    }

    fn reach(&self) -> f64 {
        self.radius
    }

    fn check(&self) -> Result<(), InstrumentError> {
        let out_of_range =
            |name, value, range| Err(InstrumentError::OutOfRange { kind: "grasper", name, value, range });
        check_length("grasper", "radius", self.radius)?;
        if let Some(open) = self.open.filter(|&open| open.is_nan() || open <= self.close) {
            return out_of_range("open", open, "later than `close` [s]");
        }
        if self.grip.is_nan() || self.grip <= 0.0 {
            return out_of_range("grip", self.grip, "positive [N]");
        }
        self.mount.check("grasper")?;
        self.jaws.map_or(Ok(()), |jaws| jaws.check("grasper"))?;
        self.shaft.map_or(Ok(()), |shaft| shaft.check("grasper"))?;
        check_friction("grasper", self.friction)
    }

    fn add_parts(&self, pose: &ToolPose, trigger: f64, parts: &mut Vec<Capsule>) {
        if let Some(shaft) = self.shaft {
            parts.push(shaft.capsule(pose, self.jaws.map_or(0.0, |jaws| jaws.length)));
        }
        if let Some(jaws) = self.jaws {
            parts.extend(jaws.capsules(pose, trigger));
        }
    }

    fn parts_that_hold(&self) -> usize {
        if self.jaws.is_some() { 2 } else { 0 }
    }

    fn friction(&self) -> f64 {
        self.friction
    }

    fn grip(&self) -> f64 {
        self.grip
    }

    fn takes_hold_of(&self, pose: &ToolPose, place: Point) -> bool {
        match self.jaws {
            Some(jaws) => jaws.sweep_over(pose, place),
            None => (place - pose.tip).squared_norm() <= self.radius * self.radius,
        }
    }

    fn each_place_between(&self, pose: &ToolPose, visit: &mut dyn FnMut(Point)) {
        if let Some(jaws) = self.jaws {
            jaws.each_place_between(pose, visit);
        }
    }

    fn is_active(&self, time: f64) -> bool {
        self.close <= time && self.open.is_none_or(|open| time < open)
    }

    fn is_active_before(&self, time: f64) -> bool {
        self.close < time && self.open.is_none_or(|open| time <= open)
    }
}
