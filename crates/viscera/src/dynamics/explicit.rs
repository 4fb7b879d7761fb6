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
use super::hold::Held;
use crate::body::{BodyState, Driven, NodeMotion, SimulatedBody, Still, find_forces, free_directions};
use crate::contact::{Contacts, Nodes};
use crate::executor::{NODE_BLOCK, NodeBlocks, node_blocks};
use crate::math::{Scalar, Vec3, dispatch, dispatch_level};
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
    /// Longest stable step of the explicit scheme as the body is now [s]; infinite where nothing vibrates, and where it does not move in
    /// time.
    pub fn stable_step(&self) -> f64 {
        if self.answer.is_some() {
            return f64::INFINITY;
        }
        let known = self.state.squared_frequency;
        stable_step(known.unwrap_or_else(|| self.squared_frequency_at(&self.state.positions)))
    }

    /// Sub-steps that a step [s] would take if the body were at rest.
    pub(crate) fn substeps_at_rest(&self, step: f64) -> f64 {
        substeps_for(step, self.squared_frequency_at(&self.rest))
    }

    /// Bound of ω_max² with the tissue at these places [1/s²].
    fn squared_frequency_at(&self, positions: &[Vec3<T>]) -> f64 {
        let mut scratch = Scratch::new(positions.len());
        let of_tissue = self.frequency.squared_frequency(positions, &mut scratch);
        of_tissue + self.external_squared_frequency(&mut scratch.forces)
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

/// Prepares a body, tied to others or not, for the sub-steps of a step, over which the motions of nodes stay as they are: forces of its
/// beginning, the nodes that are not free, and whether anything may meet it on the way.
pub fn begin<T: Scalar>(body: &mut SimulatedBody<T>, is_tied: bool, time: f64, gravity: Vec3<T>, stages: Stages) {
    body.update_internal_forces(stages);
    stages.run(Stage::Loads, || body.update_external_forces(time, gravity));
    body.driven.clear();
    body.still.clear();
    for (node, motion) in not_free(&body.state.motions) {
        if motion.is_still() {
            body.still.push(Still { node, position: body.state.positions[node] });
        } else {
            body.driven.push(Driven { node, position: Vec3::ZERO, velocity: Vec3::ZERO });
        }
    }
    let is_held = body.driven.iter().any(|driven| matches!(body.state.motions[driven.node], NodeMotion::Held(_)));
    let is_met = is_tied || is_held || body.contacts.are_possible();
    body.is_left_alone = !is_met && body.constraints.is_empty() && !body.has_changing_forces();
}

/// Nodes that are not free. Many are looked at together, without a branch for each, as most are free and every step looks at all.
fn not_free(motions: &[NodeMotion]) -> impl Iterator<Item = (usize, NodeMotion)> + '_ {
    const TOGETHER: usize = 48;
    let is_free = |motion: &NodeMotion| matches!(motion, NodeMotion::Free);
    let blocks = motions.chunks(TOGETHER).enumerate();
    let mixed = blocks.filter(move |(_, motions)| !motions.iter().fold(true, |all, motion| all & is_free(motion)));
    mixed.flat_map(move |(block, motions)| {
        let nodes = motions.iter().enumerate().filter(move |(_, motion)| !is_free(motion));
        nodes.map(move |(number, &motion)| (block * TOGETHER + number, motion))
    })
}

/// Advances a body by one sub-step of `dt` [s]. Internal and external forces must be those of its beginning.
pub fn advance<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>, stages: Stages) {
    drift(body, dt, drive, stages);
    kick(body, dt, drive, false, stages);
}

/// The second half of a sub-step of `dt` [s] and the first half of the next in one, to the same bits, of a body that is
/// left alone in between: one way through the nodes does for the sums of forces, both kicks and the drift.
pub fn stride<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>, stages: Stages) {
    let pace = Pace::new(dt, body.damping);
    keep_driven(body);
    sum_kick_and_drift(body, pace, stages);
    stages.run(Stage::KickAndDrift, || {
        kick_guided_twice(body, pace);
        drive_nodes(body, dt, drive);
    });
    body.state.positions_changed();
    body.is_linearized = false;
}

/// The first half of a sub-step of `dt` [s]: a kick, the drift, and what tools do about it. Internal and external forces must be those
/// of its beginning.
pub fn drift<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>, stages: Stages) {
    stages.run(Stage::KickAndDrift, || kick_and_drift(body, dt, drive));
    if !drive.rods.is_empty() {
        stages.run(Stage::Instruments, || meet_tools(body, dt, drive));
    }
    body.state.positions_changed();
}

