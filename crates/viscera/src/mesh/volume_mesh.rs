use std::collections::BTreeMap;

use super::{MeshError, NamedRegion, Point};
use crate::math::Mat3;

/// Nodes, cells and named regions; `CORNERS` nodes to a cell, `FACE` nodes to a face.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh<const CORNERS: usize, const FACE: usize> {
    /// Rest positions [m].
    pub nodes: Vec<Point>,
    /// Corners of every cell.
    pub cells: Vec<[u32; CORNERS]>,
    /// Named parts, by name.
    pub regions: BTreeMap<String, NamedRegion<FACE>>,
}

/// A mesh of tetrahedra with four corners.
pub type TetMesh = Mesh<4, 3>;
/// A mesh of hexahedra with eight corners.
pub type HexMesh = Mesh<8, 4>;

/// The six edges of a tetrahedron, as pairs of local corners.
pub const TET_EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
/// The four faces of a tetrahedron, face `i` opposite to corner `i`, counter-clockwise seen from outside.
pub const TET_FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
/// The twelve edges of a hexahedron, as pairs of local corners.
pub const HEX_EDGES: [[usize; 2]; 12] =
    [[0, 1], [3, 2], [4, 5], [7, 6], [0, 3], [1, 2], [4, 7], [5, 6], [0, 4], [1, 5], [2, 6], [3, 7]];
/// The six faces of a hexahedron, counter-clockwise seen from outside.
pub const HEX_FACES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

impl<const CORNERS: usize, const FACE: usize> Mesh<CORNERS, FACE> {
    /// A mesh without named regions.
    pub fn new(nodes: Vec<Point>, cells: Vec<[u32; CORNERS]>) -> Self {
        Self { nodes, cells, regions: BTreeMap::new() }
    }

    /// Positions of the corners of a cell [m].
    pub fn corners(&self, cell: usize) -> [Point; CORNERS] {
        self.cells[cell].map(|node| self.nodes[node as usize])
    }

    /// Smallest and largest coordinates [m]; (0, 0) for a mesh without nodes.
    pub fn bounds(&self) -> (Point, Point) {
        let Some(&first) = self.nodes.first() else { return (Point::ZERO, Point::ZERO) };
        self.nodes.iter().fold((first, first), |(low, high), &node| (low.min(node), high.max(node)))
    }

    /// Length of the diagonal of the bounding box [m]: the size against which tolerances are relative.
    pub fn size(&self) -> f64 {
        let (low, high) = self.bounds();
        (high - low).norm()
    }

    /// Checks that there are cells, that their nodes exist and that every coordinate is finite.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::MissingNode`] or [`MeshError::NotFinite`], naming the first offender.
    pub fn check_indices(&self) -> Result<(), MeshError> {
        if self.cells.is_empty() {
            return Err(MeshError::Empty);
        }
        if let Some(node) = self.nodes.iter().position(|node| !node.is_finite()) {
            return Err(MeshError::NotFinite { node, position: self.nodes[node].to_array() });
        }
        for (cell, corners) in self.cells.iter().enumerate() {
            if let Some(&node) = corners.iter().find(|&&node| node as usize >= self.nodes.len()) {
                return Err(MeshError::MissingNode { cell, node: node as usize, nodes: self.nodes.len() });
            }
        }
        Ok(())
    }
}

impl TetMesh {
    /// Edge matrix [x1−x0, x2−x0, x3−x0] of a cell [m].
    pub fn edge_matrix(&self, cell: usize) -> Mat3<f64> {
        let [a, b, c, d] = self.cells[cell];
        let at = |node: u32| self.nodes[node as usize];
        Mat3::from_columns(at(b) - at(a), at(c) - at(a), at(d) - at(a))
    }

    /// Signed volume of a cell [m³].
    pub fn cell_volume(&self, cell: usize) -> f64 {
        self.edge_matrix(cell).determinant() / 6.0
    }

    /// Sum of the signed volumes of all cells [m³].
    pub fn volume(&self) -> f64 {
        (0..self.cells.len()).map(|cell| self.cell_volume(cell)).sum()
    }
}

/// A mesh of either kind of cell: what a body is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum VolumeMesh {
    /// Tetrahedra.
    Tet(TetMesh),
    /// Hexahedra.
    Hex(HexMesh),
}

impl From<TetMesh> for VolumeMesh {
    fn from(mesh: TetMesh) -> Self {
        Self::Tet(mesh)
    }
}

impl From<HexMesh> for VolumeMesh {
    fn from(mesh: HexMesh) -> Self {
        Self::Hex(mesh)
    }
}

impl VolumeMesh {
    /// Rest positions [m].
    pub fn nodes(&self) -> &[Point] {
        match self {
            Self::Tet(mesh) => &mesh.nodes,
            Self::Hex(mesh) => &mesh.nodes,
        }
    }

    /// How many cells there are.
    pub fn cell_count(&self) -> usize {
        match self {
            Self::Tet(mesh) => mesh.cells.len(),
            Self::Hex(mesh) => mesh.cells.len(),
        }
    }

    /// Corners of a cell.
    pub fn cell(&self, cell: usize) -> &[u32] {
        match self {
            Self::Tet(mesh) => &mesh.cells[cell],
            Self::Hex(mesh) => &mesh.cells[cell],
        }
    }

    /// Smallest and largest coordinates [m].
    pub fn bounds(&self) -> (Point, Point) {
        match self {
            Self::Tet(mesh) => mesh.bounds(),
            Self::Hex(mesh) => mesh.bounds(),
        }
    }

    /// Length of the diagonal of the bounding box [m].
    pub fn size(&self) -> f64 {
        match self {
            Self::Tet(mesh) => mesh.size(),
            Self::Hex(mesh) => mesh.size(),
        }
    }

    /// Checks that there are cells, that their nodes exist and that every coordinate is finite.
    ///
    /// # Errors
    /// As [`Mesh::check_indices`].
    pub fn check_indices(&self) -> Result<(), MeshError> {
        match self {
            Self::Tet(mesh) => mesh.check_indices(),
            Self::Hex(mesh) => mesh.check_indices(),
        }
    }
}
