//! What users do: stiff tissue, weights, driven nodes, cuts, settings that make no sense.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, Newton, Scheme};
use viscera::instrument::Grasper;
use viscera::material::{LawFamily, LawKind, LawVisitor, StableNeoHookean, Tissue};
use viscera::mesh::TetMesh;
use viscera::model::{Corotational, ModelKind, ModelRecipe, NodallyIntegrated, TensorMass, TotalLagrangian};
use viscera::solver::Stop;
use viscera::world::{Integrator, StepError, Substep, World, WorldConfig, WorldError};

use super::support::*;

/// Tissue of 10 MPa bears steps of 10 ms, twenty times the explicit limit, in single precision, and comes to rest.
#[test]
fn stiff_tissue_bears_long_steps() {
    let body = bar_of(TotalLagrangian::new(stiff_tissue(10e6))).fix(root());
    let settings = Implicit::default();
    let (mut world, id) = world::<f32>([0.0, -9.81, 0.0], 1e-2, Integrator::Implicit(settings), body);
    assert!(world.body(id).stable_step() < 1e-2 / 20.0);
    run(&mut world, 200);
    let seen = world.observe(id);
    assert!(seen.kinetic_energy < 1e-6 * seen.elastic_energy, "{seen:?}");
}

/// At rest the supports carry the weight, ρ V g = 3 kg × 0.5 m/s², and the internal forces balance.
#[test]
fn the_static_limit_carries_the_weight() {
    for body in [bar(), bar_of(TensorMass::new(tissue()))] {
        let body = body.fix(root()).damping(4.0).stiffness_damping(0.02);
        let (mut world, id) = implicit_world(GRAVITY, 0.1, full(Scheme::BackwardEuler, 1e-10), body);
        run(&mut world, 120);
        let seen = world.observe(id);
        assert!((seen.reaction - Vector::new(0.0, 1.5, 0.0)).norm() < 1e-6 * 1.5, "{:?}", seen.reaction);
        assert!(seen.at_rest);
    }
}

/// Prescribed and held nodes are where they have to be at the end of every step, exactly, while the rest follows.
#[test]
fn driven_nodes_arrive() {
    for settings in [linearised(), full(Scheme::BackwardEuler, 1e-9), full(Scheme::EnergyMomentum, 1e-9)] {
        let pull = Curve::piecewise_linear(vec![(0.0, Vector::ZERO), (0.1, Vector::new(0.02, 0.0, 0.03))]).unwrap();
        let body = bar().fix(root()).prescribe(tip(), pull);
        let (mut world, id) = implicit_world(NO_GRAVITY, 1e-2, settings, body);
        let path =
            Curve::piecewise_linear(vec![(0.0, Vector::new(0.1, 0.05, 0.15)), (0.1, Vector::new(0.12, 0.05, 0.15))])
                .unwrap();
        let grasper = world
            .add_instrument(Grasper { path, radius: 0.03, close: 0.02, open: None, ..Grasper::default() })
            .unwrap();
        run(&mut world, 10);
        let body = world.body(id);
        for (x, rest) in body.positions().iter().zip(body.mesh().nodes()) {
            if rest.z == 0.3 {
                assert!((*x - *rest - Vector::new(0.02, 0.0, 0.03)).norm() < 1e-15, "{x:?}");
            }
        }
        let held = world.observe_instrument(grasper);
        assert!(held.held_nodes > 0 && held.force.norm() > 0.0, "{held:?}");
    }
}

/// Cutting between steps: the piece that comes off falls freely, the rest hangs on.
#[test]
fn a_piece_that_is_cut_off_falls_freely() {
    for settings in [linearised(), assembled(linearised()), full(Scheme::Bdf2, 1e-10)] {
        let (mut world, id) = implicit_world([0.0, -9.81, 0.0], 1e-2, settings, bar().fix(root()));
        let layer: Vec<u32> = {
            let mesh = world.body(id).mesh();
            let height = |cell: usize| mesh.cell(cell).iter().map(|&n| mesh.nodes()[n as usize].z).sum::<f64>() / 4.0;
            (0..mesh.cell_count()).filter(|&cell| (0.1..0.15).contains(&height(cell))).map(|cell| cell as u32).collect()
        };
        world.remove_cells(id, &layer).unwrap();
        assert_eq!(world.body(id).piece_count(), 2);
        let piece = |world: &World<f64>| {
            let body = world.body(id);
            let nodes: Vec<usize> =
                (0..body.mesh().nodes().len()).filter(|&n| body.mesh().nodes()[n].z > 0.14).collect();
            let masses = &body.state().masses;
            let mass: f64 = nodes.iter().map(|&n| masses[n]).sum();
            nodes.iter().map(|&n| body.velocities()[n] * masses[n]).fold(Vector::ZERO, |a, b| a + b) / mass
        };
        run(&mut world, 10);
        let velocity = piece(&world);
        assert!((velocity - Vector::new(0.0, -0.981, 0.0)).norm() < 1e-9, "{velocity:?}");
    }
}

