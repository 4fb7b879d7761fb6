mod bytes;
mod error;

pub use error::SnapshotError;

use super::{World, WorldError};
use crate::body::{BodyState, SimulatedBody};
use crate::math::Scalar;
use crate::model::frequency::FrequencyBound;

/// All that changes about a world, at one moment: put back, it goes on with the same bits, also after cuts. As bytes
/// ([`Snapshot::to_bytes`], [`World::read_snapshot`]) it outlives the program.
pub struct Snapshot<T: Scalar> {
    steps: u64,
    bodies: Vec<BodySnapshot<T>>,
    instruments: usize,
}

/// All that changes about a body.
struct BodySnapshot<T: Scalar> {
    state: BodyState<T>,
    frequency: Box<dyn FrequencyBound<T>>,
    /// Tells bodies apart that have as many nodes and cells.
    fingerprint: u32,
}

impl<T: Scalar> World<T> {
    /// Copies the state.
    pub fn snapshot(&self) -> Snapshot<T> {
        let of_body = |body: &SimulatedBody<T>| BodySnapshot {
            state: body.state.clone(),
            frequency: body.frequency.clone_box(),
            fingerprint: body.fingerprint,
        };
        let bodies = self.bodies.iter().map(of_body).collect();
        Snapshot { steps: self.steps, bodies, instruments: self.instruments.len() }
    }

    /// Goes back to a snapshot of this world.
    ///
    /// # Errors
    /// [`WorldError::ForeignSnapshot`] for a snapshot of a world with other bodies or instruments; nothing is changed.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> Result<(), WorldError> {
        let fits = self.instruments.len() == snapshot.instruments
            && self.bodies.len() == snapshot.bodies.len()
            && self.bodies.iter().zip(&snapshot.bodies).all(|(body, of_body)| body.fingerprint == of_body.fingerprint);
        if !fits {
            return Err(WorldError::ForeignSnapshot);
        }
        self.steps = snapshot.steps;
        for (body, of_body) in self.bodies.iter_mut().zip(&snapshot.bodies) {
            body.state = of_body.state.clone();
            body.is_linearized = false;
            body.frequency = of_body.frequency.clone_box();
        }
        self.move_tips(self.time());
        Ok(())
    }
}
