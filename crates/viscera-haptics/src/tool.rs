use viscera::instrument::{ToolInput, ToolPose};
use viscera::math::Scalar;
use viscera::world::{InstrumentId, StepError, World, WorldError};

use crate::{Contact, Matrix, Pose, Sample, Vector, Workspace};

/// An instrument of a world in the hand: it goes where the hand goes, and says what the hand is to feel.
///
/// This is the whole work of a simulation for a channel:
///
/// ```no_run
/// use viscera_haptics::{HapticThread, SimulationSide, Tool};
/// # use viscera_haptics::ToolError;
/// # fn simulate(mut world: viscera::world::World<f32>, mut side: SimulationSide) -> Result<(), ToolError> {
/// let mut tool = Tool::new(world.instrument_ids().next().expect("an instrument"));
/// while let Some(pose) = side.pose() {
///     let sample = tool.step(&mut world, &pose)?; // a step of the world
///     if let Err(error) = side.send(&sample) {
///         eprintln!("{error}");
///     }
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Tool {
    instrument: InstrumentId,
    probing: Option<Probing>,
    /// Time in which it follows the hand [s].
    follows: f64,
    /// Where it is led to [m], and of which time that is [s].
    led: Option<(f64, Vector)>,
    samples: u64,
    stiffness: Option<Matrix>,
}

/// How the stiffness at the tool is found.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Probing {
    distance: f64,
    every: u64,
}

/// Why there is no sample.
#[derive(Debug, thiserror::Error)]
pub enum ToolError {
    /// The instrument is not in the world any more, or its pose is none.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The world made no step: it is where it was before, and the message says what to change.
    #[error(transparent)]
    Step(#[from] StepError),
}

impl Tool {
    /// An instrument that the hand leads. The channel learns the stiffness from the samples.
    pub fn new(instrument: InstrumentId) -> Self {
        Self { instrument, probing: None, follows: 0.0, led: None, samples: 0, stiffness: None }
    }

    /// The same, and in every so many steps the stiffness is found by three more, each with the tool off by `distance` [m] along
    /// an axis: a hundredth of the tissue's cells is a good one. The world goes on as if nobody had asked, to the bit.
    pub fn probing(mut self, distance: f64, every: u64) -> Self {
        self.probing = Some(Probing { distance, every: every.max(1) });
        self
    }

    /// The same, and it follows the hand with a delay of `time` [s, ≥ 0; 0 by default], as if a spring and a damper lay between them: the
    /// channel makes up for the distance by the stiffness. For steps of a millisecond: held tissue has a mass, and by its inertia a
    /// count Δx of the device's encoder is felt as m Δx/Δt², a newton for 55 µm and 20 g.
    pub fn following(mut self, time: f64) -> Self {
        self.follows = time;
        self
    }

    /// Where the instrument is led to for a hand at this pose: the rest of the way falls with exp(−t/τ). It comes to the hand open: closed
    /// jaws would take hold of what lies where it comes from.
    fn lead(&mut self, pose: &Pose) -> Pose {
        let trigger = if self.led.is_some() { pose.trigger } else { 0.0 };
        let position = match self.led {
            Some((time, from)) if self.follows > 0.0 => {
                let share = 1.0 - (-(pose.time - time) / self.follows).exp();
                from + (pose.position - from) * share
            }
            _ => pose.position,
        };
        self.led = Some((pose.time, position));
        Pose { position, trigger, ..*pose }
    }

    /// Leads the instrument to the pose within one step of the world, and says what the tissue answers.
    ///
    /// # Errors
    /// [`ToolError`].
    pub fn step<T: Scalar>(&mut self, world: &mut World<T>, pose: &Pose) -> Result<Sample, ToolError> {
        let pose = &self.lead(pose);
        let due = self.probing.filter(|probing| self.samples.is_multiple_of(probing.every));
        let before = due.map(|_| world.snapshot());
        let (force, contact) = self.answer(world, pose, Vector::ZERO)?;
        if let (Some(probing), Some(before)) = (due, before) {
            let after = world.snapshot();
            let mut columns = [Vector::ZERO; 3];
            for axis in 0..3 {
                let mut offset = Vector::ZERO;
                offset[axis] = probing.distance;
                world.restore(&before)?;
                let off = self.answer(world, pose, offset);
                world.restore(&after)?;
                columns[axis] = (force - off?.0) / probing.distance;
            }
            self.stiffness = Some(Matrix { columns });
        }
        self.samples += 1;
        Ok(Sample { time: pose.time, position: pose.position, force, stiffness: self.stiffness, contact })
    }

