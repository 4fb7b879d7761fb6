//! Sparse Cholesky factorisation for the quasi-static solver of [`viscera`], by the crate faer.
//!
//! A crate of its own, because faer takes long to compile and programs that play do not need it. 4 000 unknowns take about
//! 20 ms, 15 000 about 240 ms on one core.

mod triangle;

use faer::Side;
use faer::linalg::solvers::Solve;
use faer::mat::MatMut;
use faer::sparse::linalg::LltError;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use viscera::math::Vec3;
use viscera::solver::{LinearSolver, SolverError, System};

use crate::triangle::Triangle;

/// K = L Lᵀ, with a fill-reducing order found once for all systems that share their entries.
///
/// ```
/// use viscera::solver::LinearSolver;
/// use viscera_direct::Cholesky;
///
/// let solver: &mut dyn LinearSolver = &mut Cholesky::default();
/// ```
#[derive(Default)]
pub struct Cholesky {
    triangle: Triangle,
    symbolic: Option<SymbolicLlt<usize>>,
    numeric: Option<Llt<usize, f64>>,
}

impl Cholesky {
    fn pattern(&self) -> SymbolicSparseColMatRef<'_, usize> {
        let Triangle { starts, rows, .. } = &self.triangle;
        SymbolicSparseColMatRef::new_checked(starts.len() - 1, starts.len() - 1, starts, None, rows)
    }
}

impl LinearSolver for Cholesky {
    fn factorises(&self) -> bool {
        true
    }

    fn analyse(&mut self, system: &System) {
        self.numeric = None;
        self.triangle = Triangle::new(system);
        self.symbolic = SymbolicLlt::try_new(self.pattern(), Side::Lower).ok();
    }

    fn factor(&mut self, system: &System) -> Result<(), SolverError> {
        let symbolic = self.symbolic.clone().ok_or(SolverError::OutOfMemory)?;
        self.numeric = None;
        self.triangle.fill(system);
        let values = SparseColMatRef::new(self.pattern(), &self.triangle.values);
        let outcome = Llt::try_new_with_symbolic(symbolic, values, Side::Lower);
        match outcome {
            Ok(factors) => self.numeric = Some(factors),
            Err(LltError::Numeric(_)) => return Err(SolverError::NotPositiveDefinite),
            Err(LltError::Generic(_)) => return Err(SolverError::OutOfMemory),
        }
        Ok(())
    }

    fn solve(&self, _system: &System, right: &mut [Vec3<f64>]) -> Result<(), SolverError> {
        let numeric = self.numeric.as_ref().ok_or(SolverError::NotPositiveDefinite)?;
        let mut numbers: Vec<f64> = right.iter().flat_map(|v| v.to_array()).collect();
        let size = numbers.len();
        numeric.solve_in_place(MatMut::from_column_major_slice_mut(&mut numbers, size, 1));
        right.iter_mut().zip(numbers.chunks_exact(3)).for_each(|(v, u)| *v = Vec3::new(u[0], u[1], u[2]));
        Ok(())
    }
}
