use super::{World, WorldError};
use crate::body::BodyState;
use crate::math::Scalar;
use crate::model::frequency::FrequencyBound;

/// All that changes about a world, at one moment: put back, it goes on with the same bits, also after cuts.
pub struct Snapshot<T: Scalar> {
    steps: u64,
    bodies: Vec<(BodyState<T>, Box<dyn FrequencyBound<T>>)>,
    instruments: usize,
}

impl<T: Scalar> World<T> {
    /// Copies the state.
    pub fn snapshot(&self) -> Snapshot<T> {
        let bodies = self.bodies.iter().map(|body| (body.state.clone(), body.frequency.clone_box())).collect();
        Snapshot { steps: self.steps, bodies, instruments: self.instruments.len() }
    }

    /// Goes back to a snapshot of this world.
    ///
    /// # Errors
    /// [`WorldError::ForeignSnapshot`] for a snapshot of a world with other bodies or instruments; nothing is changed.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> Result<(), WorldError> {
        let fits = self.instruments.len() == snapshot.instruments
            && self.bodies.len() == snapshot.bodies.len()
            && self.bodies.iter().zip(&snapshot.bodies).all(|(body, (state, _))| {
                body.state.positions.len() == state.positions.len() && body.state.removed.len() == state.removed.len()
            });
        if !fits {
            return Err(WorldError::ForeignSnapshot);
        }
        self.steps = snapshot.steps;
        for (body, (state, frequency)) in self.bodies.iter_mut().zip(&snapshot.bodies) {
            body.state = state.clone();
            body.frequency = frequency.clone_box();
        }
        self.move_tips(self.time());
        Ok(())
    }
}
