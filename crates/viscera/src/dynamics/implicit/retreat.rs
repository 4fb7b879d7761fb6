//! The last resort of a linearised backward Euler step whose equations nobody solved: it goes less far.
//!
//! E(s) = W(x + s δ) + ½ Σ m |s δ/Δt|² − s R·δ falls to W(x) as s falls to nothing, which is no more than there was at the start.
//! So some share s of δ gains no energy, and the step stays bounded. Hexahedra of neo-Hookean tissue, let go at a thousand times
//! their length, rose to 1017 times their energy without this.

use super::Scheme;
use super::step::Step;
use crate::math::{Scalar, Vec3};

/// How many times δ is halved before the body stays where it is.
const HALVINGS: u32 = 8;

impl<T: Scalar> Step<'_, T> {
    /// Shortens δ until the step gains no energy. Where nodes are driven, what drives them does work, and δ stays.
    pub(super) fn retreat(&mut self) {
        let memory = &*self.memory;
        let is_driven = (0..memory.start.len())
            .any(|node| memory.increment[node] != memory.filters[node].apply(memory.increment[node]));
        if is_driven || self.settings.scheme != Scheme::BackwardEuler {
            return;
        }
        let before = self.stored(&self.memory.start) + self.kinetic(&self.memory.velocities, 1.0);
        for halving in 0..=HALVINGS {
            if self.energy_of_step() <= before {
                return;
            }
            let share = if halving == HALVINGS { T::ZERO } else { T::from_f64(0.5) };
            self.memory.increment.iter_mut().for_each(|increment| *increment = *increment * share);
        }
    }

    /// Energy at the end of the step, less the work of gravity and loads on the way [J].
    fn energy_of_step(&mut self) -> f64 {
        let memory = &mut *self.memory;
        for node in 0..memory.nodal.len() {
            memory.nodal[node] = memory.start[node] + memory.increment[node];
        }
        let forces = self.body.external_forces.iter().zip(&self.memory.increment);
        let work: f64 = forces.map(|(&force, &way)| force.dot(way).to_f64()).sum();
        self.stored(&self.memory.nodal) + self.kinetic(&self.memory.increment, self.dt) - work
    }

    /// Energy stored in the tissue [J].
    fn stored(&self, positions: &[Vec3<T>]) -> f64 {
        self.body.state.models.iter().map(|model| model.energy(positions)).sum()
    }

    /// Kinetic energy of nodes that go these `ways` in a `time` [J].
    fn kinetic(&self, ways: &[Vec3<T>], time: f64) -> f64 {
        let masses = self.body.state.masses.iter().zip(ways);
        masses.map(|(&mass, &way)| 0.5 * mass.to_f64() * way.squared_norm().to_f64()).sum::<f64>() / (time * time)
    }
}
