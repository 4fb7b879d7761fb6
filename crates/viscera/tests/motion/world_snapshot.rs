//! Same input, same bits: from run to run, and from a snapshot on.

use viscera::body::LoosePieces;
use viscera::curve::Curve;
use viscera::instrument::{Cautery, Grasper};
use viscera::model::Precision;
use viscera::world::{World, WorldError};

use crate::support::{Vector, bits, free_bar, in_both_precisions, side, world};

/// Pulled, held, burnt through and bereft of its loose end within 60 steps.
fn operation<T: Precision>() -> World<T> {
    let mut world = world::<T>([0.0, -9.81, 0.0], 5e-3);
    let body = free_bar().fix(side("z-min")).damping(2.0).keep_volume(1e4);
    world.add(body.loose_pieces(LoosePieces::Drop)).unwrap();
    let tip = Vector::new(0.02, 0.02, 0.16);
    let pull = vec![(0.01, tip), (0.1, tip + Vector::new(0.0, 0.01, 0.02))];
    let path = Curve::piecewise_linear(pull).unwrap();
    world.add_instrument(Grasper { path, radius: 0.025, close: 0.01, open: Some(0.12), ..Grasper::default() }).unwrap();
    let across = vec![(0.1, Vector::new(-0.01, -0.02, 0.07)), (0.25, Vector::new(0.05, 0.06, 0.09))];
    let path = Curve::piecewise_linear(across).unwrap();
    world.add_instrument(Cautery { path, radius: 0.02, on: (0.1, 0.25), ..Cautery::default() }).unwrap();
    world
}

fn run<T: Precision>(world: &mut World<T>, steps: usize) {
    for _ in 0..steps {
        world.step().unwrap();
    }
}

/// Two runs of the same operation agree in every bit of every node.
fn two_runs_agree_in_every_bit<T: Precision>(_: ()) {
    let (mut first, mut second) = (operation::<T>(), operation::<T>());
    run(&mut first, 60);
    run(&mut second, 60);
    assert!(first.body(first.body_ids().next().unwrap()).state().removed_count > 50, "it must have cut");
    assert_eq!(bits(&first), bits(&second));
}
in_both_precisions!(two_runs_agree_in_every_bit, f32: (), f64: ());

/// Put back to before the grasp, between grasp and cut, or in the middle of the cut, a world goes on with the same bits
/// as if nothing had happened since, and so does a second world of the same making.
fn a_snapshot_brings_back_every_bit<T: Precision>(_: ()) {
    for moment in [0, 15, 30] {
        let mut world = operation::<T>();
        run(&mut world, moment);
        let snapshot = world.snapshot();
        let then = bits(&world);
        run(&mut world, 60 - moment);
        let end = bits(&world);
        world.restore(&snapshot).unwrap();
        assert_eq!(bits(&world), then, "restored at step {moment}");
        run(&mut world, 60 - moment);
        assert_eq!(bits(&world), end, "gone on from step {moment}");

        let mut other = operation::<T>();
        run(&mut other, 40);
        other.restore(&snapshot).unwrap();
        run(&mut other, 60 - moment);
        assert_eq!(bits(&other), end, "in another world from step {moment}");
    }
}
in_both_precisions!(a_snapshot_brings_back_every_bit, f32: (), f64: ());

/// A snapshot of another world is refused, and changes nothing.
#[test]
fn a_foreign_snapshot_is_refused() {
    let (mut world, mut empty) = (operation::<f64>(), world::<f64>([0.0; 3], 5e-3));
    let before = bits(&world);
    assert_eq!(world.restore(&empty.snapshot()).unwrap_err(), WorldError::ForeignSnapshot);
    assert_eq!(empty.restore(&world.snapshot()).unwrap_err(), WorldError::ForeignSnapshot);
    assert_eq!(bits(&world), before);
}
