/// What implicit steps did; of several bodies, the worst.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImplicitReport {
    /// Iterations of Newton's method; 1 for a linearised step, unless that said nothing.
    pub newton_iterations: u32,
    /// Iterations of the conjugate gradient, over all iterations of Newton's method.
    pub linear_iterations: u32,
    /// What is left of the residual: of the forces in a full step, over the forces that balance; of the linear system in a
    /// linearised one, over its right-hand side in the norm of the preconditioner.
    pub residual: f64,
    /// Whether that is below what was asked for, or the step has come to rest on a crease of its energy. A fixed number of iterations asks for
    /// nothing. A full step of forces without a potential that has no solution, and is linearised instead, is not.
    pub converged: bool,
    /// Whether a linear solve met a direction of negative curvature: tissue under strong compression.
    pub negative_curvature: bool,
}

impl ImplicitReport {
    /// Where nothing was to be done.
    pub(crate) const NOTHING: Self =
        Self { newton_iterations: 0, linear_iterations: 0, residual: 0.0, converged: true, negative_curvature: false };

    /// A solve after this one in the same step.
    pub(crate) fn then(self, next: Self) -> Self {
        Self {
            newton_iterations: self.newton_iterations + next.newton_iterations,
            linear_iterations: self.linear_iterations + next.linear_iterations,
            negative_curvature: self.negative_curvature || next.negative_curvature,
            ..next
        }
    }

    /// The worse of the two in each number.
    pub(crate) fn worst(self, other: Self) -> Self {
        Self {
            newton_iterations: self.newton_iterations.max(other.newton_iterations),
            linear_iterations: self.linear_iterations.max(other.linear_iterations),
            residual: self.residual.max(other.residual),
            converged: self.converged && other.converged,
            negative_curvature: self.negative_curvature || other.negative_curvature,
        }
    }
}
