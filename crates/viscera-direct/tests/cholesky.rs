//! The factorisation against conjugate gradients, and on a body that gives way.

use viscera::body::Body;
use viscera::dynamics::quasi_static::{QuasiStatic, StaticError};
use viscera::material::{StVenantKirchhoff, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::TotalLagrangian;
use viscera::solver::{Iterative, LinearSolver};
use viscera::world::{World, WorldConfig};
use viscera_direct::Cholesky;

fn bend(gravity: f64, solver: &mut dyn LinearSolver) -> Result<Vec<Vec3<f64>>, StaticError> {
    let mesh = TetMesh::box_grid([3, 3, 10], [0.1, 0.1, 0.4]);
    let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(10e3, 0.3).unwrap());
    let config = WorldConfig { gravity: [0.0, -gravity, 0.0], ..WorldConfig::default() };
    let mut world = World::new(config).unwrap();
    let body =
        Body::new(mesh, 1000.0).model(TotalLagrangian::new(tissue)).fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0));
    let id = world.add(body).unwrap();
    world.settle(id, &QuasiStatic { tolerance: 1e-12, ..QuasiStatic::default() }, solver)?;
    Ok(world.body(id).positions().to_vec())
}

/// Two solvers, one equilibrium: residuals of 1e-12 leave displacements of 0.1 m equal to 1e-9 of that.
#[test]
fn the_factorisation_finds_the_equilibrium_that_conjugate_gradients_find() {
    let direct = bend(0.5, &mut Cholesky::default()).unwrap();
    let iterative = bend(0.5, &mut Iterative::new(1e-13)).unwrap();
    let apart = direct.iter().zip(&iterative).map(|(&a, &b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-10, "{apart:e} m apart");
}

/// A stiffness that is not positive definite any more shows as a pivot that is not, and ends in the error that names the
/// load that can be borne.
#[test]
fn a_load_beyond_the_law_is_reported() {
    let error = bend(9.81, &mut Cholesky::default()).unwrap_err();
    let StaticError::NoEquilibrium { load_factor, .. } = error else { panic!("{error}") };
    assert!((0.05..0.3).contains(&load_factor), "{load_factor}");
}
