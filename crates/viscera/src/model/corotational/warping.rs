//! Node-wise stiffness warping: one rotation for each node instead of each element, and what it costs.
//!
//! f_i = R_i Σ_j K_ij (R_iᵀ x_j − X_j)
//!
//! R_i is the polar rotation of the deformation that fits the node's incident edges best, A_i (Σ e0 e0ᵀ)⁻¹ with
//! A_i = Σ e e0ᵀ. Where neighbouring rotations differ, f_ij ≠ −f_ji: the forces on a bent body have a sum, ghost forces
//! that push and turn it. This is what element-wise rotations cured, and the model is here to compare them with.
//!
//! Products are those of element-wise rotations, R_e K_e R_eᵀ dx, with R_e in the middle of the corners' R_i: symmetric, positive and
//! blind to translations in any shape. The paper's R_i K_ij R_iᵀ are blind to translations alone, and conjugate gradients do not solve
//! their systems where neighbours have turned differently: scrambled tissue never came back in linearised steps. R_i K_ij R_jᵀ would be
//! symmetric too, but hold a bent body against translations (5 % of a product).
//!
//! Source: Müller, Dorsey, McMillan, Jagnow, Cutler, *Stable real-time deformations* (2002), section 4.

use super::hooke::Hooke;
use super::{LAWS, OTHER_LAWS};
use crate::material::{LawKind, Tissue};
use crate::math::rotation::polar;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{TET_EDGES, TetMesh, VolumeMesh};
use crate::model::registry::Claims;
use crate::model::tet_loop::RestTet;
use crate::model::{
    BlockSink, ForceModel, GenericRecipe, ModelError, ModelInfo, ModelKind, Precision, Scratch, recipe,
};

/// Numbers of a rotation.
const ROTATION: usize = 9;

/// Node-wise stiffness warping of linear tissue, on tetrahedra; a comparator, not a model to work with.
#[derive(Clone, Debug, PartialEq)]
pub struct StiffnessWarping {
    tissue: Tissue,
}

impl StiffnessWarping {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "stiffness-warping",
        purpose: "for comparison only: rotations at the nodes, whose ghost forces push a bent body about",
        hexahedra: false,
        laws: LAWS,
        moves: true,
        no_implicit: None,
        no_cutting: None,
        tool_limits: None,
    };

    pub(crate) fn claims(_law: LawKind, _hexahedra: bool) -> Claims {
        Claims {
            of_the_law: false,
            objective: true,
            force_free: false,
            torque_free: false,
            passes_patch_test: true,
            conservative: false,
            exact_products: false,
        }
    }

    /// A model of `tissue`.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue }
    }
}

impl GenericRecipe for StiffnessWarping {
    const KIND: ModelKind = ModelKind::StiffnessWarping;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        let model = ModelKind::StiffnessWarping;
        model.check_law(self.tissue.kind(), OTHER_LAWS)?;
        self.tissue.check_count(mesh.cell_count())?;
        let VolumeMesh::Tet(mesh) = mesh else { return Err(ModelError::UnsupportedCells { model }) };
        Ok(Box::new(WarpedTets::new(mesh, &self.tissue)?))
    }
}

recipe!(StiffnessWarping);

#[derive(Clone, Debug)]
struct WarpedTets<T> {
    cells: Vec<Cell<T>>,
    edges: Vec<Edge<T>>,
    /// Edges at each node: those of node n are `edges_at_nodes.1[starts[n]..starts[n + 1]]`.
    edges_at_nodes: (Vec<u32>, Vec<u32>),
    /// (Σ e0 e0ᵀ)⁻¹ of each node.
    fits: Vec<Mat3<T>>,
}

#[derive(Clone, Debug)]
struct Cell<T> {
    corners: [u32; 4],
    edges: [u32; 6],
    /// Dm⁻¹.
    inverse: Mat3<T>,
    volume: T,
    hooke: Hooke<T>,
    removed: bool,
}

#[derive(Clone, Debug)]
struct Edge<T> {
    nodes: [u32; 2],
    /// From the first node to the second, at rest.
    rest: Vec3<T>,
    /// How many cells still have it.
    cells: u32,
}

