//! The papers' explicit scheme: central differences with lumped masses.
//!
//! (m/Δt² + γ/2Δt) x⁺ = (R − F) + 2m/Δt² x − (m/Δt² − γ/2Δt) x⁻,   stable iff Δt < 2/ω_max for any γ ≥ 0
//!
//! With v = (x⁺ − x⁻)/2Δt it reads, per node and without a past position,
//!
//! v_½ = v + Δt/2 (R − F − γv)/m,   x⁺ = x + Δt v_½,   v⁺ = [v_½ + Δt/2 (R⁺ − F⁺)/m] / (1 + γΔt/2m)
//!
//! which starts by itself, lets Δt change from step to step, and is symplectic for γ = 0.
//!
//! Source: Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), eq. 11, with the sign of γ corrected.

use super::Drive;
use crate::body::{NodeMotion, SimulatedBody};
use crate::executor::{NODE_BLOCK, NodeBlocks, node_blocks};
use crate::math::{Scalar, Vec3};
use crate::model::Scratch;
use crate::solver::Filter;
use crate::stage::{Stage, Stages};

/// Share of the stability limit 2/ω_max that automatic sub-steps use: room for the tissue to stiffen within a step.
const SAFETY: f64 = 0.9;

/// Longest stable time step [s] for a bound of ω_max² [1/s²]; infinite where nothing vibrates.
pub fn stable_step(squared_frequency: f64) -> f64 {
    2.0 / squared_frequency.sqrt()
}

/// Sub-steps of equal length that divide `step` [s] with a margin to the stability limit; at least 1.
pub fn substeps_for(step: f64, squared_frequency: f64) -> f64 {
    (step / (SAFETY * stable_step(squared_frequency))).ceil().max(1.0)
}

impl<T: Scalar> SimulatedBody<T> {
    /// Longest stable step of the explicit scheme as the body is now [s]; infinite where nothing vibrates.
    pub fn stable_step(&self) -> f64 {
        let positions = &self.state.positions;
        let measure = || self.frequency.squared_frequency(positions, &mut Scratch::new(positions.len()));
        stable_step(self.state.squared_frequency.unwrap_or_else(measure))
    }

    /// The cell that sets the stable step as the body is now; none in a body that does not vibrate.
    ///
    /// Found by halves: where the bound falls when some of the cells are taken out, it is one of them.
    pub fn stiffest_cell(&self) -> Option<usize> {
        let positions = &self.state.positions;
        let mut scratch = Scratch::new(positions.len());
        let mut rest = self.frequency.clone_box();
        let bound = rest.squared_frequency(positions, &mut scratch);
        let left = (0..self.mesh.cell_count()).filter(|&cell| !self.state.removed[cell]);
        let mut cells: Vec<u32> = left.map(|cell| cell as u32).collect();
        while cells.len() > 1 && bound > 0.0 {
            let others = cells.split_off(cells.len() / 2);
            let mut without = rest.clone_box();
            without.remove(&cells);
            if without.squared_frequency(positions, &mut scratch) == bound {
                (rest, cells) = (without, others);
            }
        }
        cells.first().filter(|_| bound > 0.0).map(|&cell| cell as usize)
    }
}

/// Advances a body by one sub-step of `dt` [s]. Internal and external forces must be those of its beginning.
pub fn advance<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>, stages: Stages) {
    stages.run(Stage::KickAndDrift, || kick_and_drift(body, dt, drive));
    body.state.positions_changed();
    body.update_internal_forces(stages);
    stages.run(Stage::Loads, || body.update_external_forces(drive.end, drive.gravity));
    stages.run(Stage::KickAndDrift, || kick(body, dt));
}

/// First half: v_½ and x⁺, and driven nodes to where they must be.
fn kick_and_drift<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>) {
    let (step, half) = (T::from_f64(dt), T::from_f64(0.5 * dt));
    for_nodes(body, &|body, node, position, velocity| {
        if body.state.motions[node] == NodeMotion::Free {
            let acceleration = acceleration(body, node) - *velocity * body.damping;
            *velocity = acceleration.mul_add(half, *velocity);
            *position = velocity.mul_add(step, *position);
            return;
        }
        let (target, filter) = (drive.target(body, node, *position), body.free_directions(node));
        match (target, filter) {
            (Some(target), Filter::Held) => {
                *velocity = (target - *position) / step;
                *position = target;
            }
            _ => {
                let acceleration = acceleration(body, node) - *velocity * body.damping;
                *velocity = acceleration.mul_add(half, *velocity);
                if let Some(target) = target {
                    *velocity = filter.merge(*velocity, (target - *position) / step);
                }
                *position = velocity.mul_add(step, *position);
            }
        }
    });
}

/// Second half: v⁺ from the forces at x⁺.
fn kick<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64) {
    let half = T::from_f64(0.5 * dt);
    let damped = T::ONE / (T::ONE + half * body.damping);
    for_nodes(body, &|body, node, _, velocity| {
        let kicked = || acceleration(body, node).mul_add(half, *velocity) * damped;
        match body.state.motions[node] {
            NodeMotion::Free => *velocity = kicked(),
            _ => match body.free_directions(node) {
                Filter::Held => {}
                filter => *velocity = filter.merge(kicked(), *velocity),
            },
        }
    });
}

/// (R − F)/m without damping [m/s²].
#[inline]
fn acceleration<T: Scalar>(body: &SimulatedBody<T>, node: usize) -> Vec3<T> {
    (body.external_forces[node] - body.state.internal_forces[node]) * (T::ONE / body.state.masses[node])
}

/// Lets `work` change place and velocity of every node, on all threads.
fn for_nodes<T: Scalar>(
    body: &mut SimulatedBody<T>,
    work: &(impl Fn(&SimulatedBody<T>, usize, &mut Vec3<T>, &mut Vec3<T>) + Sync),
) {
    let mut positions = std::mem::take(&mut body.state.positions);
    let mut velocities = std::mem::take(&mut body.state.velocities);
    let data = (NodeBlocks(&mut positions), NodeBlocks(&mut velocities));
    let the_body = &*body;
    the_body.scratch.executor.each(node_blocks(the_body.rest.len()), data, &|block, (x, v): Motion<'_, T>| {
        for (i, (position, velocity)) in x.0.iter_mut().zip(v.0).enumerate() {
            work(the_body, block * NODE_BLOCK + i, position, velocity);
        }
    });
    (body.state.positions, body.state.velocities) = (positions, velocities);
}

/// Places and velocities.
type Motion<'a, T> = (NodeBlocks<'a, Vec3<T>>, NodeBlocks<'a, Vec3<T>>);
