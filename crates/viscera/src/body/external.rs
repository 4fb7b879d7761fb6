//! What acts on a body from outside, and from what in it pulls by itself: gravity, loads, muscles, actuators.

use super::{Actuators, Drivers, NodalLoads, SimulatedBody};
use crate::executor::{NODE_BLOCK, NodeBlocks, node_blocks};
use crate::math::{Mat3, Scalar, Vec3, dispatch, dispatch_level};
use crate::model::BlockSink;
use crate::solver::Reach;

impl<T: Scalar> SimulatedBody<T> {
    /// Gravity, loads, muscles and actuators at `time` on the current positions [N].
    pub(crate) fn update_external_forces(&mut self, time: f64, gravity: Vec3<T>) {
        let masses = &self.state.masses;
        let work = |block: usize, NodeBlocks(forces): NodeBlocks<'_, Vec3<T>>| {
            let masses = &masses[block * NODE_BLOCK..];
            dispatch!(dispatch_level(), _simd => forces.iter_mut().zip(masses).for_each(|(force, &mass)| *force = gravity * mass));
        };
        self.scratch.executor.each(node_blocks(masses.len()), NodeBlocks(&mut self.external_forces), &work);
        self.loads.add(time, &self.state.positions, &self.state.removed, &mut self.external_forces);
        self.muscles.add(time, &self.state.positions, &self.state.removed, &mut self.external_forces);
        self.actuators.add(time, &self.state.positions, &mut self.external_forces);
        if let Some(followers) = &self.followers {
            let drivers = Drivers { prescribed: &self.prescribed, guides: &self.guides, loads: &self.loads };
            followers.condense(drivers, gravity.cast(), time, &mut self.external_forces);
        }
    }

    /// Whether anything but weight acts on it, which stays as it is within a step.
    pub(crate) fn has_changing_forces(&self) -> bool {
        !(self.loads.is_empty() && self.muscles.is_empty() && self.actuators.is_empty())
    }

    /// What muscles, actuators and force fields add to the bound of ω² [1/s²], `sums` being nodal memory.
    pub(crate) fn external_squared_frequency(&self, sums: &mut [[T; 4]]) -> f64 {
        let state = &self.state;
        self.muscles.squared_frequency(&state.masses, &state.removed, sums)
            + self.actuators.squared_frequency(&state.positions, &state.masses, sums)
            + self.loads.squared_frequency(&state.masses)
    }

    /// Which nodes know each other's forces, those that actuators join included.
    pub(crate) fn reach(&self) -> Reach<'_> {
        Reach { groups: self.actuators.groups(), ..self.state.reach() }
    }

    /// Adds −∂f_ext/∂x [N/m] at `time` [s], times `factor`, to `sink`: of loads that follow the surface, fields and actuators.
    pub(crate) fn add_external_blocks(&self, time: f64, factor: f64, sink: &mut dyn BlockSink<T>) {
        let state = &self.state;
        self.loads.add_blocks(time, &state.positions, &state.removed, factor, sink);
        self.actuators.add_blocks(time, &state.positions, factor, sink);
    }

    /// Brings what is known of cells that are left up to date with them.
    pub(crate) fn update_actions(&mut self) {
        self.loads.update(&self.state.removed);
        self.actuators.update(&self.state.removed, &self.state.cells_at_node);
    }
}

/// The stiffness of fields and actuators in an implicit step: it is never assembled, as actuators join nodes far apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExternalStiffness<'a, T> {
    pub(crate) loads: &'a NodalLoads<T>,
    pub(crate) actuators: &'a Actuators<T>,
    /// Time of the forces [s].
    pub(crate) time: f64,
    /// What it counts besides that of the tissue.
    pub(crate) factor: f64,
}

impl<T: Scalar> ExternalStiffness<'_, T> {
    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.actuators.is_empty() && !self.loads.has_stiffness()
    }

    /// Adds its product with `dx` on nodes at `x` to `out`.
    pub(crate) fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], out: &mut [Vec3<T>]) {
        let factor = T::from_f64(self.factor);
        self.loads.for_stiffness(self.time, x, |node, block| out[node as usize] += block * dx[node as usize] * factor);
        self.actuators.for_stiffness(self.time, x, |terms, stiffness| {
            let change = terms.iter().fold(Vec3::ZERO, |sum, &(node, weight)| sum + dx[node as usize] * weight);
            let pull = stiffness * change * factor;
            terms.iter().for_each(|&(node, weight)| out[node as usize] += pull * weight);
        });
    }

    /// Shows `add` its blocks on the diagonal on nodes at `x`.
    pub(crate) fn for_diagonal(&self, x: &[Vec3<T>], mut add: impl FnMut(u32, Mat3<T>)) {
        let factor = T::from_f64(self.factor);
        self.loads.for_stiffness(self.time, x, |node, block| add(node, block * factor));
        self.actuators.for_stiffness(self.time, x, |terms, stiffness| {
            terms.iter().for_each(|&(node, weight)| add(node, stiffness * (weight * weight * factor)));
        });
    }
}
