//! How a body answers that does not move in time: its displacement is a sum of columns, one for everything that drives or loads it.

use std::sync::Arc;

use super::influence::{Cause, Drivers, Influence};
use super::{BodyState, NodeMotion, SimulatedBody};
use crate::contact::PushMemory;
use crate::material::Tissue;
use crate::math::{Scalar, Vec3};
use crate::model::ModelError;
use crate::model::precomputed::{ContactSystem, Responses, ResponsesError, Supports, stiffness};
use crate::solver::{Envelope, LinearSolver, SolverError, System};

/// Responses of a body, what displaces it besides tools, and memory to compute in.
#[derive(Debug)]
pub(crate) struct StaticAnswer {
    pub(crate) responses: Arc<Responses>,
    influences: Vec<(Influence, Vec<Vec3<f64>>)>,
    /// Displacements of the nodes [m]: without tools but for what slips through jaws, with what these hold, and with pushes.
    pub(crate) alone: Vec<Vec3<f64>>,
    pub(crate) unpushed: Vec<Vec3<f64>>,
    pub(crate) displacements: Vec<Vec3<f64>>,
    /// The nodes that jaws hold, and how far these take them.
    pub(crate) wanted: Vec<u32>,
    pub(crate) imposed: Vec<Vec3<f64>>,
    pub(crate) held: ContactSystem,
    /// The nodes that slip through jaws, and how these pull them [N].
    pub(crate) slipping: Vec<(u32, Vec3<f64>)>,
    /// Pushes on the handles [N].
    pub(crate) forces: Vec<Vec3<f64>>,
    pub(crate) pushes: PushMemory,
}

impl StaticAnswer {
    /// The columns of a body at rest in `state`.
    pub(super) fn new<T: Scalar>(
        responses: Arc<Responses>,
        tissue: &Tissue,
        supports: &Supports<'_>,
        drivers: Drivers<'_, T>,
        state: &BodyState<T>,
    ) -> Result<Self, ModelError> {
        let system = stiffness(tissue, supports)?;
        let mut solver = Envelope::default();
        solver.analyse(&system);
        solver.factor(&system).map_err(ResponsesError::Solver)?;
        let (nodes, handles) = (responses.node_count(), responses.handles().len());
        let mut influences = Vec::new();
        for cause in drivers.causes(state) {
            let influence = cause.influence;
            influences.push((influence, answer_to(cause, &system, &solver).map_err(ResponsesError::Solver)?));
        }
        Ok(Self {
            responses,
            influences,
            alone: vec![Vec3::ZERO; nodes],
            unpushed: vec![Vec3::ZERO; nodes],
            displacements: vec![Vec3::ZERO; nodes],
            wanted: Vec::with_capacity(handles),
            imposed: Vec::with_capacity(handles),
            held: ContactSystem::with_room(handles),
            slipping: Vec::with_capacity(handles),
            forces: vec![Vec3::ZERO; handles],
            pushes: PushMemory::default(),
        })
    }

    /// Finds where the body is without tools at `time` [s].
    pub(crate) fn rest_alone<T: Scalar>(&mut self, drivers: Drivers<'_, T>, gravity: Vec3<f64>, time: f64) {
        self.alone.fill(Vec3::ZERO);
        for (influence, column) in &self.influences {
            let amount = drivers.amount(*influence, gravity, time);
            if amount != 0.0 {
                self.alone.iter_mut().zip(column).for_each(|(u, &answer)| *u += answer * amount);
            }
        }
    }
}

impl<T: Scalar> SimulatedBody<T> {
    /// The responses of a body that does not move in time but rests at the end of every step; none for one that moves.
    pub fn responses(&self) -> Option<&Arc<Responses>> {
        self.answer.as_ref().map(|answer| &answer.responses)
    }

    /// Whether jaws can take hold of a node: it is free, and where the body answers statically it has a response.
    pub(crate) fn can_be_held(&self, node: usize) -> bool {
        let answers = |answer: &StaticAnswer| answer.responses.handle_of(node as u32).is_some();
        self.state.motions[node] == NodeMotion::Free && self.answer.as_ref().is_none_or(|answer| answers(answer))
    }
}

/// u = u_held + K⁻¹ (f − K u_held) in the free directions.
fn answer_to(cause: Cause, system: &System, solver: &Envelope) -> Result<Vec<Vec3<f64>>, SolverError> {
    let Cause { held, mut forces, .. } = cause;
    let mut of_held = vec![Vec3::ZERO; held.len()];
    system.matrix.times(&held, &mut of_held);
    forces.iter_mut().zip(&of_held).for_each(|(force, &of_held)| *force -= of_held);
    system.filter(&mut forces);
    solver.solve(system, &mut forces)?;
    forces.iter_mut().zip(held).for_each(|(u, held)| *u += held);
    Ok(forces)
}