impl<T: Scalar> WarpedTets<T> {
    fn new(mesh: &TetMesh, tissue: &Tissue) -> Result<Self, ModelError> {
        mesh.check_indices()?;
        let fibred = super::has_fibres(tissue);
        let mut numbers = std::collections::BTreeMap::new();
        let mut edges: Vec<Edge<T>> = Vec::new();
        let mut edge_between = |[a, b]: [u32; 2]| {
            let nodes = [a.min(b), a.max(b)];
            let number = *numbers.entry(nodes).or_insert_with(|| {
                let [from, to] = nodes.map(|node| mesh.nodes[node as usize]);
                edges.push(Edge { nodes, rest: (to - from).cast(), cells: 0 });
                edges.len() as u32 - 1
            });
            edges[number as usize].cells += 1;
            number
        };
        let cell = |(cell, &corners): (usize, &[u32; 4])| {
            let rest = RestTet::new(mesh, cell)?;
            let stiffness = tissue.at_rest(cell);
            let law = Hooke::numbers(&stiffness, stiffness.direction, fibred);
            let law: Vec<T> = law.into_iter().map(T::from_f64).collect();
            Ok(Cell {
                corners,
                edges: TET_EDGES.map(|pair| edge_between(pair.map(|corner| corners[corner]))),
                inverse: rest.inverse.cast(),
                volume: T::from_f64(rest.volume),
                hooke: Hooke::at(&law, fibred),
                removed: false,
            })
        };
        let cells = mesh.cells.iter().enumerate().map(cell).collect::<Result<_, ModelError>>()?;
        let edges_at_nodes = edges_at_nodes(&edges, mesh.nodes.len());
        let mut tets = Self { cells, edges, edges_at_nodes, fits: vec![Mat3::ZERO; mesh.nodes.len()] };
        (0..mesh.nodes.len()).for_each(|node| tets.fit(node));
        Ok(tets)
    }

    /// Brings the fit of a node up to date with the edges that are left there.
    fn fit(&mut self, node: usize) {
        let fit = self.edges_at(node).fold(Mat3::ZERO, |sum, edge| sum + edge.rest.outer(edge.rest));
        // In units of its own size, as the determinant is its third power. A node without cells has nothing to fit.
        let unit = T::ONE / fit.trace();
        let inverse = (fit * unit).inverse() * unit;
        self.fits[node] = if inverse.is_finite() { inverse } else { Mat3::ZERO };
    }

    /// Edges of a node that cells have left.
    fn edges_at(&self, node: usize) -> impl Iterator<Item = &Edge<T>> {
        let (starts, edges) = &self.edges_at_nodes;
        let here = edges[starts[node] as usize..starts[node + 1] as usize].iter();
        here.map(|&edge| &self.edges[edge as usize]).filter(|edge| edge.cells > 0)
    }

    /// R of every node at `x`, nine numbers each.
    fn rotate(&self, x: &[Vec3<T>], rotations: &mut [T]) {
        rotations.fill(T::ZERO);
        for edge in self.edges.iter().filter(|edge| edge.cells > 0) {
            let [from, to] = edge.nodes.map(|node| node as usize);
            let moved = (x[to] - x[from]).outer(edge.rest);
            for node in [from, to] {
                let sum = read(rotations, node) + moved;
                write(rotations, node, &sum);
            }
        }
        for (node, &fit) in self.fits.iter().enumerate() {
            let r = polar(&(read(rotations, node) * fit));
            write(rotations, node, &r);
        }
    }

    /// R of one node at `x`.
    fn rotation(&self, node: usize, x: &[Vec3<T>]) -> Mat3<T> {
        let moved = |edge: &Edge<T>| {
            let [from, to] = edge.nodes.map(|node| x[node as usize]);
            (to - from).outer(edge.rest)
        };
        polar(&(self.edges_at(node).map(moved).fold(Mat3::ZERO, |sum, moved| sum + moved) * self.fits[node]))
    }

    /// R of every cell, from those of the nodes.
    fn rotate_cells(&self, rotations: &[T], of_cells: &mut [T]) {
        for (number, cell) in self.cells.iter().enumerate() {
            let [a, b, c, d] = cell.corners.map(|node| read(rotations, node as usize));
            write(of_cells, number, &polar(&(a + b + (c + d))));
        }
    }

    /// Keeps the rotations for products at `x`.
    fn keep_rotations(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) {
        let room = scratch.room_for_linearization(self.linearization_len());
        let (of_cells, of_nodes) = room.split_at_mut(ROTATION * self.cells.len());
        self.rotate(x, of_nodes);
        self.rotate_cells(of_nodes, of_cells);
    }

    /// The rotations of the cells that products use: those that were kept for them, or those at `x`.
    fn rotations_of_products<'a>(&self, x: &[Vec3<T>], scratch: &'a mut Scratch<T>) -> &'a [T] {
        if !scratch.is_linearized {
            self.keep_rotations(x, scratch);
        }
        &scratch.room_for_linearization(self.linearization_len())[..ROTATION * self.cells.len()]
    }
}

impl<T: Scalar> Cell<T> {
    /// Σ x_j α_jᵀ.
    fn gradient(&self, x: &[Vec3<T>]) -> Mat3<T> {
        let [a, b, c, d] = self.corners.map(|node| x[node as usize]);
        Mat3::from_columns(b - a, c - a, d - a) * self.inverse
    }

