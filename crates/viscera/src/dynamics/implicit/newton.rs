//! Newton's method for one implicit step of one body, whatever the scheme.

use super::memory::ImplicitMemory;
use super::scheme::{Numbers, Past, Start};
use super::tangent::Tangent;
use super::{Implicit, Newton, Scheme};
use crate::body::SimulatedBody;
use crate::dynamics::Drive;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::BlockSink;
use crate::solver::{BlockJacobi, BlockMatrix, Ending, Filter, Problem, dot};

/// The line search is content when the work of the residual along the correction has fallen below this share.
const CONTENT: f64 = 0.9;
/// The most lengths that the line search tries.
const TRIALS: u32 = 10;
/// How many roundings of the positions, through the stiffness of each node, count as no residual at all.
const ROUNDINGS: f64 = 8.0;

/// What implicit steps did; of several bodies, the worst.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImplicitReport {
    /// Iterations of Newton's method; 1 for a linearised step.
    pub newton_iterations: u32,
    /// Iterations of the conjugate gradient, over all iterations of Newton's method.
    pub linear_iterations: u32,
    /// What is left of the residual: of the forces in a full step, over the forces that balance; of the linear system in a
    /// linearised one, over its right-hand side in the norm of the preconditioner.
    pub residual: f64,
    /// Whether that is below what was asked for. A fixed number of iterations asks for nothing.
    pub converged: bool,
    /// Whether a linear solve met a direction of negative curvature: tissue under strong compression.
    pub negative_curvature: bool,
}

impl ImplicitReport {
    /// Where nothing was to be done.
    pub(crate) const NOTHING: Self =
        Self { newton_iterations: 0, linear_iterations: 0, residual: 0.0, converged: true, negative_curvature: false };

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

/// Advances a body, in memory of its own, from time `from` [s] by `dt` [s] to `drive.end`.
pub fn advance<T: Scalar>(
    body: &mut SimulatedBody<T>,
    memory: &mut ImplicitMemory<T>,
    settings: &Implicit,
    from: f64,
    dt: f64,
    drive: &Drive<'_, T>,
) -> ImplicitReport {
    let numbers = settings.scheme.numbers(body.state.past.is_known);
    let mut step = Step { body, memory, settings, numbers, from, dt, drive };
    step.begin();
    let report = match settings.newton {
        Newton::Linearised => step.solve_linearised(),
        Newton::Full { relative, at_most } => step.solve_in_full(relative, at_most),
    };
    step.finish();
    report
}

struct Step<'a, T: Scalar> {
    body: &'a mut SimulatedBody<T>,
    memory: &'a mut ImplicitMemory<T>,
    settings: &'a Implicit,
    numbers: Numbers,
    from: f64,
    dt: f64,
    drive: &'a Drive<'a, T>,
}

