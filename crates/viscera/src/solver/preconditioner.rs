use super::vectors::step_along;
use super::{Filter, Filtered, LinearOperator};
use crate::executor::{Executor, NODE_BLOCK, NodeBlocks, ReadBlocks, node_blocks};
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

    /// Takes the first product off the right-hand side, and writes what [`Preconditioner::apply`] makes of the residual over it; gives the
    /// norms of both as well, together.
    fn start(&mut self, matrix: &mut dyn LinearOperator<T>, start: Start<'_, T>, executor: &Executor) -> (Size, f64) {
        let Start { rhs, direction, product, residual, filtered } = start;
        finish(matrix, direction, product, &filtered, executor);
        residual.copy_from_slice(rhs);
        filtered.apply(0, residual);
        let scale = self.squared_norm(residual, executor).sqrt() + self.squared_norm(product, executor).sqrt();
        let data = (NodeBlocks(residual), ReadBlocks(product));
        executor.each(node_blocks(data.0.0.len()), data, &|_, (NodeBlocks(r), ReadBlocks(product))| {
            r.iter_mut().zip(product).for_each(|(r, &product)| *r -= product);
        });
        let size = self.apply(matrix, filtered.filters, residual, product, executor);
        filtered.apply(0, product);
        (size, scale)
    }

    /// Goes along a stride, and writes what [`Preconditioner::apply`] makes of the new residual over the product, filtered. A preconditioner
    /// that goes through the nodes does both on the way.
    fn stride(&mut self, matrix: &mut dyn LinearOperator<T>, stride: Stride<'_, T>, executor: &Executor) -> Size {
        let Stride { length, direction, x, residual, product, filtered } = stride;
        finish(matrix, direction, product, &filtered, executor);
        step_along(executor, (x, residual), length, (direction, product));
        let size = self.apply(matrix, filtered.filters, residual, product, executor);
        filtered.apply(0, product);
        size
    }

    /// The square of a residual's norm.
    fn squared_norm(&self, residual: &[Vec3<T>], executor: &Executor) -> f64;
}

/// The beginning of a solve: r = S b − S A x, A x being the last product.
#[derive(Debug)]
pub struct Start<'a, T> {
    /// b.
    pub rhs: &'a [Vec3<T>],
    /// x.
    pub direction: &'a mut [Vec3<T>],
    /// S A x, but for what [`LinearOperator::finish`] does, and afterwards P⁻¹ r.
    pub product: &'a mut [Vec3<T>],
    /// r.
    pub residual: &'a mut [Vec3<T>],
    /// S.
    pub filtered: Filtered<'a, T>,
}

/// x ← x + s p and r ← r − s q: a step of the conjugate gradient.
#[derive(Debug)]
pub struct Stride<'a, T> {
    /// s.
    pub length: T,
    /// p, but for what [`LinearOperator::finish`] does.
    pub direction: &'a mut [Vec3<T>],
    /// x.
    pub x: &'a mut [Vec3<T>],
    /// r.
    pub residual: &'a mut [Vec3<T>],
    /// q, but for what [`LinearOperator::finish`] does, and afterwards P⁻¹ r.
    pub product: &'a mut [Vec3<T>],
    /// S.
    pub filtered: Filtered<'a, T>,
}

/// How large a residual r is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// r·S P⁻¹ r.
    pub corrected: f64,
    /// The square of its norm.
    pub squared_norm: f64,
}

/// Finishes a product on all nodes.
fn finish<T: Scalar>(
    matrix: &dyn LinearOperator<T>,
    direction: &mut [Vec3<T>],
    product: &mut [Vec3<T>],
    filtered: &Filtered<'_, T>,
    executor: &Executor,
) {
    let data = (NodeBlocks(direction), NodeBlocks(product));
    executor.each(node_blocks(data.0.0.len()), data, &|block, (NodeBlocks(direction), NodeBlocks(product))| {
        matrix.finish(block, direction, product);
        filtered.apply(block * NODE_BLOCK, product);
    });
}