    /// α_0..α_3.
    fn gradients(&self) -> [Vec3<T>; 4] {
        let [a, b, c] = self.inverse.transpose().columns;
        [-(a + b + c), a, b, c]
    }
}

/// The edges at each of `nodes` nodes, in their order.
fn edges_at_nodes<T>(edges: &[Edge<T>], nodes: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0; nodes + 1];
    for node in edges.iter().flat_map(|edge| edge.nodes) {
        starts[node as usize + 1] += 1;
    }
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let (mut next, mut at_nodes) = (starts.clone(), vec![0; 2 * edges.len()]);
    for (number, edge) in edges.iter().enumerate() {
        for node in edge.nodes {
            at_nodes[next[node as usize] as usize] = number as u32;
            next[node as usize] += 1;
        }
    }
    (starts, at_nodes)
}

fn read<T: Scalar>(rotations: &[T], node: usize) -> Mat3<T> {
    let n = &rotations[ROTATION * node..][..ROTATION];
    Mat3::from_columns(Vec3::new(n[0], n[1], n[2]), Vec3::new(n[3], n[4], n[5]), Vec3::new(n[6], n[7], n[8]))
}

fn write<T: Scalar>(rotations: &mut [T], node: usize, r: &Mat3<T>) {
    for (row, column) in rotations[ROTATION * node..][..ROTATION].chunks_exact_mut(3).zip(r.columns) {
        row.copy_from_slice(&column.to_array());
    }
}

impl<T: Scalar> ForceModel<T> for WarpedTets<T> {
    fn name(&self) -> &'static str {
        StiffnessWarping::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        let rotations = &mut scratch.room_for_linearization(self.linearization_len())[ROTATION * self.cells.len()..];
        self.rotate(x, rotations);
        for cell in self.cells.iter().filter(|cell| !cell.removed) {
            let f = cell.gradient(x);
            for (&node, gradient) in cell.corners.iter().zip(cell.gradients()) {
                let r = read(rotations, node as usize);
                let strain = (r.transpose() * f - Mat3::IDENTITY).symmetric_part();
                out[node as usize] += r * (cell.hooke.stress(strain) * (gradient * cell.volume));
            }
        }
    }

    /// The rotations of the cells for products, then those of the nodes for forces, which may be asked for elsewhere.
    fn linearization_len(&self) -> usize {
        ROTATION * (self.cells.len() + self.fits.len())
    }

    fn linearize(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) {
        self.keep_rotations(x, scratch);
        scratch.is_linearized = true;
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        let rotations = self.rotations_of_products(x, scratch);
        for (number, cell) in self.cells.iter().enumerate().filter(|(_, cell)| !cell.removed) {
            let r = read(rotations, number);
            let stress = cell.hooke.stress((r.transpose() * cell.gradient(dx)).symmetric_part());
            for (&node, gradient) in cell.corners.iter().zip(cell.gradients()) {
                out[node as usize] += r * (stress * (gradient * cell.volume));
            }
        }
    }

    fn add_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        let rotations = self.rotations_of_products(x, scratch);
        for (number, cell) in self.cells.iter().enumerate().filter(|(_, cell)| !cell.removed) {
            let (r, gradients) = (read(rotations, number), cell.gradients());
            for (&row, p) in cell.corners.iter().zip(gradients) {
                for (&column, q) in cell.corners.iter().zip(gradients) {
                    if row == column || !sink.keeps_diagonal_only() {
                        sink.add(row, column, r * cell.hooke.block(p * cell.volume, q) * r.transpose());
                    }
                }
            }
        }
    }

    fn has_potential(&self) -> bool {
        false
    }

    /// ½ V ε:σ(ε), the mean over the corners' rotations: a measure of deformation, not a potential of the forces.
    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let of_cell = |cell: &Cell<T>| {
            let f = cell.gradient(x);
            let of_corner = |node: u32| {
                let strain = (self.rotation(node as usize, x).transpose() * f - Mat3::IDENTITY).symmetric_part();
                (cell.hooke.energy(strain) * cell.volume).to_f64()
            };
            0.25 * cell.corners.into_iter().map(of_corner).sum::<f64>()
        };
        self.cells.iter().filter(|cell| !cell.removed).map(of_cell).sum()
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            let cell = &mut self.cells[cell as usize];
            if !std::mem::replace(&mut cell.removed, true) {
                cell.edges.iter().for_each(|&edge| self.edges[edge as usize].cells -= 1);
                cell.corners.into_iter().for_each(|node| self.fit(node as usize));
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.cells[..]) + size_of_val(&self.edges[..]) + size_of_val(&self.fits[..])
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}
