use super::SimulatedBody;
use crate::math::{Scalar, Vec3};

impl<T: Scalar> SimulatedBody<T> {
    /// Puts nodes to `places` [m], one for each node in their order; what is fixed or moved stays. Panics for another number
    /// of places.
    pub fn set_node_positions(&mut self, places: &[Vec3<f64>]) {
        self.check_count(places);
        for (node, &place) in places.iter().enumerate() {
            let filter = self.free_directions(node);
            self.state.positions[node] = filter.merge(place.cast(), self.state.positions[node]);
        }
        self.state.past.is_known = false;
        self.state.positions_changed();
    }

    /// Gives nodes `velocities` [m/s], one for each node in their order; what is fixed or moved keeps its own. Panics for another
    /// number of velocities.
    pub fn set_node_velocities(&mut self, velocities: &[Vec3<f64>]) {
        self.check_count(velocities);
        for (node, &velocity) in velocities.iter().enumerate() {
            let filter = self.free_directions(node);
            self.state.velocities[node] = filter.merge(velocity.cast(), self.state.velocities[node]);
        }
        self.state.past.is_known = false;
    }

    fn check_count(&self, vectors: &[Vec3<f64>]) {
        assert_eq!(vectors.len(), self.state.positions.len(), "one vector is needed for each node");
    }
}
