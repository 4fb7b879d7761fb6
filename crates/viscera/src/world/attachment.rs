//! Bodies that are grown together: nodes of one are tied to places in the other.
//!
//! A node stays where it was in the frame of a tetrahedron behind the nearest triangle of the other surface, x = Σ w_i x_i with the
//! barycentric weights that it has there: exact at the beginning even where the two surfaces gape, and as the weights sum up to 1
//! and reproduce the node's own place, impulses along them keep momentum and angular momentum of the two. They are found as those of
//! contact: on lumped masses, before the drift for places, and after the second kick for velocities.

use super::{BodyId, World, WorldError};
use crate::body::{BodyError, SimulatedBody};
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{Point, Region};
use crate::solver::Filter;
use crate::stage::{Stage, Stages};

/// The most sweeps over all ties.
const SWEEPS: u32 = 60;
/// Sweeps end when no tie changes by more than this share of the largest change of the first sweep.
const SETTLED: f64 = 1e-10;
/// A node farther from the other surface than so many edges of its triangle is not attached to it.
const FARTHEST: f64 = 1.0;

/// Number of an attachment in its world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AttachmentId(pub usize);

/// A part of a body that is grown to another body.
#[derive(Clone, Debug)]
pub struct Attachment {
    /// The body whose nodes are tied; best the finer one.
    pub body: BodyId,
    /// Which of its nodes.
    pub region: Region,
    /// The body to whose surface they are tied, each at its nearest triangle.
    pub to: BodyId,
}

/// An attachment with its places found.
#[derive(Clone, Debug)]
pub(super) struct Ties {
    body: usize,
    to: usize,
    ties: Vec<Tie>,
    /// Impulse on the first body in this step [N s].
    impulse: Point,
    /// Mean force on the first body over the last step [N].
    pub(super) force: Point,
}

#[derive(Clone, Copy, Debug)]
struct Tie {
    node: u32,
    anchors: [u32; 4],
    weights: [f64; 4],
}

/// What impulses are to bring about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    /// Tied places meet at the end of the drift.
    Place,
    /// They move alike.
    Velocity,
}

impl<T: Scalar> World<T> {
    /// Grows a part of a body to another body, where both are now. Explicit worlds only: implicit steps solve the equations of one body
    /// after the other.
    ///
    /// # Errors
    /// [`WorldError::AttachmentNeedsExplicit`]; [`WorldError::AttachedToItself`]; [`WorldError::AttachedToPrecomputed`];
    /// [`WorldError::Body`] for a region without nodes;
    /// [`WorldError::TooFarToAttach`] for a node that is nowhere near the other surface. Panics for a body of another world.
    pub fn attach(&mut self, attachment: Attachment) -> Result<AttachmentId, WorldError> {
        let Attachment { body, region, to } = attachment;
        let (own, other) = (&self.bodies[body.0], &self.bodies[to.0]);
        let (name, to_name) = (own.name.clone(), other.name.clone());
        if !matches!(self.config.integrator, super::Integrator::Explicit(_)) {
            return Err(WorldError::AttachmentNeedsExplicit { body: name, to: to_name });
        }
        if body == to {
            return Err(WorldError::AttachedToItself { body: name });
        }
        if let Some(still) = [own, other].into_iter().find(|body| body.answer.is_some() || body.followers.is_some()) {
            return Err(WorldError::AttachedToPrecomputed { body: still.name.clone(), model: still.model });
        }
        let purpose = "an attachment";
        let nodes = region.nodes(&own.mesh).map_err(|source| {
            WorldError::Body(BodyError::Region { body: name.clone(), purpose, source: Box::new(source) })
        })?;
        let triangles: Vec<_> = other.surface_cells().collect();
        let tie = |node: u32| {
            let place = own.state.positions[node as usize].cast();
            let (tie, distance, edge) = nearest_tie(other, &triangles, node, place);
            match tie.filter(|_| distance <= FARTHEST * edge) {
                Some(tie) => Ok(tie),
                None => {
                    Err(WorldError::TooFarToAttach { body: name.clone(), to: to_name.clone(), node, distance, edge })
                }
            }
        };
        let ties = nodes.into_iter().map(tie).collect::<Result<_, _>>()?;
        let (impulse, force) = (Point::ZERO, Point::ZERO);
        self.attachments.push(Ties { body: body.0, to: to.0, ties, impulse, force });
        Ok(AttachmentId(self.attachments.len() - 1))
    }

    /// The force with which the other body pulls at the attached one [N]: the mean over the last step. Panics for a number of another
    /// world.
    pub fn attachment_force(&self, id: AttachmentId) -> Vec3<f64> {
        self.attachments[id.0].force
    }

    /// Clears what the ties did in a step before it is made.
    pub(super) fn begin_attachments(&mut self) {
        self.attachments.iter_mut().for_each(|ties| ties.impulse = Point::ZERO);
    }

    /// Takes down what they did.
    pub(super) fn settle_attachments(&mut self) {
        for ties in &mut self.attachments {
            ties.force = ties.impulse / self.config.step;
        }
    }

