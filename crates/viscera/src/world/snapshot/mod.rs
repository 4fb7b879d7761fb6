mod bytes;
mod error;

pub use error::SnapshotError;

use super::{World, WorldError};
use crate::body::{BodyState, SimulatedBody};
use crate::instrument::ToolState;
use crate::math::{Scalar, Vec3};
use crate::model::frequency::FrequencyBound;

/// All that changes about a world, at one moment: put back, it goes on with the same bits, also after cuts. As bytes
/// ([`Snapshot::to_bytes`], [`World::read_snapshot`]) it outlives the program.
pub struct Snapshot<T: Scalar> {
    steps: u64,
    bodies: Vec<BodySnapshot<T>>,
    /// Every tool, and whether it is there.
    tools: Vec<(bool, ToolState)>,
    /// Forces of the attachments [N].
    attachments: Vec<Vec3<f64>>,
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
        let tools = self.instruments.iter().zip(&self.tools);
        let tools = tools.map(|(instrument, &tool)| (instrument.is_some(), tool)).collect();
        let attachments = self.attachments.iter().map(|ties| ties.force).collect();
        Snapshot { steps: self.steps, bodies, tools, attachments }
    }

    /// Goes back to a snapshot of this world.
    ///
    /// # Errors
    /// [`WorldError::ForeignSnapshot`] for a snapshot of a world with other bodies or instruments; nothing is changed.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> Result<(), WorldError> {
        let fits = self.has_tools(&snapshot.tools)
            && self.attachments.len() == snapshot.attachments.len()
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
            body.constraints.update(&body.state.removed);
            body.update_actions();
            body.update_skin();
        }
        self.tools.iter_mut().zip(&snapshot.tools).for_each(|(tool, &(_, kept))| *tool = kept);
        self.attachments.iter_mut().zip(&snapshot.attachments).for_each(|(ties, &force)| ties.force = force);
        self.reserve_for_tools();
        Ok(())
    }

    /// Whether tools are there, and missing, as they are here.
    fn has_tools(&self, tools: &[(bool, ToolState)]) -> bool {
        self.instruments.len() == tools.len()
            && self.instruments.iter().zip(tools).all(|(instrument, (there, _))| instrument.is_some() == *there)
    }
}
