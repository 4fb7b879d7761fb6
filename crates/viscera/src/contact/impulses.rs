//! Contact in explicit sub-steps: impulses on lumped masses, by projected Gauss–Seidel.
//!
//! A sub-step is a kick, a drift, and a kick. Before the drift the impulses must leave no contact closer than touching at the end of it,
//!
//! n·(Σ b_i v_i − u) ≥ −max(gap, 0)/Δt,   λ ≥ 0,   |λ_t| ≤ μ λ,
//!
//! and after the second kick the contacts that pushed must not approach, with 0 on the right: so a block that rests feels half of its
//! weight in either kick, and what the two sum up to is all of it. One impulse before the drift alone left the velocities with the second
//! kick's half of the contact force in them, a kinetic energy as large as the energy of the dent.
//!
//! Source: Andersen, Rattle (1983), for the two impulses; Moreau (1988) for unilateral contact as a sweeping process.

use super::{Contacts, MovingCapsule};
use crate::math::{Scalar, Vec3};
use crate::mesh::Point;
use crate::solver::Filter;

/// The most sweeps over all contacts.
const SWEEPS: u32 = 60;
/// Sweeps end when no relative velocity changes by more than this share of the largest change of the first sweep.
const SETTLED: f64 = 1e-7;
/// Share of a penetration that one sub-step takes back, by moving nodes without giving them velocity.
const RECOVERY: f64 = 0.05;
/// Penetration that is left as it is, over the tool's radius. Taken back to a ten-thousandth, a block at rest trembled: what a sub-step's
/// fall leaves where a contact goes from one triangle to the next is more than that, and its recovery is energy.
const SLACK: f64 = 5e-3;

/// Nodes that contacts move.
pub(crate) struct Nodes<'a, T, F: Fn(u32) -> Filter<T>> {
    pub(crate) positions: &'a mut [Vec3<T>],
    pub(crate) velocities: &'a mut [Vec3<T>],
    pub(crate) masses: &'a [T],
    /// The directions in which impulses move a node.
    pub(crate) filter: F,
}

impl Contacts {
    /// Impulses before the drift of `dt` [s] that the nodes have made already with the velocities that they have: both are corrected.
    pub(crate) fn solve_drift<T: Scalar, F: Fn(u32) -> Filter<T>>(
        &mut self,
        nodes: &mut Nodes<'_, T, F>,
        rods: &[MovingCapsule],
        dt: f64,
    ) {
        self.find_mobilities(nodes);
        self.solve_impulses(nodes, dt, true);
        self.recover(nodes, rods);
        self.account(rods, 1.0);
    }

    /// Impulses after the second kick, which damping has divided by `damping`: they were given before that, so that they are larger.
    pub(crate) fn solve_kick<T: Scalar, F: Fn(u32) -> Filter<T>>(
        &mut self,
        nodes: &mut Nodes<'_, T, F>,
        rods: &[MovingCapsule],
        dt: f64,
        damping: f64,
    ) {
        self.list.retain(|contact| contact.push > 0.0);
        self.solve_impulses(nodes, dt, false);
        self.account(rods, damping);
    }

    fn find_mobilities<T: Scalar, F: Fn(u32) -> Filter<T>>(&mut self, nodes: &Nodes<'_, T, F>) {
        for contact in &mut self.list {
            let mut mobility = [0.0; 2];
            for (&node, &weight) in contact.nodes.iter().zip(&contact.weights) {
                let filter = (nodes.filter)(node);
                let mass = nodes.masses[node as usize].to_f64();
                if filter == Filter::Held || mass <= 0.0 {
                    continue;
                }
                let along: Point = filter.apply(contact.normal.cast()).cast();
                mobility[0] += weight * weight * contact.normal.dot(along) / mass;
                mobility[1] += weight * weight / mass;
            }
            contact.mobility = mobility;
        }
        self.list.retain(|contact| contact.mobility[0] > 0.0);
    }

    fn solve_impulses<T: Scalar, F: Fn(u32) -> Filter<T>>(
        &mut self,
        nodes: &mut Nodes<'_, T, F>,
        dt: f64,
        drifts: bool,
    ) {
        self.list.iter_mut().for_each(|contact| (contact.push, contact.drag) = (0.0, Point::ZERO));
        let mut first = 0.0f64;
        for sweep in 0..SWEEPS {
            let mut largest = 0.0f64;
            for contact in &mut self.list {
                let velocity = velocity(nodes, &contact.nodes, &contact.weights) - contact.way / dt;
                let along = contact.normal.dot(velocity);
                let allowed = if drifts { -contact.gap.max(0.0) / dt } else { 0.0 };
                let push = (contact.push + (allowed - along) / contact.mobility[0]).max(0.0);
                let change = push - contact.push;
                contact.push = push;
                let mut impulse = contact.normal * change;
                if contact.friction > 0.0 {
                    // The push has no part across the normal but through guided nodes; the next sweep sees to those.
                    let across = velocity - contact.normal * along;
                    let wanted = contact.drag - across / contact.mobility[1];
                    let (size, most) = (wanted.norm(), contact.friction * push);
                    let drag = if size > most { wanted * (most / size) } else { wanted };
                    impulse += drag - contact.drag;
                    contact.drag = drag;
                }
                let moved = if drifts { dt } else { 0.0 };
                push_nodes(nodes, &contact.nodes, &contact.weights, impulse, moved);
                largest = largest.max(impulse.norm() * contact.mobility[0]);
            }
            if sweep == 0 {
                first = largest;
            }
            if largest <= SETTLED * first {
                break;
            }
        }
    }

    /// Takes back a part of every penetration.
    fn recover<T: Scalar, F: Fn(u32) -> Filter<T>>(&mut self, nodes: &mut Nodes<'_, T, F>, rods: &[MovingCapsule]) {
        for contact in &self.list {
            let depth = -contact.gap - SLACK * rods[contact.rod as usize].start.radius;
            if depth <= 0.0 {
                continue;
            }
            let shift = contact.normal * (RECOVERY * depth / contact.mobility[0]);
            for (&node, &weight) in contact.nodes.iter().zip(&contact.weights) {
                let mass = nodes.masses[node as usize].to_f64();
                if mass > 0.0 {
                    let shift = (nodes.filter)(node).apply((shift * (weight / mass)).cast());
                    nodes.positions[node as usize] += shift;
                }
            }
        }
    }
}

/// Velocity of a point of the surface.
fn velocity<T: Scalar, F: Fn(u32) -> Filter<T>>(
    nodes: &Nodes<'_, T, F>,
    corners: &[u32; 3],
    weights: &[f64; 3],
) -> Point {
    let of = |i: usize| nodes.velocities[corners[i] as usize].cast::<f64>() * weights[i];
    of(0) + of(1) + of(2)
}

/// Gives an impulse to a point of the surface; nodes go on with the new velocity for `moved` [s].
fn push_nodes<T: Scalar, F: Fn(u32) -> Filter<T>>(
    nodes: &mut Nodes<'_, T, F>,
    corners: &[u32; 3],
    weights: &[f64; 3],
    impulse: Point,
    moved: f64,
) {
    for (&node, &weight) in corners.iter().zip(weights) {
        let mass = nodes.masses[node as usize].to_f64();
        if weight > 0.0 && mass > 0.0 {
            let change: Vec3<T> = (nodes.filter)(node).apply((impulse * (weight / mass)).cast());
            nodes.velocities[node as usize] += change;
            nodes.positions[node as usize] = change.mul_add(T::from_f64(moved), nodes.positions[node as usize]);
        }
    }
}
