//! Worlds that go from equilibrium to equilibrium.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::{QuasiStatic, StaticError};
use viscera::instrument::{Grasper, Probe, Shaft};
use viscera::material::{LawFamily, LinearElastic, NeoHookean, StVenantKirchhoff, Tissue};
use viscera::mesh::{Region, TetMesh};
use viscera::model::TotalLagrangian;
use viscera::world::{Integrator, StepError, World, WorldConfig, WorldError};

use crate::reference::{Vector, assert_displaced, bottom, displacements, force, settle};

const SIDE: f64 = 0.1;
const HEIGHT: f64 = 0.4;
const YOUNG: f64 = 10e3;

fn world(settings: QuasiStatic) -> World<f64> {
    World::new(WorldConfig { gravity: [0.0; 3], step: 0.1, integrator: Integrator::QuasiStatic(settings) }).unwrap()
}

/// A bar that stands on its fixed lower end.
fn bar(law: impl LawFamily) -> Body {
    let mesh = TetMesh::box_grid([2, 2, 8], [SIDE, SIDE, HEIGHT]);
    Body::new(mesh, 1000.0).model(TotalLagrangian::new(Tissue::uniform(law))).fix(bottom())
}

fn soft() -> NeoHookean {
    NeoHookean::from_young_poisson(YOUNG, 0.3).unwrap()
}

fn top() -> Region {
    Region::plane([0.0, 0.0, HEIGHT], [0.0, 0.0, 1.0], 1e-9)
}

/// A force on the upper end that grows to `most` [N] within a second.
fn pushed(body: Body, most: Vector) -> Body {
    let total = Curve::piecewise_linear(vec![(0.0, Vector::ZERO), (1.0, most)]).unwrap();
    body.load(Load::Force { region: top(), total })
}

#[test]
fn every_step_ends_in_the_equilibrium_of_its_time() {
    let mut world = world(QuasiStatic::default());
    let id = world.add(pushed(bar(soft()), Vector::new(2.0, 0.0, 0.0))).unwrap();
    for step in 1..=10 {
        let solved = world.step().unwrap().implicit.unwrap();
        assert!(solved.converged && solved.newton_iterations > 0 && solved.residual < 1e-7, "{solved:?}");
        assert!(world.body(id).velocities().iter().all(|&velocity| velocity == Vector::ZERO));
        let carried = world.observe(id).reaction;
        assert!((carried.x + 0.2 * f64::from(step)).abs() < 1e-7, "{carried:?} after {step} steps");
    }
    // The way there leaves no trace.
    let all = top().nodes(world.body(id).mesh()).unwrap();
    let (mut at_once, other) =
        crate::reference::world(bar(soft()).load(force(all, Vector::new(2.0, 0.0, 0.0))), [0.0; 3]);
    settle(&mut at_once, other).unwrap();
    assert_displaced(&displacements(&world, id), &displacements(&at_once, other), 1e-8, "ten steps beside one");
}

/// Small strains are those of the stiffness at rest: displacements grow with the load, however large, and whatever the law.
#[test]
fn at_small_strain_twice_the_load_moves_twice_as_far() {
    let mut world = world(QuasiStatic { small_strain: true, ..QuasiStatic::default() });
    let id = world.add(pushed(bar(soft()), Vector::new(5.0, 0.0, 0.0))).unwrap();
    world.step().unwrap();
    let once: Vec<Vector> = displacements(&world, id).iter().map(|&u| u * 2.0).collect();
    world.step().unwrap();
    assert_displaced(&displacements(&world, id), &once, 1e-9, "twice the load");
}

/// Without Poisson's effect a bar that is drawn out by δ pulls with E A δ/l.
#[test]
fn what_a_grasper_draws_out_pulls_at_it() {
    let mut world = world(QuasiStatic::default());
    world.add(bar(LinearElastic::from_young_poisson(YOUNG, 0.0).unwrap())).unwrap();
    let middle = Vector::new(0.5 * SIDE, 0.5 * SIDE, HEIGHT + 0.03);
    let (drawn, speed) = (5e-3, 0.01);
    let path =
        Curve::piecewise_linear(vec![(0.1, middle), (0.6, middle + Vector::new(0.0, 0.0, speed * 0.5))]).unwrap();
    // 30 mm above the end, its corners are 77 mm away, and the next nodes 80 mm.
    let id = world.add_instrument(Grasper { path, radius: 0.078, close: 0.05, ..Grasper::default() }).unwrap();
    for _ in 0..6 {
        world.step().unwrap();
    }
    let tool = world.tool(id);
    let expected = YOUNG * SIDE * SIDE * drawn / HEIGHT;
    assert_eq!(tool.held_nodes, 9);
    assert!((tool.holding_force.z / expected - 1.0).abs() < 1e-6, "{:?}, not {expected} N", tool.holding_force);
}

#[test]
fn a_load_beyond_the_law_undoes_the_step() {
    let mut world = world(QuasiStatic::default());
    let law = StVenantKirchhoff::from_young_poisson(YOUNG, 0.3).unwrap();
    let id = world.add(pushed(bar(law), Vector::new(0.0, 0.0, -10.0))).unwrap();
    let error = loop {
        let before = world.snapshot().to_bytes();
        if let Err(error) = world.step() {
            assert_eq!(world.snapshot().to_bytes(), before);
            break error;
        }
        assert_eq!(world.observe(id).inverted_cells, 0);
        assert!(world.steps() < 10, "nothing gave way");
    };
    assert!(matches!(&error, StepError::NoEquilibrium { error: StaticError::NoEquilibrium { .. }, .. }), "{error}");
    assert!(world.steps() > 0 && error.to_string().contains("the step is undone"), "{error}");
}

#[test]
fn what_needs_motion_is_refused() {
    let mut world = world(QuasiStatic::default());
    let shaft = Shaft { radius: 3e-3, length: 0.3 };
    let probe = Probe { shaft, ..Probe::default() };
    assert_eq!(world.add_instrument(probe).unwrap_err(), WorldError::ToolsNeedMotion);
    let bounded = Grasper { grip: 1.0, ..Grasper::default() };
    assert_eq!(world.add_instrument(bounded).unwrap_err(), WorldError::ToolsNeedMotion);
    let damped = world.add(bar(soft()).stiffness_damping(0.01)).unwrap_err();
    assert!(matches!(damped, WorldError::StiffnessDampingNeedsImplicit { .. }), "{damped}");
    let mesh = TetMesh::box_grid([1, 1, 1], [SIDE; 3]);
    world.add(Body::new(mesh, 1000.0).model(TotalLagrangian::new(Tissue::uniform(soft())))).unwrap();
    let floating = world.step().unwrap_err();
    assert!(
        matches!(&floating, StepError::NoEquilibrium { error: StaticError::NothingHolds { .. }, .. }),
        "{floating}"
    );
}
