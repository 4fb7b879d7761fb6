use super::bodies::Bodies;
use super::{LoadStep, StaticError, StaticFailure, StaticReport};
use crate::body::SimulatedBody;
use crate::executor::Executor;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::BlockSink;
use crate::solver::{BlockMatrix, LinearOperator, LinearSolver, SolverError, System, dot};

/// Shares of the mean diagonal by which a stiffness that is not positive definite is shifted, one after the other.
const SHIFTS: [f64; 9] = [0.0, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 2.0, 10.0, 100.0];
/// Share of the decrease promised by the slope that a step must bring (Armijo).
const DECREASE: f64 = 1e-4;
/// How many times a step is halved.
const HALVINGS: usize = 14;

/// Bodies on their way to the equilibrium.
pub(super) struct Equilibrium<'a, T: Scalar> {
    pub(super) bodies: Bodies<'a, T>,
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
        mut bodies: Bodies<'a, T>,
        gravity: Vec3<T>,
        time: f64,
        target: impl Fn(&SimulatedBody<T>, usize) -> Option<Vec3<T>>,
        solver: &'a mut dyn LinearSolver,
    ) -> Result<Self, StaticError> {
        bodies.update_internal_forces();
        if !bodies.is_held() {
            return Err(StaticError::NothingHolds { body: bodies.all[0].name.clone() });
        }
        let targets = bodies.nodal(|body, node| target(body, node).unwrap_or(body.state.positions[node]));
        let system = bodies.system();
        solver.analyse(&system);
        let start = bodies.nodal(|body, node| body.state.positions[node]);
        let start_forces = bodies.nodal(|body, node| body.state.internal_forces[node]);
        Ok(Self { bodies, solver, gravity, time, system, shifted: false, start, start_forces, targets })
    }

    /// Goes to a share of the load; gives the residuals. Where that fails, the body is as it was before.
    pub(super) fn advance(&mut self, share: f64, tolerance: f64, limit: usize) -> Result<Vec<f64>, StaticFailure> {
        let before = self.positions();
        self.newton(share, tolerance, limit).inspect_err(|_| self.bodies.put(|node| before[node]))
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
        self.bodies.place_followers(self.time, self.gravity);
        match self.bodies.flattest() {
            (_, cell, ratio) if ratio <= 0.0 => Err(StaticFailure::Inverted { cell }),
            _ => Ok(residuals),
        }
    }

    /// What is left of the loads in the free directions, f_ext − f_int, besides the loads themselves and the size of loads
    /// and reactions.
    fn residual(&mut self, share: f64) -> (Vec<Vec3<T>>, Vec<Vec3<f64>>, f64) {
        self.bodies.all.iter_mut().for_each(|body| body.state.positions_changed());
        self.bodies.update_internal_forces();
        self.bodies.update_external_forces(self.time, self.gravity);
        let (share, rest) = (T::from_f64(share), T::from_f64(1.0 - share));
        let external = self.bodies.nodal(|body, node| body.external_forces[node]);
        let starts = self.start_forces.iter().zip(external);
        let loads: Vec<Vec3<T>> = starts.map(|(&start, external)| start * rest + external * share).collect();
        let internal = self.bodies.nodal(|body, node| body.state.internal_forces[node]);
        let lefts = loads.iter().zip(internal);
        let mut residual: Vec<Vec3<f64>> = lefts.map(|(&load, internal)| (load - internal).cast()).collect();
        self.bodies.leave_to_ties(&mut residual);
        let (mut applied, mut reaction) = (0.0, 0.0);
        for ((left, filter), load) in residual.iter_mut().zip(&self.system.filters).zip(&loads) {
            let free = filter.apply(*left);
            applied += filter.apply(load.cast()).squared_norm();
            reaction += (*left - free).squared_norm();
            *left = free;
        }
        let scale = f64::max(applied, reaction).sqrt();
        let scale = if scale > 0.0 { scale } else { norm(&residual).max(f64::MIN_POSITIVE) };
        (loads, residual, scale)
    }

    /// Residual that the rounding of positions explains [N].
    fn rounding(&self) -> f64 {
        let diagonal = |node: usize| self.system.matrix.block(node, node).squared_norm();
        let stiffness = (0..self.start.len()).map(diagonal).sum::<f64>().sqrt();
        4.0 * T::EPSILON.to_f64() * self.bodies.size() * stiffness
    }

    /// K⁻¹ r with the stiffness at the current positions, shifted as far as it takes.
    fn descend(&mut self, residual: &[Vec3<f64>], share: f64) -> Result<Vec<Vec3<f64>>, SolverError> {
        self.bodies.assemble(&mut self.system.matrix, self.time, share);
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

    /// Where the nodes are.
    fn positions(&self) -> Vec<Vec3<T>> {
        self.bodies.nodal(|body, node| body.state.positions[node])
    }

    /// Puts the bodies where they were, moved by a `length` of `step`.
    fn move_from(&mut self, from: &[Vec3<T>], step: &[Vec3<f64>], length: f64) {
        self.bodies.put(|node| from[node] + (step[node] * length).cast());
    }

    /// Moves along `step` until the energy falls as it should, or the residual does; gives whether that was found.
    fn search(&mut self, step: &[Vec3<f64>], loads: &[Vec3<T>], residual: &[Vec3<f64>], share: f64) -> bool {
        let from = self.positions();
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
        let places = self.positions();
        let work = |node: usize| loads[node].cast::<f64>().dot((places[node] - from[node]).cast());
        self.bodies.energy() - (0..from.len()).map(work).sum::<f64>()
    }

    /// Puts held nodes where they are at a share of the load, and lets the rest follow linearly: K du = −K du_held.
    fn move_held_nodes(&mut self, share: f64) -> Result<(), SolverError> {
        let (share_reached, rest) = (T::from_f64(share), T::from_f64(1.0 - share));
        let places = self.positions();
        let mut jump: Vec<Vec3<f64>> = (0..self.start.len())
            .map(|node| {
                let goal = self.start[node] * rest + self.targets[node] * share_reached;
                let jump = (goal - places[node]).cast();
                jump - self.system.filters[node].apply(jump)
            })
            .collect();
        let stays = jump.iter().all(|jump| jump.squared_norm() <= 0.0);
        if !self.bodies.fulfil_ties(&mut jump) && stays {
            return Ok(());
        }
        self.bodies.assemble(&mut self.system.matrix, self.time, share);
        let mut forces = vec![Vec3::ZERO; jump.len()];
        self.system.apply(&jump, &mut forces);
        self.system.filter(&mut forces);
        let follow = self.descend(&forces, share)?;
        jump.iter_mut().zip(&follow).for_each(|(jump, &follow)| *jump -= follow);
        let from = self.positions();
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
        let from = self.positions();
        self.move_from(&from, &step, 1.0);
        let (_, left, scale) = self.residual(1.0);
        let residuals = vec![before, norm(&left) / scale];
        Ok(StaticReport { steps: vec![LoadStep { share: 1.0, residuals }], retries: 0 })
    }

    /// Stops the nodes and brings the forces up to date, so that reactions can be read.
    pub(super) fn come_to_rest(&mut self) {
        self.bodies.come_to_rest(self.time, self.gravity);
    }

    /// The error that says how far the load could be raised.
    pub(super) fn beyond(&self, load_factor: f64, failed_factor: f64, failure: StaticFailure) -> StaticError {
        let (number, cell, volume_ratio) = self.bodies.flattest();
        let body = &self.bodies.all[number];
        let (body, law) = (body.name.clone(), body.law());
        StaticError::NoEquilibrium { body, law, load_factor, failed_factor, failure, cell, volume_ratio }
    }
}

fn norm(values: &[Vec3<f64>]) -> f64 {
    dot(&Executor::serial(), values, values).sqrt()
}

/// Gives blocks of any precision to a matrix in double precision, its nodes numbered from `start` on.
pub(super) struct Widen<'a> {
    pub(super) matrix: &'a mut BlockMatrix<f64>,
    pub(super) start: u32,
}

impl<T: Scalar> BlockSink<T> for Widen<'_> {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        self.matrix.add(self.start + row, self.start + column, block.cast());
    }
}
