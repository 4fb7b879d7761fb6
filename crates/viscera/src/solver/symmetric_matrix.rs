/// A sparse symmetric matrix: its lower triangle by compressed columns, rows ascending, the diagonal first in each column.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricMatrix {
    /// Where each column starts, and the number of entries at the end.
    pub(crate) starts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

impl SymmetricMatrix {
    /// A matrix of zeros with these rows in each column of the lower triangle; they must ascend from the diagonal on.
    pub fn with_pattern(columns: &[Vec<usize>]) -> Self {
        let mut starts = vec![0];
        for (column, rows) in columns.iter().enumerate() {
            assert!(rows.first() == Some(&column), "a column starts with its diagonal");
            assert!(rows.windows(2).all(|pair| pair[0] < pair[1]), "rows ascend");
            starts.push(starts[column] + rows.len());
        }
        let rows = columns.concat();
        Self { values: vec![0.0; rows.len()], starts, rows }
    }

    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        self.starts.len() - 1
    }

    /// Where each column starts among rows and values, and the number of entries at the end.
    pub fn column_starts(&self) -> &[usize] {
        &self.starts
    }

    /// Row of each entry.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Value of each entry.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The entry of the lower triangle, if it is stored.
    pub(crate) fn entry_mut(&mut self, row: usize, column: usize) -> Option<&mut f64> {
        let span = self.starts[column]..self.starts[column + 1];
        let place = self.rows[span.clone()].binary_search(&row).ok()?;
        Some(&mut self.values[span.start + place])
    }

    /// The diagonal.
    pub fn diagonal(&self) -> impl Iterator<Item = f64> + '_ {
        self.starts[..self.size()].iter().map(|&start| self.values[start])
    }

    /// Adds `share` times the mean of the diagonal to the diagonal.
    pub fn shift(&mut self, share: f64) {
        let mean = self.diagonal().map(f64::abs).sum::<f64>() / self.size() as f64;
        for column in 0..self.size() {
            self.values[self.starts[column]] += share * mean;
        }
    }

    /// Writes A v to `out`.
    pub fn multiply(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for column in 0..self.size() {
            let span = self.starts[column]..self.starts[column + 1];
            let (mut sum, at_column) = (self.values[span.start] * v[column], v[column]);
            for entry in span.start + 1..span.end {
                let (row, value) = (self.rows[entry], self.values[entry]);
                out[row] += value * at_column;
                sum += value * v[row];
            }
            out[column] += sum;
        }
    }
}
