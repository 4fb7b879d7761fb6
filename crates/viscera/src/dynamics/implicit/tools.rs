//! Tools in an implicit step: what touches, what is held, what slips.

use super::scheme::{Past, Start};
use super::step::Step;
use crate::body::NodeMotion;
use crate::math::{Scalar, Vec3};
use crate::solver::Filter;

/// Where a node is taken to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Guess {
    /// Where it would without forces.
    Coast,
    /// Where the step has it so far.
    Increment,
    /// There, and the last correction farther.
    Correction,
}

impl<T: Scalar> Step<'_, T> {
    /// Finds what touches when nodes go where `guess` says, and which contacts push and which stick; gives whether that is news.
    pub(super) fn meet_tools(&mut self, guess: Guess) -> bool {
        if self.drive.rods.is_empty() {
            return false;
        }
        let (body, memory) = (&mut *self.body, &*self.memory);
        let increment = |node: u32| {
            let node = node as usize;
            match guess {
                Guess::Coast => memory.coast[node],
                Guess::Increment => memory.increment[node],
                Guess::Correction => memory.increment[node] + memory.correction[node],
            }
            .cast::<f64>()
        };
        let place = |node: u32| {
            let start = memory.start[node as usize].cast::<f64>();
            (start, start + increment(node))
        };
        let found = body.contacts.find(self.drive.rods, body.skin.triangles(), self.drive.frames, place);
        if found {
            body.contacts.find_before(&body.state.tractions, self.drive.rods, increment);
        }
        let decided = !body.contacts.is_empty() && body.contacts.decide(increment);
        found || decided
    }

    /// Adds the forces of tools to what is to be balanced, and to the square of the external forces.
    pub(super) fn add_tools(&mut self, squares: [f64; 4]) -> [f64; 4] {
        let (body, memory) = (&mut *self.body, &mut *self.memory);
        body.contacts.add_forces(&memory.increment, &mut memory.lack);
        for &(node, force) in &memory.dragged {
            memory.lack[node as usize] += force;
        }
        let [_, inertial, external, internal] = squares;
        let free = memory.filters.iter().zip(&memory.lack).map(|(filter, &lack)| filter.apply(lack));
        let lack: f64 = free.map(|lack| lack.squared_norm().to_f64()).sum();
        let of_tools = body.contacts.force().max(memory.dragged.iter().map(|(_, f)| f.norm().to_f64()).sum());
        [lack, inertial, external + of_tools * of_tools, internal]
    }

    /// Lets go, for this step, of nodes that need more than their share of the grip; gives whether there are any. They are dragged
    /// with that share, and the step has to be solved again.
    pub(super) fn slip(&mut self) -> bool {
        let known = self.memory.dragged.len();
        for driven in 0..self.memory.driven.len() {
            let node = self.memory.driven[driven] as usize;
            let NodeMotion::Held(tool) = self.body.state.motions[node] else { continue };
            let limit = self.drive.frames[tool as usize].limit;
            if self.memory.filters[node] != Filter::Held || limit == f64::INFINITY {
                continue;
            }
            let force = self.holding_force(node);
            let size = force.norm();
            if size > limit {
                let position = self.memory.start[node];
                let past = &self.body.state.past;
                let past = past
                    .is_known
                    .then(|| Past { increment: position - past.positions[node], velocity: past.velocities[node] });
                let start = Start { velocity: self.memory.velocities[node], acceleration: Vec3::ZERO, past };
                let coast = self.settings.scheme.coast(&start, T::from_f64(self.dt));
                let memory = &mut *self.memory;
                memory.dragged.push((node as u32, (force * (limit / (size * self.numbers.impulse))).cast()));
                memory.filters[node] = Filter::Free;
                memory.coast[node] = coast.increment;
                memory.coast_velocities[node] = coast.velocity;
            }
        }
        let slips = self.memory.dragged.len() > known;
        if slips {
            self.memory.list_filtered();
        }
        slips
    }

    /// Forgets what was found, for the step to be solved again.
    pub(super) fn start_again(&mut self) {
        self.body.contacts.clear();
        self.move_back();
        self.memory.history.clear();
    }

    /// The force that carries a held node through the step [N]: what the other forces on it lack, in the equations that were solved, and
    /// what its speeding up takes.
    fn holding_force(&self, node: usize) -> Vec3<f64> {
        let memory = &*self.memory;
        let speeding = self.end_velocity(node) - memory.velocities[node];
        let inertial = speeding.cast::<f64>() * (self.body.state.masses[node].to_f64() / self.dt);
        let lack = if memory.is_linear { -memory.reactions[node] } else { memory.lack[node] };
        inertial - lack.cast()
    }

    /// Writes down what the tools did, and where nodes that slipped are between the jaws now.
    pub(super) fn account_for_tools(&mut self) {
        if self.drive.frames.is_empty() {
            return;
        }
        let (start, increment) = (&self.memory.start, &self.memory.increment);
        let (dragged, mut slipped) = (&self.memory.dragged, 0);
        self.body.contacts.finish(increment, self.drive.rods, self.dt * self.numbers.impulse);
        for node in 0..start.len() {
            let NodeMotion::Held(tool) = self.body.state.motions[node] else { continue };
            let frame = &self.drive.frames[tool as usize];
            let place = (start[node] + increment[node]).cast::<f64>();
            let impulse = if self.memory.filters[node] == Filter::Held {
                self.holding_force(node) * self.dt
            } else {
                // In the order in which they slipped, round by round.
                let force = dragged.iter().find(|(number, _)| *number == node as u32).map(|(_, force)| force.cast());
                slipped += 1;
                self.body.state.grips[node] = frame.own(place).cast();
                force.unwrap_or(Vec3::ZERO) * (self.dt * self.numbers.impulse)
            };
            let load = &mut self.body.contacts.loads[tool as usize];
            load.holding += impulse;
            load.holding_moment += (place - frame.tip.1).cross(impulse);
        }
        debug_assert_eq!(slipped, dragged.len());
        let rods = self.drive.rods;
        self.body.contacts.keep_tractions(&mut self.body.state.tractions, rods);
    }
}
