//! Non-linear tensor-mass: St Venant–Kirchhoff tissue whose forces are polynomials of the displacements, with
//! coefficients summed over the tetrahedra on every vertex, edge, triangle and tetrahedron, once, before the run.
//!
//! f_p = 2 Σ_j B_pj u_j + Σ_jk [2 (C_jkp·u_j) u_k + (u_j·u_k) C_pjk] + 4 Σ_jkl D_jklp (u_j·u_k) u_l
//!
//! Removing a tetrahedron subtracts its tensors from the entities that it touches: 280 numbers, whatever the size of the
//! mesh. In the adaptive form only the linear part is applied at a vertex whose displacement is below a threshold.
//!
//! The polynomials run over displacements in a frame that follows the body. Where a part of it moves or turns against the
//! rest, their terms cancel: of the precision about (|u|/h)³ roundings are lost, with h the size of a cell. In single
//! precision a piece cut off that wanders away by a hundred cells has lost a few per cent of its forces: take
//! [`TotalLagrangian`](super::TotalLagrangian) for that.
//!
//! Source: Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), sections 3, 5 and 6, with misprints corrected.

mod entity;
mod entity_loop;
mod frame;
mod shape;
mod tensors;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use self::entity::{Edge, Tetrahedron, Triangle, Vertex};
pub(crate) use self::entity::{LinearEdge, LinearVertex};
pub(crate) use self::entity_loop::EntityLoop;
pub(crate) use self::frame::Frame;
pub(crate) use self::shape::RestShape;
use super::sections::{SectionScratch, SectionSums};
use super::{BlockSink, ForceModel, GenericRecipe, ModelError, ModelInfo, ModelKind, Precision, Scratch, recipe};
use crate::executor::{NodeBlocks, ReadBlocks, node_blocks};
use crate::material::{LawKind, Tissue};
use crate::math::{Scalar, Vec3};
use crate::mesh::VolumeMesh;

const LAWS: &[LawKind] = &[LawKind::StVenantKirchhoff, LawKind::TransverseStVenantKirchhoff];

/// The non-linear tensor-mass model of St Venant–Kirchhoff tissue, with or without fibres, on tetrahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorMass {
    tissue: Tissue,
    threshold: Option<f64>,
}

impl TensorMass {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "tensor-mass",
        purpose: "large displacements from tables on vertices, edges, triangles and tetrahedra; can be adaptive",
        hexahedra: false,
        laws: LAWS,
        moves: true,
        no_implicit: None,
        no_cutting: None,
        tool_limits: None,
    };

    /// A model of `tissue`.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue, threshold: None }
    }

    /// Applies only the linear part of the force at vertices displaced by less than `threshold` [m, > 0].
    ///
    /// The forces are then neither balanced nor the gradient of an energy near the border between the two kinds, and can
    /// feed motion: with a threshold of more than a cell, damp the body well (a liver with a threshold of 2 cm ran away at
    /// a damping of 20 1/s in cells of 14 mm, and was calm in cells of 20 mm). Leaving the non-linear part of whole edges, triangles and
    /// tetrahedra out instead would balance the forces, but not keep them the same when the body is shifted: that is worse.
    pub fn adaptive(self, threshold: f64) -> Self {
        Self { threshold: Some(threshold), ..self }
    }
}

impl GenericRecipe for TensorMass {
    const KIND: ModelKind = ModelKind::TensorMass;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        let model = ModelKind::TensorMass;
        let VolumeMesh::Tet(mesh) = mesh else { return Err(ModelError::UnsupportedCells { model }) };
        let advice = "it is made for St Venant-Kirchhoff laws; take `linear-tensor-mass` for linear ones and \
                      `total-lagrangian` for the rest";
        model.check_law(self.tissue.kind(), advice)?;
        if let Some(value) = self.threshold.filter(|value| !(value.is_finite() && *value > 0.0)) {
            return Err(ModelError::OutOfRange { name: "adaptive", value, range: "positive [m]" });
        }
        let shape = RestShape::new(mesh, &self.tissue)?;
        Ok(Box::new(TensorMassModel::<T> {
            rest: shape.rest_positions(),
            arms: shape.rest_arms(),
            squared_threshold: self.threshold.map(|threshold| T::from_f64(threshold * threshold)),
            vertices: shape.assemble_vertices(),
            edges: shape.assemble_edges(),
            triangles: shape.assemble_triangles(),
            tetrahedra: shape.assemble_tetrahedra(),
            removed: vec![false; shape.cell_count()],
            shape: Arc::new(shape),
        }))
    }
}

recipe!(TensorMass);

