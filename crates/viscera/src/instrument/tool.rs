use serde::{Deserialize, Serialize};

use super::{ToolInput, ToolPose};
use crate::math::Vec3;

/// A tool in a world as it is now: all about it that changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToolState {
    /// Where it is; the direction has length 1.
    pub pose: ToolPose,
    /// A point that its shaft passes through [m], if there is one.
    pub trocar: Option<Vec3<f64>>,
    /// From 0 (jaws open, current off) to 1.
    pub trigger: f64,
    /// What leads it, if a hand does.
    pub hand: Option<ToolInput>,
    /// Whether it has taken a step: before that it is just being put into place.
    pub has_moved: bool,
    /// Whether it has come to where a hand has it that pulls its trigger already: it follows the pull in the next step, wherever the hand
    /// has gone since.
    pub is_awaited: bool,
    /// Whether its jaws are closed or its current is on.
    pub is_closed: bool,
    /// Nodes that it holds.
    pub held_nodes: u32,
    /// Force of the tool on the tissue by contact, friction included: the mean over the last step [N].
    pub contact_force: Vec3<f64>,
    /// Moment of that force about the tip [N m].
    pub contact_torque: Vec3<f64>,
    /// Force of the tool on what it holds: the mean over the last step, with what the held nodes' inertia takes [N].
    pub holding_force: Vec3<f64>,
    /// Moment of that force about the tip [N m].
    pub holding_torque: Vec3<f64>,
    /// Points that touched at the end of the last step.
    pub contacts: u32,
}

impl ToolState {
    /// A tool that touches nothing.
    pub(crate) fn new(pose: ToolPose, trocar: Option<Vec3<f64>>) -> Self {
        Self {
            pose,
            trocar,
            trigger: 0.0,
            hand: None,
            has_moved: false,
            is_awaited: false,
            is_closed: false,
            held_nodes: 0,
            contact_force: Vec3::ZERO,
            contact_torque: Vec3::ZERO,
            holding_force: Vec3::ZERO,
            holding_torque: Vec3::ZERO,
            contacts: 0,
        }
    }

    /// Force of the tool on the tissue [N]; the hand feels the opposite.
    pub fn force(&self) -> Vec3<f64> {
        self.contact_force + self.holding_force
    }

    /// Moment of that force about the tip [N m].
    pub fn torque(&self) -> Vec3<f64> {
        self.contact_torque + self.holding_torque
    }
}
