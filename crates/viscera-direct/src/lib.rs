//! Sparse Cholesky factorisation for the quasi-static solver of [`viscera`], by the crate faer.
//!
//! A crate of its own, because faer takes long to compile and programs that play do not need it. 4 000 unknowns take about
//! 20 ms, 15 000 about 240 ms on one core.

use faer::Side;
use faer::linalg::solvers::Solve;
use faer::mat::MatMut;
use faer::sparse::linalg::LltError;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use viscera::solver::{LinearSolver, SolverError, SymmetricMatrix};

/// K = L Lᵀ, with a fill-reducing order found once for all matrices that share their entries.
///
/// ```
/// use viscera::solver::LinearSolver;
/// use viscera_direct::Cholesky;
///
/// let solver: &mut dyn LinearSolver = &mut Cholesky::default();
/// ```
#[derive(Default)]
pub struct Cholesky {
    symbolic: Option<SymbolicLlt<usize>>,
    numeric: Option<Llt<usize, f64>>,
}

fn pattern(matrix: &SymmetricMatrix) -> SymbolicSparseColMatRef<'_, usize> {
    let size = matrix.size();
    SymbolicSparseColMatRef::new_checked(size, size, matrix.column_starts(), None, matrix.rows())
}

impl LinearSolver for Cholesky {
    fn analyse(&mut self, matrix: &SymmetricMatrix) {
        self.numeric = None;
        self.symbolic = SymbolicLlt::try_new(pattern(matrix), Side::Lower).ok();
    }

    fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<(), SolverError> {
        let symbolic = self.symbolic.clone().ok_or(SolverError::OutOfMemory)?;
        let values = SparseColMatRef::new(pattern(matrix), matrix.values());
        self.numeric = None;
        match Llt::try_new_with_symbolic(symbolic, values, Side::Lower) {
            Ok(factors) => self.numeric = Some(factors),
            Err(LltError::Numeric(_)) => return Err(SolverError::NotPositiveDefinite),
            Err(LltError::Generic(_)) => return Err(SolverError::OutOfMemory),
        }
        Ok(())
    }

    fn solve(&mut self, matrix: &SymmetricMatrix, right: &mut [f64]) -> Result<(), SolverError> {
        let numeric = self.numeric.as_ref().ok_or(SolverError::NotPositiveDefinite)?;
        numeric.solve_in_place(MatMut::from_column_major_slice_mut(right, matrix.size(), 1));
        Ok(())
    }
}
