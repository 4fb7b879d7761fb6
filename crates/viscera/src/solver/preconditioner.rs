use super::vectors::step_along;
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

    /// Goes along a stride, and writes what [`Preconditioner::apply`] makes of the new residual over the product. A preconditioner that
    /// goes through the nodes does both on the way.
    fn stride(
        &mut self,
        matrix: &mut dyn LinearOperator<T>,
        filters: &[Filter<T>],
        stride: Stride<'_, T>,
        executor: &Executor,
    ) -> Size {
        let Stride { length, direction, x, residual, product } = stride;
        step_along(executor, (x, residual), length, (direction, product));
        self.apply(matrix, filters, residual, product, executor)
    }

    /// The square of a residual's norm.
    fn squared_norm(&self, residual: &[Vec3<T>], executor: &Executor) -> f64;
}

/// x ← x + s p and r ← r − s q: a step of the conjugate gradient.
#[derive(Debug)]
pub struct Stride<'a, T> {
    /// s.
    pub length: T,
    /// p.
    pub direction: &'a [Vec3<T>],
    /// x.
    pub x: &'a mut [Vec3<T>],
    /// r.
    pub residual: &'a mut [Vec3<T>],
    /// q, and afterwards P⁻¹ r.
    pub product: &'a mut [Vec3<T>],
}

/// How large a residual r is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// r·S P⁻¹ r.
    pub corrected: f64,
    /// The square of its norm.
    pub squared_norm: f64,
}
