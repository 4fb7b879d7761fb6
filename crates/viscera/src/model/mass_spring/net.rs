use std::collections::BTreeMap;
use std::sync::Arc;

use crate::executor::{NODE_BLOCK, NodeBlocks, node_blocks};
use crate::material::Tissue;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{HEX_EDGES, HEX_FACES, TET_EDGES, VolumeMesh};
use crate::model::checked_cell::checked_volume;
use crate::model::frequency::{FrequencyBound, largest_eigenvalue_bound};
use crate::model::{BlockSink, ForceModel, MassSpring, ModelError, Scratch};

/// w of an edge of a tetrahedron, of an edge and of a diagonal of a hexahedron.
const OF_TET_EDGE: f64 = 1.0;
const OF_HEX_EDGE: f64 = 17.0 / 130.0;
const OF_HEX_DIAGONAL: f64 = 18.0 / 65.0;
/// A spring shorter than this share of its rest length has no direction.
const SHORTEST: f64 = 1e-6;

/// The springs of one cell: local corners, and w.
fn springs_of(mesh: &VolumeMesh) -> Vec<([usize; 2], f64)> {
    match mesh {
        VolumeMesh::Tet(_) => TET_EDGES.map(|corners| (corners, OF_TET_EDGE)).to_vec(),
        VolumeMesh::Hex(_) => {
            let faces = HEX_FACES.iter().flat_map(|&[a, b, c, d]| [[a, c], [b, d]]);
            let diagonals = faces.chain([[0, 6], [1, 7], [2, 4], [3, 5]]).map(|corners| (corners, OF_HEX_DIAGONAL));
            HEX_EDGES.iter().map(|&corners| (corners, OF_HEX_EDGE)).chain(diagonals).collect()
        }
    }
}

/// What a cell gives to each of its springs: corners and w E V/L² [N/m].
fn shares(mesh: &VolumeMesh, tissue: &Tissue, cell: usize) -> Result<Vec<([u32; 2], f64)>, ModelError> {
    let (corners, nodes) = (mesh.cell(cell), mesh.nodes());
    let scale = tissue.at_rest(cell).lame.young() * checked_volume(mesh, cell)?;
    let share = |(ends, weight): ([usize; 2], f64)| {
        let [a, b] = ends.map(|corner| corners[corner]);
        let length = (nodes[b as usize] - nodes[a as usize]).squared_norm();
        ([a.min(b), a.max(b)], weight * scale / length)
    };
    Ok(springs_of(mesh).into_iter().map(share).collect())
}

/// The springs of a body.
#[derive(Clone, Debug)]
pub(super) struct Net<T> {
    springs: Vec<Spring<T>>,
    rest: Arc<Rest>,
    /// k of each spring in double precision [N/m]: cells are taken off these.
    stiffness: Vec<f64>,
    removed: Vec<bool>,
}

/// What a spring reads while it pulls.
#[derive(Clone, Copy, Debug)]
struct Spring<T> {
    /// k [N/m].
    stiffness: T,
    /// L [m].
    length: T,
}

/// What a cut does not change.
#[derive(Debug)]
struct Rest {
    /// The two nodes of each spring.
    ends: Vec<[u32; 2]>,
    /// L of each spring [m].
    lengths: Vec<f64>,
    /// The springs of each cell and its share in their stiffness [N/m], `per_cell` of them.
    shares: Vec<(u32, f64)>,
    per_cell: usize,
    /// The cells of each spring.
    cells: Vec<Vec<u32>>,
    /// Springs at each node, and their other ends: those of node n are `at_nodes[starts[n]..starts[n + 1]]`.
    starts: Vec<u32>,
    at_nodes: Vec<(u32, u32)>,
}

