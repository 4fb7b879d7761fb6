//! Tools that a hand leads, and tools that come and go.

use viscera::body::{Body, NodeMotion};
use viscera::curve::Curve;
use viscera::instrument::{Cautery, Grasper, InstrumentKind, Jaws, Mount, Probe, ToolInput, ToolPose};
use viscera::material::{StVenantKirchhoff, Tissue};
use viscera::mesh::{HexMesh, Region};
use viscera::model::TotalLagrangian;
use viscera::world::{InstrumentId, World, WorldError};

use super::support::*;

fn input(tip: Vector, trigger: f64) -> ToolInput {
    ToolInput::new(ToolPose { tip, direction: Vector::new(0.0, -1.0, 0.0), roll: 0.0 }, trigger)
}

fn bar() -> (World<f64>, viscera::world::BodyId) {
    let mut world = world::<f64>([0.0; 3], 5e-3, EXPLICIT);
    let body = block([8, 2, 2], [0.16, 0.04, 0.04], Vector::ZERO, 10e3).damping(5.0);
    let id = world.add(body.fix(Region::Named("x-min".into()))).unwrap();
    (world, id)
}

/// A tool is at the end of a step where the hand asked for it, and goes back to its path when it is let go.
#[test]
fn a_tool_goes_where_the_hand_leads_it() {
    let mut world = world::<f64>([0.0; 3], 5e-3, EXPLICIT);
    let path = Curve::piecewise_linear(vec![(0.0, Vector::ZERO), (1.0, Vector::new(0.0, 1.0, 0.0))]).unwrap();
    let mount = Mount::through(Vector::new(0.0, 0.4, 0.0));
    let id = world.add_instrument(Probe { path: path.clone(), mount, ..Probe::default() }).unwrap();
    let tip = Vector::new(0.3, 0.1, 0.0);
    world.set_tool(id, input(tip, 0.0)).unwrap();
    world.step().unwrap();
    let pose = world.tool(id).pose;
    assert_eq!(pose.tip, tip);
    assert_vector(pose.direction, Vector::new(0.3, -0.3, 0.0) / 0.18f64.sqrt(), 1e-15);
    world.release_tool(id).unwrap();
    world.step().unwrap();
    assert_eq!(world.tool(id).pose.tip, path.at(world.time()));
}

/// With a speed it takes as many steps as it needs, on a straight line, turns as it goes, and is there at last.
#[test]
fn a_tool_goes_no_faster_than_its_hand_lets_it() {
    let mut world = world::<f64>([0.0; 3], 5e-3, EXPLICIT);
    let id = world.add_instrument(Probe::default()).unwrap();
    world.step().unwrap();
    let (tip, start) = (Vector::new(0.3, 0.4, 0.0), world.tool(id).pose.tip);
    let pose = ToolPose { direction: Vector::new(1.0, 0.0, 0.0), ..input(tip, 0.0).pose };
    world.set_tool(id, ToolInput { speed: 4.0, ..ToolInput::new(pose, 1.0) }).unwrap();
    for step in 1..=24 {
        world.step().unwrap();
        let expected = start + (tip - start) * (f64::from(step) * 0.02 / 0.5);
        assert_vector(world.tool(id).pose.tip, expected, 1e-14);
    }
    assert!(world.tool(id).pose.direction.x > 0.9);
    // A rounding may be left for one more step.
    world.step().unwrap();
    world.step().unwrap();
    assert_eq!(world.tool(id).pose, pose);
}

