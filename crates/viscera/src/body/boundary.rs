use crate::mesh::{Face, TetTopology, VolumeMesh};

/// The faces that are, or may become, surface: triangles, and the cells on their two sides.
#[derive(Clone, Debug)]
pub(crate) struct Boundary {
    pub(super) faces: Vec<Face>,
}

/// A triangle of the current surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceTriangle {
    /// Corners, counter-clockwise seen from outside.
    pub nodes: [u32; 3],
    /// Whether a cut has laid it open.
    pub cut: bool,
}

impl Boundary {
    pub(super) fn new(mesh: &VolumeMesh) -> Self {
        let faces = match mesh {
            VolumeMesh::Tet(mesh) => TetTopology::new(mesh).faces,
            VolumeMesh::Hex(mesh) => {
                let halves = |face: Face<4>| {
                    let [a, b, c, d] = face.nodes;
                    [[a, b, c], [a, c, d]].map(|nodes| Face { nodes, cells: face.cells })
                };
                mesh.faces().into_iter().flat_map(halves).collect()
            }
        };
        Self { faces }
    }

    pub(super) fn surface<'a>(&'a self, removed: &'a [bool]) -> impl Iterator<Item = SurfaceTriangle> + 'a {
        (0..self.faces.len() as u32).filter_map(|face| self.triangle(face, removed))
    }

    /// The triangle of the surface that a face is now; none inside of the body, and in the void.
    pub(super) fn triangle(&self, face: u32, removed: &[bool]) -> Option<SurfaceTriangle> {
        let Face { nodes: [a, b, c], cells: (first, second) } = self.faces[face as usize];
        let there = |cell: u32| !removed[cell as usize];
        match (there(first), second.map(there)) {
            (true, None) => Some(SurfaceTriangle { nodes: [a, b, c], cut: false }),
            (true, Some(false)) => Some(SurfaceTriangle { nodes: [a, b, c], cut: true }),
            (false, Some(true)) => Some(SurfaceTriangle { nodes: [a, c, b], cut: true }),
            _ => None,
        }
    }
}
