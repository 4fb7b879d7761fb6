//! Small worlds that the tests share.

mod reference;

pub(crate) use reference::{Reference, number, numbers, vector, vectors};

use viscera::body::Body;
use viscera::material::{LinearElastic, StVenantKirchhoff, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::{Precision, TotalLagrangian};
use viscera::world::{BodyId, BodyObservables, Integrator, Substep, World, WorldConfig};

pub(crate) type Vector = Vec3<f64>;

/// Density of water [kg/m³].
pub(crate) const DENSITY: f64 = 1000.0;

/// Runs a test in both precisions; the tolerance follows the precision.
macro_rules! in_both_precisions {
    ($(#[$note:meta])* $test:ident, f32: $single:expr, f64: $double:expr) => {
        mod $test {
            $(#[$note])*
            #[test]
            fn in_single_precision() {
                super::$test::<f32>($single);
            }
            $(#[$note])*
            #[test]
            fn in_double_precision() {
                super::$test::<f64>($double);
            }
        }
    };
}
pub(crate) use in_both_precisions;

/// A world that takes steps of `step` [s] under `gravity` [m/s²].
pub(crate) fn world<T: Precision>(gravity: [f64; 3], step: f64) -> World<T> {
    World::new(WorldConfig { gravity, step, ..WorldConfig::default() }).unwrap()
}

/// A world without gravity whose sub-steps are exactly its steps of `step` [s].
pub(crate) fn world_of_single_substeps<T: Precision>(step: f64) -> World<T> {
    World::new(WorldConfig { gravity: [0.0; 3], step, integrator: Integrator::Explicit(Substep::Fixed(step)) }).unwrap()
}

/// Linear tissue [Pa].
pub(crate) fn linear(young: f64, poisson: f64) -> Tissue {
    Tissue::uniform(LinearElastic::from_young_poisson(young, poisson).unwrap())
}

/// St Venant–Kirchhoff tissue [Pa].
pub(crate) fn stvk(young: f64, poisson: f64) -> Tissue {
    Tissue::uniform(StVenantKirchhoff::from_young_poisson(young, poisson).unwrap())
}

/// A bar of 4×4×16 cm along z, of soft St Venant–Kirchhoff tissue, held by nothing.
pub(crate) fn free_bar() -> Body {
    Body::new(TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]), DENSITY).model(TotalLagrangian::new(stvk(5e3, 0.4)))
}

/// The named side of a generated box.
pub(crate) fn side(name: &str) -> Region {
    Region::Named(name.into())
}

/// Steps until the motion has died down, and measures then. `quiet` is the kinetic energy over the elastic one at which
/// that is so, for many steps on end: at its turning points a swing stands still as well. An error of displacement of
/// about its square root is left.
pub(crate) fn settle<T: Precision>(world: &mut World<T>, body: BodyId, quiet: f64) -> BodyObservables {
    const MOST_STEPS: usize = 3000;
    const QUIET_STEPS: usize = 30;
    let mut quiet_steps = 0;
    for _ in 0..MOST_STEPS {
        world.step().unwrap();
        let seen = world.observe(body);
        quiet_steps = if seen.kinetic_energy <= quiet * seen.elastic_energy { quiet_steps + 1 } else { 0 };
        if quiet_steps == QUIET_STEPS {
            return seen;
        }
    }
    panic!("not at rest after {MOST_STEPS} steps: {:?}", world.observe(body));
}

/// Every number of a state, bit by bit.
pub(crate) fn bits<T: Precision>(world: &World<T>) -> Vec<u64> {
    let of = |v: &Vec3<T>| v.to_array().map(|value| value.to_f64().to_bits());
    let mut bits = vec![world.time().to_bits()];
    for body in world.body_ids().map(|id| world.body(id)) {
        let state = body.state();
        bits.extend(state.positions.iter().chain(&state.velocities).flat_map(of));
        bits.extend(state.masses.iter().map(|mass| mass.to_f64().to_bits()));
        bits.extend(state.removed.iter().map(|&removed| u64::from(removed)));
        bits.extend(state.motions.iter().map(|motion| format!("{motion:?}").bytes().map(u64::from).sum::<u64>()));
    }
    bits
}

/// Asserts |value − expected| ≤ tolerance · |expected|.
#[track_caller]
pub(crate) fn assert_relative(value: f64, expected: f64, tolerance: f64) {
    let error = (value - expected).abs() / expected.abs();
    assert!(error <= tolerance, "{value} instead of {expected}: {error:.3e} off, {tolerance:.1e} allowed");
}

/// Asserts |value − expected| ≤ tolerance · |expected| for vectors.
#[track_caller]
pub(crate) fn assert_vector(value: Vector, expected: Vector, tolerance: f64) {
    let error = (value - expected).norm() / expected.norm();
    assert!(error <= tolerance, "{value:?} instead of {expected:?}: {error:.3e} off, {tolerance:.1e} allowed");
}
