use crate::math::Mat3;
use crate::mesh::Point;

/// How a tool moves over a step: what it holds goes with it, turning and all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolFrame {
    /// Its tip at the beginning and at the end [m].
    pub tip: (Point, Point),
    /// From its own axes to those of the world, at the beginning and at the end.
    pub turn: (Mat3<f64>, Mat3<f64>),
    /// The most force with which it holds one node [N].
    pub limit: f64,
}

impl ToolFrame {
    /// Where a place in its axes is at the end [m].
    pub(crate) fn at_end(&self, own: Point) -> Point {
        self.tip.1 + self.turn.1 * own
    }

    /// How far it goes [m].
    pub(crate) fn way(&self, own: Point) -> Point {
        self.tip.1 - self.tip.0 + (self.turn.1 * own - self.turn.0 * own)
    }

    /// A place of the world in its axes at the end.
    pub(crate) fn own(&self, place: Point) -> Point {
        self.turn.1.transpose_mul(place - self.tip.1)
    }
}
