//! Equilibrium under loads: Newton's method with load steps and a line search.
//!
//! Sought is x with f_int(x) = f_ext(x) in the free directions. The load is put on in steps, each a share s of the way
//! from where the body is (s = 0) to the whole load (s = 1):
//!
//! f_int(x) = (1 − s) f_int(x_start) + s f_ext(x),   x_held = (1 − s) x_start + s x_target
//!
//! so that any state is a start. The first try is the whole load; a share that fails is halved, one that succeeds is doubled.
//!
//! One iteration solves K p = r with the tangent K(x), shifted along its diagonal until it is positive definite, so that p
//! lowers the energy W(x) − f_ext·x (Nocedal, Wright, Numerical optimization, 2006, sections 3.4 and 3.5). K has the symmetric
//! part of the derivative of loads that follow the surface (pressures): all of it but at the rim of the loaded surface.
//!
//! Bodies that ties hold together have one system: every p and every jump of what is held fulfils the ties, and what they give is taken out of
//! the residual.
//!
//! A state counts when its residual is small, its stiffness positive definite without a shift, and no cell inverted. Laws
//! without a barrier, as St Venant–Kirchhoff, have other equilibria, inside out, which are no answers.

mod bodies;
mod equilibrium;
mod error;
mod response;

pub use crate::body::{LoadStep, StaticReport};
pub(crate) use bodies::Bodies;
pub use error::{StaticError, StaticFailure};
pub use response::respond;

use self::equilibrium::Equilibrium;
use crate::body::SimulatedBody;
use crate::math::{Scalar, Vec3};
use crate::solver::LinearSolver;

/// Settings of the search for an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuasiStatic {
    /// Residual at which to stop, relative to loads and reactions [> 0]; 1e-10 by default. Where rounding
    /// stops the descent before that, below √ε (1.5e-8, or 3.5e-4 in single precision), that is accepted, and reported.
    pub tolerance: f64,
    /// The most iterations for a share of the load [≥ 1]; 30 by default.
    pub iterations: usize,
    /// The first share of the load that is tried [0 < share ≤ 1]; all of it by default.
    pub first_step: f64,
    /// The least share by which the load is raised before giving up [> 0]; 1/256 by default.
    pub smallest_step: f64,
    /// One linear solve with the stiffness as it is at the start, for small displacements.
    pub small_strain: bool,
}

impl Default for QuasiStatic {
    fn default() -> Self {
        Self { tolerance: 1e-10, iterations: 30, first_step: 1.0, smallest_step: 1.0 / 256.0, small_strain: false }
    }
}

impl QuasiStatic {
    /// Brings a body to rest by itself, whatever it is attached to, under gravity [m/s²], its loads and prescribed motions as they are at
    /// `time` [s]. Velocities become zero. Nodes that an instrument holds stay where they are.
    ///
    /// # Errors
    /// [`StaticError`]; after [`StaticError::NoEquilibrium`] the body is in the last equilibrium that was found.
    pub fn solve<T: Scalar>(
        &self,
        body: &mut SimulatedBody<T>,
        gravity: [f64; 3],
        time: f64,
        solver: &mut dyn LinearSolver,
    ) -> Result<StaticReport, StaticError> {
        let gravity = Vec3::from(gravity).cast();
        self.solve_driven(Bodies::alone(body), gravity, time, |body, node| body.driven_to(node, time), solver)
    }

    /// The same with the places of held nodes from `target`.
    pub(crate) fn solve_driven<T: Scalar>(
        &self,
        mut bodies: Bodies<'_, T>,
        gravity: Vec3<T>,
        time: f64,
        target: impl Fn(&SimulatedBody<T>, usize) -> Option<Vec3<T>>,
        solver: &mut dyn LinearSolver,
    ) -> Result<StaticReport, StaticError> {
        bodies.report(None);
        if let Some((name, value, range)) = self.first_out_of_range() {
            return Err(StaticError::OutOfRange { name, value, range });
        }
        for body in &bodies.all {
            if let Some(advice) = body.model.info().no_implicit {
                return Err(StaticError::ModelHasNoEquilibrium { body: body.name.clone(), model: body.model, advice });
            }
            if let Some(feature) = body.explicit_feature() {
                return Err(StaticError::FeatureHasNoEquilibrium { body: body.name.clone(), feature });
            }
        }
        let mut equilibrium = Equilibrium::new(bodies, gravity, time, target, solver)?;
        let report = if self.small_strain { equilibrium.solve_once() } else { self.raise_load(&mut equilibrium) };
        equilibrium.come_to_rest();
        equilibrium.bodies.report(report.as_ref().ok());
        report
    }

    fn raise_load<T: Scalar>(&self, equilibrium: &mut Equilibrium<'_, T>) -> Result<StaticReport, StaticError> {
        let mut report = StaticReport { steps: Vec::new(), retries: 0 };
        let (mut share, mut step) = (0.0, self.first_step);
        while share < 1.0 {
            let next = if share + step > 1.0 - 1e-9 { 1.0 } else { share + step };
            match equilibrium.advance(next, self.tolerance, self.iterations) {
                Ok(residuals) => {
                    report.steps.push(LoadStep { share: next, residuals });
                    share = next;
                    step *= 2.0;
                }
                Err(failure) => {
                    step = 0.5 * (next - share);
                    report.retries += 1;
                    if step < self.smallest_step {
                        return Err(equilibrium.beyond(share, next, failure));
                    }
                }
            }
        }
        Ok(report)
    }

    /// The first setting that is out of range: its name, its value, and what would do.
    pub(crate) fn first_out_of_range(&self) -> Option<(&'static str, f64, &'static str)> {
        let settings = [
            ("tolerance", self.tolerance),
            ("iterations", self.iterations as f64),
            ("first_step", self.first_step),
            ("smallest_step", self.smallest_step),
        ];
        let (name, value) = settings.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0))?;
        Some((name, value, "positive"))
    }
}
