//! Linear systems: sparse symmetric matrices, how they are assembled, and what solves them.

mod assembly;
mod conjugate_gradient;
mod symmetric_matrix;

pub use assembly::{Assembly, neighbours};
pub use conjugate_gradient::ConjugateGradient;
pub use symmetric_matrix::SymmetricMatrix;

/// Something that solves K u = f for a sparse symmetric positive definite K.
///
/// The engine has [`ConjugateGradient`]; a sparse Cholesky factorisation is in the crate `viscera-direct`, apart because it
/// takes long to compile.
pub trait LinearSolver {
    /// Looks at which entries there are: once for all matrices that share them.
    fn analyse(&mut self, matrix: &SymmetricMatrix);

    /// Looks at the values.
    ///
    /// # Errors
    /// [`SolverError::NotPositiveDefinite`].
    fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<(), SolverError>;

    /// Replaces the right-hand side by the solution, for the matrix that was factored last.
    ///
    /// # Errors
    /// [`SolverError`].
    fn solve(&mut self, matrix: &SymmetricMatrix, right: &mut [f64]) -> Result<(), SolverError>;
}

/// Why a system is not solved.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SolverError {
    /// There is a direction in which the matrix does not resist.
    #[error("the stiffness matrix is not positive definite: the body is unstable, or nothing holds it")]
    NotPositiveDefinite,
    /// There is no memory for the factors.
    #[error("the factors of the stiffness matrix do not fit into memory; take conjugate gradients, or fewer cells")]
    OutOfMemory,
    /// The iteration did not come to an end.
    #[error(
        "conjugate gradients left a residual of {residual:.1e} after {iterations} iterations; allow more, or take a factorisation"
    )]
    NotConverged {
        /// Residual relative to the right-hand side.
        residual: f64,
        /// Iterations made.
        iterations: usize,
    },
}
