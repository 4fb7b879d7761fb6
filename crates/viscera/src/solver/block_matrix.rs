use super::LinearOperator;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::VolumeMesh;
use crate::solver::BlockSink;

/// A sparse matrix of 3×3 blocks, row after row: a block for every two nodes whose forces know each other.
#[derive(Clone, Debug)]
pub struct BlockMatrix<T> {
    /// The blocks of row n are `starts[n]..starts[n + 1]`.
    starts: Vec<u32>,
    /// Columns, ascending within a row.
    columns: Vec<u32>,
    blocks: Vec<Mat3<T>>,
}

impl<T: Scalar> BlockMatrix<T> {
    /// The zero matrix with the pattern of `mesh`, for models whose forces reach so far.
    pub fn new<'a>(mesh: &VolumeMesh, reach: impl Into<Reach<'a>>) -> Self {
        let mut starts = vec![0];
        let mut columns = Vec::new();
        for row in &pattern(mesh, reach.into(), &vec![false; mesh.cell_count()]) {
            columns.extend_from_slice(row);
            starts.push(columns.len() as u32);
        }
        let blocks = vec![Mat3::ZERO; columns.len()];
        Self { starts, columns, blocks }
    }

    /// Matrices side by side on the diagonal of one.
    pub(crate) fn side_by_side(parts: impl Iterator<Item = Self>) -> Self {
        let mut all = Self { starts: vec![0], columns: Vec::new(), blocks: Vec::new() };
        for part in parts {
            let (nodes, blocks) = (all.starts.len() as u32 - 1, all.columns.len() as u32);
            all.columns.extend(part.columns.iter().map(|column| column + nodes));
            all.starts.extend(part.starts[1..].iter().map(|start| start + blocks));
            all.blocks.extend(part.blocks);
        }
        all
    }

    /// Sets every block to zero; the pattern stays.
    pub fn clear(&mut self) {
        self.blocks.fill(Mat3::ZERO);
    }

    /// How many blocks there are.
    pub fn block_count(&self) -> usize {
        self.blocks.len()
    }

    /// The blocks of a row with their columns, ascending.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (u32, &Mat3<T>)> {
        let span = self.starts[row] as usize..self.starts[row + 1] as usize;
        self.columns[span.clone()].iter().copied().zip(&self.blocks[span])
    }

    /// The block at (`row`, `column`); zero outside the pattern.
    pub fn block(&self, row: usize, column: usize) -> Mat3<T> {
        self.find(row, column).map_or(Mat3::ZERO, |index| self.blocks[index])
    }

    /// Writes A x to `out`.
    pub(crate) fn times(&self, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        for (row, out) in out.iter_mut().enumerate() {
            let mut sum = Vec3::ZERO;
            for (column, block) in self.row(row) {
                sum += *block * x[column as usize];
            }
            *out = sum;
        }
    }

    fn find(&self, row: usize, column: usize) -> Option<usize> {
        let (start, end) = (self.starts[row] as usize, self.starts[row + 1] as usize);
        self.columns[start..end].binary_search(&(column as u32)).ok().map(|offset| start + offset)
    }
}

/// Which nodes know each other's forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach<'a> {
    /// Those within so many rings of cells ([`ForceModel::rings`](crate::model::ForceModel::rings)).
    pub rings: usize,
    /// Besides, all of these ([`ForceModel::coupled`](crate::model::ForceModel::coupled)).
    pub coupled: &'a [u32],
    /// And all of each of these groups: what actuators join.
    pub groups: &'a [Vec<u32>],
}

impl From<usize> for Reach<'_> {
    fn from(rings: usize) -> Self {
        Self { rings, coupled: &[], groups: &[] }
    }
}

/// The nodes that each node knows, itself included, ascending, when cells are `removed`.
pub(super) fn pattern(mesh: &VolumeMesh, reach: Reach<'_>, removed: &[bool]) -> Vec<Vec<u32>> {
    let ring = neighbours(mesh, removed);
    let mut pattern = ring.clone();
    for _ in 1..reach.rings {
        let beyond = |near: &Vec<u32>| near.iter().flat_map(|&node| ring[node as usize].iter().copied()).collect();
        pattern = pattern.iter().map(beyond).collect();
        pattern.iter_mut().for_each(sort);
    }
    for group in reach.groups.iter().map(Vec::as_slice).chain([reach.coupled]) {
        for &node in group {
            pattern[node as usize].extend_from_slice(group);
            sort(&mut pattern[node as usize]);
        }
    }
    pattern
}

/// The nodes that share a cell with each node, itself included, ascending.
fn neighbours(mesh: &VolumeMesh, removed: &[bool]) -> Vec<Vec<u32>> {
    let mut neighbours: Vec<Vec<u32>> = (0..mesh.nodes().len() as u32).map(|node| vec![node]).collect();
    for cell in (0..mesh.cell_count()).filter(|&cell| !removed[cell]) {
        let corners = mesh.cell(cell);
        for &corner in corners {
            neighbours[corner as usize].extend_from_slice(corners);
        }
    }
    neighbours.iter_mut().for_each(sort);
    neighbours
}

fn sort(nodes: &mut Vec<u32>) {
    nodes.sort_unstable();
    nodes.dedup();
}

impl<T: Scalar> BlockSink<T> for BlockMatrix<T> {
    /// Panics for two nodes outside the pattern: a block of another mesh, or of a model that reaches further.
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        let index = self.find(row as usize, column as usize);
        assert!(
            index.is_some(),
            "nodes {row} and {column} are too far apart: the block is of another mesh, or of a model that reaches further"
        );
        index.into_iter().for_each(|index| self.blocks[index] += block);
    }
}

impl<T: Scalar> LinearOperator<T> for BlockMatrix<T> {
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        self.times(x, out);
    }
}
