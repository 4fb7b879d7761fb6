use crate::math::{Mat3, Scalar, Vec3};

/// Rows of 3×3 blocks over the nodes of a lattice, both of every two that mirror each other.
#[derive(Clone, Debug)]
pub(super) struct LevelMatrix<T> {
    starts: Vec<u32>,
    /// Ascending within a row.
    columns: Vec<u32>,
    /// Where the block of the same two nodes in the other order is.
    mirrors: Vec<u32>,
    pub(super) blocks: Vec<Mat3<T>>,
}

/// The pattern of a symmetric matrix while it is put together.
pub(super) struct Pattern {
    rows: Vec<Vec<u32>>,
    /// How many columns each row had when it was last sorted.
    sorted: Vec<usize>,
}

impl Pattern {
    pub(super) fn new(rows: usize) -> Self {
        Self { rows: vec![Vec::new(); rows], sorted: vec![0; rows] }
    }

    /// A block at (`row`, `column`), and one at its mirror image.
    pub(super) fn add(&mut self, row: u32, column: u32) {
        for (row, column) in [(row as usize, column), (column as usize, row)] {
            self.rows[row].push(column);
            // Thousands of cells name the same block: what is kept stays within three times what is needed.
            if self.rows[row].len() > 2 * self.sorted[row] + 32 {
                sort(&mut self.rows[row]);
                self.sorted[row] = self.rows[row].len();
            }
        }
    }
}

fn sort(columns: &mut Vec<u32>) {
    columns.sort_unstable();
    columns.dedup();
}

impl<T: Scalar> LevelMatrix<T> {
    /// The zero matrix of a pattern.
    pub(super) fn new(mut pattern: Pattern) -> Self {
        let (mut starts, mut columns) = (vec![0], Vec::new());
        for row in &mut pattern.rows {
            sort(row);
            columns.extend_from_slice(row);
            starts.push(columns.len() as u32);
        }
        let blocks = vec![Mat3::ZERO; columns.len()];
        let mut matrix = Self { starts, columns, mirrors: Vec::new(), blocks };
        let entries = (0..matrix.rows()).flat_map(|row| matrix.span(row).map(move |index| (row, index)));
        matrix.mirrors = entries.map(|(row, index)| matrix.index(matrix.columns[index], row as u32)).collect();
        matrix
    }

    pub(super) fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn span(&self, row: usize) -> std::ops::Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }

    /// Columns of all blocks, row after row.
    pub(super) fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// Where the block at (`row`, `column`) is, which is in the pattern.
    pub(super) fn index(&self, row: u32, column: u32) -> u32 {
        let span = self.span(row as usize);
        (span.start + self.columns[span].partition_point(|&other| other < column)) as u32
    }

    /// Puts A + Aᵀ in the place of A.
    pub(super) fn add_transpose(&mut self) {
        for row in 0..self.rows() {
            for index in self.span(row) {
                let mirror = self.mirrors[index] as usize;
                if mirror >= index {
                    let sum = self.blocks[index] + self.blocks[mirror].transpose();
                    self.blocks[index] = sum;
                    self.blocks[mirror] = sum.transpose();
                }
            }
        }
    }

    /// Writes A x to `out`.
    pub(super) fn apply(&self, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        for (row, out) in out.iter_mut().enumerate() {
            let span = self.span(row);
            let mut sum = Vec3::ZERO;
            for (&column, block) in self.columns[span.clone()].iter().zip(&self.blocks[span]) {
                sum += *block * x[column as usize];
            }
            *out = sum;
        }
    }
}
