//! Contact in implicit steps: springs that push and never pull, and friction that holds until it slips.
//!
//! With d the way of the point of the tissue in the step and u that of the tool's, the force on the tissue is
//!
//! f = −k (gap + n·(d − u)) n + t,   t = t₀ − k (I − n nᵀ)(d − u) while |t| ≤ μ|f·n|,   else μ|f·n| along that,
//!
//! where t₀ is the friction at the end of the step before: a block on a slope would creep without it. Which contacts push is decided
//! between linear solves, until nothing changes; and how much of the sticking force, and of its stiffness, the cone lets through: what
//! slips keeps a spring that is just so much softer (a secant of the law), and the matrix stays positive. A slipping force that
//! stood still within a solve changed its sign from one to the next, and threw a block off its rods.
//!
//! k is [`STIFFER`] times what the diagonal of the matrix offers the point, so it belongs to the tissue, the mesh and the step.

use serde::{Deserialize, Serialize};

use super::{Contact, Contacts, MovingCapsule};
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::Point;

/// Stiffness of a contact over that of the matrix's diagonal at its point.
const STIFFER: f64 = 20.0;
/// Friction is found anew while it is off by more than this share of its limit.
const SETTLED: f64 = 5e-2;

/// Share of the force before which a contact that was made softer still takes up when it holds.
const HOLDS: f64 = 0.8;
/// Power by which such a contact is made softer faster.
const FASTER: i32 = 4;

/// Friction of a contact at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Traction {
    feature: [u32; 3],
    tool: u32,
    part: u32,
    /// On the tissue [N].
    force: Vec3<f64>,
    /// Share of the friction of sticking that the cone let through.
    grip: f64,
}

impl Traction {
    pub(super) fn new(feature: [u32; 3], (tool, part): (u32, u32), force: Vec3<f64>, grip: f64) -> Self {
        Self { feature, tool, part, force, grip }
    }

    pub(super) fn is_of_rod(&self, tool: u32, part: u32) -> bool {
        (self.tool, self.part) == (tool, part)
    }

    pub(super) fn is_of(&self, feature: [u32; 3]) -> bool {
        self.feature == feature
    }

    pub(super) fn force(&self) -> Vec3<f64> {
        self.force
    }

    pub(super) fn grip(&self) -> f64 {
        self.grip
    }
}

impl Contact {
    /// d − u.
    pub(super) fn slide(&self, increment: &impl Fn(u32) -> Point) -> Point {
        let of = |i: usize| increment(self.nodes[i]) * self.weights[i];
        of(0) + of(1) + of(2) - self.way
    }

    /// The part of a vector across the normal.
    pub(super) fn across(&self, vector: Point) -> Point {
        vector - self.normal * self.normal.dot(vector)
    }

    /// Stiffness along the normal and across it.
    fn stiffnesses(&self) -> (f64, f64) {
        let across = if self.friction > 0.0 { self.grip * self.stiffness } else { 0.0 };
        if self.is_active { (self.stiffness, across) } else { (0.0, 0.0) }
    }

    fn push_after(&self, slide: Point) -> f64 {
        -self.stiffness * (self.gap + self.normal.dot(slide))
    }

    /// The force on the tissue.
    fn set_force(&mut self, slide: Point) {
        if self.is_active {
            self.push = self.push_after(slide);
            self.drag = self.friction_of_sticking(slide) * self.grip;
        } else {
            (self.push, self.drag) = (0.0, Point::ZERO);
        }
    }

    fn friction_of_sticking(&self, slide: Point) -> Point {
        if self.friction > 0.0 { self.before - self.across(slide) * self.stiffness } else { Point::ZERO }
    }
}

impl Contacts {
    /// Says which contacts push and how well they stick when each node goes by its `increment` [m]; gives whether that is news.
    pub(crate) fn decide(&mut self, increment: impl Fn(u32) -> Point) -> bool {
        let mut news = false;
        for number in 0..self.list.len() {
            let contact = &self.list[number];
            let slide = contact.slide(&increment);
            let is_active = contact.gap + contact.normal.dot(slide) < 0.0;
            let closes_again = is_active && contact.has_opened && !contact.is_active;
            let most_push = if closes_again { self.mean_push(number, &increment) } else { f64::INFINITY };
            let contact = &mut self.list[number];
            contact.has_opened |= contact.is_active && !is_active;
            news |= std::mem::replace(&mut contact.is_active, is_active) != is_active;
            contact.set_force(slide);
            if is_active && contact.stiffness > 0.0 && contact.friction > 0.0 {
                let size = contact.friction_of_sticking(slide).norm();
                let most = contact.friction * contact.push.min(most_push);
                let force = contact.grip * size;
                // A softer spring that takes up as much as before still holds what ought to slip: on a slope little steeper than the cone
                // one secant after the other would take a dozen solves to let it go.
                let holds = contact.grip < 1.0 && force > HOLDS * contact.tried && force > most;
                let grip = match (size <= most, holds) {
                    (true, _) => 1.0,
                    (_, true) => contact.grip * (most / force).powi(FASTER),
                    _ => most / size,
                };
                contact.tried = force;
                news |= (grip - contact.grip).abs() * size > SETTLED * most;
                contact.grip = grip;
                contact.set_force(slide);
            }
        }
        news
    }

    /// Mean push of the other contacts on the rod of one [N]. A contact that opened and closes again was found as deep as tissue goes
    /// without it: friction after that push held a sliding block like another block, lifted its end, and opened the contact again.
    fn mean_push(&self, number: usize, increment: &impl Fn(u32) -> Point) -> f64 {
        let pushes =
            self.list.iter().enumerate().filter(|(other, contact)| {
                *other != number && contact.rod == self.list[number].rod && contact.is_active
            });
        let pushes = pushes.map(|(_, contact)| contact.push_after(contact.slide(increment)).max(0.0));
        let (count, sum) = pushes.fold((0.0, 0.0), |(count, sum), push| (count + 1.0, sum + push));
        if count > 0.0 { sum / count } else { f64::INFINITY }
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
            contact.grip = contact.grip.min(contact.slipping / contact.stiffness);
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
