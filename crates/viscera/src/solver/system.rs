use super::{BlockMatrix, Filter, LinearOperator};
use crate::math::{Mat3, Vec3};
use crate::solver::BlockSink;

/// A stiffness matrix and the directions in which each node is free: S K S over the free ones.
#[derive(Clone, Debug)]
pub struct System {
    /// K [N/m].
    pub matrix: BlockMatrix<f64>,
    /// S of each node.
    pub filters: Vec<Filter<f64>>,
}

impl System {
    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.filters.len()
    }

    /// Mean of the diagonal [N/m], without signs.
    pub fn mean_diagonal(&self) -> f64 {
        let of_block = |block: Mat3<f64>| (0..3).map(|axis| block.columns[axis][axis].abs()).sum::<f64>();
        (0..self.nodes()).map(|node| of_block(self.matrix.block(node, node))).sum::<f64>() / (3 * self.nodes()) as f64
    }

    /// Adds `value` [N/m] to the diagonal.
    pub fn shift(&mut self, value: f64) {
        (0..self.nodes() as u32).for_each(|node| self.matrix.add(node, node, Mat3::diagonal(value)));
    }

    /// S_r K_rc S_c; on the diagonal with `held` (I − S), so that held directions are solved by zero.
    pub fn block(&self, row: usize, column: usize, held: f64) -> Mat3<f64> {
        let (of_row, of_column) = (&self.filters[row], &self.filters[column]);
        let block = self.matrix.block(row, column);
        let columns = Mat3::IDENTITY.columns.map(|axis| {
            let free = of_column.apply(axis);
            let force = of_row.apply(block * free);
            if row == column { force + (axis - free) * held } else { force }
        });
        Mat3 { columns }
    }

    /// Takes the held directions out of a nodal vector.
    pub fn filter(&self, vector: &mut [Vec3<f64>]) {
        vector.iter_mut().zip(&self.filters).for_each(|(v, filter)| *v = filter.apply(*v));
    }
}

impl LinearOperator<f64> for System {
    /// K x; the filters are the solver's business.
    fn apply(&mut self, x: &[Vec3<f64>], out: &mut [Vec3<f64>]) {
        self.matrix.apply(x, out);
    }
}
