//! What a step is the least of, where its forces have a potential and are those at its end; and steps that end on a crease of it.
//!
//! ½ r/Δt² (δ − δ̂)·M (δ − δ̂) + β Δt/2s v⁺·M v⁺ + V(x + δ) − R·δ
//!
//! Where V has creases, forces jump, and what is least on one is no balance of forces: these pull to it from both sides. Newton's method
//! then comes to rest there, and the step is that of a tissue whose forces on the crease are somewhere between those beside it.

use super::group::Group;
use super::step::Step;
use crate::dynamics::tied::Together;
use crate::math::{Scalar, Vec3};

/// So many iterations of Newton's method,
const WHILE: usize = 10;
/// in which the potential falls by less than this share of its terms, have come to rest.
const SETTLED: f64 = 1e-8;
/// The same for the last iterations that there are. Corotational tissue let go at a thousand times its length creeps along creases for
/// hundreds of iterations, in the last three quarters of them for 2e-4 of its energy.
const SETTLED_AT_LAST: f64 = 1e-4;

/// What a step makes least of: its slope is what the forces lack to balance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Potential {
    /// Its value [J].
    pub(super) energy: f64,
    /// The sum of its terms without their signs [J].
    about: f64,
    /// What rounding of its terms and of the places makes of it [J].
    pub(super) rounding: f64,
}

impl<T: Scalar> Group<'_, T> {
    /// The potential of the step where the body is now; none where some of the forces have none.
    pub(super) fn potential(&mut self) -> Option<Potential> {
        if !matches!(self.together, Together::Alone(_)) || self.numbers.place != 1.0 {
            return None;
        }
        let step = self.member(0);
        let body = &step.body;
        let meets = !body.contacts.is_empty() || !step.memory.dragged.is_empty();
        let has_others = body.followers.is_some() || body.has_changing_forces() || body.stiffness_damping > T::ZERO;
        (step.has_potential() && !meets && !has_others).then(|| step.potential())
    }
}

impl<T: Scalar> Step<'_, T> {
    fn potential(&self) -> Potential {
        let (body, memory, state) = (&*self.body, &*self.memory, &self.body.state);
        let elastic: f64 = state.models.iter().map(|model| model.energy(&state.positions)).sum();
        let (mut energy, mut about) = (elastic, elastic.abs());
        let (mut forces, mut places) = (0.0, 0.0);
        let inertia = 0.5 * self.numbers.inertia / (self.dt * self.dt);
        let damping = 0.5 * body.damping.to_f64() * self.dt / self.numbers.velocity;
        for node in 0..state.positions.len() {
            let mass = state.masses[node].to_f64();
            let square = |v: Vec3<T>| v.cast::<f64>().squared_norm();
            let moving = mass * inertia * square(memory.increment[node] - memory.coast[node])
                + mass * damping * square(self.end_velocity(node));
            let work = body.external_forces[node].cast::<f64>().dot(memory.increment[node].cast());
            energy += moving - work;
            about += moving + work.abs();
            forces += square(state.internal_forces[node]);
            places += square(state.positions[node]);
        }
        let rounding = T::EPSILON.to_f64() * (8.0 * (forces * places).sqrt() + 64.0 * about);
        Potential { energy, about, rounding }
    }
}

/// Potentials in the last iterations of Newton's method [J].
#[derive(Debug)]
pub(super) struct Settling {
    energies: [f64; WHILE],
    count: usize,
}

impl Settling {
    /// Before the first.
    pub(super) fn new() -> Self {
        Self { energies: [f64::INFINITY; WHILE], count: 0 }
    }

    /// Whether the potential, which is `now` after one more iteration, has come to rest.
    fn has_settled(&mut self, now: Potential, is_last: bool) -> bool {
        let before = std::mem::replace(&mut self.energies[self.count % WHILE], now.energy);
        self.count += 1;
        before - now.energy <= if is_last { SETTLED_AT_LAST } else { SETTLED } * now.about
    }
}

impl<T: Scalar> Group<'_, T> {
    /// Whether Newton's method, after one more iteration, has come to rest where the potential may have a crease.
    pub(super) fn settles_on_crease(&mut self, settling: &mut Settling, is_last: bool) -> bool {
        let has_creases = self.member(0).body.state.models.iter().any(|model| model.has_creases());
        has_creases && self.potential().is_some_and(|now| settling.has_settled(now, is_last))
    }
}
