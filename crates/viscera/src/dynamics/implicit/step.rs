use super::Implicit;
use super::memory::ImplicitMemory;
use super::scheme::{Coast, Numbers, Past, Start};
use crate::body::{NodeMotion, SimulatedBody};
use crate::dynamics::Drive;
use crate::executor::{NODE_BLOCK, NodeBlocks, ReadBlocks, node_blocks};
use crate::math::{Scalar, Vec3, dispatch, dispatch_level};
use crate::solver::{Filter, among};
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
        self.memory.knows_external = false;
        self.memory.least_rounding = f64::INFINITY;
        self.memory.matrix.is_exact = false;
        self.memory.dragged.clear();
        self.body.contacts.clear();
        self.body.is_linearized &= self.body.state.forces_are_current;
        if self.settings.scheme.needs_acceleration() {
            self.balance_at_start();
        }
    }

    /// Where nodes would go without forces, which is the guess, and where driven ones have to go.
    pub(super) fn coast(&mut self) {
        let (body, drive, scheme, dt) = (&*self.body, self.drive, self.settings.scheme, T::from_f64(self.dt));
        let ImplicitMemory { increment, coast, coast_velocities, correction, filters, driven, lack, .. } =
            &mut *self.memory;
        let (state, lack, parts) = (&body.state, &lack[..], node_blocks(lack.len()));
        driven.drain(..).for_each(|node| filters[node as usize] = Filter::Free);
        let others = state.motions.iter().enumerate().filter(|(_, motion)| **motion != NodeMotion::Free);
        driven.extend(others.map(|(node, _)| node as u32));
        let driven = &driven[..];
        let free = |node: usize| {
            let past = state.past.is_known.then(|| Past {
                increment: state.positions[node] - state.past.positions[node],
                velocity: state.past.velocities[node],
            });
            let acceleration = if scheme.needs_acceleration() { lack[node] / state.masses[node] } else { Vec3::ZERO };
            scheme.coast(&Start { velocity: state.velocities[node], acceleration, past }, dt)
        };
        let goes_by_velocity = scheme.coasts_by_velocity(state.past.is_known);
        let ways = ((NodeBlocks(increment), NodeBlocks(coast)), (NodeBlocks(coast_velocities), NodeBlocks(correction)));
        let work = |block: usize, (((increment, coast), (coast_velocities, correction)), filters): Coasting<'_, T>| {
            let nodes = block * NODE_BLOCK..block * NODE_BLOCK + coast.0.len();
            if goes_by_velocity {
                let velocities = &state.velocities[nodes.clone()];
                dispatch!(dispatch_level(), _simd => coast.0.iter_mut().zip(velocities).for_each(|(coast, &v)| *coast = v * dt));
                coast_velocities.0.copy_from_slice(velocities);
            } else {
                let ends = coast.0.iter_mut().zip(coast_velocities.0.iter_mut());
                ends.zip(nodes.clone()).for_each(|((coast, end), node)| {
                    Coast { increment: *coast, velocity: *end } = free(node);
                });
            }
            increment.0.fill(Vec3::ZERO);
            for &node in among(driven, nodes.start, nodes.len()) {
                let (node, i) = (node as usize, node as usize - nodes.start);
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
            correction.0.copy_from_slice(coast.0);
        };
        body.scratch.executor.each(parts, (ways, NodeBlocks(filters)), &work);
        self.memory.list_filtered();
    }

    /// v⁺ for the δ that is known.
    pub(super) fn end_velocity(&self, node: usize) -> Vec3<T> {
        end_velocity(self.memory, self.numbers, self.dt, node)
    }

    /// δ grows by `length` corrections, and the body goes to x + θ δ.
    pub(super) fn move_by(&mut self, length: f64) {
        let (length, place) = (T::from_f64(length), T::from_f64(self.numbers.place));
        let ImplicitMemory { start, increment, correction, .. } = &mut *self.memory;
        let (state, executor) = (&mut self.body.state, &self.body.scratch.executor);
        let data = ((NodeBlocks(&mut state.positions), NodeBlocks(increment)), ReadBlocks(correction));
        let work =
            |block: usize, ((NodeBlocks(positions), NodeBlocks(increment)), ReadBlocks(correction)): Moving<'_, T>| {
                let start = &start[block * NODE_BLOCK..];
                dispatch!(dispatch_level(), _simd => {
                    let mut moved = false;
                    for ((position, increment), (&correction, &start)) in positions.iter_mut().zip(increment).zip(correction.iter().zip(start)) {
                        *increment = correction.mul_add(length, *increment);
                        let there = increment.mul_add(place, start);
                        moved |= there != *position;
                        *position = there;
                    }
                    moved
                })
            };
        if executor.fold(node_blocks(correction.len()), data, &work, &|a, b| a | b).unwrap_or(false) {
            state.positions_changed();
            self.body.is_linearized = false;
        }
    }

    /// δ is zero again, the body where it began, and coasting the guess.
    pub(super) fn move_back(&mut self) {
        self.memory.increment.fill(Vec3::ZERO);
        self.memory.correction.copy_from_slice(&self.memory.coast);
        if self.body.state.positions != self.memory.start {
            self.body.state.positions.copy_from_slice(&self.memory.start);
            self.body.state.positions_changed();
            self.body.is_linearized = false;
        }
    }

    /// The state at the end of the step.
    pub(super) fn finish(&mut self) {
        self.account_for_tools();
        let (memory, numbers, dt) = (&*self.memory, self.numbers, self.dt);
        let (state, executor) = (&mut self.body.state, &self.body.scratch.executor);
        // At a place of one the body is there already, and the forces that were found last serve the next step.
        if numbers.place != 1.0 {
            let ends = memory.start.iter().zip(&memory.increment).map(|(&start, &increment)| start + increment);
            state.positions.iter_mut().zip(ends).for_each(|(x, end)| *x = end);
            state.positions_changed();
        }
        let parts = node_blocks(memory.start.len());
        executor.each(parts, NodeBlocks(&mut state.velocities), &|block, NodeBlocks(v)| {
            let nodes = block * NODE_BLOCK..block * NODE_BLOCK + v.len();
            let share = T::from_f64(numbers.velocity / dt);
            let ways = memory.increment[nodes.clone()].iter().zip(&memory.coast[nodes.clone()]);
            let free = ways.zip(&memory.coast_velocities[nodes.clone()]);
            dispatch!(dispatch_level(), _simd => v.iter_mut().zip(free).for_each(|(v, ((&increment, &coast), &velocity))| {
                *v = (increment - coast).mul_add(share, velocity);
            }));
            for &node in memory.driven_among(nodes.start, nodes.len()) {
                v[node as usize - nodes.start] = end_velocity(memory, numbers, dt, node as usize);
            }
        });
        if self.settings.scheme.needs_past() {
            state.past.keep(&memory.start, &memory.velocities);
        }
    }
}

/// δ and δ̂, v̂ and the guess, and filters.
type Coasting<'a, T> = (
    ((NodeBlocks<'a, Vec3<T>>, NodeBlocks<'a, Vec3<T>>), (NodeBlocks<'a, Vec3<T>>, NodeBlocks<'a, Vec3<T>>)),
    NodeBlocks<'a, Filter<T>>,
);

/// Places, δ and its correction.
type Moving<'a, T> = ((NodeBlocks<'a, Vec3<T>>, NodeBlocks<'a, Vec3<T>>), ReadBlocks<'a, Vec3<T>>);

#[inline]
fn end_velocity<T: Scalar>(memory: &ImplicitMemory<T>, numbers: Numbers, dt: f64, node: usize) -> Vec3<T> {
    let free = (memory.increment[node] - memory.coast[node])
        .mul_add(T::from_f64(numbers.velocity / dt), memory.coast_velocities[node]);
    match &memory.filters[node] {
        Filter::Free => free,
        filter => filter.merge(free, memory.increment[node] / T::from_f64(dt)),
    }
}
