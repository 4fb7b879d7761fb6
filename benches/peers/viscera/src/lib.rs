//! The beam in Viscera: as one of those compared, and brought to rest in double precision as what all are measured against.

mod beam;
mod reference;
mod variant;

pub use beam::Viscera;
pub use reference::{Reference, deflection};
pub use variant::Variant;

use viscera::mesh::TetMesh;
use viscera_peers_protocol::{Case, Mesh};

/// The mesh that everybody runs: six tetrahedra to a cube.
pub fn mesh(case: &Case, cells: [usize; 3]) -> Mesh {
    let grid = TetMesh::box_grid(cells, case.beam.size);
    Mesh { nodes: grid.nodes.iter().map(|node| node.to_array()).collect(), cells: grid.cells }
}

/// The same mesh for the engine.
fn tetrahedra(mesh: &Mesh) -> TetMesh {
    TetMesh::new(mesh.nodes.iter().map(|&node| node.into()).collect(), mesh.cells.clone())
}
