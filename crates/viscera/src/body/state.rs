use serde::{Deserialize, Serialize};

use super::Removals;
use crate::constraint::KeptVolume;
use crate::contact::Traction;
use crate::executor::{Executor, NodeBlocks, ReadBlocks, node_blocks};
use crate::math::{Scalar, Vec3, large_pages};
use crate::model::ForceModel;
use crate::solver::Reach;

/// How a node moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NodeMotion {
    /// By the forces on it.
    Free,
    /// Not at all.
    Fixed,
    /// Along the body's prescribed motion of this number.
    Prescribed(u32),
    /// By the forces on it, but for the directions of the body's guide of this number.
    Guided(u32),
    /// With the tip of the world's instrument of this number.
    Held(u32),
    /// No longer: every cell around it was removed.
    Retired,
    /// With the boundary of the pre-computed part that it lies in.
    Following,
}

impl NodeMotion {
    /// Whether the node stays where it is, whatever time it is and whatever else moves.
    pub(crate) fn is_still(self) -> bool {
        matches!(self, Self::Fixed | Self::Retired)
    }
}

/// A node that is driven, as it was before all nodes were moved as if they were free: explicit steps move nodes in whole
/// registers, and put the few others right afterwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Driven<T> {
    pub(crate) node: usize,
    pub(crate) position: Vec3<T>,
    pub(crate) velocity: Vec3<T>,
}

/// A node that stays where it is: it takes less to put right than a driven one, which other threads wait for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Still<T> {
    pub(crate) node: usize,
    pub(crate) position: Vec3<T>,
}

/// Everything about a body that changes with time; a copy of it is a snapshot of the body. As bytes it goes without the models,
/// which follow from the removals.
#[derive(Serialize, Deserialize)]
#[serde(bound(serialize = "T: Serialize", deserialize = "T: Deserialize<'de>"))]
pub struct BodyState<T: Scalar> {
    /// Positions [m].
    pub positions: Vec<Vec3<T>>,
    /// Velocities [m/s].
    pub velocities: Vec<Vec3<T>>,
    /// Internal forces +∂W/∂x at the positions [N].
    pub internal_forces: Vec<Vec3<T>>,
    /// How each node moves.
    pub motions: Vec<NodeMotion>,
    /// Of held nodes: their place from the tip of the instrument, in its own axes [m].
    pub grips: Vec<Vec3<T>>,
    /// Lumped masses [kg].
    pub masses: Vec<T>,
    /// Which cells are removed.
    pub removed: Vec<bool>,
    /// How many cells are removed.
    pub removed_count: usize,
    /// The removed cells in the order in which they went.
    pub removals: Removals,
    /// How many cells still meet at each node.
    pub cells_at_node: Vec<u32>,
    /// Force models, the body's own first, then the volume penalty where there is one.
    #[serde(skip)]
    pub models: Vec<Box<dyn ForceModel<T>>>,
    /// Whether the internal forces belong to the positions and the cells that are left.
    pub forces_are_current: bool,
    /// Bound of ω_max² at the positions [1/s²], where it is known.
    pub squared_frequency: Option<f64>,
    /// The state before the last step, for schemes over two steps.
    pub past: PastState<T>,
    /// Friction of tools at the end of the last implicit step.
    pub tractions: Vec<Traction>,
    /// What is to be kept of the volumes that are kept exactly.
    pub volumes: Vec<KeptVolume>,
    /// Heat that cells have taken in [J].
    pub heat: Vec<T>,
    /// How far nodes are burnt: 0 fresh, 1 on the rim of a burnt cut.
    pub seared: Vec<T>,
}

/// Where a body was before the last step. Of no size unless the scheme asks for it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PastState<T> {
    /// Positions [m].
    pub positions: Vec<Vec3<T>>,
    /// Velocities [m/s].
    pub velocities: Vec<Vec3<T>>,
    /// Whether the body went on from there: not before the first step, nor after positions or velocities were set.
    pub is_known: bool,
}

impl<T: Scalar> PastState<T> {
    /// Asks for its memory.
    pub(crate) fn reserve(&mut self, nodes: usize) {
        self.positions.resize(nodes, Vec3::ZERO);
        self.velocities.resize(nodes, Vec3::ZERO);
    }

    /// Copies a state that is about to be left behind.
    pub(crate) fn keep(&mut self, positions: &[Vec3<T>], velocities: &[Vec3<T>]) {
        self.positions.copy_from_slice(positions);
        self.velocities.copy_from_slice(velocities);
        self.is_known = true;
    }

    fn copy_from(&mut self, other: &Self) {
        self.positions.clone_from(&other.positions);
        self.velocities.clone_from(&other.velocities);
        self.is_known = other.is_known;
    }
}

impl<T: Scalar> Clone for BodyState<T> {
    fn clone(&self) -> Self {
        Self {
            positions: self.positions.clone(),
            velocities: self.velocities.clone(),
            internal_forces: self.internal_forces.clone(),
            motions: self.motions.clone(),
            grips: self.grips.clone(),
            masses: self.masses.clone(),
            removed: self.removed.clone(),
            removed_count: self.removed_count,
            removals: self.removals.clone(),
            cells_at_node: self.cells_at_node.clone(),
            models: self.models.iter().map(|model| model.clone_box()).collect(),
            forces_are_current: self.forces_are_current,
            squared_frequency: self.squared_frequency,
            past: self.past.clone(),
            tractions: with_room(&self.tractions),
            volumes: self.volumes.clone(),
            heat: self.heat.clone(),
            seared: self.seared.clone(),
        }
    }
}

