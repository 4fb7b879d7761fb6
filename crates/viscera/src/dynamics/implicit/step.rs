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
    /// Whether this is one of the last attempts at it, which take more iterations.
    pub(super) is_patient: bool,
    pub(super) stages: Stages<'a>,
}

impl<T: Scalar> Step<'_, T> {
    /// Remembers the beginning, and finds the accelerations there where the scheme needs them.
    pub(super) fn begin(&mut self) {
        self.memory.start.copy_from_slice(&self.body.state.positions);
        self.memory.velocities.copy_from_slice(&self.body.state.velocities);
        self.memory.history.clear();
        self.memory.least_rounding = f64::INFINITY;
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
        let goes_by_velocity = scheme.coasts_by_velocity(state.past.is_known);
        let data = ((NodeBlocks(increment), NodeBlocks(coast)), (NodeBlocks(coast_velocities), NodeBlocks(filters)));
        body.scratch.executor.each(parts, data, &|block, ((increment, coast), (coast_velocities, filters))| {
            let nodes = block * NODE_BLOCK..block * NODE_BLOCK + coast.0.len();
            let ends = coast.0.iter_mut().zip(coast_velocities.0.iter_mut());
            if goes_by_velocity {
                ends.zip(&state.velocities[nodes.clone()]).for_each(|((coast, end), &v)| (*coast, *end) = (v * dt, v));
            } else {
                ends.zip(nodes.clone()).for_each(|((coast, end), node)| {
                    Coast { increment: *coast, velocity: *end } = free(node);
                });
            }
            increment.0.fill(Vec3::ZERO);
            filters.0.fill(Filter::Free);
            let others =
                state.motions[nodes.clone()].iter().enumerate().filter(|(_, motion)| **motion != NodeMotion::Free);
            for (i, _) in others {
                let node = nodes.start + i;
                let position = state.positions[node];
                let (target, filter) = (drive.target(body, node, position), body.free_directions(node));
                filters.0[i] = filter;
                match target {
                    Some(target) if filter == Filter::Held => {
                        (coast.0[i], coast_velocities.0[i]) = (target - position, Vec3::ZERO);
                    }
                    Some(target) => coast.0[i] = filter.merge(coast.0[i], target - position),
                    None => {}
                }
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
                    let end = memory.start[block * NODE_BLOCK + i] + memory.increment[block * NODE_BLOCK + i];
                    moved |= end != x[i];
                    x[i] = end;
                }
                let nodes = block * NODE_BLOCK..block * NODE_BLOCK + v.len();
                let is_free = Filter::are_free(&memory.filters[nodes.clone()]);
                let share = T::from_f64(numbers.velocity / dt);
                let ways = memory.increment[nodes.clone()].iter().zip(&memory.coast[nodes.clone()]);
                let free = ways.zip(&memory.coast_velocities[nodes.clone()]);
                if is_free {
                    v.iter_mut().zip(free).for_each(|(v, ((&increment, &coast), &velocity))| {
                        *v = (increment - coast).mul_add(share, velocity);
                    });
                } else {
                    v.iter_mut().zip(nodes).for_each(|(v, node)| *v = end_velocity(memory, numbers, dt, node));
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
