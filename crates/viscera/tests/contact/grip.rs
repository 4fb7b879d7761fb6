//! Jaws that hold up to a bound.

use viscera::curve::Curve;
use viscera::instrument::{Grasper, Jaws, Mount};
use viscera::world::{InstrumentId, Integrator, World};

use super::support::*;

/// A block that hangs from jaws at its upper side.
fn hang(integrator: Integrator, grip: f64) -> (World<f64>, InstrumentId, Vector) {
    let mut world = world::<f64>(GRAVITY, 8e-3, integrator);
    let body = block([2, 4, 2], [0.02, 0.04, 0.02], Vector::new(-0.01, -0.04, -0.01), 30e3).damping(20.0);
    let id = world.add(body).unwrap();
    let grasper = Grasper { path: still(Vector::ZERO), radius: 0.012, close: 0.0, grip, ..Grasper::default() };
    let tool = world.add_instrument(grasper).unwrap();
    let weight = Vector::from(GRAVITY) * world.observe(id).mass;
    (world, tool, weight)
}

fn run(world: &mut World<f64>, steps: usize) {
    for _ in 0..steps {
        world.step().unwrap();
    }
}

#[test]
fn jaws_report_the_weight_that_hangs_from_them() {
    for integrator in [EXPLICIT, implicit()] {
        for grip in [f64::INFINITY, 2.0] {
            let (mut world, tool, weight) = hang(integrator, grip);
            run(&mut world, 200);
            assert_vector(world.tool(tool).holding_force, -weight, 1e-5);
        }
    }
}

/// Jaws too weak for the weight lose it: it falls, held back by no more than the grip.
#[test]
fn a_grip_that_is_too_weak_slips_at_its_bound() {
    for integrator in [EXPLICIT, implicit()] {
        let (_, _, weight) = hang(integrator, 1.0);
        let grip = 0.5 * weight.norm();
        let (mut world, tool, _) = hang(integrator, grip);
        run(&mut world, 25);
        let id = world.body_ids().next().unwrap();
        let force = world.tool(tool).holding_force;
        assert!(force.norm() <= grip * (1.0 + 1e-9), "{integrator:?}: {force:?}");
        assert!(force.y > 0.6 * grip, "{integrator:?}: {force:?}");
        // At least half the weight is left to fall with, against damping of 20/s: v = a (1 − e^(−20 t))/20.
        let speed = -world.observe(id).momentum.y / world.observe(id).mass;
        let fall = 9.81 * (1.0 - (-20.0 * world.time()).exp()) / 20.0;
        assert!(speed > 0.45 * fall && speed < 0.8 * fall, "{integrator:?}: {speed} m/s, {fall} m/s by itself");
    }
}

/// Jaws that turn about their own axis turn what they hold.
#[test]
fn what_is_held_turns_with_the_jaws() {
    for integrator in [EXPLICIT, implicit()] {
        let mut world = world::<f64>([0.0; 3], 8e-3, integrator);
        let id = world
            .add(block([2, 4, 2], [0.02, 0.04, 0.02], Vector::new(-0.01, -0.04, -0.01), 30e3).damping(20.0))
            .unwrap();
        let tilt = |t: f64| Vector::new(t.sin(), -t.cos(), 0.0);
        let direction =
            Curve::piecewise_linear((0..=50).map(|i| (0.02 * f64::from(i), tilt(0.02 * f64::from(i)))).collect());
        let mount = Mount { direction: direction.unwrap(), ..Mount::default() };
        let path = still(Vector::ZERO);
        world.add_instrument(Grasper { path, mount, radius: 0.012, close: 0.0, ..Grasper::default() }).unwrap();
        run(&mut world, 200);
        // The block, which hung down along −y, hangs along the turned direction.
        let lowest = Vector::new(0.0, -0.04, 0.0);
        let nodes = world.body(id).mesh().nodes();
        let node = (0..nodes.len()).find(|&node| (nodes[node] - lowest).norm() < 1e-9).unwrap();
        assert_vector(world.body(id).positions()[node], tilt(1.0) * 0.04, 0.02);
    }
}

/// Open jaws push tissue aside; where they close they hold it, and it is lifted.
#[test]
fn jaws_that_close_on_tissue_lift_it() {
    for integrator in [EXPLICIT, implicit()] {
        let mut world = world::<f64>([0.0; 3], 8e-3, integrator);
        let body = block([8, 1, 2], [0.08, 0.006, 0.02], Vector::new(-0.04, -0.006, -0.01), 30e3).damping(20.0);
        let fixed = viscera::mesh::Region::Named("x-min".into());
        let id = world.add(body.fix(fixed)).unwrap();
        let at = |y: f64| Vector::new(0.03, y, 0.0);
        let path = vec![(0.0, at(0.03)), (0.2, at(-0.002)), (0.4, at(-0.002)), (0.8, at(0.03))];
        let path = Curve::piecewise_linear(path).unwrap();
        let jaws = Some(Jaws { length: 0.015, radius: 1e-3, opening: 1.2 });
        let grasper = Grasper { path, jaws, radius: 6e-3, close: 0.3, ..Grasper::default() };
        let tool = world.add_instrument(grasper).unwrap();
        run(&mut world, 110);
        assert!(world.tool(tool).held_nodes > 0);
        let highest = world.body(id).positions().iter().map(|place| place.y).fold(f64::MIN, f64::max);
        assert!(highest > 0.02, "{integrator:?}: {highest}");
        let force = world.tool(tool).holding_force;
        assert!(force.y > 0.0, "{integrator:?}: {force:?}");
    }
}