impl<T: Scalar> Step<'_, T> {
    /// Where nodes would go without forces, and where driven ones have to go.
    fn begin(&mut self) {
        self.memory.start.copy_from_slice(&self.body.state.positions);
        self.memory.velocities.copy_from_slice(&self.body.state.velocities);
        self.memory.history.clear();
        if self.settings.scheme.needs_acceleration() {
            self.balance_at_start();
        }
        let dt = T::from_f64(self.dt);
        for node in 0..self.memory.start.len() {
            let target = self.drive.target(self.body, node);
            let state = &self.body.state;
            let position = state.positions[node];
            let memory = &mut *self.memory;
            memory.increment[node] = Vec3::ZERO;
            memory.coast_velocities[node] = Vec3::ZERO;
            memory.filters[node] = Filter::Held;
            memory.coast[node] = match target {
                Some(target) => target - position,
                None => {
                    let past = state.past.is_known.then(|| Past {
                        increment: position - state.past.positions[node],
                        velocity: state.past.velocities[node],
                    });
                    let needs_acceleration = self.settings.scheme.needs_acceleration();
                    let acceleration =
                        if needs_acceleration { memory.lack[node] / state.masses[node] } else { Vec3::ZERO };
                    let start = Start { velocity: state.velocities[node], acceleration, past };
                    let coast = self.settings.scheme.coast(&start, dt);
                    memory.filters[node] = Filter::Free;
                    memory.coast_velocities[node] = coast.velocity;
                    coast.increment
                }
            };
        }
    }

    /// What the forces at the beginning lack to balance: mass times acceleration.
    fn balance_at_start(&mut self) {
        self.body.update_internal_forces();
        self.body.update_external_forces(self.from, self.drive.gravity);
        self.memory.nodal.copy_from_slice(&self.memory.velocities);
        self.find_damping();
        let (state, memory) = (&self.body.state, &mut *self.memory);
        for node in 0..memory.lack.len() {
            memory.lack[node] = self.body.external_forces[node] - state.internal_forces[node] - memory.damping[node];
        }
    }

    /// One linear solve from where the body is.
    fn solve_linearised(&mut self) -> ImplicitReport {
        self.evaluate();
        self.go_on();
        self.memory.correction.copy_from_slice(&self.memory.coast);
        let solve = self.correct();
        self.move_by(1.0);
        ImplicitReport {
            newton_iterations: 1,
            linear_iterations: solve.iterations,
            residual: solve.residual,
            converged: solve.converged,
            negative_curvature: solve.negative_curvature,
        }
    }

    /// Linear solves with a line search, until the forces balance.
    fn solve_in_full(&mut self, relative: f64, at_most: u32) -> ImplicitReport {
        let mut report = ImplicitReport { converged: false, ..ImplicitReport::NOTHING };
        let mut balance = self.evaluate();
        let (mut scale, mut floor) = (0.0f64, 0.0);
        loop {
            scale = scale.max(balance.scale);
            report.residual = if scale > 0.0 { balance.lack / scale } else { 0.0 };
            self.memory.history.push(report.residual);
            let arrived = self.go_on();
            report.converged = arrived && balance.lack <= (relative * scale).max(floor);
            if report.converged || report.newton_iterations == at_most || !balance.lack.is_finite() {
                return report;
            }
            if report.newton_iterations == 0 {
                self.memory.correction.copy_from_slice(&self.memory.coast);
            } else {
                self.memory.correction.fill(Vec3::ZERO);
            }
            let solve = self.correct();
            floor = solve.rounding;
            report.newton_iterations += 1;
            report.linear_iterations += solve.iterations;
            report.negative_curvature |= solve.negative_curvature;
            balance = self.search(arrived);
        }
    }

    /// Sets what driven nodes still have to go; gives whether all are where they have to be.
    fn go_on(&mut self) -> bool {
        let memory = &mut *self.memory;
        let mut arrived = true;
        for node in 0..memory.prescribed.len() {
            let held = memory.filters[node] == Filter::Held;
            let rest = if held { memory.coast[node] - memory.increment[node] } else { Vec3::ZERO };
            memory.prescribed[node] = rest;
            arrived &= rest.norm() <= memory.coast[node].norm() * (T::EPSILON + T::EPSILON);
        }
        arrived
    }

    /// The forces at y = x + θ δ and what they lack to balance.
    fn evaluate(&mut self) -> Balance {
        let place = T::from_f64(self.numbers.place);
        {
            let (state, memory) = (&mut self.body.state, &*self.memory);
            let mut moved = false;
            for node in 0..memory.start.len() {
                let position = memory.increment[node].mul_add(place, memory.start[node]);
                moved |= position != state.positions[node];
                state.positions[node] = position;
            }
            if moved {
                state.positions_changed();
            }
        }
        if self.settings.scheme == Scheme::EnergyMomentum {
            self.find_mean_forces();
        } else {
            self.body.update_internal_forces();
        }
        let time = self.from + self.numbers.place * (self.drive.end - self.from);
        self.body.update_external_forces(time, self.drive.gravity);
        self.find_velocities(place);
        self.find_damping();
        self.find_lack()
    }

    /// Forces of the energy–momentum scheme between the two ends of the step.
    fn find_mean_forces(&mut self) {
        let memory = &mut *self.memory;
        for node in 0..memory.nodal.len() {
            memory.nodal[node] = memory.start[node] + memory.increment[node];
        }
        let state = &mut self.body.state;
        state.internal_forces.fill(Vec3::ZERO);
        for model in state.models.iter().filter_map(|model| model.mean_forces()) {
            model.add_mean_forces(&memory.start, &memory.nodal, &mut self.body.scratch, &mut state.internal_forces);
        }
    }

    /// v_θ = (1 − θ) v + θ v⁺, into `nodal`.
    fn find_velocities(&mut self, place: T) {
        for node in 0..self.memory.nodal.len() {
            let (start, end) = (self.memory.velocities[node], self.end_velocity(node));
            self.memory.nodal[node] = start + (end - start) * place;
        }
    }

    /// v⁺ for the δ that is known.
    fn end_velocity(&self, node: usize) -> Vec3<T> {
        let memory = &*self.memory;
        match memory.filters[node] {
            Filter::Held => memory.increment[node] / T::from_f64(self.dt),
            _ => (memory.increment[node] - memory.coast[node])
                .mul_add(T::from_f64(self.numbers.velocity / self.dt), memory.coast_velocities[node]),
        }
    }

    /// C times the velocities in `nodal`, with K at the current positions.
    fn find_damping(&mut self) {
        let (state, memory) = (&self.body.state, &mut *self.memory);
        memory.damping.fill(Vec3::ZERO);
        if self.body.stiffness_damping > T::ZERO {
            for model in &state.models {
                model.linearize(&state.positions, &mut self.body.scratch);
                model.add_product(&state.positions, &memory.nodal, &mut self.body.scratch, &mut memory.damping);
            }
        }
        for node in 0..memory.damping.len() {
            let viscous = memory.nodal[node] * (self.body.damping * state.masses[node]);
            memory.damping[node] = memory.damping[node].mul_add(self.body.stiffness_damping, viscous);
        }
    }

    /// R − F − C v − M a of the nodes that forces move.
    fn find_lack(&mut self) -> Balance {
        let (state, memory) = (&self.body.state, &mut *self.memory);
        let inertia = T::from_f64(self.numbers.inertia / (self.dt * self.dt));
        let mut squares = [0.0; 4];
        for node in 0..memory.lack.len() {
            let external = self.body.external_forces[node];
            let inertial = (memory.increment[node] - memory.coast[node]) * (inertia * state.masses[node]);
            memory.lack[node] = external - state.internal_forces[node] - memory.damping[node] - inertial;
            if memory.filters[node] == Filter::Free {
                let forces = [memory.lack[node], inertial, external, state.internal_forces[node]];
                for (square, force) in squares.iter_mut().zip(forces) {
                    *square += force.squared_norm().to_f64();
                }
            }
        }
        let [lack, inertial, external, internal] = squares.map(f64::sqrt);
        Balance { lack, scale: inertial + external + internal }
    }

    /// Solves for the correction of δ; it holds the guess.
    fn correct(&mut self) -> Solve {
        let (numbers, dt) = (self.numbers, self.dt);
        let (alpha, beta) = (self.body.stiffness_damping.to_f64(), self.body.damping.to_f64());
        let stiffness = T::from_f64(numbers.place * (1.0 + alpha * numbers.velocity / dt));
        let mass_factor = T::from_f64(numbers.inertia / (dt * dt) + numbers.place * numbers.velocity * beta / dt);
        let (state, memory) = (&self.body.state, &mut *self.memory);
        for (mass, &nodal) in memory.masses.iter_mut().zip(&state.masses) {
            *mass = nodal * mass_factor;
        }
        memory.preconditioner.clear();
        if let Some(matrix) = &mut memory.matrix {
            matrix.clear();
        }
        let mut sink = Sinks { diagonal: &mut memory.preconditioner, matrix: memory.matrix.as_mut() };
        for model in &state.models {
            model.linearize(&state.positions, &mut self.body.scratch);
            model.add_blocks(&state.positions, &mut self.body.scratch, &mut sink);
        }
        let rounding = rounding(memory, &state.positions);
        memory.preconditioner.invert(stiffness, memory.masses.iter().copied());
        let mut tangent = Tangent {
            models: &state.models,
            positions: &state.positions,
            scratch: &mut self.body.scratch,
            assembled: memory.matrix.as_mut(),
            masses: &memory.masses,
            stiffness,
        };
        let problem = Problem {
            rhs: &memory.lack,
            filters: &memory.filters,
            prescribed: &memory.prescribed,
            preconditioner: &memory.preconditioner,
            masses: &memory.masses,
        };
        let stop = self.settings.linear;
        let report = memory.conjugate_gradient.solve(&mut tangent, &problem, stop, &mut memory.correction);
        Solve {
            iterations: report.iterations,
            residual: report.residual,
            converged: stop.accepts(report.ending),
            negative_curvature: report.ending == Ending::NegativeCurvature,
            rounding,
        }
    }

    /// Moves along the correction, as far as it leads towards balance. A step that takes driven nodes along is taken whole.
    fn search(&mut self, arrived: bool) -> Balance {
        let before = -dot(&self.memory.lack, &self.memory.correction);
        let mut length = 1.0;
        self.move_by(length);
        let mut balance = self.evaluate();
        for _ in 1..TRIALS {
            let after = -dot(&self.memory.lack, &self.memory.correction);
            let finite = balance.lack.is_finite() && after.is_finite();
            if finite && (!arrived || after <= CONTENT * before.abs()) {
                break;
            }
            let towards = if finite && after > before { before / (before - after) } else { 0.1 };
            let shorter = length * towards.clamp(0.1, 0.5);
            self.move_by(shorter - length);
            length = shorter;
            balance = self.evaluate();
        }
        balance
    }

    /// δ grows by `length` corrections.
    fn move_by(&mut self, length: f64) {
        let length = T::from_f64(length);
        let memory = &mut *self.memory;
        for (increment, &correction) in memory.increment.iter_mut().zip(&memory.correction) {
            *increment = correction.mul_add(length, *increment);
        }
    }

    /// The state at the end of the step.
    fn finish(&mut self) {
        for node in 0..self.memory.start.len() {
            self.body.state.velocities[node] = self.end_velocity(node);
        }
        let (state, memory) = (&mut self.body.state, &*self.memory);
        let mut moved = self.numbers.place != 1.0;
        for node in 0..memory.start.len() {
            let end = memory.start[node] + memory.increment[node];
            moved |= end != state.positions[node];
            state.positions[node] = end;
        }
        // The last evaluation of a full step was here, and its forces serve the next step.
        if moved {
            state.positions_changed();
        }
        if self.settings.scheme.needs_past() {
            state.past.keep(&memory.start, &memory.velocities);
        }
    }
}

