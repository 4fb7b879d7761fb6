//! Energy over a step: backward Euler gains none where its equations have one solution.
//!
//! With w = δ/Δt and forces R of loads at the end, M (w − v)/Δt = R − ∇V(x⁺) makes the change of the kinetic energy
//!
//! ½ w·M w − ½ v·M v = δ·R − δ·∇V(x⁺) − ½ (w − v)·M (w − v)
//!
//! and V(x⁺) − V(x) ≤ δ·∇V(x⁺) where V is convex between the two places. So what kinetic and elastic energy grow beyond the work
//! δ·R tells of tissue that is not convex over so long a step: it was thrown across a hump. Over a shorter one masses count
//! for more.
//!
//! Other schemes have no such bound, and gain and lose a little as tissue turns and bends. A step that gains a good part of all there is was thrown
//! across a hump with them too: Newmark's method took a cube of neo-Hookean tissue, one node poked through it, to 1e19 times its energy within nine
//! steps, linearised, and to a thousand times in full; in parts it comes to rest and never has more than at the start. Of loads it takes the mean
//! of both ends: from the end alone a load that is let go within the step would seem to have done nothing.

use super::group::Group;
use super::step::Step;
use super::{Newton, Scheme};
use crate::body::NodeMotion;
use crate::dynamics::tied::Together;
use crate::math::{Scalar, Vec3};
use crate::solver::Filter;

/// A step of backward Euler that is solved in full gains no more than this share of the energies that are about.
const GAIN: f64 = 1e-6;
/// The same for schemes without a bound, and for forces without a potential: node-wise stiffness warping gained 2.7 times its energy in a step
/// of Newmark's method, and gains 0.6 in parts.
const GAIN_UNBOUNDED: f64 = 0.1;
/// A linearised step that is looked at gains no more than this share.
const GAIN_LINEARISED: f64 = 0.01;
/// In the last attempts, where the forces have a potential, all the parts together gain no more than so many times what there was before them and what
/// was done to them since: what one of 64 alone may gain, they may to the 64th power.
const GAIN_AT_LAST: f64 = 9.0;
/// A linearised step that leaves more than this share of the forces without balance is looked at, with schemes without a bound: half the work of
/// what is left is what Newmark's method gains. Corotational tissue, stretched a thousand times and let go, came to 5e7 times its energy.
const IMBALANCE: f64 = 0.1;

/// Energies of a step [J].
struct Gain {
    /// What kinetic and elastic energy grew by beyond the work of the loads.
    gain: f64,
    /// Both before it.
    before: f64,
    /// Size of the work of the loads.
    work: f64,
    /// All that is about: both of these and the elastic energy after the step.
    about: f64,
    /// What rounding makes of the gain.
    rounding: f64,
}

impl<T: Scalar> Group<'_, T> {
    /// Whether the step that is solved gained energy, and not from anybody: tools, ties and driven nodes may give some. Linearised steps are
    /// looked at where they went astray, are far from balance or stand in for full ones.
    pub(super) fn has_gained(&mut self) -> bool {
        // The energy–momentum scheme keeps energy, and leaves the body where its forces are, at mid-step.
        if !matches!(self.together, Together::Alone(_)) || self.settings.scheme == Scheme::EnergyMomentum {
            return false;
        }
        let is_bounded = self.settings.scheme == Scheme::BackwardEuler;
        let is_suspect = self.went_astray || self.stands_in || (!is_bounded && self.imbalance > IMBALANCE);
        let is_linearised = self.settings.newton == Newton::Linearised || self.stands_in;
        let (is_patient, is_first) = (self.is_patient && !self.stands_in, self.interval.is_first);
        let mut step = self.member(0);
        match is_linearised {
            true if is_patient => step.has_potential() && step.has_gained_since(is_first),
            true => is_suspect && step.has_gained(GAIN_LINEARISED),
            false => step.has_gained(if is_bounded && step.has_potential() { GAIN } else { GAIN_UNBOUNDED }),
        }
    }
}

impl<T: Scalar> Step<'_, T> {
    fn has_gained(&self, share: f64) -> bool {
        self.gain().is_some_and(|own| own.gain > share * own.about + own.rounding)
    }

    /// Whether it did with the parts of the step before it, of which there are none if it `is_first`.
    fn has_gained_since(&mut self, is_first: bool) -> bool {
        let Some(own) = self.gain() else { return false };
        let (gain, about) = if is_first { (0.0, own.before) } else { self.memory.gain };
        let (gain, about) = (gain + own.gain, about + own.work);
        self.memory.gain = (gain, about);
        gain > GAIN_AT_LAST * about + own.rounding
    }

    /// What it gained from nobody, unless there may be somebody.
    fn gain(&self) -> Option<Gain> {
        let (body, memory, state) = (&*self.body, &*self.memory, &self.body.state);
        if body.followers.is_some() || !body.contacts.is_empty() || self.is_led() {
            return None;
        }
        let (mut kinetic, mut work) = ([0.0; 2], 0.0);
        let (mut forces, mut places) = (0.0, 0.0);
        let takes_mean = self.settings.scheme.needs_acceleration();
        let external = |node: usize| {
            let at_end = body.external_forces[node];
            if takes_mean { (memory.external[node] + at_end) * T::from_f64(0.5) } else { at_end }
        };
        for node in 0..state.positions.len() {
            let energy = |v: Vec3<T>| 0.5 * (state.masses[node] * v.squared_norm()).to_f64();
            kinetic[0] += energy(memory.velocities[node]);
            kinetic[1] += energy(self.end_velocity(node));
            work += external(node).dot(memory.increment[node]).to_f64();
            forces += state.internal_forces[node].squared_norm().to_f64();
            places += state.positions[node].squared_norm().to_f64();
        }
        let elastic = |x: &[Vec3<T>]| state.models.iter().map(|model| model.energy(x)).sum::<f64>();
        let elastic = [elastic(&memory.start), elastic(&state.positions)];
        let before = kinetic[0] + elastic[0].abs();
        let about = before + elastic[1].abs() + work.abs();
        // What rounding of the places makes of the elastic energies, and of what adds up to nothing near rest.
        let rounding = T::EPSILON.to_f64() * (8.0 * (forces * places).sqrt() + 64.0 * about);
        Some(Gain {
            gain: kinetic[1] + elastic[1] - kinetic[0] - elastic[0] - work,
            before,
            about,
            work: work.abs(),
            // On a way through places of any stiffness the last of these would excuse what it led to: neo-Hookean tissue, let go at a thousand
            // times its length, came to 1e26 times its energy in a step.
            rounding: rounding + memory.least_rounding * places.sqrt(),
        })
    }

    pub(super) fn has_potential(&self) -> bool {
        self.body.state.models.iter().all(|model| model.has_potential())
    }

    /// Whether nodes are taken along by anything.
    fn is_led(&self) -> bool {
        let (memory, motions) = (&*self.memory, &self.body.state.motions);
        let goes = |node: usize| {
            let (way, filter) = (memory.coast[node], &memory.filters[node]);
            *filter != Filter::Free && way != filter.apply(way)
        };
        (0..motions.len()).any(|node| matches!(motions[node], NodeMotion::Held(_)) || goes(node))
    }
}
