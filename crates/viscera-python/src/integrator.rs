//! How bodies move in a step.

use pyo3::prelude::*;
use viscera::dynamics::implicit::{Implicit, MatrixForm, Newton, Preconditioning, Scheme};
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::solver::{Iterative, LinearSolver, Stop};
use viscera::world::{Integrator, Substep};
use viscera_direct::Cholesky;

use crate::model::choose;

/// Central differences in stable sub-steps: cheap where the tissue is soft or its cells are large.
#[pyclass(frozen, name = "Explicit", module = "viscera")]
pub(crate) struct PyExplicit(Substep);

#[pymethods]
impl PyExplicit {
    /// As few sub-steps as are stable, or sub-steps no longer than `substep` [s].
    #[new]
    #[pyo3(signature = (substep=None))]
    fn new(substep: Option<f64>) -> Self {
        Self(substep.map_or(Substep::Automatic, Substep::Fixed))
    }

    fn __repr__(&self) -> String {
        match self.0 {
            Substep::Automatic => "Explicit()".into(),
            Substep::Fixed(time) => format!("Explicit(substep={time:?})"),
        }
    }
}

/// One step that the forces at its end decide: stiff tissue and small cells bear long steps.
#[pyclass(frozen, name = "Implicit", module = "viscera")]
pub(crate) struct PyImplicit(Implicit);

/// From one equilibrium to the next: loads and prescribed motions go on with time, without inertia or damping.
#[pyclass(frozen, name = "QuasiStatic", module = "viscera")]
pub(crate) struct PyQuasiStatic {
    settings: QuasiStatic,
    /// Which linear solver.
    solver: String,
}

#[pymethods]
impl PyQuasiStatic {
    /// `tolerance`: residual relative to loads and reactions; `iterations`: the most for a share of a step's load; `small_strain`: one
    /// linear solve from rest in each step; `solver`: "iterative" (conjugate gradients) or "direct" (sparse Cholesky). How each step
    /// came to rest is in `SimulatedBody.static_report`.
    #[new]
    #[pyo3(signature = (*, tolerance=1e-10, iterations=30, small_strain=false, solver="iterative"))]
    fn new(tolerance: f64, iterations: usize, small_strain: bool, solver: &str) -> PyResult<Self> {
        static_solver(solver, TOLERANCE)?;
        let settings = QuasiStatic { tolerance, iterations, small_strain, ..QuasiStatic::default() };
        Ok(Self { settings, solver: solver.to_owned() })
    }

    fn __repr__(&self) -> String {
        format!("<{:?}, solver {:?}>", self.settings, self.solver)
    }
}

/// Residual of conjugate gradients: what a factorisation would leave.
pub(crate) const TOLERANCE: f64 = 1e-12;

/// The solver of an equilibrium's linear systems that is meant.
pub(crate) fn static_solver(name: &str, tolerance: f64) -> PyResult<Box<dyn LinearSolver>> {
    Ok(match choose("solver", name, &[("direct", true), ("iterative", false)])? {
        true => Box::new(Cholesky::default()),
        false => Box::new(Iterative::new(tolerance)),
    })
}

fn scheme(name: &str, beta: f64, gamma: f64) -> PyResult<Scheme> {
    let known = [
        ("backward-euler", Scheme::BackwardEuler),
        ("newmark", Scheme::Newmark { beta, gamma }),
        ("bdf2", Scheme::Bdf2),
        ("energy-momentum", Scheme::EnergyMomentum),
    ];
    choose("scheme", name, &known)
}

#[pymethods]
impl PyImplicit {
    /// `scheme`: "backward-euler", "newmark" (with `beta`, `gamma`), "bdf2" or "energy-momentum". `newton`: "linearised" (one linear
    /// solve for each step) or "full", to `newton_tolerance` in at most `newton_iterations`; by default linearised for
    /// backward Euler and full for the others. `linear_tolerance`, `linear_iterations`: when the conjugate gradient ends, by
    /// default at 1e-4 in 100 iterations where the step is linearised and at 1e-6 in 2000 where it is not; iterations alone are
    /// a fixed number. `matrix`: "free" or "assembled". `preconditioner`: "block-jacobi" or "multigrid".
    #[new]
    #[pyo3(signature = (scheme="backward-euler", *, newton=None, newton_tolerance=1e-8, newton_iterations=30,
        linear_tolerance=None, linear_iterations=None, matrix="free", preconditioner="block-jacobi", beta=0.25, gamma=0.5))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        scheme: &str,
        newton: Option<&str>,
        newton_tolerance: f64,
        newton_iterations: u32,
        linear_tolerance: Option<f64>,
        linear_iterations: Option<u32>,
        matrix: &str,
        preconditioner: &str,
        beta: f64,
        gamma: f64,
    ) -> PyResult<Self> {
        let scheme = self::scheme(scheme, beta, gamma)?;
        let by_default = if scheme == Scheme::BackwardEuler { "linearised" } else { "full" };
        let full = Newton::Full { relative: newton_tolerance, at_most: newton_iterations };
        let known = [("linearised", Newton::Linearised), ("full", full)];
        let newton = choose("newton", newton.unwrap_or(by_default), &known)?;
        let settings = match newton {
            Newton::Linearised => Implicit { scheme, ..Implicit::default() },
            Newton::Full { .. } => Implicit { newton, ..Implicit::accurate(scheme) },
        };
        let linear = match (linear_tolerance, linear_iterations) {
            (None, None) => settings.linear,
            (None, Some(iterations)) => Stop::Iterations(iterations),
            (Some(relative), iterations) => Stop::Tolerance { relative, at_most: iterations.unwrap_or(2000) },
        };
        let matrix = choose("matrix", matrix, &[("free", MatrixForm::Free), ("assembled", MatrixForm::Assembled)])?;
        let known = [("block-jacobi", Preconditioning::BlockJacobi), ("multigrid", Preconditioning::Multigrid)];
        let preconditioner = choose("preconditioner", preconditioner, &known)?;
        Ok(Self(Implicit { linear, matrix, preconditioner, ..settings }))
    }

    /// The scheme with Newton's method carried to 1e-8, and linear solves to 1e-6: for accuracy.
    #[staticmethod]
    #[pyo3(signature = (scheme="backward-euler"))]
    fn accurate(scheme: &str) -> PyResult<Self> {
        self::scheme(scheme, 0.25, 0.5).map(|scheme| Self(Implicit::accurate(scheme)))
    }

    fn __repr__(&self) -> String {
        format!("<{:?}>", self.0)
    }
}

/// The integrator that is meant, and the solver of its equilibria where another than the world's own is; explicit where none is given.
pub(crate) fn integrator(given: Option<&Bound<'_, PyAny>>) -> PyResult<(Integrator, Option<Box<dyn LinearSolver>>)> {
    let Some(given) = given else { return Ok((Integrator::default(), None)) };
    if let Ok(explicit) = given.cast::<PyExplicit>() {
        return Ok((Integrator::Explicit(explicit.get().0), None));
    }
    match given.cast::<PyQuasiStatic>() {
        Ok(quasi_static) => {
            let PyQuasiStatic { settings, solver } = quasi_static.get();
            Ok((Integrator::QuasiStatic(*settings), Some(static_solver(solver, TOLERANCE)?)))
        }
        Err(_) => Ok((Integrator::Implicit(given.cast::<PyImplicit>()?.get().0), None)),
    }
}