/// A hand that came and pulled the trigger before the simulation made its next step: the jaws hold what is where they were led, and not
/// what they passed. Opened on the way they let go at once.
#[test]
fn jaws_close_where_the_hand_has_them() {
    let (mut world, body) = bar();
    let id = world.add_instrument(Grasper { radius: 0.012, ..Grasper::default() }).unwrap();
    let (above_the_middle, end) = (Vector::new(0.08, 0.045, 0.02), Vector::new(0.16, 0.045, 0.02));
    let led = |tip: Vector, trigger: f64| ToolInput { speed: 4.0, ..input(tip, trigger) };
    world.set_tool(id, led(above_the_middle, 0.0)).unwrap();
    world.step().unwrap();
    world.set_tool(id, led(end, 1.0)).unwrap();
    let mut steps = 0;
    while world.tool(id).held_nodes == 0 {
        world.step().unwrap();
        steps += 1;
        assert!(steps < 8, "never closed");
    }
    assert_eq!(steps, 5, "80 mm at 20 mm a step, and then the pull");
    let held = |node: usize| matches!(world.body(body).state().motions[node], NodeMotion::Held(_));
    let nodes = world.body(body).mesh().nodes();
    assert!((0..nodes.len()).filter(|&node| held(node)).all(|node| nodes[node].x > 0.15));
    world.set_tool(id, led(above_the_middle, 0.0)).unwrap();
    world.step().unwrap();
    assert_eq!(world.tool(id).held_nodes, 0);
}

/// Also where the rest of the way is shorter than the jaws reach, and where the hand is elsewhere by then: jaws that closed before they came
/// held nothing.
#[test]
fn jaws_close_where_they_came_to_from_nearby() {
    let (mut world, body) = bar();
    let id = world.add_instrument(Grasper { jaws: Some(Jaws::default()), radius: 0.03, ..Grasper::default() }).unwrap();
    let led = |height: f64, trigger: f64| ToolInput { speed: 4.0, ..input(Vector::new(0.16, height, 0.02), trigger) };
    world.set_tool(id, led(0.05, 0.0)).unwrap();
    world.step().unwrap();
    world.set_tool(id, led(0.033, 1.0)).unwrap();
    world.step().unwrap();
    assert_eq!(world.tool(id).held_nodes, 0, "on its way");
    world.set_tool(id, led(0.045, 1.0)).unwrap();
    world.step().unwrap();
    assert!(world.tool(id).held_nodes > 0);
    let held = |node: usize| matches!(world.body(body).state().motions[node], NodeMotion::Held(_));
    let before: Vec<f64> = world.body(body).positions().iter().map(|x| x.y).collect();
    let highest = (0..before.len()).filter(|&node| held(node)).map(|node| before[node]).fold(0.0, f64::max);
    assert!(highest > 0.045, "carried along: {highest} m");
}

/// The trigger closes the jaws at one half, and opens them below.
#[test]
fn the_trigger_closes_and_opens_the_jaws() {
    let (mut world, _) = bar();
    let id = world.add_instrument(Grasper { radius: 0.025, ..Grasper::default() }).unwrap();
    let tip = Vector::new(0.16, 0.02, 0.02);
    for (trigger, holds) in [(0.0, false), (0.49, false), (0.5, true), (1.0, true), (0.4, false)] {
        world.set_tool(id, input(tip, trigger)).unwrap();
        world.step().unwrap();
        assert_eq!(world.tool(id).held_nodes > 0, holds, "at {trigger}");
        assert_eq!(world.observe_instrument(id).active, holds);
    }
}

/// Half the trigger is half the power.
#[test]
fn the_trigger_doses_the_current() {
    let heat = |trigger: f64| {
        let (mut world, body) = bar();
        let cautery = Cautery { radius: 0.01, power: 10.0, heat: 1e9, ..Cautery::default() };
        let id = world.add_instrument(cautery).unwrap();
        let tip = Vector::new(0.08, 0.02, 0.02);
        world.set_tool(id, input(tip, 0.0)).unwrap();
        world.step().unwrap();
        world.set_tool(id, input(tip, trigger)).unwrap();
        for _ in 0..10 {
            world.step().unwrap();
        }
        world.body(body).state().heat.iter().sum::<f64>()
    };
    assert!((heat(1.0) / 0.5 - 1.0).abs() < 1e-12, "{}", heat(1.0));
    assert!((heat(0.5) / 0.25 - 1.0).abs() < 1e-12);
    assert_eq!(heat(0.0), 0.0);
}

