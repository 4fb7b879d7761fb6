//! Impossible shapes, and which of them tissue can leave.

use std::cell::Cell;

use viscera::model::ModelKind;
use viscera::world::{BodyId, World};

use super::combination::{Combination, Method};
use super::random::Random;
use crate::references::Vector;

/// Edge of the cube [m].
pub(super) const EDGE: f64 = 0.1;

/// What is done to the vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Every vertex at a random place in a box twice as large.
    Random,
    /// All in one point.
    Point,
    /// All on a line.
    Line,
    /// All in a plane.
    Plane,
    /// The mirror image.
    Mirrored,
    /// Stretched a thousand times along one axis.
    Stretched,
    /// One vertex out through the opposite side.
    Poked,
}

impl Shape {
    pub(super) const ALL: [Self; 7] =
        [Self::Random, Self::Point, Self::Line, Self::Plane, Self::Mirrored, Self::Stretched, Self::Poked];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Point => "point",
            Self::Line => "line",
            Self::Plane => "plane",
            Self::Mirrored => "mirrored",
            Self::Stretched => "stretched 1000 times",
            Self::Poked => "poked",
        }
    }

    /// Where a vertex goes that rests at `x` [m].
    fn place(self, x: Vector, random: &mut Random) -> Vector {
        let middle = Vector::splat(0.5 * EDGE);
        match self {
            Self::Random => middle + random.vector() * EDGE,
            Self::Point => middle,
            Self::Line => Vector::new(middle.x, middle.y, x.z),
            Self::Plane => Vector::new(middle.x, x.y, x.z),
            Self::Mirrored => Vector::new(x.x, x.y, -x.z),
            Self::Stretched => Vector::new(x.x, x.y, 1000.0 * x.z),
            Self::Poked if x == Vector::splat(EDGE) => Vector::new(x.x, x.y, -0.5 * EDGE),
            Self::Poked => x,
        }
    }
}

impl Shape {
    /// Puts the free nodes of a body there.
    pub(super) fn put_on(self, world: &mut World<f64>, id: BodyId, random: &mut Random) {
        let rest = world.body(id).positions().to_vec();
        put_at(world, id, |node| self.place(rest[node], random));
    }
}

/// Puts the free nodes of a body at places [m].
pub(super) fn put_at(world: &mut World<f64>, id: BodyId, place: impl FnMut(usize) -> Vector) {
    let places: Vec<Vector> = (0..world.body(id).positions().len()).map(place).collect();
    let next = Cell::new(0);
    world.body_mut(id).set_positions(|_| places[next.replace(next.get() + 1)]);
}

/// A body in a shape, and what moves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// The force model of a law on a kind of cells.
    pub combination: Combination,
    /// The integrator.
    pub method: Method,
    /// The shape.
    pub shape: Shape,
    /// Whether one side of the cube is held where it rests.
    pub held: bool,
}

/// Why nobody can expect the rest shape back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Obstacle {
    /// The law is blind to reflections: turned inside out, the tissue is at rest.
    Mirror,
    /// A free body in a point or on a line: no direction out is better than another, for any law that ignores rotations. A
    /// disturbance as small as a rounding decides.
    Symmetry,
    /// A free body of a law that takes rotations for strain: it comes to rest turned, and larger.
    Turned,
    /// Nodes that remember their place among their neighbours, in such disorder: it may end in a twist, in which each has it.
    Twist,
}

impl Case {
    /// What is in the way of the rest shape; nothing where it has to come back.
    pub fn obstacle(&self) -> Option<Obstacle> {
        // A flat cell may leave its plane on either side.
        if self.combination.is_blind_to_reflections() {
            return Some(Obstacle::Mirror);
        }
        let objective = self.combination.claims().objective;
        if self.combination.model == ModelKind::ShapeMemory {
            return Some(Obstacle::Twist);
        }
        // Models that take a rotation out have one for null deformation gradients too.
        let turns = matches!(self.combination.model, ModelKind::Corotational | ModelKind::StiffnessWarping);
        match self.shape {
            Shape::Point | Shape::Line if !self.held && objective && !turns => Some(Obstacle::Symmetry),
            _ if !self.held && !objective => Some(Obstacle::Turned),
            _ => None,
        }
    }
}
