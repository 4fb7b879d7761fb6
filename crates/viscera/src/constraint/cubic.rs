//! The real root of a cubic that is nearest to zero.

/// Steps of Newton's method from zero, and steps that halve a bracket where it goes astray.
const NEWTON_STEPS: usize = 60;
const HALVINGS: usize = 1100;
/// Newton steps that polish a root.
const POLISH_STEPS: usize = 4;

/// The real t of least size with c0 + c1 t + c2 t² + c3 t³ = 0; none if there is no real one.
///
/// One root is found by Newton's method from zero, or between bounds; the other two follow from the quadratic that is left once
/// it is divided out, and the nearest of all is polished.
pub(super) fn least_root(c: [f64; 4]) -> Option<f64> {
    let [c0, c1, c2, c3] = c;
    if c0 == 0.0 {
        return Some(0.0);
    }
    let Some(first) = newton(c).or_else(|| between_bounds(c)) else { return least_of(quadratic(c2, c1, c0), c) };
    let (b1, b2) = (c2 + c3 * first, c3);
    least_of([Some(first), None].into_iter().chain(quadratic(b2, b1, c1 + b1 * first)), c)
}

fn value(c: [f64; 4], t: f64) -> f64 {
    ((c[3] * t + c[2]) * t + c[1]) * t + c[0]
}

fn slope(c: [f64; 4], t: f64) -> f64 {
    (3.0 * c[3] * t + 2.0 * c[2]) * t + c[1]
}

/// What rounding leaves of a value that is nothing.
fn noise(c: [f64; 4], t: f64) -> f64 {
    4.0 * f64::EPSILON * (((c[3] * t).abs() + c[2].abs()) * t * t + (c[1] * t).abs() + c[0].abs())
}

fn newton(c: [f64; 4]) -> Option<f64> {
    let mut t = 0.0;
    for _ in 0..NEWTON_STEPS {
        let f = value(c, t);
        if !f.is_finite() {
            return None;
        }
        if f.abs() <= noise(c, t) {
            return Some(t);
        }
        t -= f / slope(c, t);
    }
    None
}

/// Every real root of a cubic lies within 1 + max |c_i/c3| of zero, where its two ends have opposite signs.
fn between_bounds(c: [f64; 4]) -> Option<f64> {
    let bound = 1.0 + c[..3].iter().map(|c_i| (c_i / c[3]).abs()).fold(0.0, f64::max);
    let (mut low, mut high) = (-bound, bound);
    if !bound.is_finite() || value(c, low) * value(c, high) > 0.0 {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle == low || middle == high {
            break;
        }
        let same = (value(c, middle) > 0.0) == (value(c, low) > 0.0);
        *(if same { &mut low } else { &mut high }) = middle;
    }
    Some(0.5 * (low + high))
}

/// The real roots of a t² + b t + c, without cancellation.
fn quadratic(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return [None, None];
    }
    let sum = -0.5 * (b + discriminant.sqrt().copysign(b));
    [sum / a, c / sum].map(|root| root.is_finite().then_some(root))
}

fn least_of(roots: impl IntoIterator<Item = Option<f64>>, c: [f64; 4]) -> Option<f64> {
    let polished = |mut t: f64| {
        for _ in 0..POLISH_STEPS {
            let change = value(c, t) / slope(c, t);
            if change.is_finite() {
                t -= change;
            }
        }
        t
    };
    let nearest = roots.into_iter().flatten().min_by(|a, b| a.abs().total_cmp(&b.abs()));
    nearest.map(polished).filter(|t| t.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// k (t − a)(t − b)(t − c), multiplied out.
    fn with_roots(k: f64, a: f64, b: f64, c: f64) -> [f64; 4] {
        [-k * a * b * c, k * (a * b + b * c + c * a), -k * (a + b + c), k]
    }

    #[test]
    fn of_three_real_roots_the_nearest_to_zero_is_found() {
        for k in [1.0, -3e-9, 7e12] {
            for [a, b, c] in [[1.0, -2.0, 5.0], [-0.3, 40.0, 41.0], [1e-9, 1.0, -1.0], [-4.0, 6.0, -1e5]] {
                let root = least_root(with_roots(k, a, b, c)).unwrap();
                assert!((root - a).abs() <= 1e-12 * a.abs(), "{root} for {a}, {b}, {c}");
            }
        }
    }

    #[test]
    fn one_real_root_a_line_and_no_root_at_all() {
        // (t + 3)(t² + 1), whose slope at zero leads away from −3
        assert!((least_root([3.0, 1.0, 3.0, 1.0]).unwrap() + 3.0).abs() < 1e-12);
        // t³ − 2t + 2: Newton's method from zero runs in a circle, 0 → 1 → 0
        let root = least_root([2.0, -2.0, 0.0, 1.0]).unwrap();
        assert!((root + 1.769_292_354_238_631_4).abs() < 1e-12, "{root}");
        assert_eq!(least_root([4.0, -2.0, 0.0, 0.0]), Some(2.0));
        assert_eq!(least_root([0.0, 0.0, 0.0, 0.0]), Some(0.0));
        assert_eq!(least_root([1.0, 0.0, 1.0, 0.0]), None);
        assert_eq!(least_root([1.0, 0.0, 0.0, 0.0]), None);
    }
}
