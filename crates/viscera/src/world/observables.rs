use serde::{Deserialize, Serialize};

use super::{BodyId, InstrumentId, World};
use crate::body::{NodeMotion, SimulatedBody};
use crate::material::LawKind;
use crate::math::{Scalar, Vec3};
use crate::mesh::{VolumeMesh, radius_ratio, scaled_jacobian};
use crate::stage::Stages;

/// A body counts as at rest when its kinetic energy is below this share of its elastic energy.
const REST_RATIO: f64 = 1e-8;

/// Numbers about a body, in double precision whatever the world computes in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyObservables {
    /// ½ Σ m v² [J].
    pub kinetic_energy: f64,
    /// Energy stored in the tissue [J].
    pub elastic_energy: f64,
    /// −Σ m g·x [J].
    pub gravity_energy: f64,
    /// Σ m v [kg m/s].
    pub momentum: Vec3<f64>,
    /// Σ m x×v about the origin [kg m²/s].
    pub angular_momentum: Vec3<f64>,
    /// Sum of the internal forces [N]: zero but for rounding, if the model keeps Newton's third law.
    pub net_internal_force: Vec3<f64>,
    /// Sum of x×f of the internal forces about the centre of mass [N m]: zero but for rounding, if the model keeps
    /// angular momentum.
    pub net_internal_torque: Vec3<f64>,
    /// Mass of what is left [kg].
    pub mass: f64,
    /// Volume of what is left [m³].
    pub volume: f64,
    /// (V − V0)/V0 of what is left.
    pub volume_variation: f64,
    /// Largest |V − V0|/V0 of the volumes that are kept exactly; 0 without any.
    pub volume_error: f64,
    /// Largest distance of a node from its place at rest [m].
    pub max_displacement: f64,
    /// Force by which fixed and prescribed nodes are held [N].
    pub reaction: Vec3<f64>,
    /// Cells removed.
    pub removed_cells: usize,
    /// Cells whose volume is negative.
    pub inverted_cells: usize,
    /// Inverted cells that stay so, because the law is blind to reflections and no volume is kept; none otherwise.
    pub inside_out: Option<InsideOut>,
    /// Shape of the worst cell now: of tetrahedra the radius ratio (1 regular, 0 flat, negative inverted), of hexahedra the
    /// scaled Jacobian (1 for a box, 0 or less where a corner is flat or turned inside out); 1 for a body without cells.
    pub worst_quality: f64,
    /// Nodes at which the full law acts; all of them, unless the model is linear or adaptive.
    pub nonlinear_nodes: usize,
    /// Whether the kinetic energy has died down to a hundred-millionth of the elastic energy.
    pub at_rest: bool,
    /// Of a body with a part that is pre-computed: how much its reaction changed in the last step, over its size.
    pub interface_residual: Option<f64>,
}

/// Cells that are turned inside out for good: the law of the body cannot tell them from their mirror images.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InsideOut {
    /// How many.
    pub cells: usize,
    /// The first of them.
    pub first: usize,
    /// The law.
    pub law: LawKind,
    /// A law that turns them back.
    pub instead: LawKind,
}

impl std::fmt::Display for InsideOut {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { cells, first, law, instead } = self;
        let (are, they) = if *cells == 1 { ("cell is", "it stays") } else { ("cells are", "they stay") };
        write!(
            formatter,
            "{cells} {are} inside out (cell {first} is the first), and {they} so: the law `{law}` cannot tell a cell from its \
             mirror image; take the law `{instead}`, which turns cells back"
        )
    }
}

/// Numbers about an instrument.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InstrumentObservables {
    /// Where its tip is [m].
    pub tip: Vec3<f64>,
    /// Whether it is at work: jaws closed, current on.
    pub active: bool,
    /// Nodes that it holds.
    pub held_nodes: usize,
    /// Force on the tissue [N], the mean over the last step: what carries the held nodes, their inertia included, contact and friction.
    pub force: Vec3<f64>,
    /// Moment of that force about the tip [N m].
    pub torque: Vec3<f64>,
    /// Points at which it touches tissue.
    pub contacts: usize,
}

impl<T: Scalar> World<T> {
    /// Measures a body now. Panics for a number of another world.
    pub fn observe(&mut self, id: BodyId) -> BodyObservables {
        self.bring_forces_up_to_date();
        let gravity = Vec3::from(self.config.gravity);
        self.bodies[id.0].observe(gravity)
    }

    /// Measures an instrument now. Panics for a number of another world.
    pub fn observe_instrument(&self, id: InstrumentId) -> InstrumentObservables {
        let tool = &self.tools[id.0];
        InstrumentObservables {
            tip: tool.pose.tip,
            active: self.is_at_work(id),
            held_nodes: tool.held_nodes as usize,
            force: tool.force(),
            torque: tool.torque(),
            contacts: tool.contacts as usize,
        }
    }

    pub(super) fn bring_forces_up_to_date(&mut self) {
        let (time, gravity) = (self.time(), Vec3::from(self.config.gravity).cast());
        for body in &mut self.bodies {
            body.update_internal_forces(Stages::unobserved());
            body.update_external_forces(time, gravity);
        }
    }
}

