//! Jaws that hold up to a bound.

use viscera::body::NodeMotion;
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

/// Jaws finer than the cells hold the cells that they close on; what lies beside them, as near to the tip, they leave.
#[test]
fn jaws_hold_what_is_between_them() {
    let held = |radius: f64, opening: f64, roll: f64, tip: Vector| {
        let mut world = world::<f64>([0.0; 3], 8e-3, EXPLICIT);
        // A sheet of 4 mm, its cells 10 mm wide, with thin jaws from above.
        let id = world.add(block([12, 1, 12], [0.12, 0.004, 0.12], Vector::new(-0.06, 0.0, -0.06), 30e3)).unwrap();
        let jaws = Some(Jaws { length: 0.02, radius, opening });
        let mount = Mount { roll, ..Mount::along(Vector::new(0.0, -1.0, 0.0)) };
        let tool =
            world.add_instrument(Grasper { path: still(tip), mount, jaws, close: 0.0, ..Grasper::default() }).unwrap();
        world.step().unwrap();
        let (body, number) = (world.body(id), tool.0 as u32);
        let motions = body.state().motions.iter().zip(body.mesh().nodes());
        let nodes: Vec<Vector> = motions.filter(|(m, _)| **m == NodeMotion::Held(number)).map(|(_, x)| *x).collect();
        assert_eq!(nodes.len(), world.tool(tool).held_nodes as usize);
        nodes
    };
    let extent =
        |nodes: &[Vector], of: fn(&Vector) -> f64| nodes.iter().map(of).fold(0.0, |most: f64, x| most.max(x.abs()));
    // The middle of a cell, which has no node in reach of the jaws.
    let tip = Vector::new(0.005, 0.002, 0.005);
    let narrow = held(0.5e-3, 0.05, 0.0, tip);
    assert!((4..=8).contains(&narrow.len()), "the corners of one square: {narrow:?}");
    let (along_x, along_z) = (held(1.5e-3, 1.6, 0.0, tip), held(1.5e-3, 1.6, 0.5 * std::f64::consts::PI, tip));
    let wide = [&along_x, &along_z].map(|nodes| [extent(nodes, |x| x.x - 0.005), extent(nodes, |x| x.z - 0.005)]);
    // Jaws of 20 mm that open by 92 degrees reach over 16 mm of the sheet to either side, and across no farther than a cell.
    for [x, z] in wide {
        assert!(x.max(z) > 0.012 && x.max(z) < 0.026 && x.min(z) < 0.011, "{wide:?}");
    }
    assert!(held(1.5e-3, 1.6, 0.0, tip + Vector::new(0.0, 0.03, 0.0)).is_empty(), "too high above the sheet");
}