impl<T: Scalar> Net<T> {
    pub(super) fn new(mesh: &VolumeMesh, tissue: &Tissue) -> Result<Self, ModelError> {
        mesh.check_indices()?;
        let (mut numbers, mut ends, mut all) = (BTreeMap::new(), Vec::new(), Vec::new());
        let (mut stiffness, mut cells) = (Vec::new(), Vec::new());
        for cell in 0..mesh.cell_count() {
            for (nodes, share) in shares(mesh, tissue, cell)? {
                let spring = *numbers.entry(nodes).or_insert_with(|| {
                    ends.push(nodes);
                    stiffness.push(0.0);
                    cells.push(Vec::new());
                    ends.len() - 1
                });
                all.push((spring as u32, share));
                stiffness[spring] += share;
                cells[spring].push(cell as u32);
            }
        }
        let length = |&[a, b]: &[u32; 2]| (mesh.nodes()[b as usize] - mesh.nodes()[a as usize]).norm();
        let lengths: Vec<f64> = ends.iter().map(length).collect();
        let spring = |(&stiffness, &length): (&f64, &f64)| Spring {
            stiffness: T::from_f64(stiffness),
            length: T::from_f64(length),
        };
        let springs = stiffness.iter().zip(&lengths).map(spring).collect();
        let (starts, at_nodes) = springs_at_nodes(mesh.nodes().len(), &ends);
        let per_cell = springs_of(mesh).len();
        let rest = Arc::new(Rest { ends, lengths, shares: all, per_cell, cells, starts, at_nodes });
        Ok(Self { springs, rest, stiffness, removed: vec![false; mesh.cell_count()] })
    }

    /// Adds what `pull` makes of every spring at each node: of its number and its other end. Node by node, so that threads
    /// share nothing.
    fn gather(
        &self,
        scratch: &Scratch<T>,
        out: &mut [Vec3<T>],
        pull: &(impl Fn(usize, usize, usize) -> Vec3<T> + Sync),
    ) {
        let Rest { starts, at_nodes, .. } = &*self.rest;
        assert_eq!(starts.len(), out.len() + 1, "arrays must be those of the model's mesh");
        scratch.executor.each(node_blocks(out.len()), NodeBlocks(out), &|block, NodeBlocks(out)| {
            for (place, out) in out.iter_mut().enumerate() {
                let node = block * NODE_BLOCK + place;
                for &(spring, other) in &at_nodes[starts[node] as usize..starts[node + 1] as usize] {
                    *out += pull(spring as usize, node, other as usize);
                }
            }
        });
    }
}

/// Springs at each node, in their order, and their other ends.
fn springs_at_nodes(nodes: usize, ends: &[[u32; 2]]) -> (Vec<u32>, Vec<(u32, u32)>) {
    let mut at_nodes = vec![Vec::new(); nodes];
    for (spring, &[a, b]) in ends.iter().enumerate() {
        at_nodes[a as usize].push((spring as u32, b));
        at_nodes[b as usize].push((spring as u32, a));
    }
    let mut starts = vec![0];
    starts.extend(at_nodes.iter().scan(0, |end, own: &Vec<_>| {
        *end += own.len() as u32;
        Some(*end)
    }));
    (starts, at_nodes.into_iter().flatten().collect())
}

impl<T: Scalar> Spring<T> {
    /// ∂W/∂a of a spring that reaches from a to a + `d` [N].
    fn force(&self, d: Vec3<T>) -> Vec3<T> {
        let (direction, length) = self.direction(d);
        direction * (self.stiffness * (self.length - length))
    }

    /// How that changes when `d` changes by `dd`: −[k n nᵀ + k (1 − L/l)(I − n nᵀ)] dd.
    fn change(&self, d: Vec3<T>, dd: Vec3<T>) -> Vec3<T> {
        let (direction, length) = self.direction(d);
        let along = direction * direction.dot(dd);
        let across = T::ONE - self.length / length.max(self.length * T::from_f64(SHORTEST));
        -(along + (dd - along) * across) * self.stiffness
    }

    fn direction(&self, d: Vec3<T>) -> (Vec3<T>, T) {
        let length = d.norm();
        (d / length.max(self.length * T::from_f64(SHORTEST)), length)
    }
}

