use serde::{Deserialize, Serialize};

use super::{InstrumentError, Path, ToolState};
use crate::curve::Curve;
use crate::math::{Mat3, Vec3};
use crate::mesh::Point;

/// Where tools point when nothing else is said: down.
const DOWN: Point = Point::new(0.0, -1.0, 0.0);

/// Where a rigid tool is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToolPose {
    /// Its tip [m].
    pub tip: Vec3<f64>,
    /// From the handle to the tip; of any length but zero. A tool with a trocar points from there to its tip, whatever is given here.
    pub direction: Vec3<f64>,
    /// How far it is turned about its direction [rad].
    pub roll: f64,
}

/// What a hand asks of a tool.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToolInput {
    /// Where it is to be.
    pub pose: ToolPose,
    /// From 0 (jaws open, current off) to 1 (jaws closed, full current).
    pub trigger: f64,
    /// How fast its tip goes there at most [m/s, > 0]; without bound it is there at the end of the next step, however far that is. Where
    /// there is a bound, the trigger is pulled only when the tip has come there.
    pub speed: f64,
}

impl ToolInput {
    /// At a pose by the end of the next step.
    pub const fn new(pose: ToolPose, trigger: f64) -> Self {
        Self { pose, trigger, speed: f64::INFINITY }
    }

    /// Where a tool that is at `from` comes in `time` [s].
    pub(crate) fn reached(&self, from: &ToolPose, time: f64) -> ToolPose {
        let (way, most) = ((self.pose.tip - from.tip).norm(), self.speed * time);
        if way > most { from.towards(&self.pose, most / way) } else { self.pose }
    }

    /// The trigger of a tool in its next step. It opens at once. It closes where the hand has it: a hand's way and its pull come together
    /// where a simulation is late, and jaws that closed before they came held nothing.
    pub(crate) fn pulled(&self, tool: &ToolState) -> f64 {
        let on_its_way = self.speed.is_finite() && self.pose.tip != tool.pose.tip && !tool.is_awaited;
        if on_its_way { self.trigger.min(tool.trigger) } else { self.trigger }
    }
}

/// How a tool is led along its path, apart from where its tip is.
#[derive(Clone, Debug, PartialEq)]
pub struct Mount {
    /// Where it points, from handle to tip, along time [s]; (0, −1, 0), down, by default.
    pub direction: Path,
    /// How far it is turned about its direction [rad].
    pub roll: f64,
    /// A point that the shaft passes through [m], as through the wall of the belly: the direction follows from it and the tip.
    /// [`World::set_trocar`](crate::world::World::set_trocar) moves it later.
    pub trocar: Option<Vec3<f64>>,
}

impl Default for Mount {
    fn default() -> Self {
        Self { direction: Curve::constant(DOWN), roll: 0.0, trocar: None }
    }
}

impl Mount {
    /// A tool that passes through a point [m].
    pub fn through(trocar: Vec3<f64>) -> Self {
        Self { trocar: Some(trocar), ..Self::default() }
    }

    /// A tool that points along `direction` all the time.
    pub fn along(direction: Vec3<f64>) -> Self {
        Self { direction: Curve::constant(direction), ..Self::default() }
    }

    /// The pose with its tip at `tip` at `time` [s], through `trocar`.
    pub(crate) fn pose(&self, tip: Point, time: f64, trocar: Option<Point>) -> ToolPose {
        let given = self.direction.at(time).normalized().unwrap_or(DOWN);
        ToolPose { tip, direction: given, roll: self.roll }.through(trocar)
    }

    pub(crate) fn check(&self, kind: &'static str) -> Result<(), InstrumentError> {
        let out_of_range = |name, value, range| Err(InstrumentError::OutOfRange { kind, name, value, range });
        if let Some((_, direction)) = self.direction.points().iter().find(|(_, d)| d.normalized().is_none()) {
            return out_of_range("direction", direction.norm(), "a vector with a length");
        }
        check_trocar(kind, self.trocar)?;
        if self.roll.is_finite() { Ok(()) } else { out_of_range("roll", self.roll, "finite [rad]") }
    }
}

pub(crate) fn check_trocar(kind: &'static str, trocar: Option<Point>) -> Result<(), InstrumentError> {
    match trocar.filter(|trocar| !trocar.is_finite()) {
        None => Ok(()),
        Some(trocar) => {
            Err(InstrumentError::OutOfRange { kind, name: "trocar", value: trocar.norm(), range: "finite [m]" })
        }
    }
}

impl ToolPose {
    /// The pose as a trocar [m] lets it be: its direction, of length 1, leads from there to its tip. Without a trocar, or with the tip in it,
    /// its direction stays, which must have a length.
    pub fn through(self, trocar: Option<Point>) -> Self {
        let through = trocar.and_then(|trocar| (self.tip - trocar).normalized());
        Self { direction: through.or(self.direction.normalized()).unwrap_or(DOWN), ..self }
    }

    /// Its axes in the world: across, up, and along its direction, which must be of length 1.
    ///
    /// The shortest turn that leads from the world's −y to the direction, after the roll.
    pub(crate) fn turn(&self) -> Mat3<f64> {
        let (sin, cos) = self.roll.sin_cos();
        let (x, z) = (Point::new(1.0, 0.0, 0.0), Point::new(0.0, 0.0, 1.0));
        let rolled = Mat3::from_columns(x * cos + z * sin, z * cos - x * sin, DOWN);
        let axis = DOWN.cross(self.direction);
        let along = DOWN.dot(self.direction);
        // Straight up every turn is as short as any other.
        let swing = |v: Point| match along > -1.0 + 1e-12 {
            true => v * along + axis.cross(v) + axis * (axis.dot(v) / (1.0 + along)),
            false => Point::new(v.x, -v.y, -v.z),
        };
        Mat3 { columns: rolled.columns.map(swing) }
    }

    /// Part of the way to another pose: in a straight line, turning evenly.
    pub(crate) fn towards(&self, other: &Self, share: f64) -> Self {
        let between = |a: Point, b: Point| a + (b - a) * share;
        Self {
            tip: between(self.tip, other.tip),
            direction: between(self.direction, other.direction).normalized().unwrap_or(other.direction),
            roll: self.roll + (other.roll - self.roll) * share,
        }
    }

    pub(crate) fn check(&self, kind: &'static str) -> Result<(), InstrumentError> {
        let out_of_range = |name, value, range| Err(InstrumentError::OutOfRange { kind, name, value, range });
        if !self.tip.is_finite() {
            return out_of_range("tip", self.tip.norm(), "finite [m]");
        }
        if self.direction.normalized().is_none() {
            return out_of_range("direction", self.direction.norm(), "a vector with a length");
        }
        if self.roll.is_finite() { Ok(()) } else { out_of_range("roll", self.roll, "finite [rad]") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_right_angled_and_the_last_is_the_direction() {
        for direction in [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8], [0.48, 0.6, -0.64]] {
            let turn = ToolPose { tip: Point::ZERO, direction: direction.into(), roll: 0.7 }.turn();
            assert!(((turn.transpose() * turn) - Mat3::IDENTITY).squared_norm() < 1e-28);
            assert!((turn.columns[2] - direction.into()).norm() < 1e-15);
        }
    }

    #[test]
    fn a_tool_through_a_trocar_points_away_from_it() {
        let pose = ToolPose { tip: Point::new(0.4, 0.0, 0.0), direction: DOWN, roll: 0.0 };
        let pose = pose.through(Some(Point::new(0.0, 0.3, 0.0)));
        assert!((pose.direction - Point::new(0.8, -0.6, 0.0)).norm() < 1e-15);
    }
}
