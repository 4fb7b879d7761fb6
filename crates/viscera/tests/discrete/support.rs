use viscera::body::Body;
use viscera::material::{LinearElastic, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, Region, TetMesh};
use viscera::model::Precision;
use viscera::world::{BodyId, World, WorldConfig};

pub(crate) type Vector = Vec3<f64>;

/// Density of the bodies [kg/m³].
pub(crate) const DENSITY: f64 = 1000.0;
/// Their Young's modulus [Pa].
pub(crate) const YOUNG: f64 = 10e3;

pub(crate) fn tissue() -> Tissue {
    Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, 0.4).unwrap())
}

/// A box of 10 × 10 × 30 cm in tetrahedra.
pub(crate) fn bar() -> TetMesh {
    TetMesh::box_grid([2, 2, 6], [0.1, 0.1, 0.3])
}

/// The same in hexahedra.
pub(crate) fn hex_bar() -> HexMesh {
    HexMesh::box_grid([2, 2, 6], [0.1, 0.1, 0.3])
}

/// A region of the bar between two heights.
pub(crate) fn between(low: f64, high: f64) -> Region {
    Region::cuboid([-1.0, -1.0, low - 1e-6], [1.0, 1.0, high + 1e-6])
}

/// A world with one body, in steps of 10 ms.
pub(crate) fn world<T: Precision>(gravity: [f64; 3], body: Body) -> (World<T>, BodyId) {
    let mut world = World::new(WorldConfig { gravity, step: 0.01, ..WorldConfig::default() }).unwrap();
    let id = world.add(body).unwrap();
    (world, id)
}

/// Steps for a time [s].
pub(crate) fn run<T: Precision>(world: &mut World<T>, time: f64) {
    for _ in 0..(time / world.config().step).round() as usize {
        world.step().unwrap_or_else(|error| panic!("{error}"));
    }
}

/// Turns about an axis far from the origin, and drifts.
pub(crate) fn tumbling(x: Vector) -> Vector {
    Vector::new(0.3, -0.2, 0.5) + Vector::new(1.0, 2.0, 0.7).cross(x - Vector::new(0.05, 0.05, 0.15))
}