/// A linear solve that was cut short says so, and by how much it fell short.
#[test]
fn a_solve_that_ends_early_is_reported() {
    let settings = Implicit { linear: Stop::Tolerance { relative: 1e-10, at_most: 3 }, ..Implicit::default() };
    let (mut world, id) = implicit_world(GRAVITY, 1e-2, settings, bar().fix(root()));
    let report = world.step().unwrap().implicit.unwrap();
    assert!(!report.converged && report.residual > 1e-10 && report.linear_iterations == 3, "{report:?}");
    assert_eq!(world.implicit_memory(id).unwrap().linear_history().len(), 4);
    let settings = Implicit { linear: Stop::Iterations(3), ..settings };
    let (mut world, _) = implicit_world(GRAVITY, 1e-2, settings, bar().fix(root()));
    assert!(world.step().unwrap().implicit.unwrap().converged);
}

/// A full step that does not converge, in parts and twice with four times the iterations neither, is undone and names the body.
#[test]
fn a_full_step_that_does_not_converge_is_undone() {
    let newton = Newton::Full { relative: 1e-10, at_most: 1 };
    let settings = Implicit { newton, linear: Stop::Iterations(1), ..linearised() };
    let (mut world, id) = implicit_world([0.0, -9.81, 0.0], 10.0, settings, bar().fix(root()));
    let before = world.body(id).positions().to_vec();
    let error = world.step().unwrap_err();
    assert!(matches!(error, StepError::NotConverged { iterations: 8, .. }), "{error}");
    assert_eq!(world.body(id).positions(), &before[..]);
    assert_eq!(world.time(), 0.0);
}

/// Compressed beyond the strength of its law the tangent is indefinite: the step says so, and gains no energy.
#[test]
fn negative_curvature_is_survived_and_reported() {
    let (mut world, id) = implicit_world(NO_GRAVITY, 2e-2, Implicit::default(), bar().fix(root()));
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 0.45 * x.z));
    let before = world.observe(id);
    let mut met = false;
    for _ in 0..50 {
        met |= world.step().unwrap().implicit.unwrap().negative_curvature;
    }
    assert!(met);
    let seen = world.observe(id);
    let energy = seen.kinetic_energy + seen.elastic_energy;
    assert!(energy < before.elastic_energy, "{energy} J, from {} J", before.elastic_energy);
}

/// Settings and bodies that do not fit are refused with a reason.
#[test]
fn what_does_not_fit_is_refused() {
    let refuse = |settings| {
        let integrator = Integrator::Implicit(settings);
        World::<f64>::new(WorldConfig { integrator, ..WorldConfig::default() }).err()
    };
    let bad = [
        Implicit { linear: Stop::Iterations(0), ..Implicit::default() },
        Implicit { linear: Stop::Tolerance { relative: 0.0, at_most: 9 }, ..Implicit::default() },
        Implicit { linear: Stop::Tolerance { relative: 1e-4, at_most: u32::MAX }, ..Implicit::default() },
        Implicit { newton: Newton::Full { relative: 1e-6, at_most: 0 }, ..Implicit::default() },
        Implicit { newton: Newton::Full { relative: 1e-6, at_most: u32::MAX }, ..Implicit::default() },
        Implicit { newton: Newton::Full { relative: f64::NAN, at_most: 9 }, ..Implicit::default() },
        Implicit { scheme: Scheme::Newmark { beta: 0.0, gamma: 0.5 }, ..Implicit::default() },
        Implicit { scheme: Scheme::Newmark { beta: 0.25, gamma: 0.4 }, ..Implicit::default() },
    ];
    for settings in bad {
        assert!(matches!(refuse(settings), Some(WorldError::OutOfRange { .. })), "{settings:?}");
    }
    let linearised = Implicit { scheme: Scheme::EnergyMomentum, ..Implicit::default() };
    assert_eq!(refuse(linearised), Some(WorldError::LinearisedEnergyMomentum));

    let integrator = Integrator::Implicit(Implicit::accurate(Scheme::EnergyMomentum));
    let mut world = World::<f64>::new(WorldConfig { integrator, ..WorldConfig::default() }).unwrap();
    let error = world.add(bar_of(TensorMass::new(tissue()))).unwrap_err();
    assert!(matches!(error, WorldError::NoMeanForces { model: "tensor-mass", .. }), "{error}");
    assert!(matches!(world.add(bar().keep_volume(1e3)), Err(WorldError::NoMeanForces { .. })));

    let integrator = Integrator::Explicit(Substep::Automatic);
    let mut world = World::<f64>::new(WorldConfig { integrator, ..WorldConfig::default() }).unwrap();
    let error = world.add(bar().stiffness_damping(1e-2)).unwrap_err();
    assert!(matches!(error, WorldError::StiffnessDampingNeedsImplicit { .. }), "{error}");
}

