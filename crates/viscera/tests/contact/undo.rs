//! Steps that are refused, several tools and bodies, and tissue that is cut while it is touched.

use viscera::instrument::{Cautery, Grasper, Probe, Shaft, ToolInput, ToolPose};
use viscera::mesh::Region;
use viscera::world::{BodyId, Integrator, Substep, World};

use super::support::*;

fn pose(tip: Vector) -> ToolPose {
    ToolPose { tip, direction: Vector::new(0.0, -1.0, 0.0), roll: 0.0 }
}

fn bits(world: &World<f64>) -> Vec<u64> {
    let bodies = world.body_ids().map(|id| world.body(id));
    bodies
        .flat_map(|body| body.positions().iter().chain(body.velocities()))
        .flat_map(|v| v.to_array().map(f64::to_bits))
        .collect()
}

/// A step that is refused leaves the tools, and what they hold, as they were: the next one goes on as if it had not been tried.
#[test]
fn a_refused_step_takes_the_tools_back() {
    let build = || {
        let integrator = Integrator::Explicit(Substep::Fixed(1e-4));
        let mut world = world::<f64>([0.0; 3], 5e-3, integrator);
        let body = block([4, 2, 2], [0.08, 0.04, 0.04], Vector::ZERO, 10e3);
        world.add(body.fix(Region::Named("x-min".into()))).unwrap();
        let tool = world.add_instrument(Grasper { radius: 0.025, ..Grasper::default() }).unwrap();
        (world, tool)
    };
    let near = ToolInput::new(pose(Vector::new(0.08, 0.02, 0.02)), 1.0);
    let far = ToolInput::new(pose(Vector::new(5e4, 0.02, 0.02)), 1.0);
    let ((mut tried, tool), (mut plain, _)) = (build(), build());
    for world in [&mut tried, &mut plain] {
        world.set_tool(tool, near).unwrap();
        world.step().unwrap();
    }
    tried.set_tool(tool, far).unwrap();
    let before = (bits(&tried), *tried.tool(tool));
    tried.step().unwrap_err();
    assert_eq!((bits(&tried), *tried.tool(tool)), before);
    tried.set_tool(tool, near).unwrap();
    for world in [&mut tried, &mut plain] {
        world.step().unwrap();
    }
    assert_eq!(bits(&tried), bits(&plain));
}

/// Three tools on two bodies at once: each tool reports what it does, and what they give is what the bodies get.
#[test]
fn several_tools_touch_several_bodies() {
    for integrator in [EXPLICIT, implicit()] {
        let mut world = world::<f64>([0.0; 3], 5e-3, integrator);
        let bodies: [BodyId; 2] = [0.0, 0.07]
            .map(|x| world.add(block([3, 2, 3], [0.06, 0.04, 0.06], Vector::new(x, 0.0, 0.0), 20e3)).unwrap());
        // Two probes on one body each, and one that lies across both.
        let shaft = Shaft { radius: 4e-3, length: 0.3 };
        let tools: [_; 2] = [0; 2].map(|_| world.add_instrument(Probe { shaft, ..Probe::default() }).unwrap());
        let across =
            world.add_instrument(rod(Vector::new(0.06, 0.1, 0.031), Vector::new(1.0, 0.0, 0.0), 4e-3, 0.1)).unwrap();
        let (mut given, mut touched) = (Vector::ZERO, [false; 3]);
        for step in 0..12 {
            let height = 0.05 - 3e-3 * f64::from(step);
            for (tool, x) in tools.into_iter().zip([0.021, 0.108]) {
                let pose = pose(Vector::new(x, height, 0.0131));
                world.set_tool(tool, ToolInput::new(pose, 0.0)).unwrap();
            }
            let pose =
                ToolPose { tip: Vector::new(0.26, height, 0.044), direction: Vector::new(1.0, 0.0, 0.0), roll: 0.0 };
            world.set_tool(across, ToolInput::new(pose, 0.0)).unwrap();
            world.step().unwrap();
            for id in world.instrument_ids() {
                touched[id.0] |= world.tool(id).contact_force != Vector::ZERO;
            }
            given = world.instrument_ids().fold(given, |sum, id| sum + world.tool(id).contact_force * 5e-3);
        }
        assert_eq!(touched, [true; 3], "{integrator:?}");
        for id in bodies {
            assert!(world.observe(id).momentum.y < 0.0, "{id:?} is pushed down");
        }
        // Linearised steps that go astray are solved to 1e-3 instead.
        assert_vector(momentum(&world), given, if integrator == EXPLICIT { 1e-11 } else { 1e-3 });
    }
}

/// A hook cuts its way through a bar while a probe rests on what is cut: the surface that is touched is the one that is left.
#[test]
fn tissue_is_touched_where_a_cut_has_left_it() {
    for integrator in [EXPLICIT, implicit()] {
        let mut world = world::<f64>([0.0; 3], 5e-3, integrator);
        let body = block([8, 4, 4], [0.08, 0.04, 0.04], Vector::ZERO, 20e3).damping(10.0);
        let id = world.add(body.fix(Region::Named("y-min".into()))).unwrap();
        let shaft = Some(Shaft { radius: 1e-3, length: 0.2 });
        let hook = world.add_instrument(Cautery { radius: 6e-3, shaft, ..Cautery::default() }).unwrap();
        for step in 0..40 {
            // Down into the bar: its rod would be stopped where its heat did not clear the way.
            let tip = Vector::new(0.041, 0.045 - 6e-4 * f64::from(step), 0.021);
            world.set_tool(hook, ToolInput::new(pose(tip), 1.0)).unwrap();
            world.step().unwrap();
        }
        assert!(world.body(id).state().removed_count > 10);
        // The floor of the pit is a hot tip's reach below it: free of force.
        assert!(world.tool(hook).contact_force.norm() < 1e-9, "{:?}", world.tool(hook));
        // Without current it meets the floor.
        for step in 0..25 {
            let tip = Vector::new(0.041, 0.0216 - 6e-4 * f64::from(step), 0.021);
            world.set_tool(hook, ToolInput::new(pose(tip), 0.0)).unwrap();
            world.step().unwrap();
        }
        assert!(world.tool(hook).contact_force.y < 0.0, "{integrator:?}: {:?}", world.tool(hook));
    }
}

/// No more contacts are known at a time than the surface had triangles before it was cut. Were it those that it has, or those that there happens to be
/// room for, a world would go on otherwise from a snapshot: four rods through a block of 48 tetrahedra touch more than all.
#[test]
fn contacts_beyond_all_that_are_known_are_the_same_after_a_snapshot() {
    let directions = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.6, 0.8]].map(Vector::from);
    let mut world = world::<f64>([0.0; 3], 5e-3, implicit());
    let body = block([2; 3], [0.04; 3], Vector::ZERO, 20e3).fix(Region::Named("x-min".into()));
    let id = world.add(body).unwrap();
    for direction in directions {
        world.add_instrument(rod(Vector::new(0.02, 0.055, 0.02), direction, 0.02, 0.1)).unwrap();
    }
    world.remove_cells(id, &[3, 17, 29, 40, 11, 23, 5]).unwrap();
    world.step().unwrap();
    let snapshot = world.snapshot();
    let go_on = |world: &mut World<f64>| {
        for _ in 0..3 {
            world.step().unwrap();
        }
        bits(world)
    };
    let end = go_on(&mut world);
    world.restore(&snapshot).unwrap();
    assert_eq!(go_on(&mut world), end);
}
