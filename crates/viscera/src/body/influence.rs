//! What displaces a linear body in proportion to a number: for each such influence, its answer to a unit can be found once.

use super::{BodyState, Guides, NodalLoads, NodeMotion, SimulatedBody};
use crate::curve::Curve;
use crate::math::{Mat3, Scalar, Vec3};

/// Something that displaces a body in proportion to a number.
#[derive(Clone, Copy, Debug)]
pub(super) enum Influence {
    /// Gravity along an axis [m/s²].
    Gravity(usize),
    /// A prescribed motion along an axis [m].
    Prescribed(usize, usize),
    /// The curve of a guide [m].
    Guided(usize),
    /// A component of a load.
    Load(usize, usize),
}

/// An influence, and what a unit of it does: displacements of what is held [m], forces on the nodes [N].
pub(super) struct Cause {
    pub(super) influence: Influence,
    pub(super) held: Vec<Vec3<f64>>,
    pub(super) forces: Vec<Vec3<f64>>,
}

/// What drives and loads a body.
#[derive(Clone, Copy)]
pub(crate) struct Drivers<'a, T> {
    pub(super) prescribed: &'a [Curve<Vec3<f64>>],
    pub(super) guides: &'a Guides,
    pub(super) loads: &'a NodalLoads<T>,
}

impl<T: Scalar> Drivers<'_, T> {
    /// How large an influence is at `time` [s].
    pub(super) fn amount(&self, influence: Influence, gravity: Vec3<f64>, time: f64) -> f64 {
        match influence {
            Influence::Gravity(axis) => gravity[axis],
            Influence::Prescribed(curve, axis) => self.prescribed[curve].at(time)[axis],
            Influence::Guided(curve) => self.guides.value(curve, time),
            Influence::Load(number, component) => self.loads.value(number, component, time),
        }
    }

    /// Every influence on a body that is at rest in `state`.
    pub(super) fn causes(&self, state: &BodyState<T>) -> Vec<Cause> {
        let (motions, nothing) = (&state.motions, vec![Vec3::ZERO; state.motions.len()]);
        let mut causes = Vec::new();
        for (axis, unit) in Mat3::<f64>::IDENTITY.columns.into_iter().enumerate() {
            let forces = state.masses.iter().map(|mass| unit * mass.to_f64()).collect();
            causes.push(Cause { influence: Influence::Gravity(axis), held: nothing.clone(), forces });
            for curve in 0..self.prescribed.len() {
                let of = |motion: &NodeMotion| *motion == NodeMotion::Prescribed(curve as u32);
                let held = motions.iter().map(|motion| if of(motion) { unit } else { Vec3::ZERO }).collect();
                causes.push(Cause { influence: Influence::Prescribed(curve, axis), held, forces: nothing.clone() });
            }
        }
        for curve in 0..self.guides.curve_count() {
            let share = |motion: &NodeMotion| match *motion {
                NodeMotion::Guided(guide) => self.guides.share_of(guide, curve),
                _ => Vec3::ZERO,
            };
            let held = motions.iter().map(share).collect();
            causes.push(Cause { influence: Influence::Guided(curve), held, forces: nothing.clone() });
        }
        for (number, component, forces) in self.loads.unit_forces(&state.positions) {
            let forces = forces.into_iter().map(|force| force.cast()).collect();
            causes.push(Cause { influence: Influence::Load(number, component), held: nothing.clone(), forces });
        }
        causes
    }
}

impl<T: Scalar> SimulatedBody<T> {
    /// What drives and loads the body.
    pub(crate) fn drivers(&self) -> Drivers<'_, T> {
        Drivers { prescribed: &self.prescribed, guides: &self.guides, loads: &self.loads }
    }
}