impl<T: Scalar> ForceModel<T> for Net<T> {
    fn name(&self) -> &'static str {
        MassSpring::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.gather(scratch, out, &|spring, own, other| self.springs[spring].force(x[other] - x[own]));
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.gather(scratch, out, &|spring, own, other| {
            self.springs[spring].change(x[other] - x[own], dx[other] - dx[own])
        });
    }

    fn add_blocks(&self, x: &[Vec3<T>], _scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        for (spring, &[a, b]) in self.springs.iter().zip(&self.rest.ends) {
            let d = x[b as usize] - x[a as usize];
            let block = Mat3 { columns: Mat3::IDENTITY.columns.map(|axis: Vec3<T>| -spring.change(d, axis)) };
            sink.add(a, a, block);
            sink.add(b, b, block);
            if !sink.keeps_diagonal_only() {
                sink.add(a, b, -block);
                sink.add(b, a, -block);
            }
        }
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let rest = &self.rest;
        let place = |node: u32| x[node as usize].cast::<f64>();
        let of = |(&k, (&[a, b], &length)): (&f64, (&[u32; 2], &f64))| {
            let stretch = (place(b) - place(a)).norm() - length;
            0.5 * k * stretch * stretch
        };
        self.stiffness.iter().zip(rest.ends.iter().zip(&rest.lengths)).map(of).sum()
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            if std::mem::replace(&mut self.removed[cell as usize], true) {
                continue;
            }
            let first = cell as usize * self.rest.per_cell;
            for &(spring, share) in &self.rest.shares[first..first + self.rest.per_cell] {
                let spring = spring as usize;
                let lives = self.rest.cells[spring].iter().any(|&cell| !self.removed[cell as usize]);
                self.stiffness[spring] = if lives { self.stiffness[spring] - share } else { 0.0 };
                self.springs[spring].stiffness = T::from_f64(self.stiffness[spring]);
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(self.springs.as_slice()) + size_of_val(self.rest.at_nodes.as_slice())
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

/// The bound of the highest frequency, cell by cell. A spring is nowhere stiffer than k in any direction, so that ω² of its
/// cell at rest, with k in all directions, holds for every deformation.
#[derive(Clone, Debug)]
pub(super) struct NetBound {
    /// ω² of each cell [1/s²]; 0 for one that is removed.
    cells: Vec<f64>,
}

impl NetBound {
    pub(super) fn new(mesh: &VolumeMesh, tissue: &Tissue, density: &[f64]) -> Result<Self, ModelError> {
        mesh.check_indices()?;
        let cell = |cell: usize| {
            let corners = mesh.cell(cell);
            let size = corners.len();
            let corner_mass =
                density[if density.len() == 1 { 0 } else { cell }] * checked_volume(mesh, cell)? / size as f64;
            let mut matrix = vec![0.0; size * size];
            for (nodes, share) in shares(mesh, tissue, cell)? {
                let [a, b] = nodes.map(|node| corners.iter().position(|&corner| corner == node).unwrap_or_default());
                let entry = share / corner_mass;
                for (row, column, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    matrix[row * size + column] += sign * entry;
                }
            }
            Ok(largest_eigenvalue_bound(matrix, size))
        };
        Ok(Self { cells: (0..mesh.cell_count()).map(cell).collect::<Result<_, ModelError>>()? })
    }
}

impl<T: Scalar> FrequencyBound<T> for NetBound {
    fn squared_frequency(&self, _x: &[Vec3<T>], _scratch: &mut Scratch<T>) -> f64 {
        self.cells.iter().copied().fold(0.0, f64::max)
    }

    fn remove(&mut self, cells: &[u32]) {
        cells.iter().for_each(|&cell| self.cells[cell as usize] = 0.0);
    }

    fn clone_box(&self) -> Box<dyn FrequencyBound<T>> {
        Box::new(self.clone())
    }
}
