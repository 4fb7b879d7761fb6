//! Does a rod meet a triangle while both move? Neither speed nor thinness lets one through.

use super::Capsule;
use super::closest::{Closest, closest_to_segment};
use crate::mesh::Point;

/// Part of a rod's radius within which a triangle counts as touching: contacts are known before they close.
pub(super) const MARGIN: f64 = 0.05;
/// The most advances towards a meeting. Each but the last covers the margin at least; two that are still apart after so many are
/// taken as touching there, which errs on the safe side.
const ADVANCES: u32 = 64;

/// A rod over a step: its ends move along straight lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingCapsule {
    /// Number of the tool that it is a part of.
    pub tool: u32,
    /// Number of the part.
    pub part: u32,
    /// Coefficient of friction.
    pub friction: f64,
    /// Where it is at the beginning.
    pub start: Capsule,
    /// Where it is at the end.
    pub end: Capsule,
}

impl MovingCapsule {
    /// The box of all that it sweeps.
    pub(super) fn bounds(&self) -> (Point, Point) {
        let (a, b) = (self.start, self.end);
        let reach = Point::splat(a.radius.max(b.radius));
        let (low, high) = (a.from.min(a.to).min(b.from.min(b.to)), a.from.max(a.to).max(b.from.max(b.to)));
        (low - reach, high + reach)
    }

    /// How far it goes [m].
    pub(crate) fn way(&self) -> f64 {
        (self.end.from - self.start.from).norm().max((self.end.to - self.start.to).norm())
    }

    /// A point of its axis at the beginning and at the end.
    pub(super) fn axis(&self, along: f64) -> (Point, Point) {
        let at = |capsule: &Capsule| capsule.from + (capsule.to - capsule.from) * along;
        (at(&self.start), at(&self.end))
    }
}

/// Where and how a triangle and a rod touch in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touch {
    pub(super) weights: [f64; 3],
    pub(super) along: f64,
    /// From the rod to the tissue.
    pub(super) normal: Point,
}

/// The first touch of a triangle, given by its corners at the beginning and at the end, and a rod. None where they stay apart, or
/// where the rod is on the inner side of the triangle.
///
/// Conservative advancement: nothing that moves relatively by L in the step can close a distance in less than distance/L of it.
///
/// Source: Mirtich, Impulse-based dynamic simulation of rigid body systems (1996), section 2.3.
pub(super) fn first_touch(start: &[Point; 3], end: &[Point; 3], rod: &MovingCapsule) -> Option<Touch> {
    let relative = |i: usize| {
        let way = end[i] - start[i];
        (way - (rod.end.from - rod.start.from)).norm().max((way - (rod.end.to - rod.start.to)).norm())
    };
    let fastest = relative(0).max(relative(1)).max(relative(2));
    let radius = rod.start.radius;
    let near = radius * (1.0 + MARGIN);
    let mut time = 0.0;
    for advance in 0..ADVANCES {
        let at = |a: Point, b: Point| a + (b - a) * time;
        let corners = [at(start[0], end[0]), at(start[1], end[1]), at(start[2], end[2])];
        let (from, to) = (at(rod.start.from, rod.end.from), at(rod.start.to, rod.end.to));
        let closest = closest_to_segment(&corners, from, to);
        let distance = closest.way.norm();
        if distance <= near || advance + 1 == ADVANCES {
            return touch_from_outside(&corners, from, to, &closest, distance);
        }
        time += (distance - radius) / fastest;
        // Not a number where nothing moves: apart, then, for good.
        if time.is_nan() || time > 1.0 {
            return None;
        }
    }
    None
}

fn touch_from_outside(corners: &[Point; 3], from: Point, to: Point, closest: &Closest, distance: f64) -> Option<Touch> {
    let outward = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let axis = from + (to - from) * closest.along;
    if outward.dot(axis - corners[0]) < 0.0 {
        return None;
    }
    let normal = if distance > 0.0 { closest.way / distance } else { -outward.normalized()? };
    Some(Touch { weights: closest.weights, along: closest.along, normal })
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Point; 3] = [Point::new(-1.0, -1.0, 0.0), Point::new(1.0, -1.0, 0.0), Point::new(0.0, 1.0, 0.0)];

    fn rod(from: f64, to: f64, radius: f64) -> MovingCapsule {
        let at =
            |height: f64| Capsule { from: Point::new(-3.0, 0.1, height), to: Point::new(3.0, 0.1, height), radius };
        MovingCapsule { tool: 0, part: 0, friction: 0.0, start: at(from), end: at(to) }
    }

    #[test]
    fn a_thin_rod_that_jumps_through_a_triangle_in_one_step_touches_it() {
        let touch = first_touch(&CORNERS, &CORNERS, &rod(2.0, -50.0, 1e-3)).unwrap();
        assert!((touch.normal - Point::new(0.0, 0.0, -1.0)).norm() < 1e-9);
    }

    #[test]
    fn a_rod_that_stops_short_does_not_touch() {
        assert_eq!(first_touch(&CORNERS, &CORNERS, &rod(2.0, 0.11, 0.1)), None);
        // Nearer than the margin at the beginning, it is known before it closes.
        assert!(first_touch(&CORNERS, &CORNERS, &rod(0.104, 0.104, 0.1)).is_some());
    }

    #[test]
    fn a_triangle_that_flies_along_is_not_touched() {
        let end = CORNERS.map(|corner| corner - Point::new(0.0, 0.0, 52.0));
        assert_eq!(first_touch(&CORNERS, &end, &rod(2.0, -50.0, 1e-3)), None);
    }

    #[test]
    fn a_rod_inside_the_tissue_may_leave_it() {
        assert_eq!(first_touch(&CORNERS, &CORNERS, &rod(-2.0, 50.0, 1e-3)), None);
    }
}