#[derive(Clone, Debug)]
struct TensorMassModel<T: Scalar> {
    shape: Arc<RestShape>,
    rest: Vec<Vec3<T>>,
    /// Places at rest, counted from their mean.
    arms: Vec<Vec3<T>>,
    squared_threshold: Option<T>,
    vertices: EntityLoop<T, Vertex, 1>,
    edges: EntityLoop<T, Edge, 2>,
    triangles: EntityLoop<T, Triangle, 3>,
    tetrahedra: EntityLoop<T, Tetrahedron, 4>,
    removed: Vec<bool>,
}

impl<T: Scalar> TensorMassModel<T> {
    /// The frame that follows the body. The linear part of an adaptive model knows no rotations.
    fn frame(&self, x: &[Vec3<T>]) -> Frame<T> {
        if self.squared_threshold.is_some() { Frame::along(x) } else { Frame::following(x, self.arms.iter().copied()) }
    }

    /// Makes displacements in the frame of places, and sets the weight of the non-linear part.
    fn enter(&self, frame: &Frame<T>, scratch: &mut Scratch<T>) {
        let data = (NodeBlocks(&mut scratch.nodal), (ReadBlocks(&self.arms), ReadBlocks(&self.rest)));
        scratch.executor.each(node_blocks(self.rest.len()), data, &|_, (nodal, (arms, rest))| {
            for (row, (arm, rest)) in nodal.0.iter_mut().zip(arms.0.iter().zip(rest.0)) {
                let x = Vec3::new(row[0], row[1], row[2]);
                let weight = if self.is_nonlinear_at(x - *rest) { T::ONE } else { T::ZERO };
                let u = frame.displacement(x, *arm);
                *row = [u.x, u.y, u.z, weight];
            }
        });
    }

    fn add_forces_at<const ADAPTIVE: bool>(&self, nodal: &[[T; 4]], sums: &mut SectionSums<'_, T>) {
        self.vertices.add_forces::<ADAPTIVE>(nodal, sums);
        self.edges.add_forces::<ADAPTIVE>(nodal, sums);
        self.triangles.add_forces::<ADAPTIVE>(nodal, sums);
        self.tetrahedra.add_forces::<ADAPTIVE>(nodal, sums);
    }
}

impl<T: Scalar> ForceModel<T> for TensorMassModel<T> {
    fn name(&self) -> &'static str {
        TensorMass::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        let frame = self.frame(x);
        self.enter(&frame, scratch);
        let SectionScratch { nodal, mut sums, .. } = scratch.sections(self.sum_rows());
        match self.squared_threshold {
            Some(_) => self.add_forces_at::<true>(nodal, &mut sums),
            None => self.add_forces_at::<false>(nodal, &mut sums),
        }
        frame.leave(&mut scratch.forces);
        scratch.finish(out);
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        scratch.start_direction(dx);
        let frame = self.frame(x);
        self.enter(&frame, scratch);
        frame.enter(&mut scratch.direction);
        let SectionScratch { nodal, direction, mut sums, .. } = scratch.sections(self.sum_rows());
        self.vertices.add_product(nodal, direction, &mut sums);
        self.edges.add_product(nodal, direction, &mut sums);
        self.triangles.add_product(nodal, direction, &mut sums);
        self.tetrahedra.add_product(nodal, direction, &mut sums);
        frame.leave(&mut scratch.forces);
        scratch.finish(out);
    }

    fn sum_rows(&self) -> usize {
        let Self { vertices, edges, triangles, tetrahedra, .. } = self;
        [vertices.sum_rows(), edges.sum_rows(), triangles.sum_rows(), tetrahedra.sum_rows()]
            .into_iter()
            .fold(0, usize::max)
    }

    fn add_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        scratch.start(x);
        let frame = self.frame(x);
        self.enter(&frame, scratch);
        let nodal = &scratch.nodal;
        let mut sink = frame.leaving(sink);
        self.vertices.add_blocks(nodal, &mut sink);
        self.edges.add_blocks(nodal, &mut sink);
        self.triangles.add_blocks(nodal, &mut sink);
        self.tetrahedra.add_blocks(nodal, &mut sink);
    }

    fn has_potential(&self) -> bool {
        self.squared_threshold.is_none()
    }

    /// Energy of the full law, also where an adaptive model is linear.
    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let displacement = self.shape.displacements(x, |arms| Frame::following(x, arms));
        self.vertices.energy(&displacement)
            + self.edges.energy(&displacement)
            + self.triangles.energy(&displacement)
            + self.tetrahedra.energy(&displacement)
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
            for (triangle, at) in self.shape.cell_triangles(cell) {
                self.triangles.subtract(triangle, &tensors, at);
            }
            self.tetrahedra.subtract(cell, &tensors, [0, 1, 2, 3]);
        }
    }

    fn is_nonlinear_at(&self, u: Vec3<T>) -> bool {
        self.squared_threshold.is_none_or(|threshold| u.squared_norm() >= threshold)
    }

    fn bytes(&self) -> usize {
        self.vertices.bytes() + self.edges.bytes() + self.triangles.bytes() + self.tetrahedra.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}
