//! Coarse matrices Wᵀ A W.

use super::lattice::{Interpolation, Share};
use super::level_matrix::{LevelMatrix, Pattern};
use crate::math::{Mat3, Scalar, Vec3};
use crate::solver::BlockSink;
use crate::solver::Filter;

/// The blocks of the stiffness on and above the diagonal, and the way from them to the matrix of the first lattice.
///
/// Blocks are added up for every two nodes of the mesh first: sixteen of each tetrahedron, times four by four weights, are
/// eight times the work. With U = ½ diagonal + upper part of S A S, G = Wᵀ U W and the coarse matrix is G + Gᵀ.
#[derive(Clone, Debug)]
pub(super) struct FineBlocks<T> {
    starts: Vec<u32>,
    /// Ascending within a row, from the diagonal on.
    columns: Vec<u32>,
    blocks: Vec<Mat3<T>>,
    /// For each block, where the four nodes of its column stand among those that the row reaches.
    places: Vec<[u16; 4]>,
    /// Where the nodes that a row reaches begin in `targets`.
    reach: Vec<u32>,
    /// For each row, for each of its own four nodes and each node it reaches: the block of the coarse matrix.
    targets: Vec<u32>,
    /// U W of one row.
    row: Vec<Mat3<T>>,
}

impl<T: Scalar> FineBlocks<T> {
    /// For the nodes that each node's force depends on, itself included, and the lattice of `coarse` nodes in which they lie.
    pub(super) fn new(
        neighbours: &[Vec<u32>],
        interpolation: &Interpolation<T>,
        coarse: usize,
    ) -> (Self, LevelMatrix<T>) {
        let shares = &interpolation.shares[..];
        let (mut starts, mut columns) = (vec![0], Vec::new());
        for (node, near) in neighbours.iter().enumerate() {
            columns.extend(near.iter().filter(|&&other| other as usize >= node));
            starts.push(columns.len() as u32);
        }
        let blocks = vec![Mat3::ZERO; columns.len()];
        let mut fine =
            Self { starts, columns, blocks, places: Vec::new(), reach: vec![0], targets: Vec::new(), row: Vec::new() };
        let mut pattern = Pattern::new(coarse);
        for (node, share) in shares.iter().enumerate() {
            for reached in fine.reached(node, shares) {
                share.nodes.iter().for_each(|&own| pattern.add(own, reached));
            }
        }
        let matrix = LevelMatrix::new(pattern);
        let mut most = 0;
        for (node, share) in shares.iter().enumerate() {
            let reached = fine.reached(node, shares);
            for column in &fine.columns[fine.span(node)] {
                let place = |node: u32| reached.partition_point(|&other| other < node) as u16;
                fine.places.push(shares[*column as usize].nodes.map(place));
            }
            for own in share.nodes {
                fine.targets.extend(reached.iter().map(|&reached| matrix.index(own, reached)));
            }
            fine.reach.push(fine.targets.len() as u32);
            most = most.max(reached.len());
        }
        fine.row = vec![Mat3::ZERO; most];
        (fine, matrix)
    }

    fn span(&self, row: usize) -> std::ops::Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }

    /// The lattice nodes of the columns of a row, ascending.
    fn reached(&self, row: usize, shares: &[Share<T>]) -> Vec<u32> {
        let columns = self.columns[self.span(row)].iter();
        let mut reached: Vec<u32> = columns.flat_map(|&column| shares[column as usize].nodes).collect();
        reached.sort_unstable();
        reached.dedup();
        reached
    }

    pub(super) fn clear(&mut self) {
        self.blocks.fill(Mat3::ZERO);
    }

    /// Writes Wᵀ S (K + `masses`) S W to `coarse`.
    pub(super) fn restrict(
        &mut self,
        interpolation: &Interpolation<T>,
        filters: &[Filter<T>],
        masses: &[T],
        coarse: &mut LevelMatrix<T>,
    ) {
        let shares = &interpolation.shares[..];
        coarse.blocks.fill(Mat3::ZERO);
        for (node, share) in shares.iter().enumerate() {
            if filters[node] == Filter::Held {
                continue;
            }
            let targets = &self.targets[self.reach[node] as usize..self.reach[node + 1] as usize];
            let reached = targets.len() / 4;
            let row = &mut self.row[..reached];
            row.fill(Mat3::ZERO);
            for index in self.starts[node] as usize..self.starts[node + 1] as usize {
                let column = self.columns[index] as usize;
                let mut block = self.blocks[index];
                if column == node {
                    block = (block + Mat3::diagonal(masses[node])) * T::from_f64(0.5);
                }
                let block = filtered(block, &filters[node], &filters[column]);
                for (&place, weight) in self.places[index].iter().zip(shares[column].weights) {
                    row[place as usize] += block * weight;
                }
            }
            for (targets, weight) in targets.chunks_exact(reached).zip(share.weights) {
                for (&target, block) in targets.iter().zip(&*row) {
                    coarse.blocks[target as usize] += *block * weight;
                }
            }
        }
        coarse.add_transpose();
    }
}

