use super::{LoadStep, StaticError, StaticFailure, StaticReport};
use crate::body::{NodeMotion, SimulatedBody};
use crate::math::{Scalar, Vec3};
use crate::solver::{Assembly, LinearSolver, SolverError, SymmetricMatrix, neighbours};

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
    assembly: Assembly,
    matrix: SymmetricMatrix,
    /// Whether the matrix had to be shifted when it was last solved with.
    shifted: bool,
    free: Vec<bool>,
    start: Vec<Vec3<T>>,
    start_forces: Vec<Vec3<T>>,
    targets: Vec<Vec3<T>>,
}

impl<'a, T: Scalar> Equilibrium<'a, T> {
    pub(super) fn new(
        body: &'a mut SimulatedBody<T>,
        gravity: Vec3<T>,
        time: f64,
        solver: &'a mut dyn LinearSolver,
    ) -> Result<Self, StaticError> {
        body.update_internal_forces();
        let state = &body.state;
        let free: Vec<bool> = state.motions.iter().map(|&motion| motion == NodeMotion::Free).collect();
        if !state.motions.iter().any(|motion| !matches!(motion, NodeMotion::Free | NodeMotion::Retired)) {
            return Err(StaticError::NothingHolds { body: body.name.clone() });
        }
        let target = |(node, motion): (usize, &NodeMotion)| match motion {
            NodeMotion::Prescribed(curve) => body.rest[node] + body.prescribed[*curve as usize].at(time).cast(),
            _ => state.positions[node],
        };
        let targets = state.motions.iter().enumerate().map(target).collect();
        let rings = state.models.iter().map(|model| model.rings()).max().unwrap_or(1);
        let masks: Vec<[bool; 3]> = free.iter().map(|&free| [free; 3]).collect();
        let assembly = Assembly::new(neighbours(&body.mesh, rings), &masks);
        let matrix = assembly.matrix();
        solver.analyse(&matrix);
        let (start, start_forces) = (state.positions.clone(), state.internal_forces.clone());
        Ok(Self { body, solver, gravity, time, assembly, matrix, shifted: false, free, start, start_forces, targets })
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
            let step = self.descend(&residual).map_err(StaticFailure::Solver)?;
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
        match self.flattest() {
            (cell, ratio) if ratio <= 0.0 => Err(StaticFailure::Inverted { cell }),
            _ => Ok(residuals),
        }
    }

    /// What is left of the loads at the free components, f_ext − f_int, besides the loads themselves and the size of
    /// loads and reactions.
    fn residual(&mut self, share: f64) -> (Vec<Vec3<T>>, Vec<f64>, f64) {
        let body = &mut *self.body;
        body.state.positions_changed();
        body.update_internal_forces();
        body.update_external_forces(self.time, self.gravity);
        let (share, rest) = (T::from_f64(share), T::from_f64(1.0 - share));
        let loads: Vec<Vec3<T>> = (0..self.free.len())
            .map(|node| self.start_forces[node] * rest + body.external_forces[node] * share)
            .collect();
        let left: Vec<Vec3<T>> = loads.iter().zip(&body.state.internal_forces).map(|(&f, &i)| f - i).collect();
        let (mut applied, mut reaction) = (0.0, 0.0);
        for (node, &free) in self.free.iter().enumerate() {
            if free {
                applied += loads[node].cast::<f64>().squared_norm();
            } else {
                reaction += left[node].cast::<f64>().squared_norm();
            }
        }
        let mut residual = vec![0.0; self.matrix.size()];
        self.assembly.gather(&left, &mut residual);
        let scale = f64::max(applied, reaction).sqrt();
        let scale = if scale > 0.0 { scale } else { norm(&residual).max(f64::MIN_POSITIVE) };
        (loads, residual, scale)
    }

    /// Residual that the rounding of positions explains [N].
    fn rounding(&self) -> f64 {
        let stiffness = self.matrix.diagonal().map(|value| value * value).sum::<f64>().sqrt();
        4.0 * T::EPSILON.to_f64() * self.body.mesh.size() * stiffness
    }

    fn assemble(&mut self) {
        let state = &self.body.state;
        let scratch = &mut self.body.scratch;
        self.assembly.assemble(&mut self.matrix, |dx, out| {
            for model in &state.models {
                model.add_product(&state.positions, dx, scratch, out);
            }
        });
    }

