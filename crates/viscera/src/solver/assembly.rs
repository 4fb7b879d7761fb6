//! Assembly of a stiffness matrix from products: what works for every force model.
//!
//! Nodes whose columns share no row can be probed by one product with a sum of unit vectors. So three products for each
//! colour of the nodes give the whole matrix, where no two nodes of a colour have a neighbour in common: some 50 colours
//! on a free mesh of tetrahedra, however large.
//!
//! Source: Curtis, Powell, Reid, On the estimation of sparse Jacobian matrices (1974).

use super::SymmetricMatrix;
use crate::math::{Scalar, Vec3};
use crate::mesh::VolumeMesh;

/// Which entries a stiffness matrix has, and which products find them.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// Nodes that a node's force depends on, itself included, ascending.
    neighbours: Vec<Vec<u32>>,
    /// Number of the unknown for each of the three components at a node; none for a component that is held.
    unknowns: Vec<[Option<usize>; 3]>,
    colours: Vec<Vec<u32>>,
}

/// Nodes within `rings` cells of each node, itself included, ascending.
pub fn neighbours(mesh: &VolumeMesh, rings: usize) -> Vec<Vec<u32>> {
    let nodes = mesh.nodes().len();
    let mut ring: Vec<Vec<u32>> = vec![Vec::new(); nodes];
    for cell in 0..mesh.cell_count() {
        let corners = mesh.cell(cell);
        for &node in corners {
            ring[node as usize].extend_from_slice(corners);
        }
    }
    sort(&mut ring);
    let mut reached = ring.clone();
    for _ in 1..rings {
        reached =
            reached.iter().map(|near| near.iter().flat_map(|&node| ring[node as usize].clone()).collect()).collect();
        sort(&mut reached);
    }
    reached
}

fn sort(lists: &mut [Vec<u32>]) {
    for list in lists {
        list.sort_unstable();
        list.dedup();
    }
}

impl Assembly {
    /// An assembly over the components that are `free` at each node.
    pub fn new(neighbours: Vec<Vec<u32>>, free: &[[bool; 3]]) -> Self {
        let mut count = 0;
        let mut number = |free: bool| {
            count += usize::from(free);
            free.then(|| count - 1)
        };
        let unknowns = free.iter().map(|free| free.map(&mut number)).collect();
        let colours = colour(&neighbours);
        Self { neighbours, unknowns, colours }
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.unknowns.iter().flatten().flatten().count()
    }

    /// A matrix of zeros with the entries that there are.
    pub fn matrix(&self) -> SymmetricMatrix {
        let mut columns = Vec::with_capacity(self.size());
        for (node, near) in self.neighbours.iter().enumerate() {
            for column in self.unknowns[node].into_iter().flatten() {
                let rows = near.iter().flat_map(|&other| self.unknowns[other as usize]).flatten();
                columns.push(rows.filter(|&row| row >= column).collect::<Vec<_>>());
            }
        }
        SymmetricMatrix::with_pattern(&columns)
    }

    /// Fills the matrix; `product` writes K dx for the dx that it is given.
    pub fn assemble<T: Scalar>(
        &self,
        matrix: &mut SymmetricMatrix,
        mut product: impl FnMut(&[Vec3<T>], &mut [Vec3<T>]),
    ) {
        matrix.values.fill(0.0);
        let mut direction = vec![Vec3::ZERO; self.neighbours.len()];
        let mut column = direction.clone();
        for nodes in &self.colours {
            for axis in 0..3 {
                nodes.iter().for_each(|&node| direction[node as usize][axis] = T::ONE);
                column.fill(Vec3::ZERO);
                product(&direction, &mut column);
                nodes.iter().for_each(|&node| direction[node as usize][axis] = T::ZERO);
                for &node in nodes {
                    self.store(matrix, node as usize, axis, &column);
                }
            }
        }
    }

    fn store<T: Scalar>(&self, matrix: &mut SymmetricMatrix, node: usize, axis: usize, forces: &[Vec3<T>]) {
        let Some(column) = self.unknowns[node][axis] else { return };
        for &other in &self.neighbours[node] {
            for (component, row) in self.unknowns[other as usize].into_iter().enumerate() {
                let Some(entry) = row.filter(|&row| row >= column).and_then(|row| matrix.entry_mut(row, column)) else {
                    continue;
                };
                *entry = forces[other as usize][component].to_f64();
            }
        }
    }

    /// Takes the free components out of nodal vectors.
    pub fn gather<T: Scalar>(&self, nodal: &[Vec3<T>], out: &mut [f64]) {
        for (unknowns, v) in self.unknowns.iter().zip(nodal) {
            for axis in 0..3 {
                if let Some(unknown) = unknowns[axis] {
                    out[unknown] = v[axis].to_f64();
                }
            }
        }
    }

    /// Adds `factor` times the unknowns to nodal vectors.
    pub fn scatter<T: Scalar>(&self, values: &[f64], factor: f64, nodal: &mut [Vec3<T>]) {
        for (unknowns, v) in self.unknowns.iter().zip(nodal) {
            for axis in 0..3 {
                if let Some(unknown) = unknowns[axis] {
                    v[axis] += T::from_f64(factor * values[unknown]);
                }
            }
        }
    }
}

/// Greedy colouring: no two nodes of a colour have a neighbour in common.
fn colour(neighbours: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut colour_of = vec![usize::MAX; neighbours.len()];
    let mut colours: Vec<Vec<u32>> = Vec::new();
    let mut taken_by = Vec::new();
    for (node, near) in neighbours.iter().enumerate() {
        for &between in near {
            for &other in &neighbours[between as usize] {
                let colour = colour_of[other as usize];
                if colour != usize::MAX {
                    taken_by[colour] = node;
                }
            }
        }
        let colour = taken_by.iter().position(|&by| by != node).unwrap_or(taken_by.len());
        if colour == taken_by.len() {
            taken_by.push(usize::MAX);
            colours.push(Vec::new());
        }
        colour_of[node] = colour;
        colours[colour].push(node as u32);
    }
    colours
}
