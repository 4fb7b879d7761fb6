//! How a body answers small forces where it is: (K(x) + α M) u = f in the free directions.
//!
//! With α = 0 and f = −∂f_int/∂p it is the derivative of an equilibrium by a parameter p of the tissue, and its answer to the
//! derivative of a misfit is the adjoint state: either way, gradients for one linear solve each. With α = 1/dt² + γ/dt it is the same
//! for a step of backward Euler.

use super::bodies::Bodies;
use crate::body::SimulatedBody;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::BlockSink;
use crate::solver::{LinearSolver, SolverError};

/// Displacements [m] of the nodes for each of `forces` [N, one vector for each node], with the stiffness of the tissue, of
/// pressures, fields and actuators at `time` [s], and masses that count `inertia` times [1/s², ≥ 0]. Forces on what is held have no effect.
///
/// # Errors
/// [`SolverError::NotPositiveDefinite`] where the body is unstable, or nothing holds it; the others as the solver has them.
pub fn respond<T: Scalar>(
    body: &mut SimulatedBody<T>,
    time: f64,
    forces: &[Vec<Vec3<f64>>],
    inertia: f64,
    solver: &mut dyn LinearSolver,
) -> Result<Vec<Vec<Vec3<f64>>>, SolverError> {
    let mut body = Bodies::alone(body);
    body.update_internal_forces();
    let mut system = body.system();
    body.assemble(&mut system.matrix, time, 1.0);
    if inertia > 0.0 {
        for (node, mass) in body.nodal(|body, node| body.state.masses[node].to_f64()).into_iter().enumerate() {
            system.matrix.add(node as u32, node as u32, Mat3::diagonal(inertia * mass));
        }
    }
    solver.analyse(&system);
    solver.factor(&system)?;
    let answer = |force: &Vec<Vec3<f64>>| {
        let mut displacement = force.clone();
        system.filter(&mut displacement);
        solver.solve(&system, &mut displacement).map(|()| displacement)
    };
    forces.iter().map(answer).collect()
}
