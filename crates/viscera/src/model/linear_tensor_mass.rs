//! Linear tensor-mass: small-strain tissue with one stiffness tensor on every vertex and edge.
//!
//! f_p = 2 B_pp u_p + 2 Σ_j B_pj u_j, the linear part of the non-linear tensor-mass model; half the tensors of the usual
//! stiffness matrix, K_pj = 2 B_pj.
//!
//! Source: Cotin, Delingette, Ayache (1999); Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), section 2.

use std::sync::Arc;

use super::sections::SectionScratch;
use super::tensor_mass::{EntityLoop, Frame, LinearEdge, LinearVertex, RestShape};
use super::{BlockSink, ForceModel, GenericRecipe, ModelError, ModelInfo, ModelKind, Precision, Scratch, recipe};
use crate::executor::{NodeBlocks, ReadBlocks, node_blocks};
use crate::material::{LawKind, Tissue};
use crate::math::{Scalar, Vec3, dispatch, dispatch_level};
use crate::mesh::VolumeMesh;

pub(super) const LAWS: &[LawKind] = &[LawKind::LinearElastic, LawKind::TransverseLinear];

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
        moves: true,
        no_implicit: None,
        no_cutting: None,
        tool_limits: None,
    };

    /// A model of `tissue`.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue }
    }
}

impl GenericRecipe for LinearTensorMass {
    const KIND: ModelKind = ModelKind::LinearTensorMass;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        let model = ModelKind::LinearTensorMass;
        let VolumeMesh::Tet(mesh) = mesh else { return Err(ModelError::UnsupportedCells { model }) };
        let advice = "it computes small strains only; take the law `linear`, or the model `tensor-mass`";
        model.check_law(self.tissue.kind(), advice)?;
        let shape = RestShape::new(mesh, &self.tissue)?;
        Ok(Box::new(LinearModel::<T> {
            arms: shape.rest_arms(),
            vertices: shape.assemble_vertices(),
            edges: shape.assemble_edges(),
            removed: vec![false; shape.cell_count()],
            shape: Arc::new(shape),
        }))
    }
}

recipe!(LinearTensorMass);

#[derive(Clone, Debug)]
struct LinearModel<T: Scalar> {
    shape: Arc<RestShape>,
    /// Places at rest, counted from their mean.
    arms: Vec<Vec3<T>>,
    vertices: EntityLoop<T, LinearVertex, 1>,
    edges: EntityLoop<T, LinearEdge, 2>,
    removed: Vec<bool>,
}

impl<T: Scalar> LinearModel<T> {
    /// f = K u for the displacements in the scratch's places.
    fn add_stiffness_times(&self, scratch: &mut Scratch<T>) {
        let SectionScratch { nodal, mut sums, .. } = scratch.sections(self.sum_rows());
        self.vertices.add_forces::<false>(nodal, &mut sums);
        self.edges.add_forces::<false>(nodal, &mut sums);
    }
}

impl<T: Scalar> ForceModel<T> for LinearModel<T> {
    fn name(&self) -> &'static str {
        LinearTensorMass::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        let frame = Frame::along(x);
        let data = (NodeBlocks(&mut scratch.nodal), (ReadBlocks(x), ReadBlocks(&self.arms)));
        scratch.executor.each(node_blocks(x.len()), data, &|_, (nodal, (x, arms))| {
            dispatch!(dispatch_level(), _simd => frame.write_displacements(x.0, arms.0, nodal.0));
        });
        self.add_stiffness_times(scratch);
        scratch.finish(out);
    }

    fn add_product(&self, _x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(dx);
        self.add_stiffness_times(scratch);
        scratch.finish(out);
    }

    fn sum_rows(&self) -> usize {
        self.vertices.sum_rows().max(self.edges.sum_rows())
    }

    fn add_blocks(&self, _x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        self.vertices.add_blocks(&scratch.nodal, sink);
        self.edges.add_blocks(&scratch.nodal, sink);
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let displacement = self.shape.displacements(x, |_| Frame::along(x));
        self.vertices.energy(&displacement) + self.edges.energy(&displacement)
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
