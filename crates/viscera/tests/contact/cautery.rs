//! Heat that cuts, and what it leaves on the rim.

use viscera::curve::Curve;
use viscera::instrument::Cautery;
use viscera::world::World;

use super::support::*;

/// A bar at rest, and a tip that goes through it along x in `duration` [s].
fn pass(duration: f64, power: f64) -> World<f64> {
    let mut world = world::<f64>([0.0; 3], 5e-3, EXPLICIT);
    world.add(block([8, 4, 4], [0.08, 0.04, 0.04], Vector::ZERO, 10e3)).unwrap();
    let (from, to) = (Vector::new(-0.01, 0.021, 0.019), Vector::new(0.09, 0.021, 0.019));
    let path = Curve::piecewise_linear(vec![(0.0, from), (duration, to)]).unwrap();
    let cautery = Cautery { path, radius: 4e-3, on: (0.0, duration), power, heat: 1e7, ..Cautery::default() };
    world.add_instrument(cautery).unwrap();
    while world.time() < duration {
        world.step().unwrap();
    }
    world
}

/// What a slow pass burns through, a quick brush past only warms: not one cell goes, and what it touched is seared in part.
#[test]
fn a_brush_past_warms_and_a_slow_pass_cuts() {
    let (brush, slow) = (pass(0.05, 160.0), pass(2.0, 160.0));
    let id = brush.body_ids().next().unwrap();
    assert_eq!(brush.body(id).state().removed_count, 0);
    assert!(brush.body(id).seared().iter().any(|&seared| seared > 0.0 && seared < 1.0));
    assert!(slow.body(id).state().removed_count > 20);
}

/// Energy in = power × time under way in the tissue; what is removed took its heat, and the rest is on the way.
#[test]
fn no_energy_is_lost() {
    let world = pass(1.0, 40.0);
    let body = world.body(world.body_ids().next().unwrap());
    let taken: f64 = body.state().heat.iter().sum();
    // The tip, 4 mm around, is in touch for 88 of its 100 mm. Cells that are done take no more than they need.
    assert!(taken < 40.0 * 0.9 && taken > 40.0 * 0.75, "{taken} J");
}

/// The nodes of burnt cells are seared through, and all others that are seared were touched: within reach of the way.
#[test]
fn the_rim_of_a_burnt_cut_is_seared() {
    let world = pass(1.0, f64::INFINITY);
    let body = world.body(world.body_ids().next().unwrap());
    let mut burnt = vec![false; body.mesh().nodes().len()];
    for (cell, _) in body.state().removed.iter().enumerate().filter(|(_, removed)| **removed) {
        body.mesh().cell(cell).iter().for_each(|&node| burnt[node as usize] = true);
    }
    assert!(burnt.iter().any(|&burnt| burnt));
    for (node, &seared) in body.seared().iter().enumerate() {
        assert_eq!(seared, f64::from(u8::from(burnt[node])), "node {node}");
    }
    for triangle in body.surface().iter().filter(|triangle| triangle.cut) {
        assert!(triangle.nodes.iter().all(|&node| body.seared()[node as usize] == 1.0));
    }
}
