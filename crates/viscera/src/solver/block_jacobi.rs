use super::{Filter, LinearOperator, Preconditioner, Size};
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::BlockSink;

/// Block-Jacobi preconditioner: the inverses of the 3×3 blocks on the diagonal, one for each node.
#[derive(Clone, Debug, Default)]
pub struct BlockJacobi<T> {
    /// Blocks, and after [`BlockJacobi::invert`] their inverses.
    blocks: Vec<Mat3<T>>,
}

/// A block whose determinant is below this share of that of a ball of the same trace counts as singular.
const SINGULAR: f64 = 1e-6;

impl<T: Scalar> BlockJacobi<T> {
    /// Memory for `nodes` nodes.
    pub fn new(nodes: usize) -> Self {
        Self { blocks: vec![Mat3::ZERO; nodes] }
    }

    /// Clears the blocks before new ones are added.
    pub fn clear(&mut self) {
        self.blocks.fill(Mat3::ZERO);
    }

    /// The blocks: of the matrix until [`BlockJacobi::invert`], of its inverse after it.
    pub fn blocks_mut(&mut self) -> &mut [Mat3<T>] {
        &mut self.blocks
    }

    /// Inverts the blocks `scale` K + `masses` I [kg/s²]. Where that is not positive definite (tissue under compression), the
    /// mass alone stands in: a preconditioner has to be positive definite, whatever the matrix is.
    pub fn invert(&mut self, scale: T, masses: impl Iterator<Item = T>) {
        for (block, mass) in self.blocks.iter_mut().zip(masses) {
            let sum = *block * scale + Mat3::diagonal(mass);
            *block = if is_positive_definite(&sum) {
                sum.inverse()
            } else if mass > T::ZERO {
                Mat3::diagonal(T::ONE / mass)
            } else {
                Mat3::IDENTITY
            };
        }
    }

    /// P⁻¹ r of a node.
    #[inline]
    pub(crate) fn at(&self, node: usize, residual: Vec3<T>) -> Vec3<T> {
        self.blocks[node] * residual
    }
}

impl<T: Scalar> Preconditioner<T> for BlockJacobi<T> {
    fn apply(
        &mut self,
        _matrix: &mut dyn LinearOperator<T>,
        filters: &[Filter<T>],
        residual: &[Vec3<T>],
        corrected: &mut [Vec3<T>],
    ) -> Size {
        let mut square = 0.0;
        for node in 0..residual.len() {
            corrected[node] = filters[node].apply(self.at(node, residual[node]));
            square += residual[node].dot(corrected[node]).to_f64();
        }
        Size { corrected: square, squared_norm: square }
    }

    fn squared_norm(&self, residual: &[Vec3<T>]) -> f64 {
        residual.iter().enumerate().map(|(node, &r)| r.dot(self.at(node, r)).to_f64()).sum()
    }
}

/// Sylvester's criterion, with a margin to singularity that is relative to the block's own size.
pub(super) fn is_positive_definite<T: Scalar>(block: &Mat3<T>) -> bool {
    let [a, b, _] = block.columns;
    let third = block.trace() / T::from_f64(3.0);
    let minor = a.x * b.y - b.x * a.y;
    let margin = T::from_f64(SINGULAR);
    a.x > margin * third && minor > margin * third * third && block.determinant() > margin * third * third * third
}

impl<T: Scalar> BlockSink<T> for BlockJacobi<T> {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        if row == column {
            self.blocks[row as usize] += block;
        }
    }

    fn keeps_diagonal_only(&self) -> bool {
        true
    }
}
