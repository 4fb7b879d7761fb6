//! Linear systems with a block of three unknowns for every node: conjugate gradient with filters, block rows.

mod block_jacobi;
mod block_matrix;
mod conjugate_gradient;
mod filter;

pub use block_jacobi::BlockJacobi;
pub use block_matrix::BlockMatrix;
pub(crate) use conjugate_gradient::dot;
pub use conjugate_gradient::{ConjugateGradient, Ending, Problem, SolveReport, Stop};
pub use filter::Filter;

use crate::math::{Scalar, Vec3};

/// A symmetric matrix that is known by what it does to a vector.
pub trait LinearOperator<T: Scalar> {
    /// Writes A x to `out`.
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]);
}
