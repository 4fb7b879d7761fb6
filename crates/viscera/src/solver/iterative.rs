use super::{
    BlockJacobi, BlockMatrix, ConjugateGradient, Ending, FilteredNodes, LinearOperator, LinearSolver, PlacedTies,
    Problem, SolverError, Stop, System, TieEquations,
};
use crate::executor::Executor;
use crate::math::Vec3;

/// Conjugate gradients on the assembled matrix: what needs no factorisation, for large bodies and for programs without one.
///
/// A matrix that is not positive definite is noticed where a direction of the iteration meets a negative curvature, as it
/// nearly always does; a factorisation is sure.
#[derive(Clone, Debug)]
pub struct Iterative {
    /// Where to stop: residual over right-hand side, in the norm of the preconditioner [> 0, < 1].
    tolerance: f64,
    preconditioner: Option<BlockJacobi<f64>>,
    /// What the solution has to fulfil besides, and which of the nodes are there.
    ties: Option<(PlacedTies, TieEquations)>,
}

/// The most iterations for each unknown: rounding keeps the directions from being conjugate, and one is not enough.
const ITERATIONS: u32 = 10;

impl Iterative {
    /// A solver that stops at this relative residual [> 0, < 1].
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, preconditioner: None, ties: None }
    }

    /// The default for systems whose solutions fulfil ties, by the projected conjugate gradient; `by_mass` knows which of the nodes are there.
    pub(crate) fn tied(ties: PlacedTies, by_mass: TieEquations) -> Self {
        Self { ties: Some((ties, by_mass)), ..Self::default() }
    }
}

/// A residual of 1e-12: what a factorisation would leave.
impl Default for Iterative {
    fn default() -> Self {
        Self::new(1e-12)
    }
}

fn iterations(system: &System) -> u32 {
    3 * ITERATIONS * system.nodes() as u32
}

impl LinearSolver for Iterative {
    fn factorises(&self) -> bool {
        false
    }

    fn analyse(&mut self, system: &System) {
        self.preconditioner = Some(BlockJacobi::new(system.nodes()));
    }

    fn factor(&mut self, system: &System) -> Result<(), SolverError> {
        let preconditioner = self.preconditioner.get_or_insert_with(|| BlockJacobi::new(system.nodes()));
        for (node, block) in preconditioner.blocks_mut().iter_mut().enumerate() {
            *block = system.matrix.block(node, node);
        }
        let nodes = FilteredNodes::of(&system.filters);
        preconditioner.invert(&vec![0.0; system.nodes()], nodes.with(&system.filters), &Executor::serial());
        if let Some((ties, by_mass)) = &mut self.ties {
            ties.update(by_mass, |node| preconditioner.inverse(node));
        }
        Ok(())
    }

    fn solve(&self, system: &System, right: &mut [Vec3<f64>]) -> Result<(), SolverError> {
        let mut preconditioner = self.preconditioner.clone().ok_or(SolverError::NotPositiveDefinite)?;
        let mut conjugate_gradient = ConjugateGradient::new(right.len(), iterations(system));
        let zeros = vec![Vec3::ZERO; right.len()];
        let mut solution = zeros.clone();
        let mut matrix = Tied { matrix: system.matrix.clone(), ties: self.ties.as_ref().map(|(ties, _)| ties.clone()) };
        matrix.take_out(right);
        let filtered_nodes = FilteredNodes::of(&system.filters);
        let problem = Problem {
            rhs: right,
            filtered: filtered_nodes.with(&system.filters),
            prescribed: &zeros,
            masses: &vec![0.0; zeros.len()],
            executor: &Executor::serial(),
        };
        let stop = Stop::Tolerance { relative: self.tolerance, at_most: iterations(system) };
        let report = conjugate_gradient.solve(&mut matrix, &mut preconditioner, &problem, stop, &mut solution);
        if let Some(ties) = &mut matrix.ties {
            ties.fulfil(&mut solution, |_| Vec3::ZERO);
        }
        match report.ending {
            Ending::Converged => right.copy_from_slice(&solution),
            Ending::NegativeCurvature => return Err(SolverError::NotPositiveDefinite),
            Ending::Exhausted => {
                return Err(SolverError::NotConverged { residual: report.residual, iterations: report.iterations });
            }
        }
        Ok(())
    }
}

/// A matrix, and what ties take of its products.
struct Tied {
    matrix: BlockMatrix<f64>,
    ties: Option<PlacedTies>,
}

impl Tied {
    fn take_out(&mut self, forces: &mut [Vec3<f64>]) {
        if let Some(ties) = &mut self.ties {
            ties.take_out(forces);
        }
    }
}

impl LinearOperator<f64> for Tied {
    fn apply(&mut self, x: &[Vec3<f64>], out: &mut [Vec3<f64>]) {
        self.matrix.times(x, out);
        self.take_out(out);
    }
}
