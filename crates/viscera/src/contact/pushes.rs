//! Contact with a body that answers at once: pushes on its surface, without friction, by projected Gauss–Seidel.
//!
//! g = g₀ + A λ ≥ 0,   λ ≥ 0,   g λ = 0
//!
//! g₀ are the distances that would be left at the end of the step without pushes, and A_cb is how far contact c is pushed along its
//! normal by a unit of push at contact b, with what jaws hold staying in them. A push that would have to pull is none: the tool lets go.

use super::{Contact, Contacts};
use crate::math::Vec3;
use crate::mesh::Point;
use crate::model::precomputed::{ContactSystem, Responses};

/// The most contacts of a body that answers at once: the matrix takes their square.
const MOST: usize = 256;
/// The most sweeps over all contacts. Neighbours hang together closely, and hundreds are not rare; a sweep over 30 takes a microsecond.
const SWEEPS: u32 = 4000;
/// Sweeps end when no push changes by more than this share of the largest.
const SETTLED: f64 = 1e-10;
/// What held nodes have to leave of a contact's mobility for it to be one.
const MOVABLE: f64 = 1e-9;

/// Memory for the system of the pushes.
#[derive(Clone, Debug, Default)]
pub(crate) struct PushMemory {
    /// A, row after row.
    matrix: Vec<f64>,
    gaps: Vec<f64>,
    /// What a unit of push does at the held nodes, and takes there.
    imposed: Vec<Vec3<f64>>,
}

impl PushMemory {
    /// Asks for memory for so many contacts and held nodes.
    pub(crate) fn reserve(&mut self, contacts: usize, held: usize) {
        let contacts = contacts.min(MOST);
        self.matrix.reserve((contacts * contacts).saturating_sub(self.matrix.len()));
        self.gaps.reserve(contacts.saturating_sub(self.gaps.len()));
        self.imposed.reserve(held.saturating_sub(self.imposed.len()));
    }
}

impl Contacts {
    /// Finds the pushes; `ways` gives how far a node goes in the step without them [m].
    pub(crate) fn solve_pushes(
        &mut self,
        memory: &mut PushMemory,
        responses: &Responses,
        held: &mut ContactSystem,
        ways: impl Fn(u32) -> Point,
    ) {
        let gap = |contact: &Contact| {
            let way = (0..3).fold(Point::ZERO, |sum, i| sum + ways(contact.nodes[i]) * contact.weights[i]);
            contact.gap + contact.normal.dot(way - contact.way)
        };
        if self.list.len() > MOST {
            self.list.sort_unstable_by(|a, b| gap(a).total_cmp(&gap(b)));
            self.list.truncate(MOST);
        }
        // What only moves nodes that are held is no contact.
        self.list.retain(|contact| {
            let free = mobility(contact, contact, responses);
            free > 0.0 && mobility_with(contact, contact, responses, held, &mut memory.imposed) > MOVABLE * free
        });
        let count = self.list.len();
        memory.gaps.clear();
        memory.gaps.extend(self.list.iter().map(gap));
        memory.matrix.clear();
        memory.matrix.resize(count * count, 0.0);
        for b in 0..count {
            take_up(&self.list[b], responses, held, &mut memory.imposed);
            for c in 0..=b {
                let value = mobility(&self.list[c], &self.list[b], responses) + along(&self.list[c], responses, held);
                memory.matrix[b * count + c] = value;
                memory.matrix[c * count + b] = value;
            }
        }
        self.sweep(memory);
    }

    fn sweep(&mut self, memory: &PushMemory) {
        let count = self.list.len();
        self.list.iter_mut().for_each(|contact| (contact.push, contact.drag) = (0.0, Point::ZERO));
        for _ in 0..SWEEPS {
            let (mut change, mut largest) = (0.0f64, 0.0f64);
            for c in 0..count {
                let row = &memory.matrix[c * count..][..count];
                let gap = row.iter().zip(&self.list).fold(memory.gaps[c], |gap, (a, b)| gap + a * b.push);
                let push = (self.list[c].push - gap / row[c]).max(0.0);
                change = change.max((push - self.list[c].push).abs());
                largest = largest.max(push);
                self.list[c].push = push;
            }
            if change <= SETTLED * largest {
                break;
            }
        }
    }

    /// The pushes on the nodes [N].
    pub(crate) fn pushes(&self) -> impl Iterator<Item = (u32, Vec3<f64>)> + '_ {
        let pushing = self.list.iter().filter(|contact| contact.push > 0.0);
        pushing.flat_map(|contact| {
            let of = |i: usize| (contact.nodes[i], contact.normal * (contact.push * contact.weights[i]));
            [of(0), of(1), of(2)]
        })
    }
}

/// How far contact `c` goes along its normal for a unit of push at `b`, nothing being held by jaws [m/N].
fn mobility(c: &Contact, b: &Contact, responses: &Responses) -> f64 {
    let mut sum = 0.0;
    for (&node, &weight) in b.nodes.iter().zip(&b.weights) {
        let Some(handle) = responses.handle_of(node).filter(|_| weight > 0.0) else { continue };
        for (&other, &share) in c.nodes.iter().zip(&c.weights) {
            sum += weight * share * c.normal.dot(responses.response(other, handle) * b.normal);
        }
    }
    sum
}

/// Finds the forces by which jaws keep what they hold in place under a unit of push at `b`.
fn take_up(b: &Contact, responses: &Responses, held: &mut ContactSystem, imposed: &mut Vec<Vec3<f64>>) {
    imposed.clear();
    for &node in held.nodes() {
        let mut way = Vec3::ZERO;
        for (&pushed, &weight) in b.nodes.iter().zip(&b.weights) {
            if let Some(handle) = responses.handle_of(pushed) {
                way -= responses.response(node, handle) * b.normal * weight;
            }
        }
        imposed.push(way);
    }
    held.find_forces(imposed);
}

/// What the forces that were found last do at `c`, along its normal.
fn along(c: &Contact, responses: &Responses, held: &ContactSystem) -> f64 {
    let mut sum = 0.0;
    for place in 0..held.nodes().len() {
        for (&node, &share) in c.nodes.iter().zip(&c.weights) {
            sum += share * c.normal.dot(responses.response(node, held.handle(place)) * held.force(place));
        }
    }
    sum
}

/// [`mobility`] with what jaws hold staying in them.
fn mobility_with(
    c: &Contact,
    b: &Contact,
    responses: &Responses,
    held: &mut ContactSystem,
    imposed: &mut Vec<Vec3<f64>>,
) -> f64 {
    take_up(b, responses, held, imposed);
    mobility(c, b, responses) + along(c, responses, held)
}
