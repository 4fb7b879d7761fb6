use super::System;
use crate::math::Vec3;

/// Something that solves K u = f in the free directions of a [`System`], with a symmetric positive definite K.
///
/// The engine has [`Iterative`](super::Iterative), and [`Envelope`](super::Envelope) for a few thousand unknowns; a sparse
/// Cholesky factorisation is in the crate `viscera-direct`, apart because it takes long to compile.
pub trait LinearSolver: Send + Sync {
    /// Whether it factorises the matrix: right sides then cost little, and one that is not positive definite is noticed for sure.
    fn factorises(&self) -> bool;

    /// Looks at which blocks and directions there are: once for all systems that share them.
    fn analyse(&mut self, system: &System);

    /// Looks at the values.
    ///
    /// # Errors
    /// [`SolverError::NotPositiveDefinite`], [`SolverError::OutOfMemory`].
    fn factor(&mut self, system: &System) -> Result<(), SolverError>;

    /// Replaces the right-hand side, which has no part in the held directions, by the solution, for the system that was
    /// factored last. Threads may solve with the same factors at once.
    ///
    /// # Errors
    /// [`SolverError`].
    fn solve(&self, system: &System, right: &mut [Vec3<f64>]) -> Result<(), SolverError>;
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
        iterations: u32,
    },
}
