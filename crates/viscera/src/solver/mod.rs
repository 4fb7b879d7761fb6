//! Linear systems with a block of three unknowns for every node: block rows, filters, conjugate gradient with its preconditioners,
//! the seam to factorisations, and equations that tie nodes together.

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
mod turn;
mod vectors;

pub use block_jacobi::BlockJacobi;
pub use block_matrix::{BlockMatrix, Reach};
pub use block_sink::BlockSink;
pub use conjugate_gradient::{ConjugateGradient, Ending, Problem, SolveReport, Stop};
pub(crate) use dense_cholesky::DenseCholesky;
pub use envelope::Envelope;
pub use filter::Filter;
pub(crate) use filtered::among;
pub use filtered::{Filtered, FilteredNodes};
pub use iterative::Iterative;
pub use linear_solver::{LinearSolver, SolverError};
pub use multigrid::{Cycle, Multigrid};
pub(crate) use placed_ties::PlacedTies;
pub use preconditioner::{Preconditioner, Size, Start, Stride};
pub use system::System;
pub(crate) use ties::{Tie, TieEquations};
pub use turn::Turn;
pub(crate) use turn::turn_block;
pub(crate) use vectors::{add_weighted, dot, dot_of, dot_of_rows, set_weighted};

use crate::executor::Executor;
use crate::math::{Scalar, Vec3};

/// A symmetric matrix that is known by what it does to a vector.
pub trait LinearOperator<T: Scalar>: Sync {
    /// Writes A x to `out`.
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]);

    /// Turns the direction and multiplies by it; gives p·S A p. What is done node by node at either end may be left to
    /// [`LinearOperator::finish`], which goes through the nodes anyway: an iteration of the conjugate gradient then goes through them once.
    fn apply_along(&mut self, mut turn: Turn<'_, T>, executor: &Executor) -> f64 {
        turn.make(executor);
        let Turn { direction, product, filtered, .. } = turn;
        self.apply(direction, product);
        filtered.apply(0, product);
        dot(executor, direction, product)
    }

    /// Does on a block of nodes, as the loops over nodes divide them, what the last [`LinearOperator::apply_along`] left to be done; all but the
    /// filters. Whoever looks at direction and product next does so once on each block.
    fn finish(&self, _block: usize, _direction: &mut [Vec3<T>], _product: &mut [Vec3<T>]) {}
}
