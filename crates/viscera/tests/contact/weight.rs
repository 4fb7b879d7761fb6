//! What a held tool reports is what lies on it.

use viscera::model::Precision;
use viscera::world::{Integrator, World};

use super::support::*;

/// A damped block of 6×2×4 cm that has come to rest on two rods along z; gives the forces of the rods, the means over the last fifty
/// steps, and the block's weight. A block at rest trembles where contacts go from one triangle to the next; its momentum does not grow.
fn weigh<T: Precision>(integrator: Integrator, friction: f64, steps: usize) -> ([Vector; 2], Vector, World<T>) {
    let mut world = world::<T>(GRAVITY, 8e-3, integrator);
    let id = world.add(block([6, 2, 4], [0.06, 0.02, 0.04], Vector::new(0.0, 0.003, 0.0), 20e3).damping(30.0)).unwrap();
    let along = Vector::new(0.0, 0.0, 1.0);
    let rods =
        [0.013, 0.047].map(|x| world.add_instrument(rod(Vector::new(x, 0.0, 0.02), along, 3e-3, friction)).unwrap());
    let mut forces = [Vector::ZERO; 2];
    for step in 0..steps {
        world.step().unwrap();
        for (force, rod) in forces.iter_mut().zip(rods) {
            *force += if step + 50 < steps { Vector::ZERO } else { world.observe_instrument(rod).force / 50.0 };
        }
    }
    let weight = Vector::from(GRAVITY) * world.observe(id).mass;
    (forces, weight, world)
}

fn assert_weighs<T: Precision>(integrator: Integrator, tolerance: f64) {
    let ([left, right], weight, world) = weigh::<T>(integrator, 0.3, 250);
    assert_vector(left + right, -weight, tolerance);
    // The rods stand 17 mm to either side of the middle: each carries a half, but for how the cells are cut.
    assert!((left.y / right.y - 1.0).abs() < 0.05, "{left:?} {right:?}");
    // Nothing sinks in: lowest nodes are no deeper in a rod than a hundredth of its radius.
    let body = world.body(world.body_ids().next().unwrap());
    for node in body.positions().iter().map(|place| place.cast::<f64>()) {
        for x in [0.013, 0.047] {
            let depth = 3e-3 - Vector::new(node.x - x, node.y, 0.0).norm();
            assert!(depth < 0.01 * 3e-3, "{depth} m deep at {node:?}");
        }
    }
}

#[test]
fn two_rods_carry_a_block_s_weight_in_explicit_steps() {
    assert_weighs::<f64>(EXPLICIT, 1e-3);
}

#[test]
fn two_rods_carry_a_block_s_weight_in_explicit_steps_of_single_precision() {
    assert_weighs::<f32>(EXPLICIT, 1e-3);
}

#[test]
fn two_rods_carry_a_block_s_weight_in_implicit_steps() {
    assert_weighs::<f64>(implicit(), 1e-3);
}

/// Whatever the matrix, the preconditioner and the scheme. Undamped schemes swing longer.
#[test]
fn every_implicit_scheme_weighs_the_same() {
    for settings in implicit_ways() {
        let ([left, right], weight, _) = weigh::<f64>(Integrator::Implicit(settings), 0.3, 150);
        let error = (left + right + weight).norm() / weight.norm();
        assert!(error < 5e-3, "{settings:?}: {error}");
    }
}

/// The moments about the tips balance that of gravity, node by node: Σ −m g (z − z_tip) across the rods. In single steps, that is, but for
/// how the block trembles.
#[test]
fn tools_report_the_moment_of_what_they_carry() {
    for integrator in [EXPLICIT, implicit()] {
        let (_, _, world) = weigh::<f64>(integrator, 0.3, 250);
        let torque: f64 = world.instrument_ids().map(|id| world.tool(id).contact_torque.x).sum();
        let body = world.body(world.body_ids().next().unwrap());
        let nodes = body.state().masses.iter().zip(body.positions());
        // The tips are 20 cm behind the block's middle.
        let moment: f64 = nodes.map(|(mass, place)| mass * 9.81 * (0.22 - place.z)).sum();
        assert!((torque / moment - 1.0).abs() < 2e-2, "{integrator:?}: {torque} N m instead of {moment}");
    }
}
