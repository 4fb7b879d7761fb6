//! What must hold for whatever a reader makes of any bytes.

use viscera_io::{Imported, ImportedMesh, ParseError};

/// An error must have words; a mesh must name only nodes that it has, and go through the check, which may refuse it.
pub fn hold_to_its_word(read: Result<Imported, ParseError>) {
    match read {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(Imported { mesh, notices }) => {
            notices.iter().for_each(|notice| assert!(!notice.to_string().is_empty()));
            assert!(mesh.nodes().iter().all(|node| node.is_finite()));
            match mesh {
                ImportedMesh::Tet(mesh) => drop(mesh.checked().map(|(_, report)| report.to_string())),
                ImportedMesh::Hex(mesh) => drop(mesh.checked().map(|(_, report)| report.to_string())),
                ImportedMesh::Surface(mesh) => {
                    let nodes = mesh.nodes.len() as u32;
                    assert!(mesh.triangles.iter().flatten().all(|&node| node < nodes));
                }
            }
        }
    }
}
