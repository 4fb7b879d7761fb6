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

#[cfg(test)]
mod tests {
    use crate::body::Body;
    use crate::material::{StVenantKirchhoff, Tissue};
    use crate::math::Vec3;
    use crate::mesh::{Region, TetMesh};
    use crate::model::TotalLagrangian;
    use crate::world::{World, WorldConfig};

    /// Free nodes go where they are told, a sliding one across its normal only, and a fixed one stays.
    #[test]
    fn nodes_are_placed_in_the_directions_that_are_free() {
        let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(10e3, 0.4).unwrap());
        let body = Body::new(TetMesh::box_grid([1, 1, 1], [1.0; 3]), 1000.0)
            .model(TotalLagrangian::new(tissue))
            .fix(Region::nearest([0.0; 3]))
            .slide(Region::nearest([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]);
        let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
        let id = world.add(body).unwrap();
        let rest = world.body(id).positions().to_vec();
        let shift = Vec3::new(0.1, 0.2, 0.3);
        let places: Vec<_> = rest.iter().map(|&place| place + shift).collect();
        world.body_mut(id).set_node_positions(&places);
        for (&now, &rest) in world.body(id).positions().iter().zip(&rest) {
            let wanted = match rest.to_array() {
                [0.0, 0.0, 0.0] => Vec3::ZERO,
                [1.0, 0.0, 0.0] => Vec3::new(0.1, 0.0, 0.3),
                _ => shift,
            };
            assert!((now - rest - wanted).norm() < 1e-15, "{rest:?} went to {now:?}");
        }
    }
}
