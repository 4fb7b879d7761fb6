//! Bodies that are grown together: nodes of one are tied to places in the other.
//!
//! A node stays where it was in the frame of a tetrahedron behind the nearest triangle of the other surface, x = Σ w_i x_i with the
//! barycentric weights that it has there: exact at the beginning even where the two surfaces gape, and as the weights sum up to 1
//! and reproduce the node's own place, forces along them keep momentum and angular momentum of the two. Every integrator holds them exactly:
//! explicit sub-steps by impulses, implicit steps and equilibria by solving the equations of bodies that are tied together as one.

use super::{BodyId, Integrator, World, WorldError};
use crate::body::{BodyError, SimulatedBody};
use crate::dynamics::implicit::Preconditioning;
use crate::dynamics::tied::{Aim, PlacedNode, TiedBodies};
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{Point, Region};
use crate::stage::{Stage, Stages};

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
pub(super) struct Grown {
    body: usize,
    to: usize,
    nodes: Vec<PlacedNode>,
    /// Impulse on the first body in this step [N s].
    pub(super) impulse: Point,
    /// Mean force on the first body over the last step [N].
    pub(super) force: Point,
}

impl Grown {
    /// The attached body, and the one that it is attached to.
    pub(super) fn ends(&self) -> [BodyId; 2] {
        [BodyId(self.body), BodyId(self.to)]
    }
}

impl<T: Scalar> World<T> {
    /// Grows a part of a body to another body, where both are now.
    ///
    /// Any integrator moves them: implicit steps and equilibria solve the equations of all bodies that attachments connect as one system, and
    /// every place that they give has the ties in it. A tie that says what others say already counts once.
    ///
    /// # Errors
    /// [`WorldError::AttachmentNeedsBlockJacobi`] in implicit worlds with multigrid;
    /// [`WorldError::AttachmentNeedsIterative`] in quasi-static ones whose solver factorises; [`WorldError::AttachedToItself`];
    /// [`WorldError::AttachedToPrecomputed`]; [`WorldError::Body`] for a region without nodes;
    /// [`WorldError::TooFarToAttach`] for a node that is nowhere near the other surface. Panics for a body of another world.
    pub fn attach(&mut self, attachment: Attachment) -> Result<AttachmentId, WorldError> {
        let Attachment { body, region, to } = attachment;
        let (own, other) = (&self.bodies[body.0], &self.bodies[to.0]);
        let (name, to_name) = (own.name.clone(), other.name.clone());
        if matches!(self.config.integrator, Integrator::Implicit(own) if own.preconditioner == Preconditioning::Multigrid)
        {
            return Err(WorldError::AttachmentNeedsBlockJacobi { body: name, to: to_name });
        }
        self.check_solver_of_ties(self.static_solver(), [body, to])?;
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
        let nodes = nodes.into_iter().map(tie).collect::<Result<_, _>>()?;
        let (impulse, force) = (Point::ZERO, Point::ZERO);
        self.attachments.push(Grown { body: body.0, to: to.0, nodes, impulse, force });
        self.tie_together();
        Ok(AttachmentId(self.attachments.len() - 1))
    }

    /// The force with which the other body pulls at the attached one [N]: the mean over the last step. Panics for a number of another
    /// world.
    pub fn attachment_force(&self, id: AttachmentId) -> Vec3<f64> {
        self.attachments[id.0].force
    }

    /// Finds which bodies attachments connect, and asks for the memory that solving them together takes.
    fn tie_together(&mut self) {
        let mut groups: Vec<usize> = (0..self.bodies.len()).collect();
        for grown in &self.attachments {
            let (from, to) = (groups[grown.body], groups[grown.to]);
            groups.iter_mut().filter(|group| **group == from.max(to)).for_each(|group| *group = from.min(to));
        }
        self.tied.clear();
        for group in 0..groups.len() {
            let bodies: Vec<usize> = (0..groups.len()).filter(|&body| groups[body] == group).collect();
            if bodies.len() < 2 {
                continue;
            }
            let own = self.attachments.iter().enumerate().filter(|(_, grown)| groups[grown.body] == group);
            let own = own.map(|(number, grown)| (number, [grown.body, grown.to], &grown.nodes[..]));
            let mut tied = TiedBodies::new(bodies, own);
            if let Integrator::Implicit(settings) = self.config.integrator {
                tied = tied.with_implicit_steps(&self.bodies, &settings);
            }
            self.tied.push(tied);
        }
    }

    /// Clears what the ties did in a step before it is made.
    pub(super) fn begin_attachments(&mut self) {
        self.attachments.iter_mut().for_each(|grown| grown.impulse = Point::ZERO);
    }

    /// Takes down what they did.
    pub(super) fn settle_attachments(&mut self) {
        for grown in &mut self.attachments {
            grown.force = grown.impulse / self.config.step;
        }
    }

    /// Looks which ties are left before the sub-steps of a step.
    pub(super) fn begin_ties(&mut self, stages: Stages) {
        for tied in &mut self.tied {
            stages.run(Stage::Attachments, || tied.begin(&self.bodies));
        }
    }

    /// Impulses that hold together what is attached, in a sub-step of `dt` [s].
    pub(super) fn hold_together(&mut self, dt: f64, aim: Aim, stages: Stages) {
        let (bodies, attachments) = (&mut self.bodies, &mut self.attachments);
        for tied in &mut self.tied {
            stages.run(Stage::Attachments, || {
                tied.hold_together(bodies, dt, aim, |number, impulse| attachments[number].impulse += impulse);
            });
        }
    }
}

/// The tie of a node to the triangle that is nearest to `place`, how far that is, and the triangle's longest edge [m].
fn nearest_tie<T: Scalar>(
    other: &SimulatedBody<T>,
    triangles: &[([u32; 3], u32)],
    node: u32,
    place: Point,
) -> (Option<PlacedNode>, f64, f64) {
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
        own.is_finite().then_some(PlacedNode { node, anchors, weights })
    });
    (tie, distance, edge)
}
