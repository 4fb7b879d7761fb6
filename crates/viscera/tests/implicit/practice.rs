//! What users do: stiff tissue, weights, driven nodes, cuts, settings that make no sense.

use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, Newton, Scheme};
use viscera::instrument::Grasper;
use viscera::model::{TensorMass, TotalLagrangian};
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
        let grasper = world.add_instrument(Grasper { path, radius: 0.03, close: 0.02, open: None }).unwrap();
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

/// A full step that does not converge is undone and names the body.
#[test]
fn a_full_step_that_does_not_converge_is_undone() {
    let newton = Newton::Full { relative: 1e-10, at_most: 1 };
    let (mut world, id) =
        implicit_world([0.0, -9.81, 0.0], 1e-1, Implicit { newton, ..linearised() }, bar().fix(root()));
    let before = world.body(id).positions().to_vec();
    let error = world.step().unwrap_err();
    assert!(matches!(error, StepError::NotConverged { iterations: 1, .. }), "{error}");
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
        Implicit { newton: Newton::Full { relative: 1e-6, at_most: 0 }, ..Implicit::default() },
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
