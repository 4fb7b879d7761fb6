//! Closest points of simple shapes.

use crate::mesh::Point;

/// Where a triangle and a segment are closest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Closest {
    /// Barycentric weights of the point on the triangle; exactly 0 for a corner that has no part in it.
    pub(super) weights: [f64; 3],
    /// How far along the segment, 0 to 1.
    pub(super) along: f64,
    /// From the segment to the triangle [m].
    pub(super) way: Point,
}

/// The closest points of a triangle and a segment.
///
/// They are the crossing if there is one; otherwise an end of the segment and a point of the triangle, or points of the segment
/// and of an edge.
pub(super) fn closest_to_segment(corners: &[Point; 3], from: Point, to: Point) -> Closest {
    let of = |weights: [f64; 3], along: f64| {
        let [a, b, c] = *corners;
        let way = a * weights[0] + b * weights[1] + c * weights[2] - from - (to - from) * along;
        Closest { weights, along, way }
    };
    if let Some((weights, along)) = crossing(corners, from, to) {
        return of(weights, along);
    }
    let mut best = of(weights_of_closest(corners, from), 0.0);
    let mut offer = |candidate: Closest| {
        if candidate.way.squared_norm() < best.way.squared_norm() {
            best = candidate;
        }
    };
    offer(of(weights_of_closest(corners, to), 1.0));
    for i in 0..3 {
        let (i, j) = (i, (i + 1) % 3);
        let (s, t) = closest_of_segments(corners[i], corners[j], from, to);
        let mut weights = [0.0; 3];
        (weights[i], weights[j]) = (1.0 - s, s);
        offer(of(weights, t));
    }
    best
}

/// Where a segment passes through a triangle: weights, and how far along.
fn crossing(&[a, b, c]: &[Point; 3], from: Point, to: Point) -> Option<([f64; 3], f64)> {
    let normal = (b - a).cross(c - a);
    let (before, after) = (normal.dot(from - a), normal.dot(to - a));
    if before * after > 0.0 || before == after {
        return None;
    }
    let along = before / (before - after);
    let place = from + (to - from) * along;
    let part = |u: Point, v: Point| (u - place).cross(v - place).dot(normal);
    let parts = [part(b, c), part(c, a), part(a, b)];
    let whole = normal.squared_norm();
    (parts.iter().all(|&part| part >= 0.0) && whole > 0.0).then(|| (parts.map(|part| part / whole), along))
}

/// Distance of a place to a triangle [m].
pub(crate) fn distance_to_triangle(corners: &[Point; 3], place: Point) -> f64 {
    let [a, b, c] = *corners;
    let [u, v, w] = weights_of_closest(corners, place);
    (a * u + b * v + c * w - place).norm()
}

/// Barycentric weights of the point of a triangle that is closest to a place.
///
/// Source: Ericson, Real-Time Collision Detection (2005), section 5.1.5.
pub(super) fn weights_of_closest(&[a, b, c]: &[Point; 3], place: Point) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, place - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = place - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let on_c = d1 * d4 - d3 * d2;
    if on_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let s = if d1 > d3 { d1 / (d1 - d3) } else { 0.0 };
        return [1.0 - s, s, 0.0];
    }
    let cp = place - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let on_b = d5 * d2 - d1 * d6;
    if on_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let s = if d2 > d6 { d2 / (d2 - d6) } else { 0.0 };
        return [1.0 - s, 0.0, s];
    }
    let on_a = d3 * d6 - d5 * d4;
    if on_a <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let length = (d4 - d3) + (d5 - d6);
        let s = if length > 0.0 { (d4 - d3) / length } else { 0.0 };
        return [0.0, 1.0 - s, s];
    }
    let sum = on_a + on_b + on_c;
    [on_a / sum, on_b / sum, on_c / sum]
}

/// How far along each of two segments, degenerate ones included, their closest points are, 0 to 1.
///
/// Source: Ericson, Real-Time Collision Detection (2005), section 5.1.9.
pub(super) fn closest_of_segments(p1: Point, q1: Point, p2: Point, q2: Point) -> (f64, f64) {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, f) = (d1.squared_norm(), d2.squared_norm(), d2.dot(r));
    let clamp = |value: f64| value.clamp(0.0, 1.0);
    if a == 0.0 {
        return (0.0, if e == 0.0 { 0.0 } else { clamp(f / e) });
    }
    let c = d1.dot(r);
    if e == 0.0 {
        return (clamp(-c / a), 0.0);
    }
    let b = d1.dot(d2);
    let denominator = a * e - b * b;
    let s = if denominator > 0.0 { clamp((b * f - c * e) / denominator) } else { 0.0 };
    let t = (b * s + f) / e;
    if t < 0.0 {
        (clamp(-c / a), 0.0)
    } else if t > 1.0 {
        (clamp((b - c) / a), 1.0)
    } else {
        (s, t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The smallest distance over a fine net of both shapes: slow, and always a little too large.
    fn sampled(corners: &[Point; 3], from: Point, to: Point) -> f64 {
        let mut least = f64::INFINITY;
        for i in 0..=60 {
            for j in 0..=60 - i {
                let (u, v) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                let place = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                let along = ((place - from).dot(to - from) / (to - from).squared_norm()).clamp(0.0, 1.0);
                least = least.min((place - from - (to - from) * along).norm());
            }
        }
        least
    }

    #[test]
    fn a_segment_and_a_triangle_are_as_close_as_a_fine_net_says() {
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        for _ in 0..300 {
            let mut point = || Point::new(random(), random(), random());
            let (corners, from, to) = ([point(), point(), point()], point(), point());
            let closest = closest_to_segment(&corners, from, to);
            let (found, net) = (closest.way.norm(), sampled(&corners, from, to));
            // The longest way from a place to the net: two thirds of a mesh of the net, 1/60 of an edge of at most 2√3.
            assert!(found <= net + 1e-12 && net - found < 0.04, "{found} and {net}");
            assert!((closest.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(closest.weights.iter().all(|&weight| weight >= 0.0));
        }
    }
}
