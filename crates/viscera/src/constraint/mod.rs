//! What holds a body's nodes together besides forces: closed surfaces that keep their volume, parts that keep their shape.
//!
//! Both act in explicit sub-steps, after the drift: nodes have moved as if they were free, and are put where they may be; velocities
//! follow, there and after the second kick. Rigid parts go first. A volume then pushes the nodes of a part by impulses, and the part drifts anew with
//! what momenta these leave it, until all volumes are kept: surfaces that share nodes or touch rigid parts need some sweeps, one
//! alone is exact after the first.

mod cubic;
mod exact_volume;
mod rigid_part;

pub(crate) use exact_volume::ExactVolume;
pub(crate) use rigid_part::RigidPart;

use serde::{Deserialize, Serialize};

use crate::math::{Scalar, Vec3};
use crate::mesh::Point;
use crate::solver::Filter;

/// The most sweeps over all volumes.
const SWEEPS: u32 = 60;
/// Sweeps over the velocities of volumes that may share nodes: places are what is kept exactly.
const VELOCITY_SWEEPS: u32 = 4;
/// Number of the rigid part of a node that is in none.
const NO_PART: u32 = u32::MAX;

/// What constraints keep of a volume.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptVolume {
    /// What it is to be [m³]. A cut takes along the volume that its cells have at that moment.
    pub volume: f64,
    /// The mean pressure from inside that kept it in the last sub-step [Pa].
    pub pressure: f64,
}

/// A volume that could not be kept, or a part that could not be turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unkept {
    /// Number of the volume.
    pub(crate) volume: usize,
    /// (V − V0)/V0 that is left.
    pub(crate) error: f64,
}

/// The nodes that constraints move.
pub(crate) struct Motion<'a, T> {
    pub(crate) positions: &'a mut [Vec3<T>],
    pub(crate) velocities: &'a mut [Vec3<T>],
    pub(crate) masses: &'a [T],
}

/// The constraints of a body.
#[derive(Clone, Debug, Default)]
pub(crate) struct Constraints {
    pub(crate) volumes: Vec<ExactVolume>,
    pub(crate) parts: Vec<RigidPart>,
    /// Number of the part of each node; empty without constraints.
    part_of: Vec<u32>,
    /// Places before the drift [m].
    start: Vec<Point>,
    /// What was not kept since it was last asked.
    pub(crate) unkept: Option<Unkept>,
}

/// Half of what rounding may move a coordinate of this size [m], for numbers of type `T`, and some more: sums of many.
pub(crate) fn nearer_than_rounding<T: Scalar>(size: f64) -> f64 {
    8.0 * T::ROUNDING * size
}

impl Constraints {
    /// These volumes and parts of a body of `nodes` nodes; no node is in two parts.
    pub(crate) fn new(volumes: Vec<ExactVolume>, parts: Vec<RigidPart>, nodes: usize) -> Self {
        if volumes.is_empty() && parts.is_empty() {
            return Self::default();
        }
        let mut part_of = vec![NO_PART; nodes];
        for (number, part) in parts.iter().enumerate() {
            part.nodes.iter().for_each(|&node| part_of[node as usize] = number as u32);
        }
        Self { volumes, parts, part_of, start: vec![Vec3::ZERO; nodes], unkept: None }
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.start.is_empty()
    }

    /// Finds the surfaces of the cells that are left.
    pub(crate) fn update(&mut self, removed: &[bool]) {
        self.volumes.iter_mut().for_each(|volume| volume.update(removed));
    }

    /// (V − V0)/V0 of a volume at these places, and what rounding may make of it; nothing for one that is cut away whole.
    pub(crate) fn error<T: Scalar>(&self, number: usize, kept: &KeptVolume, places: &[Vec3<T>]) -> (f64, f64) {
        let (volume, uncertain) = self.volumes[number].measure::<T>(|node| places[node as usize].cast());
        if kept.volume == 0.0 { (0.0, 0.0) } else { (volume / kept.volume - 1.0, (uncertain / kept.volume).abs()) }
    }

    /// Puts nodes that have drifted for `dt` [s] where they may be; velocities follow.
    pub(crate) fn restore_places<T: Scalar>(
        &mut self,
        motion: &mut Motion<'_, T>,
        filter: &impl Fn(u32) -> Filter<T>,
        kept: &mut [KeptVolume],
        dt: f64,
    ) {
        for (start, (x, v)) in self.start.iter_mut().zip(motion.positions.iter().zip(&*motion.velocities)) {
            *start = x.cast::<f64>() - v.cast::<f64>() * dt;
        }
        for part in &mut self.parts {
            part.begin(&self.start, motion.masses);
            part.drift(motion, dt);
        }
        for volume in &mut self.volumes {
            volume.aim(&self.start, motion.masses, filter, (&self.part_of, &self.parts));
        }
        kept.iter_mut().for_each(|kept| kept.pressure = 0.0);
        if let Err(unkept) = self.restore_volumes(motion, kept, dt) {
            self.unkept = self.unkept.or(Some(unkept));
        }
    }

    fn restore_volumes<T: Scalar>(
        &self,
        motion: &mut Motion<'_, T>,
        kept: &mut [KeptVolume],
        dt: f64,
    ) -> Result<(), Unkept> {
        let mut worst = Unkept { volume: 0, error: 0.0 };
        for _ in 0..SWEEPS {
            for (number, volume) in self.volumes.iter().enumerate() {
                match volume.restore(motion, kept[number].volume, dt, &self.part_of) {
                    Some(size) => kept[number].pressure += size / (dt * dt),
                    None => {
                        let (error, uncertain) = self.error(number, &kept[number], motion.positions);
                        if error.abs() > uncertain {
                            return Err(Unkept { volume: number, error });
                        }
                    }
                }
            }
            self.parts.iter().for_each(|part| part.drift(motion, dt));
            worst.error = 0.0;
            let mut all = true;
            for number in 0..self.volumes.len() {
                let (error, uncertain) = self.error(number, &kept[number], motion.positions);
                all &= error.abs() <= uncertain;
                if error.abs() >= worst.error.abs() {
                    worst = Unkept { volume: number, error };
                }
            }
            if all {
                return Ok(());
            }
        }
        Err(worst)
    }

    /// Takes from the velocities at the end of a sub-step of `dt` [s] what would change a volume or the shape of a rigid part: the
    /// second kick has left half of its own in them.
    pub(crate) fn restore_velocities<T: Scalar>(
        &mut self,
        motion: &mut Motion<'_, T>,
        filter: &impl Fn(u32) -> Filter<T>,
        kept: &mut [KeptVolume],
        dt: f64,
    ) {
        for (start, x) in self.start.iter_mut().zip(&*motion.positions) {
            *start = x.cast();
        }
        for part in &mut self.parts {
            part.begin(&self.start, motion.masses);
            part.settle(motion);
        }
        for volume in &mut self.volumes {
            volume.aim(&self.start, motion.masses, filter, (&self.part_of, &self.parts));
        }
        let sweeps = if self.volumes.len() > 1 { VELOCITY_SWEEPS } else { 1 };
        for _ in 0..sweeps {
            for (volume, kept) in self.volumes.iter().zip(&mut *kept) {
                kept.pressure += volume.still(motion, &self.part_of) / dt;
                self.parts.iter().for_each(|part| part.settle(motion));
            }
        }
    }
}
