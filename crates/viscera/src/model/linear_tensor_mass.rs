//! Linear tensor-mass: small-strain tissue with one stiffness tensor on every vertex and edge.
//!
//! f_p = 2 B_pp u_p + 2 Σ_j B_pj u_j, the linear part of the non-linear tensor-mass model; half the tensors of the usual
//! stiffness matrix, K_pj = 2 B_pj.
//!
//! Source: Cotin, Delingette, Ayache (1999); Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), section 2.

use std::sync::Arc;

use super::tensor_mass::{EntityLoop, LinearEdge, LinearVertex, RestShape};
use super::{BlockSink, ForceModel, ModelError, ModelInfo, ModelKind, ModelRecipe, Scratch};
use crate::material::{LawKind, Tissue};
use crate::math::{Scalar, Vec3};
use crate::mesh::VolumeMesh;

const LAWS: &[LawKind] = &[LawKind::LinearElastic, LawKind::TransverseLinear];

/// The linear tensor-mass model of linear tissue, with or without fibres, on tetrahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearTensorMass {
    tissue: Tissue,
}

impl LinearTensorMass {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "linear-tensor-mass",
        purpose: "small displacements at the lowest cost; swells when it is bent or turned",
        hexahedra: false,
        laws: LAWS,
    };

    /// A model of `tissue`.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue }
    }
}

impl ModelRecipe for LinearTensorMass {
    fn kind(&self) -> ModelKind {
        ModelKind::LinearTensorMass
    }

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build_single(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<f32>>, ModelError> {
        self.build(mesh)
    }

    fn build_double(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<f64>>, ModelError> {
        self.build(mesh)
    }
}

impl LinearTensorMass {
    fn build<T: Scalar>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        let model = ModelKind::LinearTensorMass;
        let VolumeMesh::Tet(mesh) = mesh else { return Err(ModelError::UnsupportedCells { model }) };
        if !LAWS.contains(&self.tissue.kind()) {
            let advice = "it computes small strains only; take the law `linear`, or the model `tensor-mass`";
            return Err(ModelError::UnsupportedLaw { model, law: self.tissue.kind(), advice });
        }
        let shape = RestShape::new(mesh, &self.tissue)?;
        Ok(Box::new(LinearModel::<T> {
            rest: shape.rest_positions(),
            vertices: shape.assemble_vertices(),
            edges: shape.assemble_edges(),
            removed: vec![false; shape.cell_count()],
            shape: Arc::new(shape),
        }))
    }
}

#[derive(Clone, Debug)]
struct LinearModel<T: Scalar> {
    shape: Arc<RestShape>,
    rest: Vec<Vec3<T>>,
    vertices: EntityLoop<T, LinearVertex, 1>,
    edges: EntityLoop<T, LinearEdge, 2>,
    removed: Vec<bool>,
}

impl<T: Scalar> LinearModel<T> {
    /// f = K u for the displacements in `nodal`.
    fn add_stiffness_times(&self, nodal: &[[T; 4]], out: &mut [[T; 4]]) {
        self.vertices.add_forces::<false>(nodal, out);
        self.edges.add_forces::<false>(nodal, out);
    }
}

impl<T: Scalar> ForceModel<T> for LinearModel<T> {
    fn name(&self) -> &'static str {
        LinearTensorMass::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        let Scratch { nodal, forces, .. } = scratch;
        for (row, rest) in nodal.iter_mut().zip(&self.rest) {
            *row = [row[0] - rest.x, row[1] - rest.y, row[2] - rest.z, T::ONE];
        }
        self.add_stiffness_times(nodal, forces);
        scratch.finish(out);
    }

    fn add_product(&self, _x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(dx);
        let Scratch { nodal, forces, .. } = scratch;
        self.add_stiffness_times(nodal, forces);
        scratch.finish(out);
    }

    fn add_blocks(&self, _x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        self.vertices.add_blocks(&scratch.nodal, sink);
        self.edges.add_blocks(&scratch.nodal, sink);
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let displacement = |node: u32| x[node as usize].cast::<f64>() - self.shape.mesh.nodes[node as usize];
        self.vertices.energy(displacement) + self.edges.energy(displacement)
    }

    fn remove(&mut self, cells: &[u32]) {
        for cell in cells.iter().map(|&cell| cell as usize) {
            if std::mem::replace(&mut self.removed[cell], true) {
                continue;
            }
            let tensors = self.shape.tensors(cell);
            for (vertex, at) in self.shape.cell_vertices(cell) {
                self.vertices.subtract(vertex, &tensors, at);
            }
            for (edge, at) in self.shape.cell_edges(cell) {
                self.edges.subtract(edge, &tensors, at);
            }
        }
    }

    fn is_nonlinear_at(&self, _displacement: Vec3<T>) -> bool {
        false
    }

    fn bytes(&self) -> usize {
        self.vertices.bytes() + self.edges.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}
