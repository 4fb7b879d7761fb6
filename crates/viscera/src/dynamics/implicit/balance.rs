//! The forces of a step, and what they lack to balance.

use super::Scheme;
use super::step::Step;
use crate::math::{Scalar, Vec3};
use crate::stage::Stage;

/// Norms of the forces on free nodes [N].
#[derive(Clone, Copy, Debug)]
pub(super) struct Balance {
    /// What they lack to balance.
    pub(super) lack: f64,
    /// Inertial, external and internal forces together.
    pub(super) scale: f64,
}

impl<T: Scalar> Step<'_, T> {
    /// What the forces at the beginning lack to balance: mass times acceleration.
    pub(super) fn balance_at_start(&mut self) {
        self.body.update_internal_forces(self.stages);
        self.update_external_forces(self.from);
        self.memory.nodal.copy_from_slice(&self.memory.velocities);
        self.find_damping();
        let (state, memory) = (&self.body.state, &mut *self.memory);
        for node in 0..memory.lack.len() {
            memory.lack[node] = self.body.external_forces[node] - state.internal_forces[node] - memory.damping[node];
        }
    }

    /// The forces at y = x + θ δ and what they lack to balance.
    pub(super) fn evaluate(&mut self) -> Balance {
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
                self.is_linearized = false;
            }
        }
        if self.settings.scheme == Scheme::EnergyMomentum {
            self.find_mean_forces();
        } else {
            self.body.update_internal_forces(self.stages);
        }
        let time = self.from + self.numbers.place * (self.drive.end - self.from);
        self.update_external_forces(time);
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
            self.stages.run(Stage::Forces("mean-forces"), || {
                model.add_mean_forces(&memory.start, &memory.nodal, &mut self.body.scratch, &mut state.internal_forces);
            });
        }
    }

    fn update_external_forces(&mut self, time: f64) {
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
            self.linearize();
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

    /// R − F − C v − M a of the nodes that forces move.
    fn find_lack(&mut self) -> Balance {
        let (state, memory) = (&self.body.state, &mut *self.memory);
        let inertia = T::from_f64(self.numbers.inertia / (self.dt * self.dt));
        let mut squares = [0.0; 4];
        for node in 0..memory.lack.len() {
            let external = self.body.external_forces[node];
            let inertial = (memory.increment[node] - memory.coast[node]) * (inertia * state.masses[node]);
            memory.lack[node] = external - state.internal_forces[node] - memory.damping[node] - inertial;
            let forces = [memory.lack[node], inertial, external, state.internal_forces[node]];
            for (square, force) in squares.iter_mut().zip(forces) {
                *square += memory.filters[node].apply(force).squared_norm().to_f64();
            }
        }
        let [lack, inertial, external, internal] = squares.map(f64::sqrt);
        Balance { lack, scale: inertial + external + internal }
    }
}
