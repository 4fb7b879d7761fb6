//! Newton's method for the equations of a step, or one iteration of it.

use super::ImplicitReport;
use super::balance::Balance;
use super::correction::Solve;
use super::group::Group;
use super::memory::ImplicitMemory;
use super::potential::Settling;
use super::step::Step;
use super::tools::Guess;
use crate::executor::{NODE_BLOCK, ReadBlocks, node_blocks};
use crate::math::{Scalar, Vec3, dispatch, dispatch_level};
use crate::solver::{among, dot_of};

/// A linear solve has gone astray if it leaves more of the forces than there was, and more than this share of them all.
const ASTRAY: f64 = 0.5;
/// A linearised step that meets negative curvature or goes astray is solved in full instead, so far, in so many iterations at
/// most. Without this a bar of stable neo-Hookean tissue, with one node poked out of its side, was thrown beyond 1e100 m.
pub(super) const INSTEAD: (f64, u32) = (1e-3, 40);
/// The line search is content when the work of the residual along the correction has fallen below this share.
const CONTENT: f64 = 0.9;
/// It goes farther while more than this share of the work is left to be done: tissue that softens on the way has its
/// correction from the masses alone, and crawled.
const STEEP: f64 = 0.5;
/// Iterations of Newton's method after which a step is lost. The line search then asks that its potential falls, where there is one: tissue
/// that starts a thousand times too long, or inside out, was led about by the forces alone. And products are those of the derivative itself:
/// with the rotations of cells held, tissue that collapses under ten times its modulus was not in balance after 100 iterations, and is after 40.
const LOST: u32 = 10;
/// The potential falls by more than this share of what its slope promises (Armijo).
const ENOUGH: f64 = 1e-4;
/// How much farther the line search goes.
const FARTHER: f64 = 4.0;
/// The last attempts at a step take so many times as many iterations as others, and with a potential as many of linear solves: without one, as many
/// settings of warped stiffness were undone either way. Tissue integrated at the nodes, free and let go at a thousand times its length, had
/// not balanced after 100 in a 64th part of 0.02 s, and has after 163. Hexahedra of neo-Hookean tissue had not after 400 with linear solves of at
/// most 100, and have after 4.
pub(super) const PATIENCE: u32 = 4;
/// The most solves of a linearised step between which contacts close or open.
const ROUNDS: u32 = 12;
/// Iterations of Newton's method after which contacts stay as they are.
const DECIDED: u32 = 20;
/// The most lengths that the line search tries.
const TRIALS: u32 = 10;

