use super::{BodyId, World};
use crate::math::{Scalar, Vec3};

impl<T: Scalar> World<T> {
    /// Internal forces +∂W/∂x on the nodes of a body now [N]: what holds them. The force that the tissue exerts is the negative.
    /// Panics for a number of another world.
    pub fn internal_forces(&mut self, id: BodyId) -> &[Vec3<T>] {
        self.bring_forces_up_to_date();
        &self.bodies[id.0].state.internal_forces
    }

    /// Gravity and loads on the nodes of a body now [N]. Panics for a number of another world.
    pub fn external_forces(&mut self, id: BodyId) -> &[Vec3<T>] {
        self.bring_forces_up_to_date();
        &self.bodies[id.0].external_forces
    }
}
