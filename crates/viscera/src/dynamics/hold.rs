//! What jaws do to the nodes that they hold in an explicit sub-step: impulses that carry a node along, up to the grip's bound.

use super::Drive;
use crate::body::SimulatedBody;
use crate::math::{Scalar, Vec3};

/// A held node in a sub-step.
#[derive(Clone, Copy)]
pub(super) struct Held<T> {
    pub(super) node: usize,
    /// Number of the tool.
    pub(super) tool: usize,
    /// Its place at the beginning of the drift [m].
    pub(super) position: Vec3<T>,
}

impl<T: Scalar> SimulatedBody<T> {
    /// Carries a node along in the drift of `dt` [s], with the velocity that it would have by itself. One that slips stays behind.
    pub(super) fn carry(&mut self, held: Held<T>, drive: &Drive<'_, T>, dt: f64) {
        let Held { node, tool, position } = held;
        let (frame, step) = (&drive.frames[tool], T::from_f64(dt));
        let target: Vec3<T> = frame.at_end(self.state.grips[node].cast()).cast();
        let wanted = (target - position) / step;
        let (velocity, slips) = self.hold(held, wanted, drive, dt, 1.0);
        self.state.velocities[node] = velocity;
        self.state.positions[node] = if slips { velocity.mul_add(step, position) } else { target };
        if slips {
            self.state.grips[node] = frame.own(self.state.positions[node].cast()).cast();
        }
    }

    /// Keeps a node at the speed of the tool after the second kick; `carried` is the speed in the drift [m/s].
    pub(super) fn keep_carrying(&mut self, held: Held<T>, carried: Vec3<T>, drive: &Drive<'_, T>, dt: f64) {
        let frame = &drive.frames[held.tool];
        let wanted =
            if frame.limit.is_finite() { (frame.way(self.state.grips[held.node].cast()) / dt).cast() } else { carried };
        // Damping has divided the second kick by this, and would have divided the impulse in it as well.
        let damping = 1.0 + 0.5 * dt * self.damping.to_f64();
        self.state.velocities[held.node] = self.hold(held, wanted, drive, dt, damping).0;
    }

    /// The velocity that a held node gets, and whether it slips: half of a sub-step's impulse is given at a time.
    fn hold(&mut self, held: Held<T>, wanted: Vec3<T>, drive: &Drive<'_, T>, dt: f64, damping: f64) -> (Vec3<T>, bool) {
        let Held { node, tool, position } = held;
        let (frame, mass) = (&drive.frames[tool], self.state.masses[node].to_f64() * damping);
        let own = self.state.velocities[node];
        let impulse = (wanted - own).cast::<f64>() * mass;
        let most = 0.5 * frame.limit * dt;
        let size = impulse.norm();
        let slips = size > most;
        let impulse = if slips { impulse * (most / size) } else { impulse };
        let load = &mut self.contacts.loads[tool];
        load.holding += impulse;
        load.holding_moment += (position.cast::<f64>() - frame.tip.1).cross(impulse);
        let velocity = if slips { own + (impulse / mass).cast() } else { wanted };
        (velocity, slips)
    }
}
