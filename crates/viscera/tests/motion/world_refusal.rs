//! No step yields a number that is none: what cannot be done is undone, to the last bit, and explained.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::mesh::{HexMesh, TetMesh};
use viscera::model::{Precision, TensorMass, TotalLagrangian};
use viscera::world::{Integrator, StepError, Substep, World, WorldConfig, WorldError};

use crate::support::{DENSITY, Vector, bits, free_bar, in_both_precisions, linear, side, stvk, world};

/// A pull on a side that grows from nothing to `peak` [N] at 0.1 s.
fn pull(at: &str, peak: f64) -> Load {
    let points = vec![(0.05, Vector::ZERO), (0.1, Vector::new(0.0, 0.0, peak))];
    Load::Force { region: side(at), total: Curve::piecewise_linear(points).unwrap() }
}

/// Only laws whose force grows faster than the displacement: linear tissue bears any load, if by stretching absurdly.
fn bodies() -> [Body; 3] {
    let tetrahedra = || TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]);
    [
        Body::new(tetrahedra(), DENSITY).model(TotalLagrangian::new(stvk(5e3, 0.4))),
        Body::new(tetrahedra(), DENSITY).model(TensorMass::new(stvk(5e3, 0.4))).keep_volume(1e4),
        Body::new(HexMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]), DENSITY)
            .model(TotalLagrangian::new(stvk(5e3, 0.4))),
    ]
}

/// A load that tears every number apart is refused, by a step that leaves the world as it was; steps before it and
/// observations after it see finite numbers only.
fn a_load_far_too_strong_is_refused_and_undone<T: Precision>(peak: f64) {
    for body in bodies() {
        let mut world = world::<T>([0.0; 3], 5e-3);
        let body = body.name("torn bar").fix(side("z-min")).load(pull("z-max", peak));
        let id = world.add(body).unwrap();
        let (error, before) = (0..40)
            .find_map(|_| {
                let before = bits(&world);
                world.step().err().map(|error| (error, before))
            })
            .expect("no step was refused");
        assert!(world.time() > 0.04, "refused too early: {error}");
        assert_eq!(bits(&world), before, "{error}");
        let message = error.to_string();
        assert!(message.contains("torn bar") && message.contains("cell"), "{message}");
        assert!(world.observe(id).max_displacement.is_finite());
        // And once more: a refused step is not remembered.
        assert_eq!(world.step().unwrap_err(), error);
        assert_eq!(bits(&world), before);
    }
}
in_both_precisions!(a_load_far_too_strong_is_refused_and_undone, f32: 1e30, f64: 1e30);

/// Tissue that nothing holds is torn as well, and refused in no time: sub-steps of no length went by in millions.
fn a_body_torn_from_both_sides_is_refused<T: Precision>(peak: f64) {
    for body in bodies() {
        let mut world = world::<T>([0.0; 3], 5e-3);
        world.add(body.name("torn bar").load(pull("z-max", peak)).load(pull("z-min", -peak))).unwrap();
        let error = (0..40).find_map(|_| world.step().err()).expect("no step was refused");
        assert!(error.to_string().contains("torn bar"), "{error}");
    }
}
in_both_precisions!(a_body_torn_from_both_sides_is_refused, f32: 1e30, f64: 1e30);

/// Tissue that stiffens beyond a fixed sub-step is told the one that would do, at the step where it happens.
#[test]
fn a_fixed_sub_step_that_stops_being_stable_is_refused() {
    let config = WorldConfig { gravity: [0.0; 3], step: 2e-3, integrator: Integrator::Explicit(Substep::Fixed(1e-3)) };
    let mut world = World::<f64>::new(config).unwrap();
    let stretch = Curve::piecewise_linear(vec![(0.0, Vector::ZERO), (1.0, Vector::new(0.0, 0.0, 0.64))]).unwrap();
    let body = free_bar().name("bar").fix(side("z-min")).prescribe(side("z-max"), stretch).damping(50.0);
    world.add(body).unwrap();
    let (error, before) = (0..500)
        .find_map(|_| {
            let before = bits(&world);
            world.step().err().map(|error| (error, before))
        })
        .expect("the bar stiffens fivefold");
    let StepError::UnstableSubstep { time, body, substep, stable } = &error else { panic!("{error}") };
    assert_eq!((*time, body.as_str(), *substep), (world.time(), "bar", 1e-3));
    assert!(*stable < 1e-3);
    assert_eq!(bits(&world), before);
}

/// The body that a refusal names is the one that is too fast, not one that is merely deformed more.
#[test]
fn the_refusal_names_the_body_that_is_too_fast() {
    let config = WorldConfig { gravity: [0.0; 3], step: 2e-3, integrator: Integrator::Explicit(Substep::Fixed(1e-3)) };
    let mut world = World::<f64>::new(config).unwrap();
    let soft = world
        .add(
            Body::new(TetMesh::box_grid([1, 1, 1], [0.1; 3]), DENSITY)
                .name("soft")
                .model(TotalLagrangian::new(linear(10.0, 0.3))),
        )
        .unwrap();
    let stiff = world.add(free_bar().name("stiff")).unwrap();
    world.body_mut(soft).set_positions(|x| x * 9.0);
    world.body_mut(stiff).set_positions(|x| x * 4.0);
    let StepError::UnstableSubstep { body, .. } = world.step().unwrap_err() else { panic!() };
    assert_eq!(body, "stiff");
}

/// Tissue that would need too many sub-steps is told whether it is as stiff at rest, in a message that can be read.
#[test]
fn too_stiff_tissue_is_told_what_makes_it_so() {
    let bar = |young| {
        let mut world = World::<f64>::new(WorldConfig { gravity: [0.0; 3], ..WorldConfig::default() }).unwrap();
        let mesh = TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]);
        let id = world.add(Body::new(mesh, DENSITY).model(TotalLagrangian::new(stvk(young, 0.3)))).unwrap();
        (world, id)
    };
    let said = |error: StepError| {
        assert!(matches!(error, StepError::TooStiff { .. }), "{error}");
        error.to_string()
    };
    for young in [1e18, 1e90] {
        let (mut world, _) = bar(young);
        let message = said(world.step().unwrap_err());
        assert!(message.len() < 400 && message.contains("as stiff at rest: take a shorter step"), "{message}");
    }
    let (mut world, id) = bar(1e4);
    world.body_mut(id).set_positions(|x| x * 1e7);
    let message = said(world.step().unwrap_err());
    assert!(message.contains("stretched 10000000.000 times") && message.ends_with("take a softer law"), "{message}");
}

/// A world without bodies has nothing to be refused for.
#[test]
fn an_empty_world_only_lets_time_pass() {
    for substep in [Substep::Automatic, Substep::Fixed(1e-3)] {
        let config = WorldConfig { step: 1.0, integrator: Integrator::Explicit(substep), ..WorldConfig::default() };
        let mut world = World::<f64>::new(config).unwrap();
        world.step().unwrap();
        assert_eq!(world.time(), 1.0);
    }
}

/// Sub-steps so short that a step would take more than a million are refused when the world is made, not in a
/// step that blames the tissue for them.
#[test]
fn a_sub_step_that_divides_a_step_too_finely_is_refused() {
    let config =
        WorldConfig { step: 1.0, integrator: Integrator::Explicit(Substep::Fixed(1e-9)), ..WorldConfig::default() };
    let Err(WorldError::OutOfRange { name, value, .. }) = World::<f64>::new(config).map(|_| ()) else { panic!() };
    assert_eq!((name, value), ("substep", 1e-9));
}
