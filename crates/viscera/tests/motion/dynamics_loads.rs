//! What drives a body from outside follows its curve, and what is measured of an affine motion is its closed form.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::mesh::{Region, TetMesh};
use viscera::model::{Precision, TotalLagrangian};

use crate::support::{
    DENSITY, Vector, assert_relative, assert_vector, free_bar, in_both_precisions, side, stvk, world,
};

/// At the end of every step prescribed nodes are where their curve says, and fixed ones where they were.
fn prescribed_nodes_are_on_their_curve_after_every_step<T: Precision>(tolerance: f64) {
    let points =
        vec![(0.0, Vector::ZERO), (0.05, Vector::new(0.004, 0.0, 0.01)), (0.1, Vector::new(0.0, -0.006, 0.002))];
    let curve = Curve::piecewise_linear(points).unwrap();
    let mut world = world::<T>([0.0; 3], 3e-3);
    let body = free_bar().fix(side("z-min")).prescribe(side("z-max"), curve.clone());
    let id = world.add(body.damping(20.0)).unwrap();
    for _ in 0..50 {
        world.step().unwrap();
        let body = world.body(id);
        let at = |node: u32| body.positions()[node as usize].cast::<f64>();
        let rest = |node: u32| body.mesh().nodes()[node as usize];
        for node in side("z-max").nodes(body.mesh()).unwrap() {
            assert_vector(at(node), rest(node) + curve.at(world.time()), tolerance);
        }
        for node in side("z-min").nodes(body.mesh()).unwrap() {
            assert_eq!(body.positions()[node as usize], rest(node).cast());
        }
    }
}
in_both_precisions!(prescribed_nodes_are_on_their_curve_after_every_step, f32: 1e-6, f64: 1e-14);

/// A load that ends leaves the momentum ∫F dt behind: a tent of 0.1 s and 2 N carries 0.1 N s. The trapezes of the
/// scheme are exact between the corners of the curve, which lie on steps.
#[test]
fn a_load_that_ends_has_given_its_impulse() {
    let peak = Vector::new(0.0, 2.0, 0.0); // N
    let tent = vec![(0.0, Vector::ZERO), (0.05, peak), (0.1, Vector::ZERO)];
    let total = Curve::piecewise_linear(tent).unwrap();
    let mut world = world::<f64>([0.0; 3], 5e-3);
    let id = world.add(free_bar().load(Load::Force { region: Region::All, total })).unwrap();
    for _ in 0..30 {
        world.step().unwrap();
    }
    assert_vector(world.observe(id).momentum, peak * 0.05, 1e-12);
}

/// x = F X: the volume varies by det F − 1 and the energy is V ψ(F), ψ = λ/2 (tr E)² + μ tr E².
fn an_affine_stretch_has_its_closed_form<T: Precision>(tolerance: f64) {
    let (size, young, poisson) = ([0.1, 0.2, 0.1], 5e3, 0.4);
    let mesh = TetMesh::box_grid([2, 3, 2], size);
    let mut world = world::<T>([0.0, -9.81, 0.0], 1e-3);
    let id = world.add(Body::new(mesh, DENSITY).model(TotalLagrangian::new(stvk(young, poisson)))).unwrap();
    let stretch = [1.3, 0.8, 1.1];
    world.body_mut(id).set_positions(|x| Vector::new(stretch[0] * x.x, stretch[1] * x.y, stretch[2] * x.z));
    world.body_mut(id).set_velocities(|x| Vector::new(2.0, 0.0, 0.0) + x * 0.0);
    let seen = world.observe(id);

    let (lambda, mu) = (young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
    let strain = stretch.map(|stretch| 0.5 * (stretch * stretch - 1.0));
    let (trace, square) = (strain.iter().sum::<f64>(), strain.iter().map(|e| e * e).sum::<f64>());
    let volume = 0.1 * 0.2 * 0.1;
    assert_relative(seen.elastic_energy, volume * (0.5 * lambda * trace * trace + mu * square), tolerance);
    assert_relative(seen.volume_variation, 1.3 * 0.8 * 1.1 - 1.0, tolerance);
    let mass = DENSITY * volume;
    assert_relative(seen.mass, mass, tolerance);
    assert_relative(seen.kinetic_energy, 0.5 * mass * 4.0, tolerance);
    assert!(!seen.at_rest && seen.inverted_cells == 0);
    // m g h of the centre: half of 0.8 × 0.2 m up, by symmetry of the mesh about its centre.
    assert_relative(seen.gravity_energy, mass * 9.81 * 0.5 * 0.8 * 0.2, tolerance);
}
in_both_precisions!(an_affine_stretch_has_its_closed_form, f32: 2e-6, f64: 1e-12);
