use crate::mesh::VolumeMesh;
use crate::solver::Filter;

/// What holds a body: what its responses depend on besides its tissue.
#[derive(Clone, Copy, Debug)]
pub struct Supports<'a> {
    /// The rest shape.
    pub mesh: &'a VolumeMesh,
    /// The directions in which forces move each node.
    pub filters: &'a [Filter<f64>],
}

impl Supports<'_> {
    /// A checksum of nodes and cells.
    pub(super) fn mesh_checksum(&self) -> u32 {
        let mut hasher = crc32fast::Hasher::new();
        for number in self.mesh.nodes().iter().flat_map(|node| node.to_array()) {
            hasher.update(&number.to_bits().to_le_bytes());
        }
        for cell in 0..self.mesh.cell_count() {
            self.mesh.cell(cell).iter().for_each(|node| hasher.update(&node.to_le_bytes()));
        }
        hasher.finalize()
    }

    /// A checksum of what is held, in which directions.
    pub(super) fn held_checksum(&self) -> u32 {
        let mut hasher = crc32fast::Hasher::new();
        for (node, filter) in self.filters.iter().enumerate() {
            let (kind, normals) = match *filter {
                Filter::Free => continue,
                Filter::Plane(p) => (1_u8, vec![p]),
                Filter::Line(p, q) => (2, vec![p, q]),
                Filter::Held => (3, Vec::new()),
            };
            hasher.update(&(node as u32).to_le_bytes());
            hasher.update(&[kind]);
            normals.iter().flat_map(|normal| normal.to_array()).for_each(|x| hasher.update(&x.to_bits().to_le_bytes()));
        }
        hasher.finalize()
    }

    /// Nodes of the surface that forces move, in whichever directions; ascending.
    pub(super) fn free_surface(&self) -> Vec<u32> {
        let triangles = match self.mesh {
            VolumeMesh::Tet(mesh) => mesh.surface().triangles,
            VolumeMesh::Hex(mesh) => mesh.surface().triangles,
        };
        let mut nodes: Vec<u32> = triangles.into_iter().flatten().collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.retain(|&node| self.filters[node as usize] != Filter::Held);
        nodes
    }
}
