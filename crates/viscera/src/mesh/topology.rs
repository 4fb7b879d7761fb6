use rustc_hash::{FxBuildHasher, FxHashMap};

use super::{HexMesh, Mesh, SurfaceMesh, TET_EDGES, TET_FACES, TetMesh};

/// A face between two cells, or between one and the outside: a triangle, or a quadrilateral of a hexahedral mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face<const CORNERS: usize = 3> {
    /// Corners, counter-clockwise seen from outside the first cell.
    pub nodes: [u32; CORNERS],
    /// The cells on its two sides; the second is absent on the surface.
    pub cells: (u32, Option<u32>),
}

/// Unique edges and faces of a tetrahedral mesh and who meets whom.
///
/// Edges run from the smaller to the larger node number; faces keep the orientation of the tetrahedron that has them
/// first. Numbers are given in the order in which the cells meet them, so equal meshes have equal topologies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetTopology {
    /// Edges [from, to] with from < to.
    pub edges: Vec<[u32; 2]>,
    /// Faces.
    pub faces: Vec<Face>,
    /// The six edges of every cell, in the order of [`TET_EDGES`].
    pub cell_edges: Vec<[u32; 6]>,
    /// The four faces of every cell, face `i` opposite to corner `i`.
    pub cell_faces: Vec<[u32; 4]>,
    /// Faces that more than two cells share, with the third and further cells: empty in a proper mesh.
    pub overshared_faces: Vec<(u32, u32)>,
}

impl TetTopology {
    /// Finds edges and faces.
    pub fn new(mesh: &TetMesh) -> Self {
        let mut topology = Self::default();
        // Hashes that nobody can foresee, those of the standard library, take as long again.
        let mut edge_of = FxHashMap::with_capacity_and_hasher(mesh.cells.len() * 2, FxBuildHasher);
        let mut face_of: FxHashMap<[u32; 3], u32> =
            FxHashMap::with_capacity_and_hasher(mesh.cells.len() * 2, FxBuildHasher);
        for (cell, corners) in mesh.cells.iter().enumerate() {
            topology.cell_edges.push(TET_EDGES.map(|[i, j]| {
                let key = [corners[i].min(corners[j]), corners[i].max(corners[j])];
                *edge_of.entry(key).or_insert_with(|| {
                    topology.edges.push(key);
                    topology.edges.len() as u32 - 1
                })
            }));
            let mut cell_faces = [0; 4];
            for (slot, local) in cell_faces.iter_mut().zip(TET_FACES) {
                let nodes = local.map(|i| corners[i]);
                let mut key = nodes;
                key.sort_unstable();
                *slot = *face_of.entry(key).or_insert_with(|| {
                    topology.faces.push(Face { nodes, cells: (u32::MAX, None) });
                    topology.faces.len() as u32 - 1
                });
                let cells = &mut topology.faces[*slot as usize].cells;
                match cells {
                    (first, None) if *first == u32::MAX => *first = cell as u32,
                    (_, second @ None) => *second = Some(cell as u32),
                    _ => topology.overshared_faces.push((*slot, cell as u32)),
                }
            }
            topology.cell_faces.push(cell_faces);
        }
        topology
    }

    /// Corners of the surface triangles, counter-clockwise seen from outside.
    pub fn surface(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.faces.iter().filter(|face| face.cells.1.is_none()).map(|face| face.nodes)
    }

    /// The tetrahedron across each face of `cell`, where there is one.
    pub fn neighbours(&self, cell: usize) -> [Option<u32>; 4] {
        self.cell_faces[cell].map(|face| match self.faces[face as usize].cells {
            (first, second) if first == cell as u32 => second,
            (first, _) => Some(first),
        })
    }
}

/// Which cells meet at each node: the cells of node `n` are `cells[starts[n]..starts[n + 1]]`, ascending.
pub fn cells_of_nodes<const CORNERS: usize, const FACE: usize>(mesh: &Mesh<CORNERS, FACE>) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; mesh.nodes.len() + 1];
    for &node in mesh.cells.iter().flatten() {
        starts[node as usize + 1] += 1;
    }
    for node in 0..mesh.nodes.len() {
        starts[node + 1] += starts[node];
    }
    let mut cursor = starts.clone();
    let mut cells = vec![0u32; mesh.cells.len() * CORNERS];
    for (cell, corners) in mesh.cells.iter().enumerate() {
        for &node in corners {
            cells[cursor[node as usize] as usize] = cell as u32;
            cursor[node as usize] += 1;
        }
    }
    (starts, cells)
}

impl TetMesh {
    /// The outward surface; nodes keep their numbers.
    pub fn surface(&self) -> SurfaceMesh {
        SurfaceMesh { nodes: self.nodes.clone(), triangles: TetTopology::new(self).surface().collect() }
    }
}

impl HexMesh {
    /// Every face once, in the order in which the cells meet them.
    pub fn faces(&self) -> Vec<Face<4>> {
        let mut faces: Vec<Face<4>> = Vec::new();
        let mut face_of: FxHashMap<[u32; 4], usize> =
            FxHashMap::with_capacity_and_hasher(self.cells.len() * 4, FxBuildHasher);
        for (cell, corners) in self.cells.iter().enumerate() {
            for local in super::HEX_FACES {
                let nodes = local.map(|i| corners[i]);
                let mut key = nodes;
                key.sort_unstable();
                match face_of.get(&key) {
                    Some(&face) => faces[face].cells.1 = Some(cell as u32),
                    None => {
                        face_of.insert(key, faces.len());
                        faces.push(Face { nodes, cells: (cell as u32, None) });
                    }
                }
            }
        }
        faces
    }

    /// Corners of the surface quadrilaterals, counter-clockwise seen from outside.
    pub fn surface_quads(&self) -> Vec<[u32; 4]> {
        self.faces().into_iter().filter(|face| face.cells.1.is_none()).map(|face| face.nodes).collect()
    }

    /// The outward surface, each quadrilateral cut into two triangles; nodes keep their numbers.
    pub fn surface(&self) -> SurfaceMesh {
        let triangles = self.surface_quads().into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        SurfaceMesh { nodes: self.nodes.clone(), triangles }
    }
}