/// The second half: the kick by the forces at the new places, where the bound of the highest frequency is asked for after the last one.
pub fn kick<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>, is_last: bool, stages: Stages) {
    if is_last {
        body.update_forces_and_bound(stages);
    } else {
        body.update_internal_forces(stages);
    }
    // Weights do not change within a step.
    if body.has_changing_forces() {
        stages.run(Stage::Loads, || body.update_external_forces(drive.end, drive.gravity));
    }
    stages.run(Stage::KickAndDrift, || kick_again(body, dt, drive));
    if !body.contacts.is_empty() {
        stages.run(Stage::Instruments, || {
            let damping = 1.0 + 0.5 * dt * body.damping.to_f64();
            let (contacts, mut nodes) = touched(body);
            contacts.solve_kick(&mut nodes, drive.rods, dt, damping);
        });
    }
}

/// Finds where tools touch in the drift, and gives the impulses that keep them out.
fn meet_tools<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>) {
    let (state, step) = (&body.state, T::from_f64(dt));
    let places = |node: u32| {
        let (end, velocity) = (state.positions[node as usize], state.velocities[node as usize]);
        ((end - velocity * step).cast(), end.cast())
    };
    body.contacts.clear();
    if body.contacts.find(drive.rods, body.skin.triangles(), drive.frames, places) {
        let (contacts, mut nodes) = touched(body);
        contacts.solve_drift(&mut nodes, drive.rods, dt);
    }
}

/// The contacts of a body, and the nodes that they move.
fn touched<T: Scalar>(body: &mut SimulatedBody<T>) -> (&mut Contacts, Nodes<'_, T, impl Fn(u32) -> Filter<T>>) {
    let (guides, motions) = (&body.guides, &body.state.motions);
    let nodes = Nodes {
        positions: &mut body.state.positions,
        velocities: &mut body.state.velocities,
        masses: &body.state.masses,
        filter: |node: u32| free_directions(guides, motions[node as usize]),
    };
    (&mut body.contacts, nodes)
}

/// First half: v_½ and x⁺, and driven nodes to where they must be.
fn kick_and_drift<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>) {
    let pace = Pace::new(dt, body.damping);
    keep_driven(body);
    for_blocks(body, &|x, v, accelerations| {
        dispatch!(dispatch_level(), _simd => kick_and_drift_freely(x, v, accelerations, pace));
    });
    drive_nodes(body, dt, drive);
}

/// Puts nodes that are not free to where they must be after the drift.
fn drive_nodes<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>) {
    let step = T::from_f64(dt);
    for &Still { node, position } in &body.still {
        body.state.positions[node] = position;
        body.state.velocities[node] = Vec3::ZERO;
    }
    for i in 0..body.driven.len() {
        let Driven { node, position, .. } = body.driven[i];
        if let NodeMotion::Held(tool) = body.state.motions[node] {
            body.carry(Held { node, tool: tool as usize, position }, drive, dt);
            continue;
        }
        let (target, filter) = (drive.target(body, node, position), body.free_directions(node));
        let Some(target) = target else { continue };
        let velocity = filter.merge(body.state.velocities[node], (target - position) / step);
        body.state.velocities[node] = velocity;
        body.state.positions[node] = if filter == Filter::Held { target } else { velocity.mul_add(step, position) };
    }
}

/// Second half: v⁺ from the forces at x⁺.
fn kick_again<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>) {
    let pace = Pace::new(dt, body.damping);
    keep_driven(body);
    for_blocks(body, &|_, v, accelerations| {
        dispatch!(dispatch_level(), _simd => kick_freely(v, accelerations, pace));
    });
    body.still.iter().for_each(|still| body.state.velocities[still.node] = Vec3::ZERO);
    for i in 0..body.driven.len() {
        let Driven { node, velocity, position } = body.driven[i];
        if let NodeMotion::Held(tool) = body.state.motions[node] {
            body.keep_carrying(Held { node, tool: tool as usize, position }, velocity, drive, dt);
            continue;
        }
        body.state.velocities[node] = body.free_directions(node).merge(body.state.velocities[node], velocity);
    }
}

/// Finds the forces, kicks by them twice and drifts.
fn sum_kick_and_drift<T: Scalar>(body: &mut SimulatedBody<T>, pace: Pace<T>, stages: Stages) {
    let SimulatedBody { state, scratch, external_forces, .. } = body;
    let BodyState { models, positions, velocities, internal_forces, masses, .. } = state;
    let patches = find_forces(models, positions, scratch, internal_forces, stages).map(|(_, patches)| patches);
    let work = |block: usize, ((x, v), NodeBlocks(internal)): (Motion<'_, T>, NodeBlocks<'_, Vec3<T>>)| {
        let nodes = block * NODE_BLOCK..block * NODE_BLOCK + internal.len();
        dispatch!(dispatch_level(), _simd => {
            if let Some(patches) = patches {
                patches.write_up_block(block, scratch.summed(), internal);
            }
            let accelerations = (&external_forces[nodes.clone()], &*internal, &masses[nodes]);
            kick_twice_and_drift_freely(x.0, v.0, accelerations, pace);
        });
    };
    let data = ((NodeBlocks(positions), NodeBlocks(velocities)), NodeBlocks(internal_forces));
    stages.run(Stage::KickAndDrift, || scratch.executor.each(node_blocks(masses.len()), data, &work));
}

