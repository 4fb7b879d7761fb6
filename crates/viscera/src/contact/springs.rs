//! Contact in implicit steps: springs that push and never pull, and friction that holds until it slips.
//!
//! With d the way of the point of the tissue in the step and u that of the tool's, the force on the tissue is
//!
//! f = −k (gap + n·(d − u)) n + t,   t = t₀ − k (I − n nᵀ)(d − u) while |t| ≤ μ|f·n|,   else μ|f·n| along that,
//!
//! where t₀ is the friction at the end of the step before: a block on a slope would creep without it. Which contacts push and which
//! of them stick is decided between linear solves, until nothing changes; all stick at first, and one that slips does so until the end of
//! the step, with a force that stands still within a solve.
//!
//! k is [`STIFFER`] times what the diagonal of the matrix offers the point, so it belongs to the tissue, the mesh and the step.

use serde::{Deserialize, Serialize};

use super::{Contact, Contacts, MovingCapsule};
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::Point;

/// Stiffness of a contact over that of the matrix's diagonal at its point.
const STIFFER: f64 = 20.0;
/// Friction that slips is found anew while it changes by more than this share of its limit.
const SETTLED: f64 = 1e-2;

/// Friction of a contact at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Traction {
    feature: [u32; 3],
    tool: u32,
    part: u32,
    /// On the tissue [N].
    force: Vec3<f64>,
}

impl Traction {
    pub(super) fn new(feature: [u32; 3], tool: u32, part: u32, force: Vec3<f64>) -> Self {
        Self { feature, tool, part, force }
    }

    pub(super) fn is_of(&self, feature: [u32; 3], tool: u32, part: u32) -> bool {
        (self.feature, self.tool, self.part) == (feature, tool, part)
    }

    pub(super) fn force(&self) -> Vec3<f64> {
        self.force
    }
}

impl Contact {
    /// d − u.
    fn slide(&self, increment: &impl Fn(u32) -> Point) -> Point {
        let of = |i: usize| increment(self.nodes[i]) * self.weights[i];
        of(0) + of(1) + of(2) - self.way
    }

    /// Stiffness along the normal and across it.
    fn stiffnesses(&self) -> (f64, f64) {
        let across = if self.sticks && self.friction > 0.0 { self.stiffness } else { 0.0 };
        if self.is_active { (self.stiffness, across) } else { (0.0, 0.0) }
    }

    /// The force on the tissue; that of friction which slips stands still.
    fn set_force(&mut self, slide: Point) {
        if !self.is_active {
            (self.push, self.drag) = (0.0, Point::ZERO);
            return;
        }
        let along = self.normal.dot(slide);
        self.push = -self.stiffness * (self.gap + along);
        if self.sticks {
            self.drag = self.friction_of_sticking(slide);
        }
    }

    fn friction_of_sticking(&self, slide: Point) -> Point {
        if self.friction > 0.0 {
            let across = slide - self.normal * self.normal.dot(slide);
            self.before - across * self.stiffness
        } else {
            Point::ZERO
        }
    }
}

impl Contacts {
    /// Says which contacts push and which stick when each node goes by its `increment` [m]; gives whether that is news.
    pub(crate) fn decide(&mut self, increment: impl Fn(u32) -> Point) -> bool {
        let mut news = false;
        for contact in &mut self.list {
            let slide = contact.slide(&increment);
            let is_active = contact.gap + contact.normal.dot(slide) < 0.0;
            news |= std::mem::replace(&mut contact.is_active, is_active) != is_active;
            let is_known = contact.stiffness > 0.0;
            if !is_active || !is_known {
                contact.set_force(slide);
                continue;
            }
            contact.push = -contact.stiffness * (contact.gap + contact.normal.dot(slide));
            let (wanted, most) = (contact.friction_of_sticking(slide), contact.friction * contact.push);
            let size = wanted.norm();
            // Once it has slipped it slips until the end of the step: with the push that goes with it, it may seem to stick, and with
            // that to slip again.
            let sticks = contact.sticks && size <= most;
            let drag = if sticks || size == 0.0 { wanted } else { wanted * (most / size) };
            news |= sticks != contact.sticks || (!sticks && (drag - contact.drag).norm() > SETTLED * most);
            (contact.sticks, contact.drag) = (sticks, drag);
        }
        news
    }

    /// Sets the stiffness of contacts that have none yet. `diagonal` gives what the matrix has for a node on its diagonal
    /// [N/m], and nothing for one that forces do not move.
    pub(crate) fn set_stiffness(&mut self, diagonal: impl Fn(u32) -> Option<f64>) {
        self.list.retain_mut(|contact| {
            if contact.stiffness > 0.0 {
                return true;
            }
            let compliance: f64 = contact
                .nodes
                .iter()
                .zip(&contact.weights)
                .filter_map(|(&node, &weight)| diagonal(node).map(|diagonal| weight * weight / diagonal))
                .sum();
            contact.stiffness = if compliance > 0.0 { STIFFER / compliance } else { 0.0 };
            contact.stiffness > 0.0
        });
    }

    /// Adds the forces on the tissue after the way `increments` [N] to `out`.
    pub(crate) fn add_forces<T: Scalar>(&mut self, increments: &[Vec3<T>], out: &mut [Vec3<T>]) {
        for contact in &mut self.list {
            contact.set_force(contact.slide(&|node| increments[node as usize].cast()));
            let force = contact.normal * contact.push + contact.drag;
            for (&node, &weight) in contact.nodes.iter().zip(&contact.weights) {
                out[node as usize] += (force * weight).cast();
            }
        }
    }

    /// Adds `scale` times the springs' part of the matrix times x to `out`.
    pub(crate) fn add_product<T: Scalar>(&self, scale: f64, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        for contact in &self.list {
            let (along, across) = contact.stiffnesses();
            if along == 0.0 {
                continue;
            }
            let of = |i: usize| x[contact.nodes[i] as usize].cast::<f64>() * contact.weights[i];
            let way = of(0) + of(1) + of(2);
            let force = way * across + contact.normal * ((along - across) * contact.normal.dot(way));
            for (&node, &weight) in contact.nodes.iter().zip(&contact.weights) {
                out[node as usize] += (force * (weight * scale)).cast();
            }
        }
    }

    /// Gives the springs' part of the matrix over `scale` to `add`, block by block.
    pub(crate) fn add_blocks<T: Scalar>(&self, scale: f64, mut add: impl FnMut(u32, u32, Mat3<T>)) {
        for contact in &self.list {
            let (along, across) = contact.stiffnesses();
            if along == 0.0 {
                continue;
            }
            let block = contact.normal.outer(contact.normal) * (along - across) + Mat3::diagonal(across);
            for (&row, &of_row) in contact.nodes.iter().zip(&contact.weights) {
                for (&column, &of_column) in contact.nodes.iter().zip(&contact.weights) {
                    let share = of_row * of_column / scale;
                    if share > 0.0 {
                        add(row, column, (block * share).cast());
                    }
                }
            }
        }
    }

    /// Adds the forces after the way `increments`, over `duration` [s], to the tools' loads.
    pub(crate) fn finish<T: Scalar>(&mut self, increments: &[Vec3<T>], rods: &[MovingCapsule], duration: f64) {
        for contact in &mut self.list {
            contact.set_force(contact.slide(&|node| increments[node as usize].cast()));
        }
        self.account(rods, duration);
    }

    /// The sum of the forces' sizes [N].
    pub(crate) fn force(&self) -> f64 {
        self.list.iter().map(|contact| (contact.normal * contact.push + contact.drag).norm()).sum()
    }
}
