//! What a tool takes hold of when it closes.

use crate::body::{NodeMotion, SimulatedBody};
use crate::instrument::{Instrument, ToolPose};
use crate::math::{Mat3, Scalar, Vec3};

/// A tool that closes.
pub(super) struct Grip {
    tool: u32,
    pose: ToolPose,
    to_own: Mat3<f64>,
}

impl Grip {
    pub(super) fn new(tool: u32, pose: ToolPose) -> Self {
        Self { tool, pose, to_own: pose.turn().transpose() }
    }

    /// Holds a node from now on, if it can be held; gives how many that are.
    pub(super) fn hold<T: Scalar>(&self, body: &mut SimulatedBody<T>, node: usize) -> u32 {
        if !body.can_be_held(node) {
            return 0;
        }
        let place = body.state.positions[node].cast::<f64>();
        body.state.motions[node] = NodeMotion::Held(self.tool);
        body.state.grips[node] = (self.to_own * (place - self.pose.tip)).cast();
        1
    }

    /// Holds the corners of cells that reach in between the jaws; gives how many that are.
    pub(super) fn hold_cells<T: Scalar>(&self, body: &mut SimulatedBody<T>, instrument: &dyn Instrument<T>) -> u32 {
        let (mut low, mut high) = (Vec3::splat(f64::INFINITY), Vec3::splat(f64::NEG_INFINITY));
        instrument.each_place_between(&self.pose, &mut |place| (low, high) = (low.min(place), high.max(place)));
        let mut held = 0;
        for cell in 0..body.mesh.cell_count() {
            let (lowest, highest) = body.cell_bounds(cell);
            let apart = (lowest - high).max(low - highest);
            if body.state.removed[cell] || apart.x > 0.0 || apart.y > 0.0 || apart.z > 0.0 {
                continue;
            }
            let mut reaches = false;
            instrument.each_place_between(&self.pose, &mut |place| reaches = reaches || body.is_in_cell(cell, place));
            if reaches {
                for corner in 0..body.mesh.cell(cell).len() {
                    held += self.hold(body, body.mesh.cell(cell)[corner] as usize);
                }
            }
        }
        held
    }
}
