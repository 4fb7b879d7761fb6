//! Shafts that pass through a point, and points that move.

use viscera::instrument::{Mount, Probe, Shaft, ToolInput, ToolPose};
use viscera::world::{InstrumentId, World, WorldError};

use super::support::*;

const STEP: f64 = 5e-3;
const DOWN: Vector = Vector::new(0.0, -1.0, 0.0);

fn lead(world: &mut World<f64>, id: InstrumentId, tip: Vector) {
    world.set_tool(id, ToolInput::new(ToolPose { tip, direction: DOWN, roll: 0.0 }, 0.0)).unwrap();
}

/// Beside a free block, a rod that stands upright through a point above it.
fn beside_a_block() -> (World<f64>, InstrumentId) {
    let mut world = world::<f64>([0.0; 3], STEP, EXPLICIT);
    world.add(block([4, 4, 4], [0.04; 3], Vector::new(0.01, 0.02, -0.02), 10e3)).unwrap();
    let mount = Mount::through(Vector::new(0.0, 0.2, 0.0));
    let shaft = Shaft { radius: 5e-3, length: 0.3 };
    let id = world.add_instrument(Probe { path: still(Vector::ZERO), mount, shaft, friction: 0.0 }).unwrap();
    (world, id)
}

/// Given, moved and taken away: the tip stays with the hand, the shaft follows the point, and keeps its direction without one.
#[test]
fn a_shaft_follows_its_trocar() {
    let mut world = world::<f64>([0.0; 3], STEP, EXPLICIT);
    let id = world.add_instrument(Probe::default()).unwrap();
    let tip = Vector::new(0.3, 0.0, 0.0);
    lead(&mut world, id, tip);
    world.step().unwrap();
    for trocar in [Vector::new(0.0, 0.4, 0.0), Vector::new(0.3, 0.1, 0.2)] {
        world.set_trocar(id, Some(trocar)).unwrap();
        world.step().unwrap();
        let tool = world.tool(id);
        assert_eq!((tool.pose.tip, tool.trocar), (tip, Some(trocar)));
        assert_vector(tool.pose.direction, (tip - trocar).normalized().unwrap(), 1e-15);
    }
    let (before, kept) = (world.tool(id).pose, world.snapshot());
    world.set_trocar(id, None).unwrap();
    world.step().unwrap();
    assert_vector(world.tool(id).pose.direction, before.direction, 1e-15);
    lead(&mut world, id, tip);
    world.step().unwrap();
    assert_eq!(world.tool(id).pose.direction, DOWN, "the hand leads it freely");
    world.restore(&kept).unwrap();
    assert_eq!(world.tool(id).trocar, Some(Vector::new(0.3, 0.1, 0.2)));
}

/// A rod that a moved trocar turns into a block pushes it along, as one that is led there: what the block gains in momentum is what
/// the tool gave it, by Newton's third law. One whose rod was put behind the surface at once would be felt a step late.
#[test]
fn a_shaft_that_its_trocar_turns_pushes_tissue() {
    let (mut world, id) = beside_a_block();
    world.step().unwrap();
    assert_eq!(world.tool(id).contacts, 0, "it stands 5 mm off");
    // At the middle of the block the rod comes 12 mm nearer.
    world.set_trocar(id, Some(Vector::new(0.06, 0.2, 0.0))).unwrap();
    world.step().unwrap();
    let (gained, tool) = (momentum(&world), *world.tool(id));
    assert!(tool.contacts > 0 && gained.x > 0.0, "{gained:?}");
    assert_vector(tool.contact_force * STEP, gained, 1e-9);
}

#[test]
fn a_trocar_that_is_nowhere_is_refused() {
    let (mut world, id) = beside_a_block();
    let refused = world.set_trocar(id, Some(Vector::new(f64::NAN, 0.0, 0.0))).unwrap_err();
    assert!(refused.to_string().contains("trocar"), "{refused}");
    assert_eq!(world.tool(id).trocar, Some(Vector::new(0.0, 0.2, 0.0)), "nothing has changed");
    world.remove_instrument(id).unwrap();
    assert!(matches!(world.set_trocar(id, None), Err(WorldError::MissingInstrument { instrument: 0 })));
}
