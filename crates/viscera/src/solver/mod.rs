//! Linear systems with a block of three unknowns for every node: block rows, filters, conjugate gradient with its preconditioners,
//! the seam to factorisations, and
//! equations that tie nodes together.

mod block_jacobi;
mod block_matrix;
mod block_sink;
mod conjugate_gradient;
mod dense_cholesky;
mod envelope;
mod filter;
mod filtered;
mod iterative;
mod linear_solver;
mod multigrid;
mod placed_ties;
mod preconditioner;
mod system;
mod ties;
mod vectors;

pub use block_jacobi::BlockJacobi;
pub use block_matrix::{BlockMatrix, Reach};
pub use block_sink::BlockSink;
pub use conjugate_gradient::{ConjugateGradient, Ending, Problem, SolveReport, Stop};
pub(crate) use dense_cholesky::DenseCholesky;
pub use envelope::Envelope;
pub use filter::Filter;
pub use filtered::Filtered;
pub use iterative::Iterative;
pub use linear_solver::{LinearSolver, SolverError};
pub use multigrid::{Cycle, Multigrid};
pub(crate) use placed_ties::PlacedTies;
pub use preconditioner::{Preconditioner, Size, Stride};
pub use system::System;
pub(crate) use ties::{Tie, TieEquations};
pub(crate) use vectors::{add_weighted, dot, dot_of, set_weighted};

use crate::executor::Executor;
use crate::math::{Scalar, Vec3};

/// A symmetric matrix that is known by what it does to a vector.
pub trait LinearOperator<T: Scalar> {
    /// Writes A x to `out`.
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]);

    /// Writes S A x to `out` and gives x·S A x: what an iteration of the conjugate gradient asks for. An operator that goes through the nodes
    /// at its end does all three on the way.
    fn apply_along(
        &mut self,
        x: &[Vec3<T>],
        filtered: &Filtered<'_, T>,
        executor: &Executor,
        out: &mut [Vec3<T>],
    ) -> f64 {
        self.apply(x, out);
        filtered.apply(0, out);
        dot(executor, x, out)
    }
}
