//! Bars to move, and ways to measure how they did.

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, MatrixForm, Newton, Preconditioning, Scheme};
use viscera::material::{LawFamily, LinearElastic, StVenantKirchhoff, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::{ModelRecipe, Precision, TotalLagrangian};
use viscera::solver::Stop;
use viscera::world::{BodyId, Integrator, World, WorldConfig};

pub(crate) type Vector = Vec3<f64>;

/// Soft St Venant–Kirchhoff tissue, E = 10 kPa, ν = 0.3.
pub(crate) fn tissue() -> Tissue {
    stiff_tissue(10e3)
}

pub(crate) fn stiff_tissue(young: f64) -> Tissue {
    uniform(StVenantKirchhoff::from_young_poisson(young, 0.3).unwrap())
}

/// Linear tissue of the same stiffness, for models that turn it.
pub(crate) fn linear_tissue() -> Tissue {
    uniform(LinearElastic::from_young_poisson(10e3, 0.3).unwrap())
}

pub(crate) fn uniform<L: LawFamily>(law: L) -> Tissue {
    Tissue::uniform(law)
}

/// A bar along z, 10 × 10 × 30 cm, of 1000 kg/m³ and the model `recipe`.
pub(crate) fn bar_of(recipe: impl ModelRecipe + 'static) -> Body {
    Body::new(TetMesh::box_grid([2, 2, 6], [0.1, 0.1, 0.3]), 1000.0).model(recipe)
}

pub(crate) fn bar() -> Body {
    bar_of(TotalLagrangian::new(tissue()))
}

/// The bar's lower end.
pub(crate) fn root() -> Region {
    Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0)
}

/// The bar's upper end.
pub(crate) fn tip() -> Region {
    Region::plane([0.0, 0.0, 0.3], [0.0, 0.0, 1.0], 0.0)
}

pub(crate) const NO_GRAVITY: [f64; 3] = [0.0; 3];
pub(crate) const GRAVITY: [f64; 3] = [0.0, -0.5, 0.0];

/// Newton's method to `relative`, linear solves tight enough not to limit it.
pub(crate) fn full(scheme: Scheme, relative: f64) -> Implicit {
    Implicit { newton: Newton::Full { relative, at_most: 60 }, linear: tight(), ..Implicit::accurate(scheme) }
}

pub(crate) fn linearised() -> Implicit {
    Implicit { linear: tight(), ..Implicit::default() }
}

pub(crate) fn tight() -> Stop {
    Stop::Tolerance { relative: 1e-13, at_most: 3000 }
}

pub(crate) fn assembled(settings: Implicit) -> Implicit {
    Implicit { matrix: MatrixForm::Assembled, ..settings }
}

pub(crate) fn multigrid(settings: Implicit) -> Implicit {
    Implicit { preconditioner: Preconditioning::Multigrid, ..settings }
}

pub(crate) fn world<T: Precision>(
    gravity: [f64; 3],
    step: f64,
    integrator: Integrator,
    body: Body,
) -> (World<T>, BodyId) {
    let mut world = World::new(WorldConfig { gravity, step, integrator }).unwrap();
    let id = world.add(body).unwrap();
    (world, id)
}

pub(crate) fn implicit_world(gravity: [f64; 3], step: f64, settings: Implicit, body: Body) -> (World<f64>, BodyId) {
    world(gravity, step, Integrator::Implicit(settings), body)
}

pub(crate) fn run<T: Precision>(world: &mut World<T>, steps: usize) {
    for _ in 0..steps {
        world.step().unwrap();
    }
}

/// The largest distance between two shapes [m].
pub(crate) fn distance(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| (a - b).norm()).fold(0.0, f64::max)
}