/// A copy with the same room: it may take the place of the original in a world that goes on.
fn with_room(tractions: &Vec<Traction>) -> Vec<Traction> {
    let mut copy = Vec::with_capacity(tractions.capacity());
    copy.extend_from_slice(tractions);
    copy
}

impl<T: Scalar> BodyState<T> {
    /// Which nodes know each other's forces.
    pub(crate) fn reach(&self) -> Reach<'_> {
        let rings = self.models.iter().map(|model| model.rings()).max().unwrap_or(1);
        let coupled = self.models.iter().map(|model| model.coupled()).find(|coupled| !coupled.is_empty());
        Reach { rings, coupled: coupled.unwrap_or(&[]), groups: &[] }
    }

    /// Says that the positions were changed: forces and frequency have to be found anew.
    pub(crate) fn positions_changed(&mut self) {
        self.forces_are_current = false;
        self.squared_frequency = None;
    }

    /// Whether every position and velocity is a finite number.
    pub fn is_finite(&self) -> bool {
        // A sum is finite if and only if its terms are, but for overflow, which is as bad: one test for many numbers.
        let sum = |vectors: &[Vec3<T>]| vectors.iter().fold(T::ZERO, |sum, v| sum + (v.x + v.y + v.z));
        sum(&self.positions).is_finite() && sum(&self.velocities).is_finite()
    }
}

/// The part of the state that a step without a cut changes: what is needed to undo the step.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionBackup<T> {
    positions: Vec<Vec3<T>>,
    velocities: Vec<Vec3<T>>,
    internal_forces: Vec<Vec3<T>>,
    motions: Vec<NodeMotion>,
    grips: Vec<Vec3<T>>,
    /// Whether motions and grips were kept.
    keeps_hold: bool,
    forces_are_current: bool,
    squared_frequency: Option<f64>,
    past: PastState<T>,
    tractions: Vec<Traction>,
    volumes: Vec<KeptVolume>,
}

/// Numbers of nodes, and those that take their place.
type Copying<'a, V> = (NodeBlocks<'a, V>, ReadBlocks<'a, V>);

fn onto<'a, V: Copy>(to: &'a mut Vec<V>, from: &'a [V]) -> Copying<'a, V> {
    to.resize(from.len(), from[0]);
    (NodeBlocks(to), ReadBlocks(from))
}

/// As one block of memory: `clone_from` goes from vector to vector.
fn copy<V: Copy>((NodeBlocks(to), ReadBlocks(from)): Copying<'_, V>) {
    to.copy_from_slice(from);
}

impl<T: Scalar> MotionBackup<T> {
    /// A first backup, which brings its memory with it.
    pub(crate) fn new(state: &BodyState<T>) -> Self {
        let vectors = || large_pages::room_for(state.positions.len());
        let (positions, velocities, internal_forces) = (vectors(), vectors(), vectors());
        let mut backup = Self { positions, velocities, internal_forces, ..Self::default() };
        backup.keep(state, true, &Executor::serial());
        backup
    }

    /// Copies the motion of `state`; how its nodes move, and where jaws hold them, only where that may change within a step.
    pub(crate) fn keep(&mut self, state: &BodyState<T>, keeps_hold: bool, executor: &Executor) {
        self.keeps_hold = keeps_hold;
        if keeps_hold {
            copy(onto(&mut self.motions, &state.motions));
            copy(onto(&mut self.grips, &state.grips));
        }
        let motion = (onto(&mut self.positions, &state.positions), onto(&mut self.velocities, &state.velocities));
        let forces = onto(&mut self.internal_forces, &state.internal_forces);
        let parts = node_blocks(state.positions.len());
        executor.each(parts, (motion, forces), &|_, ((x, v), forces)| {
            copy(x);
            copy(v);
            copy(forces);
        });
        self.forces_are_current = state.forces_are_current;
        self.squared_frequency = state.squared_frequency;
        self.past.copy_from(&state.past);
        self.tractions.clone_from(&state.tractions);
        self.volumes.clone_from(&state.volumes);
    }

    /// Asks for memory for so many more contacts.
    pub(crate) fn reserve_tractions(&mut self, count: usize) {
        self.tractions.reserve(count);
    }

    /// Positions that were kept [m].
    pub(crate) fn positions(&self) -> &[Vec3<T>] {
        &self.positions
    }

    /// Puts the copy back.
    pub(crate) fn put_back(&self, state: &mut BodyState<T>) {
        state.positions.clone_from(&self.positions);
        state.velocities.clone_from(&self.velocities);
        state.internal_forces.clone_from(&self.internal_forces);
        if self.keeps_hold {
            state.motions.clone_from(&self.motions);
            state.grips.clone_from(&self.grips);
        }
        state.forces_are_current = self.forces_are_current;
        state.squared_frequency = self.squared_frequency;
        state.past.copy_from(&self.past);
        state.tractions.clone_from(&self.tractions);
        state.volumes.clone_from(&self.volumes);
    }
}
