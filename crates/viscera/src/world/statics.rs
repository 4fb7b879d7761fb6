use super::{BodyId, Integrator, World, WorldError};
use crate::dynamics::quasi_static::{QuasiStatic, StaticError, StaticReport, respond};
use crate::math::{Scalar, Vec3};
use crate::solver::{LinearSolver, SolverError};

impl<T: Scalar> World<T> {
    /// What solves the linear systems of quasi-static steps: [`Iterative`](crate::solver::Iterative) to 1e-12, unless another was given.
    pub fn static_solver(&self) -> &dyn LinearSolver {
        self.static_solver.as_ref()
    }

    /// Lets `solver` solve the linear systems of quasi-static steps from now on: a factorisation, where stiffnesses are close to
    /// singular, or a body has few thousand unknowns. Bodies that are attached to each other keep conjugate gradients to 1e-12, which know
    /// the ties.
    ///
    /// ```
    /// use viscera::dynamics::quasi_static::QuasiStatic;
    /// use viscera::solver::Envelope;
    /// use viscera::world::{Integrator, World, WorldConfig};
    ///
    /// let integrator = Integrator::QuasiStatic(QuasiStatic::default());
    /// let mut world = World::<f64>::new(WorldConfig { integrator, ..WorldConfig::default() })?;
    /// world.set_static_solver(Box::new(Envelope::default()))?;
    /// assert!(world.static_solver().factorises());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`WorldError::AttachmentNeedsIterative`] for a factorisation in a quasi-static world with attached bodies; the solver stays as it was.
    pub fn set_static_solver(&mut self, solver: Box<dyn LinearSolver>) -> Result<(), WorldError> {
        if let Some(grown) = self.attachments.first() {
            self.check_solver_of_ties(solver.as_ref(), grown.ends())?;
        }
        self.static_solver = solver;
        Ok(())
    }

    /// A factorisation knows no ties between the `attached` body and the one that it is attached to.
    pub(super) fn check_solver_of_ties(
        &self,
        solver: &dyn LinearSolver,
        attached: [BodyId; 2],
    ) -> Result<(), WorldError> {
        if matches!(self.config.integrator, Integrator::QuasiStatic(_)) && solver.factorises() {
            let [body, to] = attached.map(|id| self.bodies[id.0].name.clone());
            return Err(WorldError::AttachmentNeedsIterative { body, to });
        }
        Ok(())
    }

    /// Brings a body to rest under the world's gravity, its loads and prescribed motions as they are now. Time stands
    /// still. Panics for a number of another world.
    ///
    /// ```
    /// use viscera::body::Body;
    /// use viscera::dynamics::quasi_static::QuasiStatic;
    /// use viscera::material::{NeoHookean, Tissue};
    /// use viscera::mesh::{Region, TetMesh};
    /// use viscera::model::TotalLagrangian;
    /// use viscera::solver::Iterative;
    /// use viscera::world::{World, WorldConfig};
    ///
    /// let mesh = TetMesh::box_grid([2, 2, 8], [0.1, 0.1, 0.4]); // m
    /// let tissue = Tissue::uniform(NeoHookean::from_young_poisson(10e3, 0.45)?); // Pa
    /// let mut world = World::<f64>::new(WorldConfig { gravity: [0.0, -0.5, 0.0], ..WorldConfig::default() })?;
    /// let bar = world.add(
    ///     Body::new(mesh, 1000.0 /* kg/m³ */)
    ///         .model(TotalLagrangian::new(tissue))
    ///         .fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0)),
    /// )?;
    /// let report = world.settle(bar, &QuasiStatic::default(), &mut Iterative::default())?;
    /// assert!(report.steps.last().and_then(|step| step.residuals.last()).is_some_and(|&residual| residual <= 1e-10));
    /// // What fixes the bar carries its weight of 2 N.
    /// assert!((world.observe(bar).reaction.y - 2.0).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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

    /// How a body answers small `forces` [N] where it is, see [`respond`]: displacements [m] of its nodes for each of them, with the
    /// masses counting `inertia` times [1/s²; 0 for a body at rest]. Nothing moves. Panics for a number of another world.
    ///
    /// # Errors
    /// As [`respond`].
    pub fn respond(
        &mut self,
        id: BodyId,
        forces: &[Vec<Vec3<f64>>],
        inertia: f64,
        solver: &mut dyn LinearSolver,
    ) -> Result<Vec<Vec<Vec3<f64>>>, SolverError> {
        let time = self.time();
        respond(&mut self.bodies[id.0], time, forces, inertia, solver)
    }
}
