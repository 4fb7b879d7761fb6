use viscera::body::Body;
use viscera::mesh::Region;
use viscera::model::{Corotational, ShapeMemory};
use viscera::world::{BodyId, World, WorldConfig};

use crate::support::{DENSITY, Vector, bar, between, run, tissue, tumbling, world};

/// The largest relative change of a distance between nodes of a region.
fn strain(world: &World<f64>, id: BodyId, region: &Region) -> f64 {
    let body = world.body(id);
    let nodes: Vec<usize> = region.nodes(body.mesh()).unwrap().into_iter().map(|node| node as usize).collect();
    let mut worst = 0.0f64;
    for &a in &nodes {
        for &b in nodes.iter().filter(|&&b| b < a) {
            let now = (body.positions()[a] - body.positions()[b]).norm();
            let rest = (body.mesh().nodes()[a] - body.mesh().nodes()[b]).norm();
            worst = worst.max((now / rest - 1.0).abs());
        }
    }
    worst
}

/// A rigid bar thrown free tumbles about no axis of its own: it keeps momentum, angular momentum and its shape to rounding, and
/// its energy.
#[test]
fn a_thrown_rigid_bar_keeps_momenta_energy_and_shape() {
    let body = Body::new(bar(), DENSITY).model(Corotational::new(tissue())).rigid(Region::All);
    let (mut world, id) = world::<f64>([0.0; 3], body);
    world.body_mut(id).set_velocities(|x| tumbling(x) * 3.0);
    let start = world.observe(id);
    for _ in 0..300 {
        run(&mut world, 0.01);
        let seen = world.observe(id);
        assert!((seen.momentum - start.momentum).norm() < 1e-12 * start.momentum.norm());
        let change = (seen.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm();
        assert!(change < 1e-11, "{change:e}");
        // ω Δt ≤ 0.05 leaves the energy of a discrete rigid body within its square.
        assert!((seen.kinetic_energy / start.kinetic_energy - 1.0).abs() < 2.5e-3);
        assert!(strain(&world, id, &Region::All) < 1e-12);
    }
    assert!(world.observe(id).max_displacement > 1.0);
}

/// A part of a soft bar is as rigid, and what it shakes off the rest takes: momenta of the whole stay.
#[test]
fn a_bar_with_a_rigid_half_keeps_momenta_and_the_shape_of_that_half() {
    let half = || between(0.15, 0.3);
    let body = Body::new(bar(), DENSITY).model(ShapeMemory::new(tissue())).rigid(half());
    let (mut world, id) = world::<f64>([0.0; 3], body.keep_volume_exactly("whole", Region::All));
    world.body_mut(id).set_velocities(|x| tumbling(x) + Vector::new(2.0 * x.z, 0.0, 0.0));
    let start = world.observe(id);
    for _ in 0..100 {
        run(&mut world, 0.01);
        let seen = world.observe(id);
        assert!((seen.momentum - start.momentum).norm() < 1e-12 * start.momentum.norm());
        let change = (seen.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm();
        assert!(change < 1e-10, "{change:e}");
        assert!(strain(&world, id, &half()) < 1e-12);
        assert!(seen.volume_error < 1e-12, "{:e}", seen.volume_error);
    }
    assert!(strain(&world, id, &between(0.0, 0.15)) > 1e-3, "the other half is soft");
}

/// A rigid block on soft tissue: what fixes the tissue carries both, and the tissue is pressed down by the block's weight over its
/// stiffness E A/l, as a column under a load on its end.
#[test]
fn soft_tissue_carries_a_rigid_block() {
    let body = Body::new(bar(), DENSITY)
        .model(Corotational::new(tissue()))
        .damping(8.0)
        .fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0))
        .rigid(between(0.2, 0.3));
    let gravity = 0.5;
    let (mut world, id) = world::<f64>([0.0, 0.0, -gravity], body);
    run(&mut world, 6.0);
    let seen = world.observe(id);
    assert!(
        (seen.reaction.z / (seen.mass * gravity) - 1.0).abs() < 1e-6,
        "{} N of {} N",
        seen.reaction.z,
        seen.mass * gravity
    );
    // 1 kg of block and half of the 2 kg of tissue press 0.2 m of 10 kPa on 0.01 m²; glued ends stiffen a short column.
    let column = (1.0 + 0.5 * 2.0) * gravity * 0.2 / (10e3 * 0.01);
    let body = world.body(id);
    let nodes = between(0.2, 0.3).nodes(body.mesh()).unwrap();
    let sunk = |&node: &u32| (body.mesh().nodes()[node as usize] - body.positions()[node as usize]).z;
    let mean = nodes.iter().map(sunk).sum::<f64>() / nodes.len() as f64;
    assert!((0.7..1.05).contains(&(mean / column)), "{mean} m, {column} m by a column");
    assert!(strain(&world, id, &between(0.2, 0.3)) < 1e-12);
}

#[test]
fn parts_that_cannot_be_rigid_are_refused() {
    let refusal = |body: Body| {
        let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
        world.add(body.name("bar").model(ShapeMemory::new(tissue()))).unwrap_err().to_string()
    };
    let held = refusal(Body::new(bar(), DENSITY).fix(between(0.0, 0.0)).rigid(between(0.0, 0.1)));
    assert!(held.starts_with("body `bar`: node 0 of a rigid part is fixed or moved as well; leave it out"), "{held}");
    let twice = refusal(Body::new(bar(), DENSITY).rigid(between(0.0, 0.1)).rigid(between(0.1, 0.2)));
    assert!(twice.contains("is in two rigid parts; make one of the two"), "{twice}");
    let line = refusal(Body::new(bar(), DENSITY).rigid(Region::cuboid([-0.01, -0.01, -1.0], [0.01, 0.01, 1.0])));
    assert_eq!(line, "body `bar`: the 7 nodes of a rigid part lie in a line; take a region with three that do not");
}
