use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, Newton};
use viscera::material::{NeoHookean, Tissue};
use viscera::mesh::{Region, TetMesh, VolumeMesh};
use viscera::model::{Corotational, Precomputed, TotalLagrangian};
use viscera::solver::{Iterative, Stop};
use viscera::world::{BodyId, Integrator, World, WorldConfig};

use crate::support::{DENSITY, Vector, bar, between, hex_bar, run, tissue, world};

const CENTRE: [f64; 3] = [0.3, 0.1, 0.2];

fn attraction(radius: f64, per_volume: f64) -> Load {
    Load::Attraction { region: Region::All, centre: CENTRE, radius, per_volume: Curve::constant(per_volume) }
}

/// Force per volume at `x` of a ball of radius R and strength s: s R²/r² outside, s r/R inside.
fn field(x: Vector, radius: f64, strength: f64) -> Vector {
    let r = Vector::from(CENTRE) - x;
    let size = r.norm();
    r / size * if size > radius { strength * (radius / size).powi(2) } else { strength * size / radius }
}

/// −s R²/r outside, s (r²/2R − 3R/2) inside: the energy for each volume whose slope the field is.
fn potential(x: Vector, radius: f64, strength: f64) -> f64 {
    let r = (x - Vector::from(CENTRE)).norm();
    strength * if r > radius { -radius * radius / r } else { r * r / (2.0 * radius) - 1.5 * radius }
}

/// The rest volume that each node stands for [m³]: its mass over the density.
fn volumes(world: &World<f64>, id: BodyId) -> Vec<f64> {
    world.body(id).state().masses.iter().map(|mass| mass / DENSITY).collect()
}

/// A force ρ g per volume is weight, at every node, before and after a cut; also where the answer was found before.
#[test]
fn a_body_force_of_density_times_gravity_is_weight() {
    let weight =
        Load::BodyForce { region: Region::All, per_volume: Curve::constant(Vector::new(0.0, -9.81 * DENSITY, 0.0)) };
    for mesh in [VolumeMesh::from(bar()), hex_bar().into()] {
        let body = || Body::new(mesh.clone(), DENSITY).model(Corotational::new(tissue())).fix(between(0.0, 0.0));
        let (mut heavy, a) = world::<f64>([0.0, -9.81, 0.0], body());
        let (mut pulled, b) = world::<f64>([0.0; 3], body().load(weight.clone()));
        for cut in [vec![], vec![0, 3, 7]] {
            heavy.remove_cells(a, &cut).unwrap();
            pulled.remove_cells(b, &cut).unwrap();
            run(&mut heavy, 0.1);
            run(&mut pulled, 0.1);
            let pairs = heavy.body(a).positions().iter().zip(pulled.body(b).positions());
            let apart = pairs.map(|(&x, &y)| (x - y).norm()).fold(0.0, f64::max);
            assert!(apart < 1e-11 && heavy.observe(a).max_displacement > 1e-3, "{apart} m apart");
        }
    }
    let body = || Body::new(bar(), DENSITY).model(Precomputed::new(tissue())).fix(between(0.0, 0.0));
    let (mut heavy, a) = world::<f64>([0.0, -9.81, 0.0], body());
    let (mut pulled, b) = world::<f64>([0.0; 3], body().load(weight));
    run(&mut heavy, 0.01);
    run(&mut pulled, 0.01);
    let pairs = heavy.body(a).positions().iter().zip(pulled.body(b).positions());
    assert!(pairs.map(|(&x, &y)| (x - y).norm()).fold(0.0, f64::max) < 1e-12);
}

/// Only the cells of its region feel a field: the forces add up to the field times their volume.
#[test]
fn a_field_acts_on_the_cells_of_its_region() {
    let push = Vector::new(200.0, 0.0, -100.0);
    let curve = Curve::piecewise_linear(vec![(0.0, Vector::ZERO), (1.0, push)]).unwrap();
    let load = Load::BodyForce { region: between(0.2, 0.3), per_volume: curve };
    let body = Body::new(bar(), DENSITY).model(Corotational::new(tissue())).fix(Region::All).load(load);
    let (mut world, id) = world::<f64>([0.0; 3], body);
    run(&mut world, 0.5);
    let forces = world.external_forces(id);
    let sum = forces.iter().fold(Vector::ZERO, |sum, &force| sum + force);
    let expected = push * (0.5 * 0.1 * 0.1 * 0.1);
    assert!((sum - expected).norm() < 1e-12 * expected.norm(), "{sum:?} N, not {expected:?} N");
}

/// Inside and outside of the ball, on the line between the two it is continuous.
#[test]
fn an_attraction_is_that_of_a_ball() {
    for radius in [0.05, 0.25, 2.0] {
        let body = Body::new(bar(), DENSITY).model(Corotational::new(tissue())).fix(Region::All);
        let (mut world, id) = world::<f64>([0.0; 3], body.load(attraction(radius, 3e3)));
        let forces = world.external_forces(id).to_vec();
        let volumes = volumes(&world, id);
        for ((force, &x), volume) in forces.iter().zip(world.body(id).mesh().nodes()).zip(volumes) {
            let expected = field(x, radius, 3e3) * volume;
            assert!((*force - expected).norm() < 1e-12 * expected.norm(), "{force:?} at {x:?}, not {expected:?}");
        }
    }
}