/// Taken out, a tool lets go and is no longer there; others keep their numbers.
#[test]
fn tools_come_and_go() {
    let (mut world, _) = bar();
    let tip = Vector::new(0.16, 0.02, 0.02);
    let grasper = || Grasper { path: still(tip), radius: 0.025, close: 0.0, ..Grasper::default() };
    let (first, second) = (world.add_instrument(grasper()).unwrap(), world.add_instrument(Probe::default()).unwrap());
    world.step().unwrap();
    assert!(world.tool(first).held_nodes > 0);
    world.remove_instrument(first).unwrap();
    world.step().unwrap();
    assert_eq!(world.instrument_ids().collect::<Vec<_>>(), [second]);
    assert_eq!(world.set_tool(first, input(tip, 0.0)), Err(WorldError::MissingInstrument { instrument: 0 }));
    let third = world.add_instrument(InstrumentKind::Cautery.example(1.0)).unwrap();
    assert_eq!(third, InstrumentId(2));
    world.replace_instrument(second, grasper()).unwrap();
    world.step().unwrap();
    assert_eq!(world.instrument(second).kind(), "grasper");
    assert!(world.tool(second).held_nodes > 0);
    world.replace_instrument(second, Probe::default()).unwrap();
    world.step().unwrap();
    assert_eq!(world.tool(second).held_nodes, 0);
}

/// What burns cells away is refused where no body can lose any, and taken where one can, or none is there yet.
#[test]
fn a_cautery_needs_something_to_burn() {
    let mut world = world::<f64>([0.0; 3], 5e-3, EXPLICIT);
    world.add_instrument(Cautery::default()).unwrap();
    let hexahedra = Body::new(HexMesh::box_grid([2, 2, 2], [0.1, 0.1, 0.1]), 1000.0);
    let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(10e3, 0.3).unwrap());
    world.add(hexahedra.model(TotalLagrangian::new(tissue))).unwrap();
    let refused = world.add_instrument(Cautery::default());
    assert!(matches!(refused, Err(WorldError::NothingToCut { kind: "cautery", .. })), "{refused:?}");
    let refused = world.replace_instrument(InstrumentId(0), Cautery::default());
    assert!(refused.unwrap_err().to_string().contains("make a body of tetrahedra"));
    world.add(block([2, 2, 2], [0.04, 0.04, 0.04], Vector::ZERO, 10e3)).unwrap();
    world.add_instrument(Cautery::default()).unwrap();
}

#[test]
fn poses_that_are_none_are_refused() {
    let (mut world, _) = bar();
    let id = world.add_instrument(Probe::default()).unwrap();
    let good = input(Vector::ZERO, 0.0);
    let bad = [
        ToolInput { trigger: f64::NAN, ..good },
        ToolInput { speed: 0.0, ..good },
        ToolInput { speed: f64::NAN, ..good },
        input(Vector::new(f64::INFINITY, 0.0, 0.0), 0.0),
        ToolInput { pose: ToolPose { direction: Vector::ZERO, ..good.pose }, ..good },
        ToolInput { pose: ToolPose { roll: f64::NAN, ..good.pose }, ..good },
    ];
    for input in bad {
        assert!(matches!(world.set_tool(id, input), Err(WorldError::Instrument(_))), "{input:?}");
    }
    assert_eq!(world.tool(id).hand, None);
}

/// A tool that was just added is put where the hand first asks for it; it does not come there through the tissue.
#[test]
fn a_new_tool_is_put_into_place() {
    let (mut world, body) = bar();
    let id = world.add_instrument(Probe::default()).unwrap();
    world.set_tool(id, input(Vector::new(0.1, 0.2, 0.05), 0.0)).unwrap();
    world.step().unwrap();
    assert_eq!(world.tool(id).contact_force, Vector::ZERO);
    // What rounding makes of a body at rest.
    assert!(world.observe(body).kinetic_energy < 1e-25);
}
