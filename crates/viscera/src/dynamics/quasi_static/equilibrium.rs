use super::{LoadStep, StaticError, StaticFailure, StaticReport};
use crate::body::{NodeMotion, SimulatedBody};
use crate::executor::Executor;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::BlockSink;
use crate::solver::{BlockMatrix, LinearOperator, LinearSolver, SolverError, System, dot};
use crate::stage::Stages;

/// Shares of the mean diagonal by which a stiffness that is not positive definite is shifted, one after the other.
const SHIFTS: [f64; 9] = [0.0, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 2.0, 10.0, 100.0];
/// Share of the decrease promised by the slope that a step must bring (Armijo).
const DECREASE: f64 = 1e-4;
/// How many times a step is halved.
const HALVINGS: usize = 14;

/// A body on its way to the equilibrium.
pub(super) struct Equilibrium<'a, T: Scalar> {
    body: &'a mut SimulatedBody<T>,
    solver: &'a mut dyn LinearSolver,
    gravity: Vec3<T>,
    time: f64,
    /// The stiffness, and the directions that are free.
    system: System,
    /// Whether the stiffness had to be shifted when it was last solved with.
    shifted: bool,
    start: Vec<Vec3<T>>,
    start_forces: Vec<Vec3<T>>,
    targets: Vec<Vec3<T>>,
}

impl<'a, T: Scalar> Equilibrium<'a, T> {
    pub(super) fn new(
        body: &'a mut SimulatedBody<T>,
        gravity: Vec3<T>,
        time: f64,
        target: impl Fn(&SimulatedBody<T>, usize) -> Option<Vec3<T>>,
        solver: &'a mut dyn LinearSolver,
    ) -> Result<Self, StaticError> {
        body.update_internal_forces(Stages::unobserved());
        let state = &body.state;
        if !state.motions.iter().any(|motion| !matches!(motion, NodeMotion::Free | NodeMotion::Retired)) {
            return Err(StaticError::NothingHolds { body: body.name.clone() });
        }
        let places = state.positions.iter().enumerate();
        let targets = places.map(|(node, &place)| target(body, node).unwrap_or(place)).collect();
        let filters = (0..state.motions.len()).map(|node| body.free_directions(node).cast()).collect();
        let system = System { matrix: BlockMatrix::new(&body.mesh, state.reach()), filters };
        solver.analyse(&system);
        let (start, start_forces) = (state.positions.clone(), state.internal_forces.clone());
        Ok(Self { body, solver, gravity, time, system, shifted: false, start, start_forces, targets })
    }

    /// Goes to a share of the load; gives the residuals. Where that fails, the body is as it was before.
    pub(super) fn advance(&mut self, share: f64, tolerance: f64, limit: usize) -> Result<Vec<f64>, StaticFailure> {
        let before = self.body.state.positions.clone();
        self.newton(share, tolerance, limit).inspect_err(|_| {
            self.body.state.positions.clone_from(&before);
            self.body.state.positions_changed();
        })
    }

    fn newton(&mut self, share: f64, tolerance: f64, limit: usize) -> Result<Vec<f64>, StaticFailure> {
        self.shifted = false;
        self.move_held_nodes(share).map_err(StaticFailure::Solver)?;
        let (mut forces, mut residual, mut scale) = self.residual(share);
        let mut residuals = vec![norm(&residual) / scale];
        while residuals[residuals.len() - 1] > tolerance {
            let reached = residuals[residuals.len() - 1];
            if residuals.len() > limit || !reached.is_finite() {
                return Err(StaticFailure::TooManyIterations { residual: reached, iterations: residuals.len() - 1 });
            }
            let step = self.descend(&residual, share).map_err(StaticFailure::Solver)?;
            if reached <= self.rounding() / scale {
                break;
            }
            if !self.search(&step, &forces, &residual, share) {
                // Rounding has the last word: more so in tensor-mass, which sums powers of the displacement.
                if reached <= T::EPSILON.to_f64().sqrt() {
                    break;
                }
                return Err(StaticFailure::NoDescent { residual: reached });
            }
            (forces, residual, scale) = self.residual(share);
            residuals.push(norm(&residual) / scale);
        }
        if self.shifted {
            return Err(StaticFailure::Unstable);
        }
        self.body.place_followers(self.time, self.gravity);
        match self.flattest() {
            (cell, ratio) if ratio <= 0.0 => Err(StaticFailure::Inverted { cell }),
            _ => Ok(residuals),
        }
    }