impl<T: Scalar> Group<'_, T> {
    /// One linear solve from the beginning, with coasting as its guess; or what stands in for it where that says nothing.
    pub(super) fn solve_linearised(&mut self) -> ImplicitReport {
        let before = self.evaluate();
        let arrived = self.go_on();
        self.meet_tools(Guess::Coast);
        let mut solve = self.correct();
        for _ in 1..ROUNDS {
            if solve.negative_curvature || !self.meet_tools(Guess::Correction) {
                break;
            }
            let again = self.correct();
            solve = Solve { iterations: solve.iterations + again.iterations, ..again };
        }
        if !solve.negative_curvature {
            let gain = self.work().abs();
            self.move_by(1.0);
            // The forces there serve the next step.
            let after = self.evaluate();
            // A step that ends on a slope steeper than that which it went down has climbed.
            let climbed = arrived && after.lack > ASTRAY * before.lack && self.work() > gain;
            let astray = climbed || after.lack > before.lack.max(ASTRAY * after.scale);
            let astray = astray && after.lack > solve.rounding;
            if !astray && after.lack.is_finite() {
                self.each(|step| step.memory.is_linear = true);
                self.imbalance = if after.scale > 0.0 { after.lack / after.scale } else { 0.0 };
                return ImplicitReport {
                    newton_iterations: 1,
                    linear_iterations: solve.iterations,
                    residual: solve.residual,
                    converged: solve.converged,
                    negative_curvature: false,
                };
            }
        }
        self.each(|step| step.move_back());
        let (relative, at_most) = INSTEAD;
        self.went_astray = true;
        let report = self.solve_in_full(relative, at_most);
        ImplicitReport {
            linear_iterations: solve.iterations + report.linear_iterations,
            negative_curvature: solve.negative_curvature || report.negative_curvature,
            ..report
        }
    }

    /// Linear solves with a line search, until the forces balance.
    pub(super) fn solve_in_full(&mut self, relative: f64, at_most: u32) -> ImplicitReport {
        self.each(|step| step.memory.is_linear = false);
        let mut report = ImplicitReport { converged: false, ..ImplicitReport::NOTHING };
        let mut balance = self.evaluate();
        let (mut scale, mut floor, mut settling) = (0.0f64, 0.0, Settling::new());
        loop {
            scale = scale.max(balance.scale);
            report.residual = if scale > 0.0 { balance.lack / scale } else { 0.0 };
            self.each(|step| step.memory.history.push(report.residual));
            let arrived = self.go_on();
            let guess = if report.newton_iterations == 0 { Guess::Coast } else { Guess::Increment };
            let news = report.newton_iterations < DECIDED && self.meet_tools(guess);
            if news {
                balance = self.find_lack();
            }
            report.converged = arrived && !news && balance.lack <= (relative * scale).max(floor);
            if report.converged || report.newton_iterations == at_most || !balance.lack.is_finite() {
                return report;
            }
            let first = report.newton_iterations == 0;
            if !first {
                self.each(|step| step.memory.correction.fill(Vec3::ZERO));
            }
            let stalls = arrived && report.newton_iterations >= LOST && self.may_be_exact();
            let is_lost = arrived && (!self.may_climb || report.newton_iterations >= LOST);
            self.each(|step| step.memory.matrix.is_exact = stalls);
            let solve = self.correct();
            floor = solve.rounding;
            report.newton_iterations += 1;
            report.linear_iterations += solve.iterations;
            report.negative_curvature |= solve.negative_curvature;
            balance = self.search(arrived, is_lost);
            if stalls && self.settles_on_crease(&mut settling, report.newton_iterations == at_most) {
                report.residual = balance.lack / scale;
                report.converged = true;
                return report;
            }
        }
    }

    /// Whether a lost step may be solved with the derivative itself: where there is a potential, so that it is symmetric, in a step that asked for
    /// a full solution. Not by Newmark's method, which has many solutions then and found others of them: of tissue let go in 274 impossible
    /// shapes five fewer came back.
    fn may_be_exact(&mut self) -> bool {
        let goes_on_from_forces = self.settings.scheme.needs_acceleration();
        !self.went_astray && !goes_on_from_forces && !self.any(|step| !step.has_potential())
    }

    /// Moves along the correction, as far as it leads towards balance: neither up again nor where most of the way down is left.
    /// A step that takes driven nodes along is taken whole. One that is lost has its potential looked at as well.
    fn search(&mut self, arrived: bool, is_lost: bool) -> Balance {
        let before = self.work();
        let start = if is_lost { self.potential() } else { None };
        let (mut length, mut descends, mut climbs) = (1.0, 0.0, f64::INFINITY);
        self.move_by(length);
        let mut balance = self.evaluate();
        for _ in 1..TRIALS {
            let after = self.work();
            let falls = start.is_none_or(|start| {
                let promised = ENOUGH * length * before;
                self.potential().is_some_and(|now| now.energy <= start.energy + promised + start.rounding)
            });
            let finite = balance.lack.is_finite() && after.is_finite() && falls;
            if finite && (!arrived || (after <= CONTENT * before.abs() && after >= -STEEP * before.abs())) {
                break;
            }
            if finite && after < 0.0 {
                descends = length;
            } else {
                climbs = length;
            }
            let next = if climbs.is_finite() {
                let towards = if finite && after > before { before / (before - after) } else { 0.1 };
                let share = (length * towards - descends) / (climbs - descends);
                descends + share.clamp(0.1, 0.5) * (climbs - descends)
            } else {
                FARTHER * length
            };
            self.move_by(next - length);
            length = next;
            balance = self.evaluate();
        }
        balance
    }
}

impl<T: Scalar> Step<'_, T> {
    /// Sets what driven nodes still have to go; gives whether all are where they have to be.
    pub(super) fn go_on(&mut self) -> bool {
        let ImplicitMemory { prescribed, coast, increment, filters, driven, .. } = &mut *self.memory;
        let mut arrived = true;
        for node in driven.iter().map(|&node| node as usize) {
            let rest = coast[node] - increment[node];
            let rest = rest - filters[node].apply(rest);
            // What the filter's own rounding leaves of a way across the directions that are known is no way to go.
            let ways = coast[node].norm() + increment[node].norm();
            let is_there = rest.norm() <= ways * T::EPSILON * T::from_f64(8.0);
            prescribed[node] = if is_there { Vec3::ZERO } else { rest };
            arrived &= is_there;
        }
        arrived
    }

    /// Work of what the forces lack to balance against the correction [J], in the free directions: reactions are larger by far,
    /// and would turn the rounding of a correction across them into work.
    pub(super) fn work(&self) -> f64 {
        let ImplicitMemory { filters, driven, lack, correction, .. } = &*self.memory;
        let work = |block: usize, ReadBlocks(lack): ReadBlocks<'_, Vec3<T>>| {
            let nodes = block * NODE_BLOCK..block * NODE_BLOCK + lack.len();
            let (filters, ways) = (&filters[nodes.clone()], &correction[nodes]);
            if among(driven, block * NODE_BLOCK, lack.len()).is_empty() {
                return dispatch!(dispatch_level(), _simd => dot_of(lack, ways));
            }
            let free = filters.iter().zip(lack).map(|(filter, &lack)| filter.apply(lack));
            free.zip(ways).map(|(lack, &way)| lack.dot(way).to_f64()).sum::<f64>()
        };
        let executor = &self.body.scratch.executor;
        -executor.fold(node_blocks(lack.len()), ReadBlocks(lack), &work, &|a, b| a + b).unwrap_or(0.0)
    }
}