    /// K⁻¹ r with the stiffness at the current positions, shifted as far as it takes.
    fn descend(&mut self, residual: &[f64]) -> Result<Vec<f64>, SolverError> {
        self.assemble();
        let mut last = 0.0;
        let mut outcome = Err(SolverError::NotPositiveDefinite);
        for shift in SHIFTS {
            if shift > 0.0 {
                self.matrix.shift(shift - last);
            }
            last = shift;
            let mut step = residual.to_vec();
            outcome = self
                .solver
                .factor(&self.matrix)
                .and_then(|()| self.solver.solve(&self.matrix, &mut step))
                .map(|()| step);
            self.shifted = shift > 0.0;
            if outcome.is_ok() {
                break;
            }
        }
        outcome
    }

    /// Moves along `step` until the energy falls as it should, or the residual does; gives whether that was found.
    fn search(&mut self, step: &[f64], loads: &[Vec3<T>], residual: &[f64], share: f64) -> bool {
        let from = self.body.state.positions.clone();
        let slope: f64 = step.iter().zip(residual).map(|(p, r)| p * r).sum();
        let before = self.energy(&from, loads);
        let mut length = 1.0;
        for _ in 0..HALVINGS {
            self.body.state.positions.clone_from(&from);
            self.assembly.scatter(step, length, &mut self.body.state.positions);
            self.body.state.positions_changed();
            if self.energy(&from, loads) <= before - DECREASE * length * slope
                || norm(&self.residual(share).1) < 0.5 * norm(residual)
            {
                return true;
            }
            length *= 0.5;
        }
        // Close to the end the energy cannot be told apart any more, and the residual goes on falling slowly.
        self.body.state.positions.clone_from(&from);
        self.assembly.scatter(step, 1.0, &mut self.body.state.positions);
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
        let (share, rest) = (T::from_f64(share), T::from_f64(1.0 - share));
        let mut jump = vec![Vec3::ZERO; self.free.len()];
        for node in (0..self.free.len()).filter(|&node| !self.free[node]) {
            jump[node] = self.start[node] * rest + self.targets[node] * share - self.body.state.positions[node];
        }
        if jump.iter().all(|jump| jump.squared_norm() <= T::ZERO) {
            return Ok(());
        }
        let mut forces = vec![Vec3::ZERO; jump.len()];
        for model in &self.body.state.models {
            model.add_product(&self.body.state.positions, &jump, &mut self.body.scratch, &mut forces);
        }
        let mut right = vec![0.0; self.matrix.size()];
        self.assembly.gather(&forces, &mut right);
        let follow = self.descend(&right)?;
        self.body.state.positions.iter_mut().zip(&jump).for_each(|(x, &jump)| *x += jump);
        self.assembly.scatter(&follow, -1.0, &mut self.body.state.positions);
        self.body.state.positions_changed();
        Ok(())
    }

    /// The whole load on the stiffness as it is now.
    pub(super) fn solve_once(&mut self) -> Result<StaticReport, StaticError> {
        // Loads first, and both together by superposition: the stiffness is that of the start for either.
        let (_, residual, scale) = self.residual(1.0);
        let before = norm(&residual) / scale;
        let stable = |outcome: Result<Vec<f64>, SolverError>, shifted: bool| match outcome {
            Ok(step) if !shifted => Ok(step),
            Ok(_) => Err(StaticFailure::Unstable),
            Err(error) => Err(StaticFailure::Solver(error)),
        };
        let outcome = self.descend(&residual);
        let step = stable(outcome, self.shifted).map_err(|failure| self.beyond(0.0, 1.0, failure))?;
        self.move_held_nodes(1.0).map_err(|error| self.beyond(0.0, 1.0, StaticFailure::Solver(error)))?;
        self.assembly.scatter(&step, 1.0, &mut self.body.state.positions);
        let (_, left, scale) = self.residual(1.0);
        let residuals = vec![before, norm(&left) / scale];
        Ok(StaticReport { steps: vec![LoadStep { share: 1.0, residuals }], retries: 0 })
    }

    /// Stops the nodes and brings the forces up to date, so that reactions can be read.
    pub(super) fn come_to_rest(&mut self) {
        self.body.state.velocities.fill(Vec3::ZERO);
        self.body.update_internal_forces();
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
        let (body, law) = (self.body.name.clone(), self.body.law);
        StaticError::NoEquilibrium { body, law, load_factor, failed_factor, failure, cell, volume_ratio }
    }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}
