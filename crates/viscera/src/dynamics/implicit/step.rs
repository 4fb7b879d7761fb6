use super::memory::ImplicitMemory;
use super::scheme::{Numbers, Past, Start};
use super::{Implicit, ImplicitReport, Newton};
use crate::body::SimulatedBody;
use crate::dynamics::Drive;
use crate::math::{Scalar, Vec3};
use crate::solver::Filter;
use crate::stage::Stages;

/// Advances a body, in memory of its own, from time `from` [s] by `dt` [s] to `drive.end`.
pub fn advance<T: Scalar>(
    body: &mut SimulatedBody<T>,
    memory: &mut ImplicitMemory<T>,
    settings: &Implicit,
    from: f64,
    dt: f64,
    drive: &Drive<'_, T>,
    stages: Stages,
) -> ImplicitReport {
    let numbers = settings.scheme.numbers(body.state.past.is_known);
    let mut step = Step { body, memory, settings, numbers, from, dt, drive, stages };
    step.begin();
    let mut report = step.solve();
    for _ in 0..SLIPS {
        if !step.slip() {
            break;
        }
        report = report.then(step.solve());
    }
    step.finish();
    report
}

/// How many times nodes that slip through jaws are let go in a step; the first time sees nearly all of them.
const SLIPS: u32 = 4;

/// One implicit step of one body, whatever the scheme.
pub(super) struct Step<'a, T: Scalar> {
    pub(super) body: &'a mut SimulatedBody<T>,
    pub(super) memory: &'a mut ImplicitMemory<T>,
    pub(super) settings: &'a Implicit,
    pub(super) numbers: Numbers,
    pub(super) from: f64,
    pub(super) dt: f64,
    pub(super) drive: &'a Drive<'a, T>,
    pub(super) stages: Stages<'a>,
}

impl<T: Scalar> Step<'_, T> {
    fn solve(&mut self) -> ImplicitReport {
        match self.settings.newton {
            Newton::Linearised => self.solve_linearised(),
            Newton::Full { relative, at_most } => self.solve_in_full(relative, at_most),
        }
    }

    /// Where nodes would go without forces, and where driven ones have to go.
    fn begin(&mut self) {
        self.memory.start.copy_from_slice(&self.body.state.positions);
        self.memory.velocities.copy_from_slice(&self.body.state.velocities);
        self.memory.history.clear();
        self.memory.dragged.clear();
        self.body.contacts.clear();
        self.body.is_linearized &= self.body.state.forces_are_current;
        if self.settings.scheme.needs_acceleration() {
            self.balance_at_start();
        }
        let dt = T::from_f64(self.dt);
        for node in 0..self.memory.start.len() {
            let state = &self.body.state;
            let position = state.positions[node];
            let (target, filter) = (self.drive.target(self.body, node, position), self.body.free_directions(node));
            let memory = &mut *self.memory;
            memory.increment[node] = Vec3::ZERO;
            memory.coast_velocities[node] = Vec3::ZERO;
            memory.filters[node] = filter;
            memory.coast[node] = match target {
                Some(target) if filter == Filter::Held => target - position,
                _ => {
                    let past = state.past.is_known.then(|| Past {
                        increment: position - state.past.positions[node],
                        velocity: state.past.velocities[node],
                    });
                    let needs_acceleration = self.settings.scheme.needs_acceleration();
                    let acceleration =
                        if needs_acceleration { memory.lack[node] / state.masses[node] } else { Vec3::ZERO };
                    let start = Start { velocity: state.velocities[node], acceleration, past };
                    let coast = self.settings.scheme.coast(&start, dt);
                    memory.coast_velocities[node] = coast.velocity;
                    target.map_or(coast.increment, |target| filter.merge(coast.increment, target - position))
                }
            };
        }
    }

    /// v⁺ for the δ that is known.
    pub(super) fn end_velocity(&self, node: usize) -> Vec3<T> {
        let memory = &*self.memory;
        let driven = memory.increment[node] / T::from_f64(self.dt);
        let free = (memory.increment[node] - memory.coast[node])
            .mul_add(T::from_f64(self.numbers.velocity / self.dt), memory.coast_velocities[node]);
        memory.filters[node].merge(free, driven)
    }

    /// δ grows by `length` corrections.
    pub(super) fn move_by(&mut self, length: f64) {
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
        self.account_for_tools();
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
