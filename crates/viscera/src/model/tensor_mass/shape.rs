//! What a tensor-mass body is at rest: mesh, topology, tissue. It never changes; a cut only takes cells off the tables.

use super::entity::Entity;
use super::entity_loop::{Assembly, EntityLoop};
use super::frame::Frame;
use super::tensors::TetTensors;
use crate::material::{RestStiffness, Tissue};
use crate::math::{Scalar, Vec3};
use crate::mesh::{TET_EDGES, TetMesh, TetTopology};
use crate::model::ModelError;
use crate::model::tet_loop::RestTet;

#[derive(Debug)]
pub(crate) struct RestShape {
    pub(crate) mesh: TetMesh,
    topology: TetTopology,
    tissue: Tissue,
}

impl RestShape {
    /// # Errors
    /// [`ModelError`] for a tissue that does not fit, or a cell without volume.
    pub(crate) fn new(mesh: &TetMesh, tissue: &Tissue) -> Result<Self, ModelError> {
        mesh.check_indices()?;
        tissue.check_count(mesh.cells.len())?;
        for cell in 0..mesh.cells.len() {
            RestTet::new(mesh, cell)?;
        }
        Ok(Self { mesh: mesh.clone(), topology: TetTopology::new(mesh), tissue: tissue.clone() })
    }

    /// Tensors of one tetrahedron.
    pub(crate) fn tensors(&self, cell: usize) -> TetTensors {
        let stiffness: RestStiffness = self.tissue.at_rest(cell);
        TetTensors::new(&RestTet::measure(&self.mesh, cell), &stiffness)
    }

    pub(crate) fn cell_count(&self) -> usize {
        self.mesh.cells.len()
    }

    /// Rest positions in the precision of play.
    pub(crate) fn rest_positions<T: Scalar>(&self) -> Vec<Vec3<T>> {
        self.mesh.nodes.iter().map(|node| node.cast()).collect()
    }

    /// Places at rest, counted from their mean.
    pub(crate) fn rest_arms<T: Scalar>(&self) -> Vec<Vec3<T>> {
        let mean = self.rest_mean();
        self.mesh.nodes.iter().map(|&node| (node - mean).cast()).collect()
    }

    /// The mean place at rest.
    fn rest_mean(&self) -> Vec3<f64> {
        let nodes = &self.mesh.nodes;
        nodes.iter().fold(Vec3::ZERO, |sum, &node| sum + node) / nodes.len().max(1) as f64
    }

    /// Displacements of nodes at `x` as `frame` sees them, in double precision.
    pub(crate) fn displacements<T: Scalar>(
        &self,
        x: &[Vec3<T>],
        frame: impl FnOnce(&mut dyn Iterator<Item = Vec3<f64>>) -> Frame<f64>,
    ) -> impl Fn(u32) -> Vec3<f64> {
        let mean = self.rest_mean();
        let frame = frame(&mut self.mesh.nodes.iter().map(|&node| node - mean));
        move |node: u32| frame.displacement(x[node as usize].cast(), self.mesh.nodes[node as usize] - mean)
    }

    /// Table of the vertices.
    pub(crate) fn assemble_vertices<T: Scalar, E: Entity<1>>(&self) -> EntityLoop<T, E, 1> {
        self.assemble((0..self.mesh.nodes.len() as u32).map(|node| [node]).collect(), |shape, cell| {
            shape.cell_vertices(cell)
        })
    }

    /// Table of the edges.
    pub(crate) fn assemble_edges<T: Scalar, E: Entity<2>>(&self) -> EntityLoop<T, E, 2> {
        self.assemble(self.topology.edges.clone(), Self::cell_edges)
    }

    /// Table of the triangles.
    pub(crate) fn assemble_triangles<T: Scalar, E: Entity<3>>(&self) -> EntityLoop<T, E, 3> {
        self.assemble(self.topology.faces.iter().map(|face| face.nodes).collect(), Self::cell_triangles)
    }

    /// Table of the tetrahedra.
    pub(crate) fn assemble_tetrahedra<T: Scalar, E: Entity<4>>(&self) -> EntityLoop<T, E, 4> {
        self.assemble(self.mesh.cells.clone(), |_, cell| [(cell, [0, 1, 2, 3])])
    }

    fn assemble<T: Scalar, E: Entity<NODES>, const NODES: usize, const COUNT: usize>(
        &self,
        nodes: Vec<[u32; NODES]>,
        entities: impl Fn(&Self, usize) -> [(usize, [usize; NODES]); COUNT],
    ) -> EntityLoop<T, E, NODES> {
        let mut assembly = Assembly::<E, NODES>::new(nodes);
        for cell in 0..self.cell_count() {
            let tensors = self.tensors(cell);
            for (entity, at) in entities(self, cell) {
                assembly.add(entity, &tensors, at);
            }
        }
        assembly.finish(self.mesh.nodes.len())
    }

    /// The vertices of a cell, each with the local corner that it is.
    pub(crate) fn cell_vertices(&self, cell: usize) -> [(usize, [usize; 1]); 4] {
        let corners = self.mesh.cells[cell];
        [0, 1, 2, 3].map(|i| (corners[i] as usize, [i]))
    }

    /// The edges of a cell, each with the local corners that its ends are: an edge runs from the smaller node number.
    pub(crate) fn cell_edges(&self, cell: usize) -> [(usize, [usize; 2]); 6] {
        let corners = self.mesh.cells[cell];
        let edges = self.topology.cell_edges[cell];
        std::array::from_fn(|e| {
            let [i, j] = TET_EDGES[e];
            (edges[e] as usize, if corners[i] < corners[j] { [i, j] } else { [j, i] })
        })
    }

    /// The triangles of a cell, each with the local corners that its corners are.
    pub(crate) fn cell_triangles(&self, cell: usize) -> [(usize, [usize; 3]); 4] {
        let corners = self.mesh.cells[cell];
        self.topology.cell_faces[cell].map(|face| {
            let nodes = self.topology.faces[face as usize].nodes;
            let local = |node| corners.iter().position(|&corner| corner == node).unwrap_or_default();
            (face as usize, nodes.map(local))
        })
    }
}
