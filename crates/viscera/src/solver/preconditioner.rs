use super::{Filter, LinearOperator};
use crate::executor::Executor;
use crate::math::{Scalar, Vec3};

/// A symmetric positive definite stand-in P for a matrix A whose systems are easier to solve.
///
/// Residuals are measured in a norm that all preconditioners of a matrix share, that of the inverse blocks on its diagonal, so
/// that a tolerance means the same whichever is used.
pub trait Preconditioner<T: Scalar> {
    /// Writes P⁻¹ r to `corrected`, for a residual without a part in the prescribed directions; what the result has in them is not
    /// used. `matrix` is A, for those that need products with it.
    fn apply(
        &mut self,
        matrix: &mut dyn LinearOperator<T>,
        filters: &[Filter<T>],
        residual: &[Vec3<T>],
        corrected: &mut [Vec3<T>],
        executor: &Executor,
    ) -> Size;

    /// The square of a residual's norm.
    fn squared_norm(&self, residual: &[Vec3<T>], executor: &Executor) -> f64;
}

/// How large a residual r is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// r·S P⁻¹ r.
    pub corrected: f64,
    /// The square of its norm.
    pub squared_norm: f64,
}
