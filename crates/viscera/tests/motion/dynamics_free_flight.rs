//! A body that nothing holds: what must be conserved is.

use viscera::body::Body;
use viscera::mesh::TetMesh;
use viscera::model::{ModelRecipe, Precision, TensorMass, TotalLagrangian};

use crate::support::{
    DENSITY, Vector, assert_relative, assert_vector, free_bar, in_both_precisions, stvk, world,
    world_of_single_substeps,
};

/// Largest relative change of momentum and angular momentum of a tumbling, swinging bar over 1000 sub-steps.
fn assert_tumbling_keeps_momenta<T: Precision>(recipe: impl ModelRecipe + 'static, tolerance: f64) {
    let mut world = world::<T>([0.0; 3], 5e-3);
    let mesh = TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]);
    let id = world.add(Body::new(mesh, DENSITY).model(recipe).keep_volume(1e4)).unwrap();
    let spin = Vector::new(3.0, 1.0, -2.0); // rad/s
    let motion = |x: Vector| Vector::new(0.1, -0.2, 0.3) + spin.cross(x) + Vector::new(0.0, 0.0, 4.0 * x.z);
    world.body_mut(id).set_velocities(motion);
    let before = world.observe(id);
    let (mut substeps, mut most_elastic) = (0, 0.0_f64);
    while substeps < 1000 {
        substeps += world.step().unwrap().substeps;
        most_elastic = most_elastic.max(world.observe(id).elastic_energy);
    }
    let after = world.observe(id);
    assert!(most_elastic > 0.01 * before.kinetic_energy, "the body must have been deformed");
    assert_vector(after.momentum, before.momentum, tolerance);
    assert_vector(after.angular_momentum, before.angular_momentum, tolerance);
}

/// Momentum and angular momentum are kept by any forces that obey Newton's third law, and by the scheme exactly: what
/// is left is rounding.
fn tumbling_keeps_momentum_and_angular_momentum<T: Precision>(tolerance: f64) {
    assert_tumbling_keeps_momenta::<T>(TotalLagrangian::new(stvk(5e3, 0.4)), tolerance);
}
in_both_precisions!(tumbling_keeps_momentum_and_angular_momentum, f32: 1e-4, f64: 1e-12);

/// The tables of tensor-mass are polynomials of the displacement, flight included: 40 cm away from where they were made,
/// terms of (0.4 m/2 cm)³ cancel, and every evaluation loses four digits. In single precision a flying body needs the
/// total-Lagrangian model.
#[test]
fn tensor_mass_keeps_momentum_but_for_the_digits_that_its_polynomials_cancel() {
    assert_tumbling_keeps_momenta::<f64>(TensorMass::new(stvk(5e3, 0.4)), 1e-6);
}

/// x = −g t²/2 and v = −g t: central differences are exact for a constant acceleration, and an unheld body feels no
/// stress. In single precision half an ulp at 4 m is 2.4e-7 m, a strain of 1e-5 over a cell.
fn a_body_that_nothing_holds_falls_as_galilei_says<T: Precision>(tolerance: f64) {
    let mut world = world::<T>([0.0, -9.81, 0.0], 1e-2);
    let id = world.add(free_bar()).unwrap();
    for _ in 0..50 {
        world.step().unwrap();
    }
    let (body, time) = (world.body(id), world.time());
    for (node, (&x, &v)) in body.positions().iter().zip(body.velocities()).enumerate() {
        let fallen = x.cast::<f64>() - body.mesh().nodes()[node];
        assert_vector(fallen, Vector::new(0.0, -0.5 * 9.81 * time * time, 0.0), tolerance);
        assert_vector(v.cast(), Vector::new(0.0, -9.81 * time, 0.0), tolerance);
    }
}
in_both_precisions!(a_body_that_nothing_holds_falls_as_galilei_says, f32: 1e-4, f64: 1e-12);

/// The scheme is symplectic and of second order: without damping the energy sways about its first value, and half the
/// step makes the swing four times smaller. 5 % are left for terms of fourth order.
#[test]
fn energy_sways_with_the_square_of_the_step() {
    let swing = |step: f64, steps: usize| {
        let mut world = world_of_single_substeps::<f64>(step);
        let id = world.add(free_bar()).unwrap();
        world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1.1 * x.z));
        let energy = |seen: viscera::world::BodyObservables| seen.kinetic_energy + seen.elastic_energy;
        let first = energy(world.observe(id));
        let swing = (0..steps).map(|_| {
            world.step().unwrap();
            (energy(world.observe(id)) - first).abs() / first
        });
        swing.fold(0.0, f64::max)
    };
    let coarse = swing(4e-4, 1000);
    assert!(coarse < 0.02, "the energy sways by {coarse:.2e}");
    assert_relative(coarse / swing(2e-4, 2000), 4.0, 0.05);
}