    /// What is left of the loads in the free directions, f_ext − f_int, besides the loads themselves and the size of loads
    /// and reactions.
    fn residual(&mut self, share: f64) -> (Vec<Vec3<T>>, Vec<Vec3<f64>>, f64) {
        let body = &mut *self.body;
        body.state.positions_changed();
        body.update_internal_forces(Stages::unobserved());
        body.update_external_forces(self.time, self.gravity);
        let (share, rest) = (T::from_f64(share), T::from_f64(1.0 - share));
        let loads: Vec<Vec3<T>> = (0..self.start.len())
            .map(|node| self.start_forces[node] * rest + body.external_forces[node] * share)
            .collect();
        let (mut applied, mut reaction) = (0.0, 0.0);
        let mut residual = Vec::with_capacity(loads.len());
        for (node, filter) in self.system.filters.iter().enumerate() {
            let left = (loads[node] - body.state.internal_forces[node]).cast::<f64>();
            let free = filter.apply(left);
            applied += filter.apply(loads[node].cast()).squared_norm();
            reaction += (left - free).squared_norm();
            residual.push(free);
        }
        let scale = f64::max(applied, reaction).sqrt();
        let scale = if scale > 0.0 { scale } else { norm(&residual).max(f64::MIN_POSITIVE) };
        (loads, residual, scale)
    }

    /// Residual that the rounding of positions explains [N].
    fn rounding(&self) -> f64 {
        let diagonal = |node: usize| self.system.matrix.block(node, node).squared_norm();
        let stiffness = (0..self.start.len()).map(diagonal).sum::<f64>().sqrt();
        4.0 * T::EPSILON.to_f64() * self.body.size * stiffness
    }

    /// The stiffness of the tissue, and of loads that follow the surface.
    fn assemble(&mut self, share: f64) {
        self.system.matrix.clear();
        let body = &mut *self.body;
        body.is_linearized = false;
        let (state, mut sink) = (&body.state, Widen(&mut self.system.matrix));
        for model in &state.models {
            model.linearize(&state.positions, &mut body.scratch);
            model.add_blocks(&state.positions, &mut body.scratch, &mut sink);
        }
        body.loads.add_blocks(self.time, &state.positions, &state.removed, share, &mut sink);
    }

    /// K⁻¹ r with the stiffness at the current positions, shifted as far as it takes.
    fn descend(&mut self, residual: &[Vec3<f64>], share: f64) -> Result<Vec<Vec3<f64>>, SolverError> {
        self.assemble(share);
        let mean = self.system.mean_diagonal();
        let mut last = 0.0;
        let mut outcome = Err(SolverError::NotPositiveDefinite);
        for shift in SHIFTS {
            if shift > 0.0 {
                self.system.shift((shift - last) * mean);
            }
            last = shift;
            let mut step = residual.to_vec();
            outcome = self
                .solver
                .factor(&self.system)
                .and_then(|()| self.solver.solve(&self.system, &mut step))
                .map(|()| step);
            self.shifted = shift > 0.0;
            if outcome.is_ok() {
                break;
            }
        }
        outcome
    }

    /// Puts the body where it was, moved by a `length` of `step`.
    fn move_from(&mut self, from: &[Vec3<T>], step: &[Vec3<f64>], length: f64) {
        let positions = &mut self.body.state.positions;
        for ((x, &from), &step) in positions.iter_mut().zip(from).zip(step) {
            *x = from + (step * length).cast();
        }
        self.body.state.positions_changed();
    }

    /// Moves along `step` until the energy falls as it should, or the residual does; gives whether that was found.
    fn search(&mut self, step: &[Vec3<f64>], loads: &[Vec3<T>], residual: &[Vec3<f64>], share: f64) -> bool {
        let from = self.body.state.positions.clone();
        let slope = dot(&Executor::serial(), step, residual);
        let before = self.energy(&from, loads);
        let mut length = 1.0;
        for _ in 0..HALVINGS {
            self.move_from(&from, step, length);
            if self.energy(&from, loads) <= before - DECREASE * length * slope
                || norm(&self.residual(share).1) < 0.5 * norm(residual)
            {
                return true;
            }
            length *= 0.5;
        }
        // Close to the end the energy cannot be told apart any more, and the residual goes on falling slowly.
        self.move_from(&from, step, 1.0);
        norm(&self.residual(share).1) < norm(residual)
    }

