use super::closest::closest_of_segments;
use crate::math::Vec3;
use crate::mesh::{Point, TET_EDGES, TET_FACES};

/// A ball swept along a line: a rod with round ends, or what a round tip covers between two moments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// One end of the line [m].
    pub from: Point,
    /// The other end [m].
    pub to: Point,
    /// Radius of the ball [m].
    pub radius: f64,
}

impl Capsule {
    /// Whether the bounding boxes overlap: cheap, and true wherever [`Capsule::touches`] is.
    pub fn may_touch(&self, corners: &[Point; 4]) -> bool {
        let reach = Vec3::splat(self.radius);
        let (low, high) = (self.from.min(self.to) - reach, self.from.max(self.to) + reach);
        let [a, b, c, d] = *corners;
        let (cell_low, cell_high) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        (0..3).all(|axis| cell_low[axis] <= high[axis] && low[axis] <= cell_high[axis])
    }

    /// Whether the capsule touches the tetrahedron, whatever its orientation.
    ///
    /// The line and the tetrahedron are closest either inside one another, between a corner and the line, between an end
    /// and a face, or between an edge and the line.
    pub fn touches(&self, corners: &[Point; 4]) -> bool {
        let limit = self.radius * self.radius;
        let triangle = |face: [usize; 3]| face.map(|i| corners[i]);
        contains(corners, self.from)
            || TET_EDGES
                .iter()
                .any(|&[i, j]| squared_distance_of_segments(corners[i], corners[j], self.from, self.to) <= limit)
            || TET_FACES.iter().any(|&face| {
                let face = triangle(face);
                crosses(&face, self.from, self.to)
                    || squared_distance_to_inside(&face, self.from).is_some_and(|distance| distance <= limit)
                    || squared_distance_to_inside(&face, self.to).is_some_and(|distance| distance <= limit)
            })
    }
}

/// Six times the signed volume.
fn volume(a: Point, b: Point, c: Point, d: Point) -> f64 {
    (b - a).dot((c - a).cross(d - a))
}

fn contains(&[a, b, c, d]: &[Point; 4], p: Point) -> bool {
    let whole = volume(a, b, c, d);
    let parts = [volume(p, b, c, d), volume(a, p, c, d), volume(a, b, p, d), volume(a, b, c, p)];
    parts.into_iter().all(|part| part * whole >= 0.0) && whole != 0.0
}

/// Whether the segment from p to q passes through the triangle.
fn crosses(&[a, b, c]: &[Point; 3], p: Point, q: Point) -> bool {
    let (before, after) = (volume(a, b, c, p), volume(a, b, c, q));
    if before * after > 0.0 || before == after {
        return false;
    }
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    sides.into_iter().all(|side| side >= 0.0) || sides.into_iter().all(|side| side <= 0.0)
}

/// Squared distance from p to the plane of the triangle, where its foot lies in the triangle.
fn squared_distance_to_inside(&[a, b, c]: &[Point; 3], p: Point) -> Option<f64> {
    let normal = (b - a).cross(c - a);
    let squared_norm = normal.squared_norm();
    let inside = |u: Point, v: Point| (v - u).cross(p - u).dot(normal) >= 0.0;
    (squared_norm > 0.0 && inside(a, b) && inside(b, c) && inside(c, a)).then(|| {
        let height = normal.dot(p - a);
        height * height / squared_norm
    })
}

/// Squared distance between two segments, degenerate ones included.
fn squared_distance_of_segments(p1: Point, q1: Point, p2: Point, q2: Point) -> f64 {
    let (s, t) = closest_of_segments(p1, q1, p2, q2);
    (p1 + (q1 - p1) * s - p2 - (q2 - p2) * t).squared_norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn touches(from: [f64; 3], to: [f64; 3], radius: f64) -> bool {
        let corners = CORNERS.map(Point::from);
        let [a, b, c, d] = corners;
        let capsule = Capsule { from: from.into(), to: to.into(), radius };
        let touches = capsule.touches(&corners);
        assert_eq!(touches, capsule.touches(&[b, a, c, d]), "the orientation must not matter");
        assert!(!touches || capsule.may_touch(&corners), "the quick test must not miss what is touched");
        touches
    }

    #[test]
    fn a_tip_inside_touches_however_small_it_is() {
        assert!(touches([0.2, 0.2, 0.2], [0.2, 0.2, 0.2], 1e-9));
    }

    #[test]
    fn a_fast_tip_that_jumps_right_through_touches() {
        assert!(touches([0.2, 0.2, -5.0], [0.2, 0.2, 5.0], 1e-9));
    }

    #[test]
    fn a_tip_touches_from_its_radius_on() {
        // Above a face, beyond an edge, beyond a corner.
        for (place, distance) in [
            ([0.2, 0.2, -0.5], 0.5),
            ([0.5, -0.3, -0.4], 0.5),
            ([2.0, 0.0, 0.0], 1.0),
            ([1.0, 1.0, 1.0], 2.0 / 3.0_f64.sqrt()),
        ] {
            assert!(touches(place, place, distance * 1.001), "{place:?}");
            assert!(!touches(place, place, distance * 0.999), "{place:?}");
        }
    }

    #[test]
    fn a_path_that_passes_by_touches_from_its_closest_approach_on() {
        let (from, to) = ([-3.0, -0.5, 0.5], [3.0, -0.5, 0.5]);
        assert!(touches(from, to, 0.501));
        assert!(!touches(from, to, 0.499));
    }
}
