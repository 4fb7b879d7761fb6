use super::Point;

/// A solid given by how far every place lies from its skin: what tetrahedra are stuffed into.
///
/// Any function that is continuous, negative inside and positive outside has the right zero; only near the skin should it
/// grow about as fast as the distance, so that a root is found in few steps.
pub trait SignedDistance {
    /// Distance to the skin [m]: negative inside, positive outside, zero on it.
    fn distance(&self, place: Point) -> f64;

    /// Smallest and largest coordinates of a box that holds the solid [m].
    fn bounds(&self) -> (Point, Point);
}