    /// Impulses that hold together what is attached, in a sub-step of `dt` [s].
    pub(super) fn hold_together(&mut self, dt: f64, aim: Aim, stages: Stages) {
        for ties in &mut self.attachments {
            let Ok([own, other]) = self.bodies.get_disjoint_mut([ties.body, ties.to]) else { continue };
            stages.run(Stage::Attachments, || ties.impulse += ties_impulse(&ties.ties, own, other, dt, aim));
        }
    }
}

fn ties_impulse<T: Scalar>(
    ties: &[Tie],
    own: &mut SimulatedBody<T>,
    other: &mut SimulatedBody<T>,
    dt: f64,
    aim: Aim,
) -> Point {
    let (mut sum, mut first) = (Point::ZERO, 0.0f64);
    // The second kick has been divided by this, and would have divided the impulse in it as well.
    let damping = if aim == Aim::Velocity { 1.0 + 0.5 * dt * own.damping.to_f64() } else { 1.0 };
    for sweep in 0..SWEEPS {
        let mut largest = 0.0f64;
        for tie in ties {
            let node = tie.node as usize;
            // Cut off on one side, the tie is cut.
            let gone = |body: &SimulatedBody<T>, node: usize| body.state.masses[node] <= T::ZERO;
            if gone(own, node) || tie.anchors.iter().any(|&anchor| gone(other, anchor as usize)) {
                continue;
            }
            let anchors = tie.anchors.iter().zip(tie.weights);
            let apart = |of_own: Vec3<T>, of_other: &[Vec3<T>]| {
                let there = anchors.clone();
                there.fold(of_own.cast::<f64>(), |sum, (&anchor, w)| sum - of_other[anchor as usize].cast::<f64>() * w)
            };
            let velocity = match aim {
                Aim::Place => apart(own.state.positions[node], &other.state.positions) / dt,
                Aim::Velocity => apart(own.state.velocities[node], &other.state.velocities),
            };
            let mobility = anchors.clone().fold(mobility(own, node), |sum, (&anchor, weight)| {
                sum + weight * weight * mobility(other, anchor as usize)
            });
            if mobility <= 0.0 {
                continue;
            }
            let impulse = -(velocity / mobility);
            let moved = if aim == Aim::Place { dt } else { 0.0 };
            push(own, node, impulse, moved);
            for (&anchor, weight) in tie.anchors.iter().zip(tie.weights) {
                push(other, anchor as usize, -(impulse * weight), moved);
            }
            sum += impulse * damping;
            largest = largest.max(impulse.norm() * mobility);
        }
        if sweep == 0 {
            first = largest;
        }
        if largest <= SETTLED * first {
            break;
        }
    }
    sum
}

/// The velocity that a unit of impulse gives a node [1/kg].
fn mobility<T: Scalar>(body: &SimulatedBody<T>, node: usize) -> f64 {
    match body.free_directions(node) {
        Filter::Held => 0.0,
        _ => 1.0 / body.state.masses[node].to_f64(),
    }
}

fn push<T: Scalar>(body: &mut SimulatedBody<T>, node: usize, impulse: Point, moved: f64) {
    let change = (impulse / body.state.masses[node].to_f64()).cast();
    let change: Vec3<T> = body.free_directions(node).apply(change);
    body.state.velocities[node] += change;
    body.state.positions[node] = change.mul_add(T::from_f64(moved), body.state.positions[node]);
}

/// The tie of a node to the triangle that is nearest to `place`, how far that is, and the triangle's longest edge [m].
fn nearest_tie<T: Scalar>(
    other: &SimulatedBody<T>,
    triangles: &[([u32; 3], u32)],
    node: u32,
    place: Point,
) -> (Option<Tie>, f64, f64) {
    let at = |node: u32| other.state.positions[node as usize].cast::<f64>();
    let mut nearest = (None, f64::INFINITY, 0.0);
    for &(corners, cell) in triangles {
        let [a, b, c] = corners.map(at);
        let distance = crate::contact::distance_to_triangle(&[a, b, c], place);
        if distance < nearest.1 {
            let edge = (b - a).norm().max((c - b).norm()).max((a - c).norm());
            nearest = (Some((corners, cell)), distance, edge);
        }
    }
    let (found, distance, edge) = nearest;
    let tie = found.and_then(|(corners, cell)| {
        let [a, b, c] = corners.map(at);
        // The corner of the cell that lies farthest off the triangle makes the best frame with it.
        let normal = (b - a).cross(c - a);
        let height = |&corner: &u32| normal.dot(at(corner) - a).abs();
        let apex = other.mesh.cell(cell as usize).iter().copied().max_by(|x, y| height(x).total_cmp(&height(y)))?;
        let frame = Mat3::from_columns(b - a, c - a, at(apex) - a);
        let own = frame.inverse() * (place - a);
        let weights = [1.0 - own.x - own.y - own.z, own.x, own.y, own.z];
        let anchors = [corners[0], corners[1], corners[2], apex];
        own.is_finite().then_some(Tie { node, anchors, weights })
    });
    (tie, distance, edge)
}