fn boxed_bar(recipe: Box<dyn ModelRecipe>) -> Body {
    Body::new(TetMesh::box_grid([2, 2, 6], [0.1, 0.1, 0.3]), 1000.0).boxed_model(recipe)
}

/// One linear solve for each step, as tight as it can be.
fn linearised_by(scheme: Scheme) -> Implicit {
    Implicit { scheme, ..linearised() }
}

/// The tissue that a law shows itself by.
struct Example;

impl LawVisitor for Example {
    type Output = Tissue;

    fn visit<L: LawFamily>(self) -> Tissue {
        Tissue::uniform(L::example())
    }
}

/// Every model of every law that it computes, by every scheme that can move it: let go from a stretch of 10 % and damped, the
/// bar comes back to its rest shape and never has more energy than at the start.
#[test]
fn every_scheme_brings_every_model_back_to_rest() {
    let damped_newmark = Scheme::Newmark { beta: 0.3025, gamma: 0.6 };
    let schemes = [Scheme::BackwardEuler, damped_newmark, Scheme::Bdf2, Scheme::EnergyMomentum];
    let mut moved = 0;
    for kind in LawKind::ALL {
        let able = ModelKind::ALL.iter().filter(|model| model.info().moves && model.info().laws.contains(kind));
        for model in able {
            let claims = model.claims(*kind, false);
            for scheme in schemes {
                let body = boxed_bar(model.recipe(kind.visit(Example))).damping(3.0).fix(root());
                let settings = if claims.exact_products { full(scheme, 1e-8) } else { linearised_by(scheme) };
                let config =
                    WorldConfig { gravity: NO_GRAVITY, step: 0.05, integrator: Integrator::Implicit(settings) };
                let mut world = World::<f64>::new(config);
                let Some((world, id)) =
                    world.as_mut().ok().and_then(|world| world.add(body).ok().map(|id| (world, id)))
                else {
                    assert_eq!(scheme, Scheme::EnergyMomentum, "{model} of {kind}");
                    continue;
                };
                world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1.1 * x.z));
                let start = world.observe(id).elastic_energy;
                for _ in 0..120 {
                    world.step().unwrap_or_else(|error| panic!("{model} of {kind}, {scheme:?}: {error}"));
                    let seen = world.observe(id);
                    let energy = seen.kinetic_energy + seen.elastic_energy;
                    assert!(energy <= 1.05 * start, "{model} of {kind}, {scheme:?}: {energy} J of {start} J");
                }
                let left = world.observe(id).max_displacement;
                // Damping by mass hardly reaches fast vibration, which energy–momentum keeps as it is.
                let most = if scheme == Scheme::EnergyMomentum { 3e-3 } else { 3e-4 };
                assert!(left < most, "{model} of {kind}, {scheme:?}: {left} m from rest, of 30 mm at the start");
                moved += 1;
            }
        }
    }
    assert!(moved > 40, "{moved} combinations");
}

/// A node poked through the opposite side of the bar comes back by itself in laws and models that say so, and with it the cells
/// that it turned inside out.
#[test]
fn a_node_poked_through_the_bar_comes_back() {
    let recipes: [fn() -> Box<dyn ModelRecipe>; 3] = [
        || Box::new(TotalLagrangian::new(Tissue::uniform(StableNeoHookean::example()))),
        || Box::new(NodallyIntegrated::new(Tissue::uniform(StableNeoHookean::example()))),
        || Box::new(Corotational::new(linear_tissue())),
    ];
    let poke = Vector::new(0.12, 0.02, 0.03);
    for recipe in recipes {
        for settings in
            [linearised_by(Scheme::BackwardEuler), linearised_by(Scheme::Bdf2), full(Scheme::BackwardEuler, 1e-6)]
        {
            let body = boxed_bar(recipe()).damping(3.0).fix(root());
            let what = format!("{} by {settings:?}", recipe().kind());
            let (mut world, id) = implicit_world(NO_GRAVITY, 0.01, settings, body);
            let middle = Vector::new(0.05, 0.05, 0.2);
            world.body_mut(id).set_positions(|x| if (x - middle).norm() < 1e-6 { x + poke } else { x });
            let start = world.observe(id);
            assert!(start.inverted_cells > 0, "{what}: nothing is inverted");
            for _ in 0..300 {
                world.step().unwrap();
                let seen = world.observe(id);
                let energy = seen.kinetic_energy + seen.elastic_energy;
                assert!(energy <= start.elastic_energy, "{what}: {energy} J of {} J", start.elastic_energy);
            }
            let seen = world.observe(id);
            assert_eq!(seen.inverted_cells, 0, "{what}");
            assert!(seen.max_displacement < 0.02 * poke.norm(), "{what}: {} m", seen.max_displacement);
        }
    }
}