/// Kicks guided nodes once more from where they were: guides hold them between the two kicks.
fn kick_guided_twice<T: Scalar>(body: &mut SimulatedBody<T>, pace: Pace<T>) {
    let is_guided = |driven: &&Driven<T>| matches!(body.state.motions[driven.node], NodeMotion::Guided(_));
    for &Driven { node, position, velocity } in body.driven.iter().filter(is_guided) {
        let force = body.external_forces[node] - body.state.internal_forces[node];
        let (mass, mut x, mut v) = (body.state.masses[node], position, velocity);
        pace.kick(&mut v, force, mass);
        v = free_directions(&body.guides, body.state.motions[node]).merge(v, velocity);
        pace.kick_and_drift(&mut x, &mut v, force, mass);
        body.state.velocities[node] = v;
    }
}

/// Remembers where the nodes are that are driven, and how fast.
fn keep_driven<T: Scalar>(body: &mut SimulatedBody<T>) {
    for driven in &mut body.driven {
        driven.position = body.state.positions[driven.node];
        driven.velocity = body.state.velocities[driven.node];
    }
}

/// A sub-step, and what damping makes of it.
#[derive(Clone, Copy)]
struct Pace<T> {
    /// Its length [s], and half of it.
    step: T,
    half: T,
    /// Damping rate [1/s].
    damping: T,
    /// What is left of a velocity after the second kick.
    damped: T,
}

impl<T: Scalar> Pace<T> {
    fn new(dt: f64, damping: T) -> Self {
        let half = T::from_f64(0.5 * dt);
        Self { step: T::from_f64(dt), half, damping, damped: T::ONE / (T::ONE + half * damping) }
    }

    /// The first kick of a sub-step by a force R − F, and the drift.
    #[inline(always)]
    fn kick_and_drift(self, x: &mut Vec3<T>, v: &mut Vec3<T>, force: Vec3<T>, mass: T) {
        let acceleration = force * (T::ONE / mass) - *v * self.damping;
        *v = acceleration.mul_add(self.half, *v);
        *x = v.mul_add(self.step, *x);
    }

    /// The second kick.
    #[inline(always)]
    fn kick(self, v: &mut Vec3<T>, force: Vec3<T>, mass: T) {
        *v = force.mul_add(self.half / mass, *v) * self.damped;
    }
}

/// External forces, internal forces and masses of a block of nodes: what (R − F)/m comes from.
type Accelerations<'a, T> = (&'a [Vec3<T>], &'a [Vec3<T>], &'a [T]);

/// Lets `work` move blocks of nodes, on all threads.
fn for_blocks<T: Scalar>(
    body: &mut SimulatedBody<T>,
    work: &(impl Fn(&mut [Vec3<T>], &mut [Vec3<T>], Accelerations<'_, T>) + Sync),
) {
    let (state, external) = (&mut body.state, &body.external_forces);
    let (internal, masses) = (&state.internal_forces, &state.masses);
    let data = (NodeBlocks(&mut state.positions), NodeBlocks(&mut state.velocities));
    let work = |block: usize, (NodeBlocks(x), NodeBlocks(v)): Motion<'_, T>| {
        let nodes = block * NODE_BLOCK..block * NODE_BLOCK + x.len();
        work(x, v, (&external[nodes.clone()], &internal[nodes.clone()], &masses[nodes]));
    };
    body.scratch.executor.each(node_blocks(masses.len()), data, &work);
}

/// Places and velocities.
type Motion<'a, T> = (NodeBlocks<'a, Vec3<T>>, NodeBlocks<'a, Vec3<T>>);

#[inline(always)]
fn kick_and_drift_freely<T: Scalar>(
    x: &mut [Vec3<T>],
    v: &mut [Vec3<T>],
    (external, internal, masses): Accelerations<'_, T>,
    pace: Pace<T>,
) {
    for ((((x, v), &external), &internal), &mass) in x.iter_mut().zip(v).zip(external).zip(internal).zip(masses) {
        pace.kick_and_drift(x, v, external - internal, mass);
    }
}

#[inline(always)]
fn kick_freely<T: Scalar>(v: &mut [Vec3<T>], (external, internal, masses): Accelerations<'_, T>, pace: Pace<T>) {
    for (((v, &external), &internal), &mass) in v.iter_mut().zip(external).zip(internal).zip(masses) {
        pace.kick(v, external - internal, mass);
    }
}

/// Both in one way through the nodes.
#[inline(always)]
fn kick_twice_and_drift_freely<T: Scalar>(
    x: &mut [Vec3<T>],
    v: &mut [Vec3<T>],
    (external, internal, masses): Accelerations<'_, T>,
    pace: Pace<T>,
) {
    for ((((x, v), &external), &internal), &mass) in x.iter_mut().zip(v).zip(external).zip(internal).zip(masses) {
        pace.kick(v, external - internal, mass);
        pace.kick_and_drift(x, v, external - internal, mass);
    }
}
