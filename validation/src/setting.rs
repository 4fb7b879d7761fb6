//! What the studies share: planes to hold bodies by, kinds of cells, and bringing a body to rest.

use viscera::body::Body;
use viscera::dynamics::quasi_static::{QuasiStatic, StaticReport};
use viscera::material::Tissue;
use viscera::mesh::{CubeCut, HexMesh, Region, TetMesh, VolumeMesh};
use viscera::model::{NodallyIntegrated, TotalLagrangian};
use viscera::world::{BodyId, World, WorldConfig};
use viscera_direct::Cholesky;

use crate::ValidationError;
use crate::references::Vector;

/// The plane through `point` across axis 0, 1 or 2.
pub fn plane(axis: usize, at: f64) -> Region {
    let (mut point, mut normal) = ([0.0; 3], [0.0; 3]);
    point[axis] = at;
    normal[axis] = 1.0;
    Region::plane(point, normal, 1e-9 * at.abs())
}

/// How a box is filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cells {
    /// Six tetrahedra to a cell.
    Six,
    /// Two cuts into five, one over the other, each with half of the stiffness and density.
    Ten,
    /// Hexahedra.
    Hexahedra,
}

impl Cells {
    pub(crate) fn fill(self, cells: [usize; 3], size: [f64; 3]) -> VolumeMesh {
        match self {
            Self::Six => TetMesh::box_grid(cells, size).into(),
            Self::Ten => TetMesh::box_grid_cut(cells, size, CubeCut::Ten).into(),
            Self::Hexahedra => HexMesh::box_grid(cells, size).into(),
        }
    }

    /// Share of stiffness and density in each of superposed cells.
    pub(crate) fn share(self) -> f64 {
        if self == Self::Ten { 0.5 } else { 1.0 }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Six => "6 tetrahedra",
            Self::Ten => "10 tetrahedra",
            Self::Hexahedra => "hexahedra",
        }
    }
}

/// A kind of element: cells, and whether the law is asked in them or at the nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Element {
    pub(crate) cells: Cells,
    /// Whether it is integrated at the nodes.
    pub nodal: bool,
}

impl Element {
    /// Plain tetrahedra in two cuts, hexahedra, and tetrahedra integrated at the nodes.
    pub(crate) const ALL: [Self; 5] = [
        Self { cells: Cells::Six, nodal: false },
        Self { cells: Cells::Ten, nodal: false },
        Self { cells: Cells::Hexahedra, nodal: false },
        Self { cells: Cells::Six, nodal: true },
        Self { cells: Cells::Ten, nodal: true },
    ];

    /// Its name in tables.
    pub fn name(self) -> String {
        let how = if self.nodal { ", integrated at the nodes" } else { "" };
        format!("{}{how}", self.cells.name())
    }

    /// A body of `tissue`, which nodes can be asked for.
    pub(crate) fn body(self, mesh: VolumeMesh, density: f64, tissue: Tissue) -> Body {
        let body = Body::new(mesh, density);
        if self.nodal { body.model(NodallyIntegrated::new(tissue)) } else { body.model(TotalLagrangian::new(tissue)) }
    }
}

/// A body at rest, and how it came there.
pub struct Settled {
    /// The world that it is alone in.
    pub world: World<f64>,
    /// Its number there.
    pub id: BodyId,
    /// How Newton's method went; nothing if it came to rest otherwise.
    pub report: StaticReport,
}

impl Settled {
    /// Brings `body` to rest under `gravity` [m/s²].
    ///
    /// # Errors
    /// [`ValidationError`] where the body makes no sense or no equilibrium is found.
    pub fn new(body: Body, gravity: [f64; 3], settings: &QuasiStatic) -> Result<Self, ValidationError> {
        let mut world = World::new(WorldConfig { gravity, ..WorldConfig::default() })?;
        let id = world.add(body)?;
        let report = world.settle(id, settings, &mut Cholesky::default())?;
        Ok(Self { world, id, report })
    }

    /// A body that came to rest by itself.
    pub(crate) fn already(world: World<f64>, id: BodyId) -> Self {
        Self { world, id, report: StaticReport { steps: Vec::new(), retries: 0 } }
    }

    /// Displacements from rest [m].
    pub fn displacements(&self) -> Vec<Vector> {
        let body = self.world.body(self.id);
        body.positions().iter().zip(body.mesh().nodes()).map(|(&x, &rest)| x - rest).collect()
    }

    /// Displacement [m] of the node that rests nearest to `place`.
    pub fn displacement_at(&self, place: Vector) -> Vector {
        let body = self.world.body(self.id);
        let nodes = body.mesh().nodes();
        let away = |node: &usize| (nodes[*node] - place).squared_norm();
        let nearest = (0..nodes.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0);
        body.positions()[nearest] - nodes[nearest]
    }
}

/// Largest difference over the largest of `expected`.
pub(crate) fn largest_difference(actual: &[Vector], expected: &[Vector]) -> f64 {
    let largest = expected.iter().map(|u| u.norm()).fold(0.0, f64::max);
    actual.iter().zip(expected).map(|(&a, &e)| (a - e).norm()).fold(0.0, f64::max) / largest
}
