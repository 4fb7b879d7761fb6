//! Conjugate gradients with the diagonal as preconditioner: what needs no factorisation, for large bodies and for programs
//! without one. A matrix that is not positive definite is noticed where a direction of the iteration meets a negative
//! curvature, as it nearly always does; a factorisation is sure.
//!
//! Source: Hestenes, Stiefel, Methods of conjugate gradients for solving linear systems (1952).

use super::{LinearSolver, SolverError, SymmetricMatrix};

/// Conjugate gradients on the assembled matrix.
#[derive(Clone, Debug)]
pub struct ConjugateGradient {
    /// Where to stop: residual over right-hand side, both in the norm of the preconditioner.
    pub tolerance: f64,
    /// The most iterations of a solve; 0 stands for ten times the number of unknowns.
    pub iterations: usize,
    inverse_diagonal: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

impl ConjugateGradient {
    /// A solver that stops at this relative residual [> 0].
    pub fn new(tolerance: f64) -> Self {
        let empty = Vec::new;
        Self {
            tolerance,
            iterations: 0,
            inverse_diagonal: empty(),
            residual: empty(),
            direction: empty(),
            product: empty(),
        }
    }
}

/// A residual of 1e-12: what a factorisation would leave.
impl Default for ConjugateGradient {
    fn default() -> Self {
        Self::new(1e-12)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl LinearSolver for ConjugateGradient {
    fn analyse(&mut self, matrix: &SymmetricMatrix) {
        for vector in [&mut self.inverse_diagonal, &mut self.residual, &mut self.direction, &mut self.product] {
            vector.clear();
            vector.resize(matrix.size(), 0.0);
        }
    }

    fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<(), SolverError> {
        for (inverse, value) in self.inverse_diagonal.iter_mut().zip(matrix.diagonal()) {
            if value.is_nan() || value <= 0.0 {
                return Err(SolverError::NotPositiveDefinite);
            }
            *inverse = 1.0 / value;
        }
        Ok(())
    }

    fn solve(&mut self, matrix: &SymmetricMatrix, right: &mut [f64]) -> Result<(), SolverError> {
        let Self { inverse_diagonal, residual, direction, product, .. } = self;
        let limit = if self.iterations == 0 { 10 * matrix.size() } else { self.iterations };
        residual.copy_from_slice(right);
        right.fill(0.0);
        let weight = |r: &[f64]| r.iter().zip(inverse_diagonal.iter()).map(|(r, d)| r * r * d).sum::<f64>();
        direction.iter_mut().zip(residual.iter()).zip(inverse_diagonal.iter()).for_each(|((p, r), d)| *p = r * d);
        let start = weight(residual);
        let mut size = start;
        for _ in 0..limit {
            if size <= start * self.tolerance * self.tolerance {
                return Ok(());
            }
            matrix.multiply(direction, product);
            let curvature = dot(direction, product);
            if curvature.is_nan() || curvature <= 0.0 {
                return Err(SolverError::NotPositiveDefinite);
            }
            let length = size / curvature;
            right.iter_mut().zip(direction.iter()).for_each(|(u, p)| *u += length * p);
            residual.iter_mut().zip(product.iter()).for_each(|(r, q)| *r -= length * q);
            let before = std::mem::replace(&mut size, weight(residual));
            let turn = size / before;
            for ((p, r), d) in direction.iter_mut().zip(residual.iter()).zip(inverse_diagonal.iter()) {
                *p = r * d + turn * *p;
            }
        }
        Err(SolverError::NotConverged { residual: (size / start).sqrt(), iterations: limit })
    }
}
