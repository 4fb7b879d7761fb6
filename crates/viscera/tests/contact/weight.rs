//! What a held tool reports is what lies on it.

use viscera::model::Precision;
use viscera::world::{Integrator, World};

use super::support::*;

/// A damped block of 6×2×4 cm that has come to rest on two rods along z; gives the forces of the rods, and the block's weight.
fn weigh<T: Precision>(integrator: Integrator, friction: f64, steps: usize) -> ([Vector; 2], Vector, World<T>) {
    let mut world = world::<T>(GRAVITY, 8e-3, integrator);
    let id = world.add(block([6, 2, 4], [0.06, 0.02, 0.04], Vector::new(0.0, 0.003, 0.0), 20e3).damping(30.0)).unwrap();
    let along = Vector::new(0.0, 0.0, 1.0);
    let rods =
        [0.013, 0.047].map(|x| world.add_instrument(rod(Vector::new(x, 0.0, 0.02), along, 3e-3, friction)).unwrap());
    for _ in 0..steps {
        world.step().unwrap();
    }
    let weight = Vector::from(GRAVITY) * world.observe(id).mass;
    (rods.map(|rod| world.observe_instrument(rod).force), weight, world)
}

fn assert_weighs<T: Precision>(integrator: Integrator, tolerance: f64) {
    let ([left, right], weight, world) = weigh::<T>(integrator, 0.3, 250);
    assert_vector(left + right, -weight, tolerance);
    // The rods stand 17 mm to either side of the middle: each carries a half, but for how the cells are cut.
    assert!((left.y / right.y - 1.0).abs() < 0.02, "{left:?} {right:?}");
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
    assert_weighs::<f64>(EXPLICIT, 1e-6);
}

#[test]
fn two_rods_carry_a_block_s_weight_in_explicit_steps_of_single_precision() {
    assert_weighs::<f32>(EXPLICIT, 1e-3);
}

#[test]
fn two_rods_carry_a_block_s_weight_in_implicit_steps() {
    assert_weighs::<f64>(implicit(), 1e-6);
}

/// Whatever the matrix, the preconditioner and the scheme. Undamped schemes swing longer.
#[test]
fn every_implicit_scheme_weighs_the_same() {
    for settings in implicit_ways() {
        let ([left, right], weight, _) = weigh::<f64>(Integrator::Implicit(settings), 0.3, 150);
        let error = (left + right + weight).norm() / weight.norm();
        assert!(error < 1e-2, "{settings:?}: {error}");
    }
}

/// The moment about the tip is that of the weight at the block's middle.
#[test]
fn a_tool_reports_the_moment_of_what_it_carries() {
    let (_, weight, world) = weigh::<f64>(EXPLICIT, 0.3, 250);
    let tool = world.tool(world.instrument_ids().next().unwrap());
    // The tip is 20 cm behind the block's middle along the rod.
    let lever = Vector::new(0.0, 0.0, 0.02) - Vector::new(0.0, 0.0, 0.22);
    let moment = lever.cross(tool.contact_force);
    assert!((tool.contact_torque.x - moment.x).abs() < 2e-3 * weight.norm() * 0.2, "{tool:?}, {moment:?}");
}
