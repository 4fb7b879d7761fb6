use viscera::body::Body;
use viscera::mesh::{HexMesh, Region, TetMesh, VolumeMesh};
use viscera::model::{MassSpring, ModelRecipe, ShapeMemory};
use viscera::world::BodyObservables;

use crate::support::{DENSITY, Vector, bar, run, tissue, tumbling, world};

/// A bar held at its foot whose upper end is dragged down through the layer of nodes below it, a little awry in another way for each
/// `phase`, and let go; before and after.
fn dragged_through(recipe: Box<dyn ModelRecipe>, phase: f64) -> (BodyObservables, BodyObservables) {
    let bar = TetMesh::box_grid([3, 3, 9], [0.1, 0.1, 0.3]);
    let foot = Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0);
    let body = Body::new(bar, DENSITY).boxed_model(recipe).fix(foot).damping(4.0);
    let (mut world, id) = world::<f64>([0.0; 3], body);
    let awry = |x: Vector| Vector::new(0.01 * (40.0 * x.y + phase).sin(), 0.008 * (9.0 + 2.0 * phase).cos(), -0.05);
    world.body_mut(id).set_positions(|x| if x.z > 0.28 { x + awry(x) } else { x });
    let before = world.observe(id);
    run(&mut world, 6.0);
    (before, world.observe(id))
}

/// A layer of cells that was dragged inside out comes back where nodes remember their place; springs are as content folded.
#[test]
fn a_layer_turned_inside_out_comes_back_and_in_a_net_of_springs_it_stays() {
    for phase in [0.0, 1.0, 2.0] {
        let (before, after) = dragged_through(Box::new(ShapeMemory::new(tissue())), phase);
        assert_eq!((before.inverted_cells, after.inverted_cells), (54, 0));
        assert!(after.max_displacement < 3e-3, "{} m from rest, of 50 mm", after.max_displacement);
        let (_, after) = dragged_through(Box::new(MassSpring::new(tissue())), phase);
        assert_eq!(after.inverted_cells, 54);
        assert!(after.max_displacement > 0.05, "the net is {} m from rest", after.max_displacement);
    }
}

/// Free tissue that is all in one point comes back from there: nothing turns it, and how fast it may is known all the same. Once no frequency
/// was, and steps diverged at once.
#[test]
fn explicit_steps_lead_out_of_one_point() {
    let meshes: [VolumeMesh; 2] =
        [TetMesh::box_grid([2; 3], [0.1; 3]).into(), HexMesh::box_grid([2; 3], [0.1; 3]).into()];
    for mesh in meshes {
        let body = Body::new(mesh, DENSITY).model(ShapeMemory::new(tissue())).damping(50.0);
        let (mut world, id) = world::<f64>([0.0; 3], body);
        world.body_mut(id).set_positions(|_| Vector::splat(0.05));
        run(&mut world, 2.0);
        let seen = world.observe(id);
        assert_eq!(seen.inverted_cells, 0);
        assert!(seen.max_displacement < 1e-7, "{} m from rest", seen.max_displacement);
    }
}

/// Free and undamped, what remembers its shape keeps energy, momentum and angular momentum while it tumbles and vibrates.
#[test]
fn a_free_body_keeps_energy_momentum_and_angular_momentum() {
    let (mut world, id) = world::<f64>([0.0; 3], Body::new(bar(), DENSITY).model(ShapeMemory::new(tissue())));
    world.body_mut(id).set_positions(|x| Vector::new(x.x, 1.05 * x.y + 0.1 * x.z * x.z, x.z));
    world.body_mut(id).set_velocities(tumbling);
    let start = world.observe(id);
    let energy = |seen: &BodyObservables| seen.kinetic_energy + seen.elastic_energy;
    for _ in 0..200 {
        run(&mut world, 0.01);
        let seen = world.observe(id);
        assert!((seen.momentum - start.momentum).norm() < 1e-12 * start.momentum.norm());
        assert!((seen.angular_momentum - start.angular_momentum).norm() < 1e-12 * start.angular_momentum.norm());
        // Central differences keep a nearby energy: half the square of ω Δt ≤ 1.8 of the fastest vibration, which has little.
        assert!((energy(&seen) / energy(&start) - 1.0).abs() < 0.02, "{}", energy(&seen) / energy(&start));
    }
    assert!(start.elastic_energy > 1e-3 * start.kinetic_energy, "{} J", start.elastic_energy);
}
