//! Linear systems with a block of three unknowns for every node: block rows, filters, conjugate gradient with its preconditioners,
//! and the seam to factorisations.

mod block_jacobi;
mod block_matrix;
mod block_sink;
mod conjugate_gradient;
mod dense_cholesky;
mod envelope;
mod filter;
mod iterative;
mod linear_solver;
mod multigrid;
mod preconditioner;
mod system;
mod vectors;

pub use block_jacobi::BlockJacobi;
pub use block_matrix::{BlockMatrix, Reach};
pub use block_sink::BlockSink;
pub use conjugate_gradient::{ConjugateGradient, Ending, Problem, SolveReport, Stop};
pub(crate) use dense_cholesky::DenseCholesky;
pub use envelope::Envelope;
pub use filter::Filter;
pub use iterative::Iterative;
pub use linear_solver::{LinearSolver, SolverError};
pub use multigrid::{Cycle, Multigrid};
pub use preconditioner::{Preconditioner, Size};
pub use system::System;
pub(crate) use vectors::{add_weighted, dot, set_weighted};

use crate::math::{Scalar, Vec3};

/// A symmetric matrix that is known by what it does to a vector.
pub trait LinearOperator<T: Scalar> {
    /// Writes A x to `out`.
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]);
}
