//! What motions without loads keep.

use viscera::body::Body;
use viscera::dynamics::implicit::Scheme;
use viscera::material::{Lame, TransverseStVenantKirchhoff};
use viscera::mesh::HexMesh;
use viscera::model::TotalLagrangian;
use viscera::world::BodyObservables;

use super::support::*;

fn energy(o: &BodyObservables) -> f64 {
    o.kinetic_energy + o.elastic_energy
}

/// A free bar, stretched by 10 % and turning.
fn thrown(
    body: Body,
    settings: viscera::dynamics::implicit::Implicit,
) -> (viscera::world::World<f64>, viscera::world::BodyId) {
    let (mut world, id) = implicit_world(NO_GRAVITY, 5e-3, settings, body);
    let body = world.body_mut(id);
    body.set_positions(|x| Vector::new(x.x, x.y, 1.1 * x.z));
    body.set_velocities(|x| Vector::new(0.4, 0.2, 1.0) + Vector::new(3.0, 1.0, -2.0).cross(x));
    (world, id)
}

/// Simo and Tarnow: energy, momentum and angular momentum to 1e-9 of their sizes over fifty steps of many times the stable
/// explicit one, isotropic and with fibres.
#[test]
fn the_energy_momentum_step_keeps_energy_momentum_and_angular_momentum() {
    let lame = |young, poisson| Lame::from_young_poisson(young, poisson).unwrap();
    let fibres = TransverseStVenantKirchhoff::new(lame(10e3, 0.3), [0.0, 0.6, 0.8], lame(20e3, 0.3)).unwrap();
    for tissue in [tissue(), uniform(fibres)] {
        let body = bar_of(TotalLagrangian::new(tissue));
        let (mut world, id) = thrown(body, full(Scheme::EnergyMomentum, 1e-12));
        let before = world.observe(id);
        for _ in 0..50 {
            world.step().unwrap();
            let now = world.observe(id);
            let drift = (energy(&now) - energy(&before)).abs() / energy(&before);
            assert!(drift < 1e-9, "energy drifts by {drift:e}");
            assert!((now.momentum - before.momentum).norm() < 1e-9 * before.momentum.norm());
            let turned = (now.angular_momentum - before.angular_momentum).norm();
            assert!(turned < 1e-9 * before.angular_momentum.norm(), "angular momentum drifts by {turned:e}");
        }
        // It does vibrate: elastic energy has gone over into motion.
        assert!(world.observe(id).elastic_energy < 0.9 * before.elastic_energy);
    }
}

/// The same on hexahedra, sheared and twisted within each cell so that the eight points differ: what Newton's method leaves, 1e-13 of
/// the forces, is all that changes.
#[test]
fn the_energy_momentum_step_keeps_them_on_hexahedra_too() {
    let lame = |young, poisson| Lame::from_young_poisson(young, poisson).unwrap();
    let fibres = TransverseStVenantKirchhoff::new(lame(10e3, 0.3), [0.0, 0.6, 0.8], lame(20e3, 0.3)).unwrap();
    for tissue in [tissue(), uniform(fibres)] {
        let mesh = HexMesh::box_grid([2, 2, 6], [0.1, 0.1, 0.3]);
        let body = Body::new(mesh, 1000.0).model(TotalLagrangian::new(tissue));
        let (mut world, id) = thrown(body, full(Scheme::EnergyMomentum, 1e-13));
        world
            .body_mut(id)
            .set_positions(|x| Vector::new(x.x + x.y * x.z, x.y - 2.0 * x.x * x.z, 1.1 * x.z + x.x * x.y));
        let before = world.observe(id);
        for _ in 0..50 {
            world.step().unwrap();
            let now = world.observe(id);
            let drift = (energy(&now) - energy(&before)).abs() / energy(&before);
            assert!(drift < 1e-11, "energy drifts by {drift:e}");
            assert!((now.momentum - before.momentum).norm() < 1e-11 * before.momentum.norm());
            let turned = (now.angular_momentum - before.angular_momentum).norm();
            assert!(turned < 1e-11 * before.angular_momentum.norm(), "angular momentum drifts by {turned:e}");
        }
        assert!(world.observe(id).elastic_energy < 0.9 * before.elastic_energy);
    }
}

/// Internal forces add up to nothing, so that every scheme keeps the momentum of a free body, solved in full or not.
#[test]
fn every_scheme_keeps_momentum() {
    let schemes = [Scheme::BackwardEuler, Scheme::AVERAGE_ACCELERATION, Scheme::Bdf2, Scheme::EnergyMomentum];
    let settings = schemes.map(|scheme| full(scheme, 1e-11));
    for settings in settings.into_iter().chain([linearised()]) {
        let (mut world, id) = thrown(bar(), settings);
        let before = world.observe(id).momentum;
        run(&mut world, 20);
        let drift = (world.observe(id).momentum - before).norm() / before.norm();
        assert!(drift < 1e-9, "{:?} drifts by {drift:e}", settings.scheme);
    }
}

/// Backward Euler loses energy in every step of a free vibration and never gains any.
#[test]
fn backward_euler_never_gains_energy() {
    let (mut world, id) = implicit_world(NO_GRAVITY, 5e-3, full(Scheme::BackwardEuler, 1e-10), bar().fix(root()));
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1.15 * x.z));
    let mut before = energy(&world.observe(id));
    let first = before;
    for step in 0..100 {
        world.step().unwrap();
        let now = energy(&world.observe(id));
        assert!(now < before, "step {step}: {now} J after {before} J");
        before = now;
    }
    assert!(before < 0.9 * first);
}

/// Damping of the stiffness leaves rigid motion alone and takes energy from vibration; damping by mass slows both, with
/// momentum falling as exp(−βt) to the order of the scheme.
#[test]
fn rayleigh_damping_takes_what_it_should() {
    let settings = full(Scheme::AVERAGE_ACCELERATION, 1e-10);
    let (mut plain, id) = thrown(bar(), settings);
    let (mut by_stiffness, _) = thrown(bar().stiffness_damping(0.02), settings);
    let (mut by_mass, _) = thrown(bar().damping(2.0), settings);
    let before = plain.observe(id).momentum;
    for world in [&mut plain, &mut by_stiffness, &mut by_mass] {
        run(world, 40);
    }
    let kept = (by_stiffness.observe(id).momentum - before).norm() / before.norm();
    assert!(kept < 1e-8, "stiffness damping changes momentum by {kept:e}");
    assert!(by_stiffness.observe(id).elastic_energy < 0.5 * plain.observe(id).elastic_energy);
    // 0.2 s at 2 1/s; the trapezoidal rule errs by (βΔt)²/12 of the exponent
    let left = by_mass.observe(id).momentum.norm() / before.norm();
    assert!((left - (-0.4f64).exp()).abs() < 1e-4, "{left}");
}
