//! Coulomb's cone: what lies on a slope below it stays, and above it slides as it should.

use viscera::world::{Integrator, World};

use super::support::*;

/// A stiff block on a pair of rods along z, with gravity turned so that the rods carry it on a slope along them; gives how far and
/// how fast it has slid within a fifth of a second.
fn slide(integrator: Integrator, slope: f64, friction: f64, damping: f64) -> (f64, f64, World<f64>) {
    let (sin, cos) = slope.atan().sin_cos();
    let mut world = world::<f64>([0.0, -9.81 * cos, 9.81 * sin], 5e-3, integrator);
    let body = block([6, 2, 4], [0.06, 0.02, 0.04], Vector::new(0.0, 0.003, 0.0), 100e3).damping(damping);
    let id = world.add(body).unwrap();
    let along = Vector::new(0.0, 0.0, 1.0);
    for x in [0.013, 0.047] {
        world.add_instrument(rod(Vector::new(x, 0.0, 0.02), along, 3e-3, friction)).unwrap();
    }
    for _ in 0..20 {
        world.step().unwrap();
    }
    let middle = |world: &World<f64>| {
        let places = world.body(id).positions();
        places.iter().map(|place| place.z).sum::<f64>() / places.len() as f64
    };
    let (before, count) = (middle(&world), 20);
    for _ in 0..count {
        world.step().unwrap();
    }
    let way = middle(&world) - before;
    let speed = world.observe(id).momentum.z / world.observe(id).mass;
    (way, speed, world)
}

#[test]
fn a_block_on_a_slope_below_the_cone_stays() {
    for integrator in [EXPLICIT, implicit()] {
        let (way, _, _) = slide(integrator, 0.2, 0.4, 30.0);
        assert!(way.abs() < 2e-5, "{integrator:?}: it crept {way} m");
    }
}

/// a = g (sin α − μ cos α).
#[test]
fn a_block_on_a_slope_above_the_cone_slides_as_coulomb_says() {
    let (slope, friction) = (0.5f64, 0.2);
    let (sin, cos) = slope.atan().sin_cos();
    for (integrator, tolerance) in [(EXPLICIT, 0.03), (implicit(), 0.05)] {
        let (_, speed, world) = slide(integrator, slope, friction, 0.0);
        let expected = 9.81 * (sin - friction * cos) * world.time();
        assert!((speed / expected - 1.0).abs() < tolerance, "{integrator:?}: {speed} m/s instead of {expected}");
    }
}

/// Without friction nothing is felt across the normals: the rods' forces have no part along them.
#[test]
fn without_friction_nothing_is_felt_along_the_rod() {
    for integrator in [EXPLICIT, implicit()] {
        let (_, _, world) = slide(integrator, 0.5, 0.0, 0.0);
        for id in world.instrument_ids() {
            let force = world.tool(id).contact_force;
            assert!(force.z.abs() < 1e-2 * force.norm() && force.y > 0.0, "{integrator:?}: {force:?}");
        }
    }
}
