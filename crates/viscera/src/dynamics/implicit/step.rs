use super::Implicit;
use super::memory::ImplicitMemory;
use super::scheme::{Coast, Numbers, Past, Start};
use crate::body::{NodeMotion, SimulatedBody};
use crate::dynamics::Drive;
use crate::executor::{NODE_BLOCK, NodeBlocks, ReadBlocks, node_blocks};
use crate::math::{Scalar, Vec3};
use crate::solver::Filter;
use crate::stage::Stages;

/// One implicit step of one body, whatever the scheme: its part in the equations of those that are solved together.
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
    /// Remembers the beginning, and finds the accelerations there where the scheme needs them.
    pub(super) fn begin(&mut self) {
        self.memory.start.copy_from_slice(&self.body.state.positions);
        self.memory.velocities.copy_from_slice(&self.body.state.velocities);
        self.memory.history.clear();
        self.memory.matrix.is_exact = false;
        self.memory.dragged.clear();
        self.body.contacts.clear();
        self.body.is_linearized &= self.body.state.forces_are_current;
        if self.settings.scheme.needs_acceleration() {
            self.balance_at_start();
        }
    }

    /// Where nodes would go without forces, and where driven ones have to go.
    pub(super) fn coast(&mut self) {
        let (body, drive, scheme, dt) = (&*self.body, self.drive, self.settings.scheme, T::from_f64(self.dt));
        let ImplicitMemory { increment, coast, coast_velocities, filters, lack, .. } = &mut *self.memory;
        let (state, lack, parts) = (&body.state, &lack[..], node_blocks(lack.len()));
        let free = |node: usize| {
            let past = state.past.is_known.then(|| Past {
                increment: state.positions[node] - state.past.positions[node],
                velocity: state.past.velocities[node],
            });
            let acceleration = if scheme.needs_acceleration() { lack[node] / state.masses[node] } else { Vec3::ZERO };
            scheme.coast(&Start { velocity: state.velocities[node], acceleration, past }, dt)
        };
        let data = ((NodeBlocks(increment), NodeBlocks(coast)), (NodeBlocks(coast_velocities), NodeBlocks(filters)));
        body.scratch.executor.each(parts, data, &|block, ((increment, coast), (coast_velocities, filters))| {
            increment.0.fill(Vec3::ZERO);
            for i in 0..coast.0.len() {
                let node = block * NODE_BLOCK + i;
                // Nearly all are.
                if state.motions[node] == NodeMotion::Free {
                    filters.0[i] = Filter::Free;
                    Coast { increment: coast.0[i], velocity: coast_velocities.0[i] } = free(node);
                    continue;
                }
                let position = state.positions[node];
                let (target, filter) = (drive.target(body, node, position), body.free_directions(node));
                filters.0[i] = filter;
                (coast.0[i], coast_velocities.0[i]) = match target {
                    Some(target) if filter == Filter::Held => (target - position, Vec3::ZERO),
                    _ => {
                        let coast = free(node);
                        let merged = |target: Vec3<T>| filter.merge(coast.increment, target - position);
                        (target.map_or(coast.increment, merged), coast.velocity)
                    }
                };
            }
        });
    }

    /// v⁺ for the δ that is known.
    pub(super) fn end_velocity(&self, node: usize) -> Vec3<T> {
        end_velocity(self.memory, self.numbers, self.dt, node)
    }

    /// δ grows by `length` corrections.
    pub(super) fn move_by(&mut self, length: f64) {
        let length = T::from_f64(length);
        let ImplicitMemory { increment, correction, .. } = &mut *self.memory;
        let data = (NodeBlocks(increment), ReadBlocks(correction));
        self.body.scratch.executor.each(node_blocks(correction.len()), data, &|_, (increment, correction)| {
            for (increment, &correction) in increment.0.iter_mut().zip(correction.0) {
                *increment = correction.mul_add(length, *increment);
            }
        });
    }

    /// The state at the end of the step.
    pub(super) fn finish(&mut self) {
        self.account_for_tools();
        let (memory, numbers, dt) = (&*self.memory, self.numbers, self.dt);
        let (state, executor) = (&mut self.body.state, &self.body.scratch.executor);
        let data = (NodeBlocks(&mut state.positions), NodeBlocks(&mut state.velocities));
        let work =
            |block: usize, (NodeBlocks(x), NodeBlocks(v)): (NodeBlocks<'_, Vec3<T>>, NodeBlocks<'_, Vec3<T>>)| {
                let mut moved = false;
                for i in 0..x.len() {
                    let node = block * NODE_BLOCK + i;
                    v[i] = end_velocity(memory, numbers, dt, node);
                    let end = memory.start[node] + memory.increment[node];
                    moved |= end != x[i];
                    x[i] = end;
                }
                moved
            };
        let moved = executor.fold(node_blocks(memory.start.len()), data, &work, &|a, b| a | b).unwrap_or(false);
        // The last evaluation of a full step was here, and its forces serve the next step.
        if moved || numbers.place != 1.0 {
            state.positions_changed();
        }
        if self.settings.scheme.needs_past() {
            state.past.keep(&memory.start, &memory.velocities);
        }
    }
}

#[inline]
fn end_velocity<T: Scalar>(memory: &ImplicitMemory<T>, numbers: Numbers, dt: f64, node: usize) -> Vec3<T> {
    let free = (memory.increment[node] - memory.coast[node])
        .mul_add(T::from_f64(numbers.velocity / dt), memory.coast_velocities[node]);
    match &memory.filters[node] {
        Filter::Free => free,
        filter => filter.merge(free, memory.increment[node] / T::from_f64(dt)),
    }
}