/// S_row A S_column.
fn filtered<T: Scalar>(block: Mat3<T>, row: &Filter<T>, column: &Filter<T>) -> Mat3<T> {
    if (*row, *column) == (Filter::Free, Filter::Free) {
        return block;
    }
    let of_row = |block: Mat3<T>, filter: &Filter<T>| Mat3 { columns: block.columns.map(|c| filter.apply(c)) };
    of_row(of_row(block, row).transpose(), column).transpose()
}

impl<T: Scalar> BlockSink<T> for FineBlocks<T> {
    /// Of two blocks that mirror each other it keeps one, and none of removed cells: those are zero, or no numbers where what is left of the
    /// tissue around them left the numbers. Panics for two other nodes outside the pattern.
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        if column < row {
            return;
        }
        let span = self.span(row as usize);
        // Seven columns on average: faster from one to the next than by halving.
        let offset = self.columns[span.clone()].iter().position(|&other| other == column);
        assert!(
            offset.is_some() || block == Mat3::ZERO || !block.is_finite(),
            "nodes {row} and {column} are too far apart: the block is of another mesh or model"
        );
        offset.into_iter().for_each(|offset| self.blocks[span.start + offset] += block);
    }
}

/// The way from a lattice's matrix to that of the next.
#[derive(Clone, Debug)]
pub(super) struct Coarsening {
    /// The two nodes whose mean makes the value at a node.
    parents: Vec<[u32; 2]>,
    /// The four blocks to which a block goes, a quarter to each.
    targets: Vec<[u32; 4]>,
}

impl Coarsening {
    /// For the two nodes of the next lattice, of `coarse` nodes, that make the value at each node of this one.
    pub(super) fn new<T: Scalar>(
        matrix: &LevelMatrix<T>,
        parents: Vec<[u32; 2]>,
        coarse: usize,
    ) -> (Self, LevelMatrix<T>) {
        let entries = || (0..matrix.rows()).flat_map(|row| matrix.span(row).map(move |index| (row, index)));
        let pairs = |(row, index): (usize, usize)| {
            let ([a, b], [c, d]) = (parents[row], parents[matrix.columns()[index] as usize]);
            [(a, c), (a, d), (b, c), (b, d)]
        };
        let mut pattern = Pattern::new(coarse);
        entries().flat_map(pairs).for_each(|(row, column)| pattern.add(row, column));
        let next = LevelMatrix::new(pattern);
        let targets = entries().map(|entry| pairs(entry).map(|(row, column)| next.index(row, column))).collect();
        (Self { parents, targets }, next)
    }

    /// Writes Wᵀ A W to `coarse`.
    pub(super) fn restrict_matrix<T: Scalar>(&self, matrix: &LevelMatrix<T>, coarse: &mut LevelMatrix<T>) {
        coarse.blocks.fill(Mat3::ZERO);
        for (targets, block) in self.targets.iter().zip(&matrix.blocks) {
            let quarter = *block * T::from_f64(0.25);
            for &target in targets {
                coarse.blocks[target as usize] += quarter;
            }
        }
    }

    /// Writes Wᵀ r to `coarse`.
    pub(super) fn restrict<T: Scalar>(&self, fine: &[Vec3<T>], coarse: &mut [Vec3<T>]) {
        coarse.fill(Vec3::ZERO);
        for (&[a, b], &value) in self.parents.iter().zip(fine) {
            let half = value * T::from_f64(0.5);
            coarse[a as usize] += half;
            coarse[b as usize] += half;
        }
    }

    /// Writes W e to `fine`.
    pub(super) fn prolong<T: Scalar>(&self, coarse: &[Vec3<T>], fine: &mut [Vec3<T>]) {
        for (&[a, b], value) in self.parents.iter().zip(fine) {
            *value = (coarse[a as usize] + coarse[b as usize]) * T::from_f64(0.5);
        }
    }
}
