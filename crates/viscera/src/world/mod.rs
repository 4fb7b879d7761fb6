//! The world: bodies, instruments, a clock.

mod attachment;
mod config;
mod error;
mod forces;
mod grip;
mod observables;
mod parts;
mod snapshot;
mod statics;
mod step;
mod step_explicit;
mod step_implicit;
mod step_quasi_static;
mod step_static;
mod succession;
mod tools;

pub use attachment::{Attachment, AttachmentId};
pub use config::{Integrator, Substep, WorldConfig};
pub use error::{StepError, WorldError};
pub use observables::{BodyObservables, InsideOut, InstrumentObservables};
pub use snapshot::{Snapshot, SnapshotError};
pub use step::StepReport;

use crate::body::{Body, SimulatedBody};
use crate::dynamics::implicit::ImplicitMemory;
use crate::dynamics::tied::TiedBodies;
use crate::instrument::{Instrument, ToolState};
use crate::math::Scalar;
use crate::model::Precision;
use crate::solver::{Iterative, LinearSolver};
use attachment::Grown;
use tools::ToolMotion;

/// Number of a body in its world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId(pub usize);

/// Number of an instrument in its world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct InstrumentId(pub usize);

/// Bodies and instruments that move together in time, in single (`World<f32>`) or double (`World<f64>`) precision.
pub struct World<T: Scalar> {
    config: WorldConfig,
    bodies: Vec<SimulatedBody<T>>,
    /// Memory of implicit steps, one for each body; none if the world moves explicitly.
    implicit: Vec<ImplicitMemory<T>>,
    static_solver: Box<dyn LinearSolver>,
    /// Instruments; nothing in the place of one that was taken out.
    instruments: Vec<Option<Box<dyn Instrument<T>>>>,
    /// The instruments as they are now.
    tools: Vec<ToolState>,
    motion: ToolMotion,
    attachments: Vec<Grown>,
    /// Bodies that attachments connect.
    tied: Vec<TiedBodies<T>>,
    /// Steps taken; time is their number times their length, so that it carries no rounding from step to step.
    steps: u64,
    /// Memory for the cells that an instrument removes.
    removable: Vec<u32>,
}

impl<T: Scalar> World<T> {
    /// An empty world.
    ///
    /// # Errors
    /// [`WorldError::OutOfRange`] for a step that is not positive, or gravity that is not finite.
    pub fn new(config: WorldConfig) -> Result<Self, WorldError> {
        config.check()?;
        Ok(Self {
            config,
            bodies: Vec::new(),
            implicit: Vec::new(),
            static_solver: Box::new(Iterative::default()),
            instruments: Vec::new(),
            tools: Vec::new(),
            motion: ToolMotion::default(),
            attachments: Vec::new(),
            tied: Vec::new(),
            steps: 0,
            removable: Vec::new(),
        })
    }

    /// Adds a body.
    ///
    /// # Errors
    /// [`WorldError::Body`] where the body makes no sense; [`WorldError::UnstableSubstep`] where it cannot be simulated
    /// at the fixed sub-step that was asked for, with the number that would do; [`WorldError::NoMeanForces`],
    /// [`WorldError::ModelNeedsExplicit`], [`WorldError::FeatureNeedsExplicit`] and
    /// [`WorldError::StiffnessDampingNeedsImplicit`] where it does not fit the integrator.
    pub fn add(&mut self, body: Body) -> Result<BodyId, WorldError>
    where
        T: Precision,
    {
        let mut body = SimulatedBody::new(body)?;
        self.check_integrator(&body)?;
        if let Integrator::Implicit(settings) = self.config.integrator {
            if settings.scheme.needs_past() {
                body.reserve_past();
            }
            self.implicit.push(ImplicitMemory::new(body.mesh(), body.state.reach(), &settings));
        }
        let cells = body.mesh().cell_count();
        self.removable.reserve(cells.saturating_sub(self.removable.capacity()));
        self.bodies.push(body);
        self.reserve_for_tools();
        Ok(BodyId(self.bodies.len() - 1))
    }

    /// Settings of the world.
    pub fn config(&self) -> &WorldConfig {
        &self.config
    }

    /// Steps taken since the beginning.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Time [s].
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.config.step
    }

    /// Numbers of all bodies.
    pub fn body_ids(&self) -> impl Iterator<Item = BodyId> + use<T> {
        (0..self.bodies.len()).map(BodyId)
    }

    /// Numbers of the instruments that are there.
    pub fn instrument_ids(&self) -> impl Iterator<Item = InstrumentId> + '_ {
        let present = self.instruments.iter().enumerate().filter(|(_, instrument)| instrument.is_some());
        present.map(|(number, _)| InstrumentId(number))
    }

    /// A body of this world. Panics for a number of another world.
    pub fn body(&self, id: BodyId) -> &SimulatedBody<T> {
        &self.bodies[id.0]
    }

    /// How the equations of a body were solved in the last implicit step; none if the world moves explicitly.
    pub fn implicit_memory(&self, id: BodyId) -> Option<&ImplicitMemory<T>> {
        self.implicit.get(id.0)
    }

    /// A body of this world, to be changed. Panics for a number of another world.
    pub fn body_mut(&mut self, id: BodyId) -> &mut SimulatedBody<T> {
        &mut self.bodies[id.0]
    }

    /// An instrument of this world. Panics for a number of another world, and for one that was taken out.
    pub fn instrument(&self, id: InstrumentId) -> &dyn Instrument<T> {
        self.instruments[id.0].as_deref().expect("the instrument was not taken out")
    }

    /// Removes cells of a body now, between two steps; cells that are gone already are passed over. Gives how many went,
    /// pieces that came loose and were dropped included.
    ///
    /// # Errors
    /// [`WorldError::ModelCannotBeCut`]; [`WorldError::MissingCell`] for a number that the body does not have, and
    /// [`WorldError::PrecomputedCell`] for one of a pre-computed part. Nothing is removed then.
    pub fn remove_cells(&mut self, id: BodyId, cells: &[u32]) -> Result<usize, WorldError> {
        let body = &mut self.bodies[id.0];
        if let Some(advice) = body.model.info().no_cutting {
            return Err(WorldError::ModelCannotBeCut { body: body.name().into(), model: body.model, advice });
        }
        let count = body.mesh().cell_count();
        if let Some(&cell) = cells.iter().find(|&&cell| cell as usize >= count) {
            return Err(WorldError::MissingCell { body: body.name().into(), cell, cells: count });
        }
        if let Some(&cell) = cells.iter().find(|&&cell| !body.can_lose(cell)) {
            return Err(WorldError::PrecomputedCell { body: body.name().into(), cell });
        }
        let before = body.state().removed_count;
        self.removable.clear();
        self.removable.extend_from_slice(cells);
        body.remove_cells(&mut self.removable);
        Ok(body.state().removed_count - before)
    }
}
