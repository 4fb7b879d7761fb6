use super::level_matrix::LevelMatrix;
use crate::math::{Scalar, Vec3};

/// The factors L D Lᵀ of a small symmetric matrix in double precision: each row from its first entry to the diagonal.
///
/// A direction in which the matrix does not resist is left out, as if it were held. That is right for what no place of the mesh
/// takes part in, and keeps the inverse from being negative where the matrix is.
#[derive(Clone, Debug)]
pub(super) struct Skyline {
    /// First column of each row.
    first: Vec<u32>,
    /// Where each row begins in `entries`.
    starts: Vec<u32>,
    entries: Vec<f64>,
    /// D⁻¹; zero for what is left out.
    inverse: Vec<f64>,
    solution: Vec<f64>,
}

/// A pivot below this many roundings of the entry it came from is none.
const ROUNDINGS: f64 = 64.0;

impl Skyline {
    /// Memory for a matrix of this pattern.
    pub(super) fn new<T: Scalar>(matrix: &LevelMatrix<T>) -> Self {
        let size = 3 * matrix.rows();
        let first: Vec<u32> =
            (0..size).map(|row| 3 * matrix.columns()[matrix.span(row / 3).start].min(row as u32 / 3)).collect();
        let mut starts = vec![0];
        for (row, &first) in first.iter().enumerate() {
            starts.push(starts[row] + row as u32 - first + 1);
        }
        let entries = vec![0.0; starts[size] as usize];
        Self { first, starts, entries, inverse: vec![0.0; size], solution: vec![0.0; size] }
    }

    /// Row `row` from its first entry to the diagonal.
    fn row(&self, row: usize) -> std::ops::Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }

    /// Factors a matrix.
    pub(super) fn factor<T: Scalar>(&mut self, matrix: &LevelMatrix<T>) {
        self.entries.fill(0.0);
        for row in 0..matrix.rows() {
            for index in matrix.span(row) {
                let column = matrix.columns()[index] as usize;
                for (across, numbers) in matrix.blocks[index].columns.iter().enumerate() {
                    for (down, number) in numbers.to_array().into_iter().enumerate() {
                        let (row, column) = (3 * row + down, 3 * column + across);
                        if column <= row {
                            let start = self.starts[row] as usize;
                            self.entries[start + column - self.first[row] as usize] = number.to_f64();
                        }
                    }
                }
            }
        }
        let least = ROUNDINGS * T::EPSILON.to_f64();
        for row in 0..self.first.len() {
            let (first, span) = (self.first[row] as usize, self.row(row));
            let (above, own) = self.entries.split_at_mut(span.start);
            let own = &mut own[..span.len()];
            // Entries times their pivots first: u_ij = a_ij − Σ u_ik l_jk.
            for column in first..row {
                let other = self.first[column] as usize;
                let from = first.max(other);
                let start = self.starts[column] as usize;
                let theirs = &above[start + from - other..start + column - other];
                let sum: f64 = own[from - first..column - first].iter().zip(theirs).map(|(u, l)| u * l).sum();
                own[column - first] -= sum;
            }
            let entry = own[row - first];
            let mut pivot = entry;
            for column in first..row {
                let product = own[column - first];
                own[column - first] = product * self.inverse[column];
                pivot -= product * own[column - first];
            }
            self.inverse[row] = if pivot > least * entry { 1.0 / pivot } else { 0.0 };
        }
    }

    /// Writes the solution for `right` to `x`.
    pub(super) fn solve<T: Scalar>(&mut self, right: &[Vec3<T>], x: &mut [Vec3<T>]) {
        for (solution, number) in self.solution.iter_mut().zip(right.iter().flat_map(|right| right.to_array())) {
            *solution = number.to_f64();
        }
        for row in 0..self.first.len() {
            let (first, span) = (self.first[row] as usize, self.row(row));
            let known = self.entries[span].iter().zip(&self.solution[first..row]);
            let sum: f64 = known.map(|(l, y)| l * y).sum();
            self.solution[row] -= sum;
        }
        for (solution, inverse) in self.solution.iter_mut().zip(&self.inverse) {
            *solution *= inverse;
        }
        for row in (0..self.first.len()).rev() {
            let (first, span) = (self.first[row] as usize, self.row(row));
            let own = self.solution[row];
            for (l, above) in self.entries[span].iter().zip(&mut self.solution[first..row]) {
                *above -= l * own;
            }
        }
        for (x, numbers) in x.iter_mut().zip(self.solution.chunks_exact(3)) {
            *x = Vec3::new(numbers[0], numbers[1], numbers[2]).cast();
        }
    }
}
