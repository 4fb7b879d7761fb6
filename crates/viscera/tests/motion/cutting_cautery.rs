//! A cautery removes what its tip touches, all along its way.

use viscera::curve::Curve;
use viscera::instrument::{Cautery, Path};
use viscera::model::Precision;
use viscera::world::World;

use crate::support::{Vector, free_bar, in_both_precisions, side, world};

const RADIUS: f64 = 7e-3; // m

/// The removed cells after a straight way of the tip through the bar, at rest, within `steps` steps of 10 ms.
fn removed_on_a_way<T: Precision>(from: Vector, to: Vector, steps: u32, on: (f64, f64)) -> Vec<bool> {
    let duration = 0.01 * f64::from(steps);
    let mut world = world::<T>([0.0; 3], 0.01);
    let id = world.add(free_bar().fix(side("z-min"))).unwrap();
    let path = Curve::piecewise_linear(vec![(0.0, from), (duration, to)]).unwrap();
    world.add_instrument(Cautery { path, radius: RADIUS, on, ..Cautery::default() }).unwrap();
    let reported: usize = (0..steps).map(|_| world.step().unwrap().removed_cells).sum();
    let removed = world.body(id).state().removed.clone();
    assert_eq!(reported, removed.iter().filter(|&&removed| removed).count());
    removed
}

/// Samples of the way, each tested against each cell: the brute way to say which cells a ball on it touches.
fn touched(world: &World<f64>, from: Vector, to: Vector) -> Vec<bool> {
    let mesh = world.body(world.body_ids().next().unwrap()).mesh();
    let sample = |i: u32| from + (to - from) * (f64::from(i) / 400.0);
    let inside = |cell: usize, place: Vector| {
        let corners: [Vector; 4] = std::array::from_fn(|c| mesh.nodes()[mesh.cell(cell)[c] as usize]);
        distance_to_tetrahedron(&corners, place) <= RADIUS
    };
    (0..mesh.cell_count()).map(|cell| (0..=400).any(|i| inside(cell, sample(i)))).collect()
}

/// Distance by projecting onto the tetrahedron in barycentric coordinates, by bisected descent: slow and independent.
fn distance_to_tetrahedron(corners: &[Vector; 4], place: Vector) -> f64 {
    // Frank and Wolfe's method with exact line search, 200 rounds: linear convergence is enough for a millionth.
    let mut nearest = corners[0];
    for _ in 0..200 {
        let best = corners.iter().min_by(|a, b| (nearest - place).dot(**a).total_cmp(&(nearest - place).dot(**b)));
        let direction = *best.unwrap() - nearest;
        let length = direction.squared_norm();
        if length == 0.0 {
            break;
        }
        nearest += direction * ((place - nearest).dot(direction) / length).clamp(0.0, 1.0);
    }
    (nearest - place).norm()
}

/// However fast the tip is, it jumps over no cell: one step through the whole bar removes what forty steps remove, and
/// that is what the tip touches.
fn a_fast_tip_removes_what_a_slow_one_does<T: Precision>(_: ()) {
    let (from, to) = (Vector::new(-0.02, 0.013, 0.071), Vector::new(0.06, 0.027, 0.106));
    let always = (f64::NEG_INFINITY, f64::INFINITY);
    let at_once = removed_on_a_way::<T>(from, to, 1, always);
    let mut world = world::<f64>([0.0; 3], 0.01);
    world.add(free_bar()).unwrap();
    assert_eq!(at_once, touched(&world, from, to));
    assert!(at_once.iter().filter(|&&removed| removed).count() > 20);
}
in_both_precisions!(a_fast_tip_removes_what_a_slow_one_does, f32: (), f64: ());

/// Slowly, the tissue moves between the steps (fibres that were under way spring back), so the exact set may differ; with
/// the body at rest and no load nothing moves, and the sets agree.
#[test]
fn the_way_does_not_depend_on_its_division_into_steps() {
    let (from, to) = (Vector::new(-0.02, 0.013, 0.071), Vector::new(0.06, 0.027, 0.106));
    let always = (f64::NEG_INFINITY, f64::INFINITY);
    assert_eq!(removed_on_a_way::<f64>(from, to, 1, always), removed_on_a_way::<f64>(from, to, 40, always));
}

/// Without current nothing burns, and with it only the part of the way on which it flows.
#[test]
fn only_the_way_under_current_burns() {
    let (from, to) = (Vector::new(0.02, 0.02, 0.16), Vector::new(0.02, 0.02, 0.0));
    let off = removed_on_a_way::<f64>(from, to, 20, (1.0, 2.0));
    assert!(off.iter().all(|removed| !removed));
    // Current during the first half of the time: the way from 16 cm down to 8 cm, whatever the steps.
    let half = removed_on_a_way::<f64>(from, to, 20, (0.0, 0.1));
    let direct = removed_on_a_way::<f64>(from, Vector::new(0.02, 0.02, 0.08), 1, (0.0, 0.01));
    assert_eq!(half, direct);
}

/// A tip that only passes by, farther than its radius, burns nothing.
#[test]
fn a_tip_that_passes_by_burns_nothing() {
    let beside = -1.01 * RADIUS;
    let (from, to): (Vector, Vector) = (Vector::new(beside, 0.02, -0.1), Vector::new(beside, 0.02, 0.3));
    assert!(removed_on_a_way::<f64>(from, to, 5, (0.0, 1.0)).iter().all(|removed| !removed));
    let path: Path = Curve::constant(from);
    assert_eq!(path.at(1.0), from);
}
