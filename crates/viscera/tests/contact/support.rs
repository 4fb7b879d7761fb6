//! Soft blocks, and worlds to move them in.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, MatrixForm, Preconditioning, Scheme};
use viscera::instrument::{Mount, Path, Probe, Shaft};
use viscera::material::{NeoHookean, Tissue};
use viscera::math::Vec3;
use viscera::mesh::TetMesh;
use viscera::model::{Precision, TotalLagrangian};
use viscera::solver::Stop;
use viscera::world::{Integrator, Substep, World, WorldConfig};

pub(crate) type Vector = Vec3<f64>;

pub(crate) const GRAVITY: [f64; 3] = [0.0, -9.81, 0.0];

pub(crate) const EXPLICIT: Integrator = Integrator::Explicit(Substep::Automatic);

/// Linearised backward Euler, solved as far as double precision goes.
pub(crate) fn implicit() -> Integrator {
    let linear = Stop::Tolerance { relative: 1e-12, at_most: 2000 };
    Integrator::Implicit(Implicit { linear, ..Implicit::default() })
}

/// Every way to take implicit steps with tools.
pub(crate) fn implicit_ways() -> Vec<Implicit> {
    let linear = Stop::Tolerance { relative: 1e-10, at_most: 2000 };
    vec![
        Implicit { linear, ..Implicit::default() },
        Implicit { linear, matrix: MatrixForm::Assembled, ..Implicit::default() },
        Implicit { linear, preconditioner: Preconditioning::Multigrid, ..Implicit::default() },
        Implicit { linear, ..Implicit::accurate(Scheme::BackwardEuler) },
        Implicit { linear, ..Implicit::accurate(Scheme::AVERAGE_ACCELERATION) },
        Implicit { linear, ..Implicit::accurate(Scheme::Bdf2) },
    ]
}

pub(crate) fn world<T: Precision>(gravity: [f64; 3], step: f64, integrator: Integrator) -> World<T> {
    World::new(WorldConfig { gravity, step, integrator }).unwrap()
}

pub(crate) fn tissue(young: f64) -> Tissue {
    Tissue::uniform(NeoHookean::from_young_poisson(young, 0.4).unwrap())
}

/// A block with its lowest corner at `low`, of so many cells and this size [m], 1000 kg/m³ and E = `young` [Pa].
pub(crate) fn block(cells: [usize; 3], size: [f64; 3], low: Vector, young: f64) -> Body {
    let mut mesh = TetMesh::box_grid(cells, size);
    mesh.nodes.iter_mut().for_each(|node| *node += low);
    Body::new(mesh, 1000.0).model(TotalLagrangian::new(tissue(young)))
}

pub(crate) fn still(place: Vector) -> Path {
    Curve::constant(place)
}

/// A rod that lies along `direction`, 40 cm long, with its middle at `middle`.
pub(crate) fn rod(middle: Vector, direction: Vector, radius: f64, friction: f64) -> Probe {
    let shaft = Shaft { radius, length: 0.4 };
    Probe { path: still(middle + direction * 0.2), mount: Mount::along(direction), shaft, friction }
}

#[track_caller]
pub(crate) fn assert_vector(value: Vector, expected: Vector, tolerance: f64) {
    let error = (value - expected).norm();
    assert!(error <= tolerance * expected.norm(), "{value:?} instead of {expected:?}: {error:.3e} off");
}

/// Σ m v [kg m/s].
pub(crate) fn momentum<T: Precision>(world: &World<T>) -> Vector {
    let mut sum = Vector::ZERO;
    for body in world.body_ids().map(|id| world.body(id)) {
        for (mass, velocity) in body.state().masses.iter().zip(body.velocities()) {
            sum += velocity.cast::<f64>() * mass.to_f64();
        }
    }
    sum
}
