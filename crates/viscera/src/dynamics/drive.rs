use crate::body::{NodeMotion, SimulatedBody};
use crate::contact::{MovingCapsule, ToolFrame};
use crate::math::{Scalar, Vec3};

/// What drives the nodes that forces do not move, over one step.
#[derive(Clone, Copy, Debug)]
pub struct Drive<'a, T> {
    /// Time at the end of the step [s].
    pub end: f64,
    /// How the instruments move over the step.
    pub frames: &'a [ToolFrame],
    /// Their rigid parts, which tissue does not pass.
    pub rods: &'a [MovingCapsule],
    /// Gravity [m/s²].
    pub gravity: Vec3<T>,
}

impl<T: Scalar> Drive<'_, T> {
    /// Where a node that is at `position` has to be at the end of the step [m], in the directions that are not left to the
    /// forces; none for one that forces move.
    pub(crate) fn target(&self, body: &SimulatedBody<T>, node: usize, position: Vec3<T>) -> Option<Vec3<T>> {
        let state = &body.state;
        match state.motions[node] {
            NodeMotion::Fixed | NodeMotion::Retired | NodeMotion::Following => Some(position),
            NodeMotion::Held(instrument) => {
                Some(self.frames[instrument as usize].at_end(state.grips[node].cast()).cast())
            }
            _ => body.driven_to(node, self.end),
        }
    }
}

impl<T: Scalar> SimulatedBody<T> {
    /// Where a node has to be at `time` [s] by the body's own prescribed motions [m]; none for one that has none.
    pub(super) fn driven_to(&self, node: usize, time: f64) -> Option<Vec3<T>> {
        match self.state.motions[node] {
            NodeMotion::Prescribed(curve) => Some(self.rest[node] + self.prescribed[curve as usize].at(time).cast()),
            NodeMotion::Guided(guide) => Some(self.rest[node] + self.guides.displacement(guide, time).cast()),
            _ => None,
        }
    }
}
