//! The nodes of a hybrid body that follow its boundary: what loads them is felt there, and they are put in place when it has moved.

use std::sync::Arc;

use super::influence::{Drivers, Influence};
use super::{BodyState, SimulatedBody};
use crate::material::Tissue;
use crate::math::{Scalar, Vec3};
use crate::mesh::VolumeMesh;
use crate::model::ModelError;
use crate::model::hybrid::{Condensation, part_stiffness};
use crate::model::precomputed::ResponsesError;
use crate::solver::{Envelope, LinearSolver};

/// A vector for each node of some.
type Nodal = Vec<Vec3<f64>>;

/// The pre-computed part of a body, and how its followers answer weight and loads.
#[derive(Debug)]
pub(crate) struct Followers {
    pub(crate) condensation: Arc<Condensation>,
    /// For a unit of each influence: forces on the boundary [N], displacements of the followers [m].
    influences: Vec<(Influence, Nodal, Nodal)>,
    /// Displacements of the followers [m].
    displacements: Vec<Vec3<f64>>,
}

impl Followers {
    /// The answers of a body at rest in `state`.
    pub(super) fn new<T: Scalar>(
        condensation: Arc<Condensation>,
        (tissue, mesh): (&Tissue, &VolumeMesh),
        drivers: Drivers<'_, T>,
        state: &BodyState<T>,
    ) -> Result<Self, ModelError> {
        let system = part_stiffness(tissue, mesh, &condensation)?;
        let mut solver = Envelope::default();
        solver.analyse(&system);
        solver.factor(&system).map_err(ResponsesError::Solver)?;
        let mut influences = Vec::new();
        for cause in drivers.causes(state) {
            let mut forces = cause.forces;
            system.filter(&mut forces);
            if forces.iter().any(|&force| force != Vec3::ZERO) {
                let on_boundary = condensation.condense(&forces);
                solver.solve(&system, &mut forces).map_err(ResponsesError::Solver)?;
                let of_followers = condensation.followers().iter().map(|&node| forces[node as usize]).collect();
                influences.push((cause.influence, on_boundary, of_followers));
            }
        }
        let displacements = vec![Vec3::ZERO; condensation.followers().len()];
        Ok(Self { condensation, influences, displacements })
    }

    /// Moves what loads the followers to the boundary.
    pub(super) fn condense<T: Scalar>(
        &self,
        drivers: Drivers<'_, T>,
        gravity: Vec3<f64>,
        time: f64,
        external_forces: &mut [Vec3<T>],
    ) {
        for &node in self.condensation.followers() {
            external_forces[node as usize] = Vec3::ZERO;
        }
        for (influence, on_boundary, _) in &self.influences {
            let amount = drivers.amount(*influence, gravity, time);
            for (&node, &force) in self.condensation.boundary().iter().zip(on_boundary) {
                external_forces[node as usize] += (force * amount).cast();
            }
        }
    }
}

impl<T: Scalar> SimulatedBody<T> {
    /// Puts nodes that follow the boundary of a pre-computed part to where they rest at `time` [s].
    pub(crate) fn place_followers(&mut self, time: f64, gravity: Vec3<T>) {
        let Some(mut followers) = self.followers.take() else { return };
        let Followers { condensation, influences, displacements } = &mut *followers;
        displacements.fill(Vec3::ZERO);
        for (influence, _, answers) in influences.iter() {
            let amount = self.drivers().amount(*influence, gravity.cast(), time);
            displacements.iter_mut().zip(answers).for_each(|(u, &answer)| *u += answer * amount);
        }
        let boundary = condensation.boundary();
        condensation.follow(|place| self.displacement_of(boundary[place], &self.state.positions), displacements);
        for (&node, &displacement) in condensation.followers().iter().zip(displacements.iter()) {
            self.state.positions[node as usize] = (self.rest[node as usize].cast::<f64>() + displacement).cast();
        }
        self.followers = Some(followers);
        self.state.positions_changed();
    }

    /// How much the reaction of the pre-computed part on its boundary changed in the last step, over its size: how far the part is from
    /// the equilibrium in which it is taken to be. None for a body without one.
    pub fn interface_residual(&self) -> Option<f64> {
        let condensation = &self.followers.as_ref()?.condensation;
        let boundary = condensation.boundary();
        let now = |place: usize| self.displacement_of(boundary[place], &self.state.positions);
        let before = |place: usize| self.displacement_of(boundary[place], self.backup.positions());
        Some(condensation.change_of_reaction(now, before))
    }

    /// Whether a cell can be cut away: not one of a pre-computed part.
    pub(crate) fn can_lose(&self, cell: u32) -> bool {
        let moves = |followers: &Followers| followers.condensation.dynamic_cells().binary_search(&cell).is_ok();
        self.followers.as_ref().is_none_or(|followers| moves(followers))
    }

    fn displacement_of(&self, node: u32, positions: &[Vec3<T>]) -> Vec3<f64> {
        (positions[node as usize] - self.rest[node as usize]).cast()
    }
}
