//! The forces of a step, and what they lack to balance.

use super::Scheme;
use super::memory::ImplicitMemory;
use super::step::Step;
use crate::executor::{NODE_BLOCK, NodeBlocks, node_blocks};
use crate::math::{Scalar, Vec3, dispatch, dispatch_level};
use crate::solver::{among, dot_of};
use crate::stage::Stage;

/// Norms of the forces on free nodes [N].
#[derive(Clone, Copy, Debug)]
pub(super) struct Balance {
    /// What they lack to balance.
    pub(super) lack: f64,
    /// Inertial, external and internal forces together.
    pub(super) scale: f64,
}

/// Squares of what is lacking and of inertial, external and internal forces [N²].
pub(super) type Squares = [f64; 4];

impl Balance {
    /// From the squares over all nodes.
    pub(super) fn of(squares: Squares) -> Self {
        let [lack, inertial, external, internal] = squares.map(f64::sqrt);
        Self { lack, scale: inertial + external + internal }
    }
}

impl<T: Scalar> Step<'_, T> {
    /// What the forces at the beginning lack to balance: mass times acceleration.
    pub(super) fn balance_at_start(&mut self) {
        self.body.update_forces_and_linearize(self.stages);
        self.update_external_forces(self.from);
        self.memory.external.copy_from_slice(&self.body.external_forces);
        self.memory.nodal.copy_from_slice(&self.memory.velocities);
        self.find_damping();
        let (state, memory) = (&self.body.state, &mut *self.memory);
        for node in 0..memory.lack.len() {
            memory.lack[node] = self.body.external_forces[node] - state.internal_forces[node] - memory.damping[node];
        }
    }

    /// The forces where the body is, at y = x + θ δ, and what they lack to balance; gives their squares.
    pub(super) fn evaluate(&mut self) -> Squares {
        if self.settings.scheme == Scheme::EnergyMomentum {
            self.find_mean_forces();
        } else {
            self.body.update_forces_and_linearize(self.stages);
        }
        let time = self.from + self.numbers.place * (self.drive.end - self.from);
        self.update_external_forces(time);
        // Without, its forces stay the zeros that they are from the beginning.
        if self.body.damping > T::ZERO || self.body.stiffness_damping > T::ZERO {
            self.find_velocities(T::from_f64(self.numbers.place));
            self.find_damping();
        }
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
            self.stages.run(Stage::Forces("mean-forces"), || {
                model.add_mean_forces(&memory.start, &memory.nodal, &mut self.body.scratch, &mut state.internal_forces);
            });
        }
    }

    /// Weight alone stays as it is within a step.
    fn update_external_forces(&mut self, time: f64) {
        let is_weight = self.body.followers.is_none() && !self.body.has_changing_forces();
        if std::mem::replace(&mut self.memory.knows_external, true) && is_weight {
            return;
        }
        self.stages.run(Stage::Loads, || self.body.update_external_forces(time, self.drive.gravity));
    }

    /// v_θ = (1 − θ) v + θ v⁺, into `nodal`.
    fn find_velocities(&mut self, place: T) {
        for node in 0..self.memory.nodal.len() {
            let (start, end) = (self.memory.velocities[node], self.end_velocity(node));
            self.memory.nodal[node] = start + (end - start) * place;
        }
    }

    /// C times the velocities in `nodal`, with K at the current positions.
    fn find_damping(&mut self) {
        if self.body.stiffness_damping > T::ZERO {
            self.body.linearize(self.stages);
        }
        let (state, memory) = (&self.body.state, &mut *self.memory);
        memory.damping.fill(Vec3::ZERO);
        if self.body.stiffness_damping > T::ZERO {
            for model in &state.models {
                self.stages.run(Stage::Products(model.name()), || {
                    model.add_product(&state.positions, &memory.nodal, &mut self.body.scratch, &mut memory.damping);
                });
            }
        }
        for node in 0..memory.damping.len() {
            let viscous = memory.nodal[node] * (self.body.damping * state.masses[node]);
            memory.damping[node] = memory.damping[node].mul_add(self.body.stiffness_damping, viscous);
        }
    }

    /// R − F − C v − M a of the nodes that forces move; gives the squares of it and of inertial, external and internal forces.
    pub(super) fn find_lack(&mut self) -> Squares {
        let inertia = T::from_f64(self.numbers.inertia / (self.dt * self.dt));
        let body = &*self.body;
        let ImplicitMemory { increment, coast, damping, filters, driven, lack, .. } = &mut *self.memory;
        let (increment, coast, damping, filters, driven) = (&*increment, &*coast, &*damping, &*filters, &*driven);
        let work = |block: usize, NodeBlocks(lacks): NodeBlocks<'_, Vec3<T>>| {
            let is_free = among(driven, block * NODE_BLOCK, lacks.len()).is_empty();
            let nodes = block * NODE_BLOCK..block * NODE_BLOCK + lacks.len();
            let external = &body.external_forces[nodes.clone()];
            let internal = &body.state.internal_forces[nodes.clone()];
            let mut inertial = [Vec3::ZERO; NODE_BLOCK];
            let inertial = &mut inertial[..lacks.len()];
            let ways = increment[nodes.clone()].iter().zip(&coast[nodes.clone()]);
            let masses = ways.zip(&body.state.masses[nodes.clone()]);
            let (damping, filters) = (&damping[nodes.clone()], &filters[nodes]);
            let squares = dispatch!(dispatch_level(), _simd => {
                for (force, ((&increment, &coast), &mass)) in inertial.iter_mut().zip(masses) {
                    *force = (increment - coast) * (inertia * mass);
                }
                let forces = external.iter().zip(internal).zip(damping.iter().zip(&*inertial));
                for (lack, ((&external, &internal), (&damping, &inertial))) in lacks.iter_mut().zip(forces) {
                    *lack = external - internal - damping - inertial;
                }
                let (lacks, inertial) = (&*lacks, &*inertial);
                [dot_of(lacks, lacks), dot_of(inertial, inertial), dot_of(external, external), dot_of(internal, internal)]
            });
            if is_free {
                return squares;
            }
            let square = |forces: &[Vec3<T>]| {
                let decided = forces.iter().zip(filters).map(|(&force, filter)| filter.apply(force));
                decided.map(|force| force.squared_norm().to_f64()).sum::<f64>()
            };
            [square(lacks), square(inertial), square(external), square(internal)]
        };
        let blocks = node_blocks(increment.len());
        let sums = |a: [f64; 4], b: [f64; 4]| std::array::from_fn(|i| a[i] + b[i]);
        let squares = body.scratch.executor.fold(blocks, NodeBlocks(lack), &work, &sums);
        let mut squares = squares.unwrap_or_default();
        if !self.body.contacts.is_empty() || !self.memory.dragged.is_empty() {
            squares = self.add_tools(squares);
        }
        squares
    }
}
