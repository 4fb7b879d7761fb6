use super::SolverError;

/// A pivot below this share of its diagonal is rounding: nothing resists in that direction.
pub(super) const LEAST_PIVOT: f64 = 1e-11;

/// A = L Lᵀ of a small symmetric matrix, rows of the lower triangle one after another, in memory that is asked for once.
#[derive(Clone, Debug, Default)]
pub(crate) struct DenseCholesky {
    size: usize,
    values: Vec<f64>,
}

impl DenseCholesky {
    /// Room for so many unknowns.
    pub(crate) fn with_room(size: usize) -> Self {
        Self { size: 0, values: Vec::with_capacity(size * (size + 1) / 2) }
    }

    /// Forgets the matrix.
    pub(crate) fn clear(&mut self) {
        self.size = 0;
        self.values.clear();
    }

    /// Replaces the matrix, of which `entry` gives row and column of the lower triangle, and factors it.
    ///
    /// # Errors
    /// [`SolverError::NotPositiveDefinite`].
    pub(crate) fn factor(
        &mut self,
        size: usize,
        mut entry: impl FnMut(usize, usize) -> f64,
    ) -> Result<(), SolverError> {
        self.clear();
        for row in 0..size {
            let start = self.values.len();
            for column in 0..row {
                let value = entry(row, column);
                let other = &self.values[column * (column + 1) / 2..][..=column];
                let sum = dot(&self.values[start..], &other[..column]);
                let value = (value - sum) / other[column];
                self.values.push(value);
            }
            let (diagonal, before) = (entry(row, row), &self.values[start..]);
            let pivot = diagonal - dot(before, before);
            if pivot <= LEAST_PIVOT * diagonal || !pivot.is_finite() {
                return Err(SolverError::NotPositiveDefinite);
            }
            self.values.push(pivot.sqrt());
        }
        self.size = size;
        Ok(())
    }

    /// Replaces the right-hand side by the solution.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        for row in 0..self.size {
            let values = self.row(row);
            x[row] = (x[row] - dot(&values[..row], &x[..row])) / values[row];
        }
        for row in (0..self.size).rev() {
            let values = self.row(row);
            let own = x[row] / values[row];
            x[row] = own;
            x[..row].iter_mut().zip(values).for_each(|(x, value)| *x -= own * value);
        }
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.values[row * (row + 1) / 2..][..=row]
    }
}

/// Eight sums at a time, for registers; always in the same order.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}