impl<T: Scalar> SimulatedBody<T> {
    /// Largest distance of a node that still belongs to a cell from its place at rest [m].
    pub fn max_displacement(&self) -> f64 {
        let state = &self.state;
        (0..state.positions.len())
            .filter(|&node| state.motions[node] != NodeMotion::Retired)
            .map(|node| (state.positions[node] - self.rest[node]).squared_norm().to_f64())
            .fold(0.0, f64::max)
            .sqrt()
    }

    /// The cells that are left, their volumes now and at rest [m³].
    fn volumes(&self) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
        let left = (0..self.mesh.cell_count()).filter(|&cell| !self.state.removed[cell]);
        left.map(|cell| (cell, self.cell_volume(cell), self.cell_volumes[cell]))
    }

    /// Torque of the internal forces about the centre of mass [N m].
    fn net_internal_torque(&self) -> Vec3<f64> {
        let state = &self.state;
        let place = |node: usize| state.positions[node].cast::<f64>();
        let (mut mass, mut moment) = (0.0, Vec3::ZERO);
        for (node, m) in state.masses.iter().map(|m| m.to_f64()).enumerate() {
            mass += m;
            moment += place(node) * m;
        }
        let centre = if mass > 0.0 { moment / mass } else { moment };
        let torque = |node: usize| (place(node) - centre).cross(state.internal_forces[node].cast());
        (0..state.positions.len()).fold(Vec3::ZERO, |sum, node| sum + torque(node))
    }

    /// Shape of the worst cell that is left.
    fn worst_quality(&self) -> f64 {
        let place = |node: u32| self.state.positions[node as usize].cast::<f64>();
        let quality = |cell: usize| match &self.mesh {
            VolumeMesh::Tet(mesh) => radius_ratio(mesh.cells[cell].map(place)),
            VolumeMesh::Hex(mesh) => scaled_jacobian(&mesh.cells[cell].map(place)),
        };
        let left = (0..self.mesh.cell_count()).filter(|&cell| !self.state.removed[cell]);
        left.map(quality).fold(1.0, f64::min)
    }

    fn observe(&self, gravity: Vec3<f64>) -> BodyObservables {
        let state = &self.state;
        let (mut kinetic, mut gravity_energy, mut mass) = (0.0, 0.0, 0.0);
        let (mut momentum, mut angular_momentum) = (Vec3::ZERO, Vec3::ZERO);
        let (mut reaction, mut net_internal_force) = (Vec3::ZERO, Vec3::ZERO);
        let mut nonlinear_nodes = 0;
        for node in 0..state.positions.len() {
            let (m, x, v) = (state.masses[node].to_f64(), state.positions[node].cast(), state.velocities[node].cast());
            kinetic += 0.5 * m * v.squared_norm();
            gravity_energy -= m * gravity.dot(x);
            mass += m;
            momentum += v * m;
            angular_momentum += x.cross(v) * m;
            net_internal_force += state.internal_forces[node].cast();
            if matches!(state.motions[node], NodeMotion::Fixed | NodeMotion::Prescribed(_) | NodeMotion::Guided(_)) {
                let force = state.internal_forces[node] - self.external_forces[node];
                reaction += (force - self.free_directions(node).apply(force)).cast();
            }
            let alive = state.motions[node] != NodeMotion::Retired;
            if alive && state.models[0].is_nonlinear_at(state.positions[node] - self.rest[node]) {
                nonlinear_nodes += 1;
            }
        }
        let net_internal_torque = self.net_internal_torque();
        let elastic = state.models.iter().map(|model| model.energy(&state.positions)).sum::<f64>();
        let (mut volume, mut rest_volume, mut inverted_cells, mut first_inverted) = (0.0, 0.0, 0, 0);
        for (cell, now, rest) in self.volumes() {
            volume += now;
            rest_volume += rest;
            if now < 0.0 {
                first_inverted = if inverted_cells == 0 { cell } else { first_inverted };
                inverted_cells += 1;
            }
        }
        let for_good = inverted_cells > 0 && state.models.len() == 1 && self.law.is_blind_to_reflections();
        let (first, law, instead) = (first_inverted, self.law, LawKind::TURNS_BACK);
        BodyObservables {
            kinetic_energy: kinetic,
            elastic_energy: elastic,
            gravity_energy,
            momentum,
            angular_momentum,
            net_internal_force,
            net_internal_torque,
            mass,
            volume,
            volume_variation: if rest_volume > 0.0 { volume / rest_volume - 1.0 } else { 0.0 },
            volume_error: self.kept_volumes().map(|kept| kept.error.abs()).fold(0.0, f64::max),
            max_displacement: self.max_displacement(),
            reaction,
            removed_cells: state.removed_count,
            inverted_cells,
            inside_out: for_good.then_some(InsideOut { cells: inverted_cells, first, law, instead }),
            worst_quality: self.worst_quality(),
            nonlinear_nodes,
            at_rest: kinetic <= REST_RATIO * elastic,
            interface_residual: self.interface_residual(),
        }
    }
}