/// Norms of the forces on free nodes [N].
#[derive(Clone, Copy, Debug)]
struct Balance {
    /// What they lack to balance.
    lack: f64,
    /// Inertial, external and internal forces together.
    scale: f64,
}

/// What one linear solve did.
#[derive(Clone, Copy, Debug)]
struct Solve {
    iterations: u32,
    residual: f64,
    converged: bool,
    negative_curvature: bool,
    /// Forces that rounding of the positions makes [N].
    rounding: f64,
}

/// Blocks go to the preconditioner, and to the matrix where there is one.
struct Sinks<'a, T> {
    diagonal: &'a mut BlockJacobi<T>,
    matrix: Option<&'a mut BlockMatrix<T>>,
}

impl<T: Scalar> BlockSink<T> for Sinks<'_, T> {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        self.diagonal.add(row, column, block);
        if let Some(matrix) = &mut self.matrix {
            matrix.add(row, column, block);
        }
    }
}

/// ε |K_pp| |x_p| over all nodes, in the Euclidean norm: the forces that rounding of the positions makes.
fn rounding<T: Scalar>(memory: &mut ImplicitMemory<T>, positions: &[Vec3<T>]) -> f64 {
    let blocks = memory.preconditioner.blocks_mut();
    let squares =
        blocks.iter().zip(positions).map(|(block, x)| (block.trace().to_f64() / 3.0 * x.norm().to_f64()).powi(2));
    ROUNDINGS * T::EPSILON.to_f64() * squares.sum::<f64>().sqrt()
}
