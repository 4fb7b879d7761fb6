//! Bodies whose equilibrium is one system of equations: one alone, or those that ties hold together.

use super::StaticReport;
use super::equilibrium::Widen;
use crate::body::{NodeMotion, SimulatedBody};
use crate::dynamics::tied::TiedBodies;
use crate::math::{Scalar, Vec3};
use crate::mesh::Point;
use crate::solver::{BlockMatrix, Iterative, System};
use crate::stage::Stages;

/// Ties that are as many roundings of the bodies' size apart, or fewer, are closed when something moves next.
const ROUNDINGS: f64 = 64.0;

/// Bodies one after the other: their nodes are numbered through.
pub(crate) struct Bodies<'a, T: Scalar> {
    pub(super) all: Vec<&'a mut SimulatedBody<T>>,
    ties: Option<&'a mut TiedBodies<T>>,
}

impl<'a, T: Scalar> Bodies<'a, T> {
    pub(crate) fn alone(body: &'a mut SimulatedBody<T>) -> Self {
        Self { all: vec![body], ties: None }
    }

    /// Tied bodies, of all those of a world, and what solves their systems.
    pub(crate) fn tied(ties: &'a mut TiedBodies<T>, bodies: &'a mut [SimulatedBody<T>]) -> (Self, Iterative) {
        ties.begin(bodies);
        let all = bodies.iter_mut().enumerate().filter(|(number, _)| ties.bodies.contains(number));
        let mut tied = Self { all: all.map(|(_, body)| body).collect(), ties: None };
        let starts: Vec<usize> = tied.starts().collect();
        let solver = Iterative::tied(ties.placed(&starts), ties.by_mass.clone());
        tied.ties = Some(ties);
        (tied, solver)
    }

    /// Says of each what was found.
    pub(super) fn report(&mut self, report: Option<&StaticReport>) {
        self.all.iter_mut().for_each(|body| body.static_report = report.cloned());
    }

    /// Where the nodes of each body begin.
    fn starts(&self) -> impl Iterator<Item = usize> {
        self.all.iter().scan(0, |next, body| Some(std::mem::replace(next, *next + body.state.positions.len())))
    }

    pub(super) fn is_held(&self) -> bool {
        let moves_freely = |motion: &NodeMotion| matches!(motion, NodeMotion::Free | NodeMotion::Retired);
        self.all.iter().any(|body| !body.state.motions.iter().all(moves_freely))
    }

