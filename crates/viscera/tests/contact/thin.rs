//! Tissue that is thin and tools that are fast do not pass through one another.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::instrument::{Mount, Probe, Shaft};
use viscera::mesh::Region;
use viscera::model::Precision;
use viscera::world::{BodyId, Integrator, World};

use super::support::*;

const RADIUS: f64 = 2.5e-3; // m

/// A sheet of 8×8 cm, 5 mm thick, and a rod of 5 mm that comes down on it end first at `speed` [m/s] for 3 cm, and stays there.
fn strike<T: Precision>(sheet: Body, speed: f64, integrator: Integrator) -> (World<T>, BodyId) {
    let mut world = world::<T>([0.0; 3], 16e-3, integrator);
    let id = world.add(sheet).unwrap();
    let (above, below) = (Vector::new(0.041, 0.02, 0.039), Vector::new(0.041, -0.01, 0.039));
    let way = vec![(0.0, above), (0.03 / speed, below)];
    let path = Curve::piecewise_linear(way).unwrap();
    let shaft = Shaft { radius: RADIUS, length: 0.3 };
    world.add_instrument(Probe { path, shaft, mount: Mount::default(), friction: 0.1 }).unwrap();
    for _ in 0..8 {
        world.step().unwrap();
    }
    (world, id)
}

fn sheet() -> Body {
    block([8, 1, 8], [0.08, 0.005, 0.08], Vector::new(0.0, -0.005, 0.0), 20e3).damping(10.0)
}

/// The sheet is below the tip where that is: no node near the rod is above the tip's lowest point less a hundredth of the radius,
/// and the tip does not lie in the tissue.
fn assert_kept_out<T: Precision>(world: &World<T>, id: BodyId, what: &str) {
    let (body, tool) = (world.body(id), world.tool(world.instrument_ids().next().unwrap()));
    let place = |node: u32| body.positions()[node as usize].cast::<f64>();
    let mut nearest = f64::INFINITY;
    for triangle in body.surface() {
        let [a, b, c] = triangle.nodes.map(place);
        for i in 0..=20 {
            for j in 0..=20 - i {
                let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                let point = a * (1.0 - u - v) + b * u + c * v;
                let from_tip = point - tool.pose.tip;
                let along = from_tip.y.clamp(0.0, 0.3);
                nearest = nearest.min((from_tip - Vector::new(0.0, along, 0.0)).norm());
            }
        }
    }
    assert!(nearest > 0.9 * RADIUS, "{what}: tissue is {nearest} m from the axis");
    let under = body
        .positions()
        .iter()
        .map(|p| p.cast::<f64>())
        .filter(|p| Vector::new(p.x - tool.pose.tip.x, 0.0, p.z - tool.pose.tip.z).norm() < RADIUS);
    let highest = under.map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    assert!(
        highest < tool.pose.tip.y - 0.9 * RADIUS + 1e-3,
        "{what}: tissue at {highest} m, the tip at {} m",
        tool.pose.tip.y
    );
}

fn assert_thin_tissue_stays_out(integrator: Integrator, speed: f64, held: bool) {
    let rim = |name: &str| Region::Named(name.into());
    let body =
        if held { sheet().fix(rim("x-min")).fix(rim("x-max")).fix(rim("z-min")).fix(rim("z-max")) } else { sheet() };
    let (world, id) = strike::<f64>(body, speed, integrator);
    assert_kept_out(&world, id, &format!("{integrator:?} at {speed} m/s, held: {held}"));
}

#[test]
fn a_fast_rod_drags_a_thin_sheet_along_in_explicit_steps() {
    for held in [false, true] {
        assert_thin_tissue_stays_out(EXPLICIT, 5.0, held);
    }
}

#[test]
fn a_fast_rod_drags_a_thin_sheet_along_in_implicit_steps() {
    for held in [false, true] {
        assert_thin_tissue_stays_out(implicit(), 5.0, held);
    }
}

#[test]
fn a_slow_rod_dents_a_thin_sheet_in_both() {
    assert_thin_tissue_stays_out(EXPLICIT, 0.3, true);
    assert_thin_tissue_stays_out(implicit(), 0.3, true);
}

/// Tissue that flies at a rod at 5 m/s is caught as well: the rod is what moves in its eyes.
#[test]
fn a_thin_sheet_that_flies_at_a_rod_is_caught() {
    for integrator in [EXPLICIT, implicit()] {
        let mut world = world::<f64>([0.0; 3], 5e-3, integrator);
        let id = world.add(block([8, 1, 8], [0.08, 0.005, 0.08], Vector::new(0.0, 0.012, 0.0), 200e3)).unwrap();
        let along = Vector::new(0.0, 0.0, 1.0);
        let tool = world.add_instrument(rod(Vector::new(0.041, 0.0, 0.039), along, RADIUS, 0.0)).unwrap();
        world.body_mut(id).set_velocities(|_| Vector::new(0.0, -5.0, 0.0));
        // 25 mm on the way, of which 10 are free.
        world.step().unwrap();
        assert!(world.tool(tool).contact_force.y > 0.0, "{integrator:?}");
        // Above the rod the sheet has not gone on.
        for place in world.body(id).positions().iter().filter(|place| (place.x - 0.041).abs() < RADIUS) {
            assert!(place.y > 0.0, "{integrator:?}: {place:?}");
        }
    }
}
