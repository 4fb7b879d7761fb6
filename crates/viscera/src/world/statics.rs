use super::{BodyId, World};
use crate::dynamics::quasi_static::{QuasiStatic, StaticError, StaticReport};
use crate::math::Scalar;
use crate::solver::LinearSolver;

impl<T: Scalar> World<T> {
    /// Brings a body to rest under the world's gravity, its loads and prescribed motions as they are now. Time stands
    /// still. Panics for a number of another world.
    ///
    /// # Errors
    /// As [`QuasiStatic::solve`].
    pub fn settle(
        &mut self,
        id: BodyId,
        settings: &QuasiStatic,
        solver: &mut dyn LinearSolver,
    ) -> Result<StaticReport, StaticError> {
        let (gravity, time) = (self.config.gravity, self.time());
        settings.solve(&mut self.bodies[id.0], gravity, time, solver)
    }
}
