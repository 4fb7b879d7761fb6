//! Nodes that are put somewhere by hand.

use viscera::body::Body;
use viscera::material::{StVenantKirchhoff, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::TotalLagrangian;
use viscera::world::{World, WorldConfig};

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