    /// Numbers of each node, one body after the other.
    pub(super) fn nodal<V>(&self, of: impl Fn(&SimulatedBody<T>, usize) -> V) -> Vec<V> {
        let of_body = |body: &&'a mut SimulatedBody<T>| -> Vec<V> {
            (0..body.state.positions.len()).map(|node| of(body, node)).collect()
        };
        self.all.iter().flat_map(of_body).collect()
    }

    /// The empty system of their stiffness.
    pub(super) fn system(&self) -> System {
        let parts = self.all.iter().map(|body| BlockMatrix::new(&body.mesh, body.reach()));
        System {
            matrix: BlockMatrix::side_by_side(parts),
            filters: self.nodal(|body, node| body.free_directions(node).cast()),
        }
    }

    /// Puts all nodes to where `place` says.
    pub(super) fn put(&mut self, place: impl Fn(usize) -> Vec3<T>) {
        let mut start = 0;
        for body in &mut self.all {
            let positions = &mut body.state.positions;
            positions.iter_mut().enumerate().for_each(|(node, x)| *x = place(start + node));
            start += positions.len();
            body.state.positions_changed();
        }
    }

    pub(super) fn update_internal_forces(&mut self) {
        self.all.iter_mut().for_each(|body| body.update_internal_forces(Stages::unobserved()));
    }

    pub(super) fn update_external_forces(&mut self, time: f64, gravity: Vec3<T>) {
        self.all.iter_mut().for_each(|body| body.update_external_forces(time, gravity));
    }

    pub(super) fn place_followers(&mut self, time: f64, gravity: Vec3<T>) {
        self.all.iter_mut().for_each(|body| body.place_followers(time, gravity));
    }

    /// The stiffness of the tissue, of loads that follow the surface, fields and actuators, of which a share is on.
    pub(super) fn assemble(&mut self, matrix: &mut BlockMatrix<f64>, time: f64, share: f64) {
        matrix.clear();
        let mut start = 0;
        for body in &mut self.all {
            body.is_linearized = false;
            let (state, mut sink) = (&body.state, Widen { matrix: &mut *matrix, start });
            for model in &state.models {
                model.linearize(&state.positions, &mut body.scratch);
                model.add_blocks(&state.positions, &mut body.scratch, &mut sink);
            }
            body.add_external_blocks(time, share, &mut sink);
            start += state.positions.len() as u32;
        }
    }

    /// Elastic energy [J].
    pub(super) fn energy(&self) -> f64 {
        let of_body = |body: &&'a mut SimulatedBody<T>| -> f64 {
            body.state.models.iter().map(|model| model.energy(&body.state.positions)).sum()
        };
        self.all.iter().map(of_body).sum()
    }

    /// Size of the largest [m].
    pub(super) fn size(&self) -> f64 {
        self.all.iter().map(|body| body.size).fold(0.0, f64::max)
    }

    /// Takes out of forces what ties give.
    pub(super) fn leave_to_ties(&mut self, forces: &mut [Point]) {
        let starts: Vec<usize> = self.starts().collect();
        let Some(ties) = &mut self.ties else { return };
        let places: Vec<usize> = ties.nodes.iter().map(|node| starts[node.member] + node.node).collect();
        ties.by_mass.resolve_forces(|number| forces[places[number]]);
        places.iter().enumerate().for_each(|(number, &place)| forces[place] -= ties.by_mass.force(number));
    }

    /// Makes ways fulfil the ties; gives whether that was more than rounding.
    pub(super) fn fulfil_ties(&mut self, ways: &mut [Point]) -> bool {
        let (starts, size): (Vec<usize>, f64) = (self.starts().collect(), self.size());
        let Some(ties) = &mut self.ties else { return false };
        let all = &self.all;
        ties.by_mass.resolve(|number| {
            let node = ties.nodes[number];
            all[node.member].state.positions[node.node].cast::<f64>() + ways[starts[node.member] + node.node]
        });
        let mut largest = 0.0f64;
        for (number, node) in ties.nodes.iter().enumerate() {
            let change = ties.by_mass.mobility(number) * ties.by_mass.force(number);
            ways[starts[node.member] + node.node] -= change;
            largest = largest.max(change.norm());
        }
        largest > ROUNDINGS * T::EPSILON.to_f64() * size
    }

    /// Stops the nodes and brings the forces up to date, so that reactions can be read; those of ties are external to each body.
    pub(super) fn come_to_rest(&mut self, time: f64, gravity: Vec3<T>) {
        self.all.iter_mut().for_each(|body| body.state.velocities.fill(Vec3::ZERO));
        self.place_followers(time, gravity);
        self.update_internal_forces();
        self.update_external_forces(time, gravity);
        if self.ties.is_none() {
            return;
        }
        let out_of_balance = |body: &SimulatedBody<T>, node: usize| {
            (body.external_forces[node] - body.state.internal_forces[node]).cast::<f64>()
        };
        let mut forces = self.nodal(out_of_balance);
        self.leave_to_ties(&mut forces);
        let Some(ties) = &mut self.ties else { return };
        for (number, node) in ties.nodes.iter().enumerate() {
            let force = &mut self.all[node.member].external_forces[node.node];
            *force = (force.cast::<f64>() - ties.by_mass.force(number)).cast();
        }
    }

    /// The cell that has lost most of its volume, the number of its body, and what is left of it.
    pub(super) fn flattest(&self) -> (usize, usize, f64) {
        let mut worst = (0, 0, f64::INFINITY);
        for (number, body) in self.all.iter().enumerate() {
            for cell in (0..body.mesh.cell_count()).filter(|&cell| !body.state.removed[cell]) {
                let ratio = body.volume_ratio(cell);
                if ratio < worst.2 {
                    worst = (number, cell, ratio);
                }
            }
        }
        worst
    }
}