    /// The force on the hand after a step to the pose, off by `offset` [m].
    fn answer<T: Scalar>(
        &self,
        world: &mut World<T>,
        pose: &Pose,
        offset: Vector,
    ) -> Result<(Vector, Contact), ToolError> {
        let pose_there = ToolPose { tip: pose.position + offset, ..pose.tool_pose() };
        world.set_tool(self.instrument, ToolInput::new(pose_there, pose.trigger))?;
        world.step()?;
        let seen = world.observe_instrument(self.instrument);
        let contact = if seen.held_nodes > 0 { Contact::Holding } else { Contact::Pressing };
        Ok((-seen.force, contact))
    }
}

/// Where tools point that are not turned.
const DOWN: Vector = Vector::new(0.0, -1.0, 0.0);

impl Pose {
    /// The pose of a tool whose handle has these axes: the third points from the handle to the tip, and a roll of zero is the
    /// shortest turn from a tool that points down, along −y, with its first axis along x.
    pub fn tool_pose(&self) -> ToolPose {
        let [across, _, direction] = self.orientation.columns;
        let level = shortest_turn(direction, DOWN, across);
        ToolPose { tip: self.position, direction, roll: level.z.atan2(level.x) }
    }
}

impl Workspace {
    /// A device at rest in its origin is where this tool is, and its handle points as the tool does.
    pub fn of_tool(tool: &ToolPose) -> Self {
        let direction = tool.direction.normalized().unwrap_or(DOWN);
        let (sin, cos) = tool.roll.sin_cos();
        let level = [Vector::new(cos, 0.0, sin), Vector::new(-sin, 0.0, cos), DOWN];
        let rotation = Matrix { columns: level.map(|axis| shortest_turn(DOWN, direction, axis)) };
        Self { origin: tool.tip, rotation, ..Self::default() }
    }
}

/// What the shortest turn that leads `from` to `to`, both of length 1, makes of a vector. Against each other, one of them down, the turn
/// is about x.
fn shortest_turn(from: Vector, to: Vector, v: Vector) -> Vector {
    let (axis, along) = (from.cross(to), from.dot(to));
    if along > -1.0 + 1e-12 {
        v * along + axis.cross(v) + axis * (axis.dot(v) / (1.0 + along))
    } else {
        Vector::new(v.x, -v.y, -v.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(orientation: Matrix) -> Pose {
        Pose { time: 0.0, position: Vector::ZERO, orientation, velocity: Vector::ZERO, trigger: 0.0 }
    }

    /// A tool that points down and is turned about itself by an angle, then swung forward by another.
    #[test]
    fn the_roll_is_what_is_left_of_the_turn_when_the_tool_is_swung_back() {
        for (roll, swing) in [(0.0, 0.0), (0.7, 0.0), (-2.0, 0.9), (1.2, -2.5)] {
            let (sin, cos) = f64::sin_cos(roll);
            let level = [Vector::new(cos, 0.0, sin), Vector::new(-sin, 0.0, cos), Vector::new(0.0, -1.0, 0.0)];
            let (sin, cos) = f64::sin_cos(swing);
            let about_x = |v: Vector| Vector::new(v.x, cos * v.y - sin * v.z, sin * v.y + cos * v.z);
            let found = pose(Matrix { columns: level.map(about_x) }).tool_pose();
            assert!((found.roll - roll).abs() < 1e-12, "{}, not {roll}", found.roll);
            assert!((found.direction - Vector::new(0.0, -cos, -sin)).norm() < 1e-12);
        }
    }

    /// A tool of the scene that a device takes over as it is: its pose comes back from the device at rest.
    #[test]
    fn a_device_at_rest_in_the_workspace_of_a_tool_is_where_the_tool_is() {
        let directions = [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.6, -0.64, 0.48], [-0.6, 0.0, 0.8]];
        for (number, direction) in directions.into_iter().map(Vector::from).enumerate() {
            let tool = ToolPose { tip: Vector::new(0.1, -0.2, 0.3), direction, roll: 0.4 * number as f64 - 0.8 };
            let workspace = Workspace::of_tool(&tool);
            workspace.check().expect("a rotation");
            let rest = Pose { position: workspace.to_scene(Vector::ZERO), ..pose(workspace.rotation) }.tool_pose();
            assert!((rest.tip - tool.tip).norm() < 1e-15);
            assert!((rest.direction - direction).norm() < 1e-12 && (rest.roll - tool.roll).abs() < 1e-12, "{rest:?}");
        }
    }
}