/// A free body that falls through the ball keeps kinetic, elastic and the field's energy together, and its angular momentum about
/// the centre; central differences let the sum swing by (ωΔt)².
#[test]
fn a_body_that_falls_through_a_field_keeps_its_energy() {
    let (radius, strength) = (0.15, 4e3);
    let body = Body::new(bar(), DENSITY).model(Corotational::new(tissue())).load(attraction(radius, strength));
    let mut world = World::<f64>::new(WorldConfig { gravity: [0.0; 3], step: 1e-3, ..WorldConfig::default() }).unwrap();
    let id = world.add(body).unwrap();
    world.body_mut(id).set_velocities(|_| Vector::new(0.0, 0.2, 0.3));
    let volumes = volumes(&world, id);
    let account = |world: &mut World<f64>| {
        let seen = world.observe(id);
        let state = world.body(id).state();
        let of_field: f64 =
            state.positions.iter().zip(&volumes).map(|(&x, volume)| volume * potential(x, radius, strength)).sum();
        let spin = state
            .positions
            .iter()
            .zip(&state.velocities)
            .zip(&state.masses)
            .fold(Vector::ZERO, |sum, ((&x, &v), &mass)| sum + (x - Vector::from(CENTRE)).cross(v) * mass);
        (seen.kinetic_energy, seen.kinetic_energy + seen.elastic_energy + of_field, spin)
    };
    let (_, start, spin) = account(&mut world);
    let (mut fastest, mut astray) = (0.0f64, 0.0f64);
    for _ in 0..500 {
        world.step().unwrap();
        let (kinetic, energy, now) = account(&mut world);
        fastest = fastest.max(kinetic);
        astray = astray.max((energy - start).abs());
        assert!((now - spin).norm() < 1e-10 * spin.norm());
    }
    assert!(fastest > 1.0 && astray < 2e-3 * fastest, "{astray} J of {fastest} J");
}

/// Settled in a field that attracts: the answer to a small force is the slope of the forces, and an implicit step ends there too.
#[test]
fn statics_and_implicit_steps_know_how_a_field_changes() {
    let law = NeoHookean::from_young_poisson(5e3, 0.3).unwrap();
    let body = || {
        Body::new(TetMesh::box_grid([2, 2, 6], [0.1, 0.1, 0.3]), DENSITY)
            .model(TotalLagrangian::new(Tissue::uniform(law)))
            .fix(Region::Named("z-min".into()))
            .load(attraction(0.2, 2e3))
    };
    let (mut world, id) = world::<f64>([0.0; 3], body());
    let report = world.settle(id, &Default::default(), &mut Iterative::new(1e-13)).unwrap();
    assert_eq!(report.steps.len(), 1);
    let last = &report.steps[0].residuals;
    assert!(last.len() <= 9, "{last:?}");

    let settings = Implicit {
        newton: Newton::Full { relative: 1e-11, at_most: 30 },
        linear: Stop::Tolerance { relative: 1e-12, at_most: 3000 },
        ..Implicit::default()
    };
    let config = WorldConfig { gravity: [0.0; 3], step: 1.0, integrator: Integrator::Implicit(settings) };
    let mut moving = World::<f64>::new(config).unwrap();
    let other = moving.add(body().damping(1.0)).unwrap();
    for _ in 0..40 {
        let report = moving.step().unwrap().implicit.unwrap();
        assert!(report.converged && report.newton_iterations <= 9, "{report:?}");
    }
    let pairs = world.body(id).positions().iter().zip(moving.body(other).positions());
    let apart = pairs.map(|(&x, &y)| (x - y).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-6 && world.observe(id).max_displacement > 0.01, "{apart} m apart");
}

/// Metres and millimetres tell the same story: forces per volume are N/m³ = kg/(m² s²).
#[test]
fn fields_and_actuators_are_the_same_in_millimetres() {
    use viscera::body::{Actuator, ActuatorLine};
    let ends = [1.0, 1000.0].map(|unit: f64| {
        let size = [0.1 * unit, 0.1 * unit, 0.3 * unit];
        let tissue = Tissue::uniform(viscera::material::LinearElastic::from_young_poisson(8e3 / unit, 0.3).unwrap());
        let line = ActuatorLine::Between { from: Region::nearest([0.0; 3]), to: Region::nearest(size) };
        let along = ActuatorLine::Along { region: Region::All, direction: [1.0, 0.0, 1.0] };
        let one = || Curve::constant(1.0);
        let body = Body::new(TetMesh::box_grid([2, 2, 6], size), DENSITY / unit.powi(3))
            .model(Corotational::new(tissue))
            .fix(Region::Named("z-min".into()))
            .damping(3.0)
            .actuator(Actuator {
                line,
                stiffness: 20.0,
                length: Curve::constant(0.8),
                tension: Curve::constant(0.5 * unit),
            })
            .actuator(Actuator {
                line: along,
                stiffness: 2e3 / unit,
                length: one(),
                tension: Curve::constant(100.0 / unit),
            })
            .load(Load::BodyForce {
                region: Region::All,
                per_volume: Curve::constant(Vector::new(0.0, -900.0, 100.0) / unit.powi(2)),
            })
            .load(Load::Attraction {
                region: Region::All,
                centre: CENTRE.map(|x| x * unit),
                radius: 0.25 * unit,
                per_volume: Curve::constant(2e3 / unit.powi(2)),
            });
        let (mut world, id) = world::<f64>([0.0; 3], body);
        run(&mut world, 0.5);
        world.body(id).positions().iter().map(|&x| x / unit).collect::<Vec<_>>()
    });
    let [metres, millimetres] = ends;
    let apart = metres.iter().zip(&millimetres).map(|(&a, &b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-11, "{apart} m apart");
}
