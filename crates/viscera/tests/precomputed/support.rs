//! Blocks of linear tissue that stand on a fixed face, pre-computed and in full.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::executor::Executor;
use viscera::material::{LinearElastic, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, Region, TetMesh, VolumeMesh};
use viscera::model::precomputed::Responses;
use viscera::model::{LinearTensorMass, Precomputed, TotalLagrangian};
use viscera::solver::{Envelope, Iterative};
use viscera::world::{BodyId, Integrator, World, WorldConfig};

pub(crate) type Vector = Vec3<f64>;

pub(crate) const SIZE: [f64; 3] = [0.08, 0.06, 0.10];

/// Numbers between −1 and 1, always the same.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new() -> Self {
        Self(11)
    }

    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    }

    pub(crate) fn vector(&mut self) -> Vector {
        Vector::new(self.number(), self.number(), self.number())
    }
}

pub(crate) fn tissue(young: f64) -> Tissue {
    Tissue::uniform(LinearElastic::from_young_poisson(young, 0.42).unwrap())
}

/// A block of tetrahedra without any regularity.
pub(crate) fn tetrahedra() -> VolumeMesh {
    let mut mesh = TetMesh::box_grid([3, 3, 5], SIZE);
    let mut random = Random::new();
    // The lowest nodes stay in their plane, which is fixed.
    mesh.nodes.iter_mut().filter(|node| node.z > 0.0).for_each(|node| *node += random.vector() * 1.5e-3);
    mesh.into()
}

pub(crate) fn hexahedra() -> VolumeMesh {
    HexMesh::box_grid([3, 3, 4], SIZE).into()
}

pub(crate) fn bottom() -> Region {
    Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0)
}

pub(crate) fn top() -> Region {
    Region::HalfSpace { point: Vector::new(0.0, 0.0, 0.9 * SIZE[2]), normal: Vector::new(0.0, 0.0, 1.0) }
}

/// A block that is held by nothing yet.
pub(crate) fn loose(mesh: VolumeMesh) -> Body {
    Body::new(mesh, 1000.0).name("block").model(Precomputed::new(tissue(6e3)))
}

/// A block that stands on its fixed lower face.
pub(crate) fn standing(mesh: VolumeMesh) -> Body {
    loose(mesh).fix(bottom())
}

/// The same with a model that knows nothing of responses.
pub(crate) fn in_full(body: Body, hexahedra: bool) -> Body {
    if hexahedra {
        body.model(TotalLagrangian::new(tissue(6e3)))
    } else {
        body.model(LinearTensorMass::new(tissue(6e3)))
    }
}

pub(crate) fn responses(body: &Body) -> Responses {
    body.precompute(&mut Envelope::default(), &Executor::serial(), &|_, _| ()).unwrap()
}

pub(crate) fn world(gravity: [f64; 3], integrator: Integrator) -> World<f64> {
    World::new(WorldConfig { gravity, step: 0.01, integrator }).unwrap()
}

pub(crate) fn run(world: &mut World<f64>, steps: usize) {
    for _ in 0..steps {
        world.step().unwrap();
    }
}

/// The static solution in full: one linear solve, as far as double precision goes.
pub(crate) fn solved(body: Body, gravity: [f64; 3]) -> (World<f64>, BodyId) {
    let mut world = world(gravity, Integrator::default());
    let id = world.add(body).unwrap();
    let settings = QuasiStatic { small_strain: true, ..QuasiStatic::default() };
    world.settle(id, &settings, &mut Iterative::new(1e-13)).unwrap();
    (world, id)
}

pub(crate) fn displacements(world: &World<f64>, id: BodyId) -> Vec<Vector> {
    let body = world.body(id);
    body.positions().iter().zip(body.mesh().nodes()).map(|(&now, &rest)| now - rest).collect()
}

/// Imposes displacements on nodes for good.
pub(crate) fn prescribed(body: Body, nodes: &[u32], ways: &[Vector]) -> Body {
    let pairs = nodes.iter().zip(ways);
    pairs.fold(body, |body, (&node, &way)| body.prescribe(Region::Nodes(vec![node]), Curve::constant(way)))
}

/// The largest difference of two lists of vectors, over the largest of the second.
pub(crate) fn difference(a: &[Vector], b: &[Vector]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = |values: &mut dyn Iterator<Item = Vector>| values.map(|v| v.norm()).fold(0.0, f64::max);
    largest(&mut a.iter().zip(b).map(|(&a, &b)| a - b)) / largest(&mut b.iter().copied())
}