    /// W(x) − f·(x − from) [J].
    fn energy(&self, from: &[Vec3<T>], loads: &[Vec3<T>]) -> f64 {
        let state = &self.body.state;
        let elastic: f64 = state.models.iter().map(|model| model.energy(&state.positions)).sum();
        let work = |node: usize| loads[node].cast::<f64>().dot((state.positions[node] - from[node]).cast());
        elastic - (0..from.len()).map(work).sum::<f64>()
    }

    /// Puts held nodes where they are at a share of the load, and lets the rest follow linearly: K du = −K du_held.
    fn move_held_nodes(&mut self, share: f64) -> Result<(), SolverError> {
        let (share_reached, rest) = (T::from_f64(share), T::from_f64(1.0 - share));
        let mut jump: Vec<Vec3<f64>> = (0..self.start.len())
            .map(|node| {
                let goal = self.start[node] * rest + self.targets[node] * share_reached;
                let jump = (goal - self.body.state.positions[node]).cast();
                jump - self.system.filters[node].apply(jump)
            })
            .collect();
        if jump.iter().all(|jump| jump.squared_norm() <= 0.0) {
            return Ok(());
        }
        self.assemble(share);
        let mut forces = vec![Vec3::ZERO; jump.len()];
        self.system.apply(&jump, &mut forces);
        self.system.filter(&mut forces);
        let follow = self.descend(&forces, share)?;
        jump.iter_mut().zip(&follow).for_each(|(jump, &follow)| *jump -= follow);
        let from = self.body.state.positions.clone();
        self.move_from(&from, &jump, 1.0);
        Ok(())
    }

    /// The whole load on the stiffness as it is now.
    pub(super) fn solve_once(&mut self) -> Result<StaticReport, StaticError> {
        // Loads first, and both together by superposition: the stiffness is that of the start for either.
        let (_, residual, scale) = self.residual(1.0);
        let before = norm(&residual) / scale;
        let stable = |outcome: Result<Vec<Vec3<f64>>, SolverError>, shifted: bool| match outcome {
            Ok(step) if !shifted => Ok(step),
            Ok(_) => Err(StaticFailure::Unstable),
            Err(error) => Err(StaticFailure::Solver(error)),
        };
        let outcome = self.descend(&residual, 0.0);
        let step = stable(outcome, self.shifted).map_err(|failure| self.beyond(0.0, 1.0, failure))?;
        self.move_held_nodes(1.0).map_err(|error| self.beyond(0.0, 1.0, StaticFailure::Solver(error)))?;
        let from = self.body.state.positions.clone();
        self.move_from(&from, &step, 1.0);
        let (_, left, scale) = self.residual(1.0);
        let residuals = vec![before, norm(&left) / scale];
        Ok(StaticReport { steps: vec![LoadStep { share: 1.0, residuals }], retries: 0 })
    }

    /// Stops the nodes and brings the forces up to date, so that reactions can be read.
    pub(super) fn come_to_rest(&mut self) {
        self.body.state.velocities.fill(Vec3::ZERO);
        self.body.place_followers(self.time, self.gravity);
        self.body.update_internal_forces(Stages::unobserved());
        self.body.update_external_forces(self.time, self.gravity);
    }

    /// The cell that has lost most of its volume, and what is left of it.
    fn flattest(&self) -> (usize, f64) {
        let body = &*self.body;
        let cells = (0..body.mesh.cell_count()).filter(|&cell| !body.state.removed[cell]);
        cells
            .map(|cell| (cell, body.volume_ratio(cell)))
            .fold((0, f64::INFINITY), |worst, new| if new.1 < worst.1 { new } else { worst })
    }

    /// The error that says how far the load could be raised.
    pub(super) fn beyond(&self, load_factor: f64, failed_factor: f64, failure: StaticFailure) -> StaticError {
        let (cell, volume_ratio) = self.flattest();
        let (body, law) = (self.body.name.clone(), self.body.law());
        StaticError::NoEquilibrium { body, law, load_factor, failed_factor, failure, cell, volume_ratio }
    }
}

fn norm(values: &[Vec3<f64>]) -> f64 {
    dot(&Executor::serial(), values, values).sqrt()
}

/// Gives blocks of any precision to a matrix in double precision.
pub(super) struct Widen<'a>(pub(super) &'a mut BlockMatrix<f64>);

impl<T: Scalar> BlockSink<T> for Widen<'_> {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        self.0.add(row, column, block.cast());
    }
}
