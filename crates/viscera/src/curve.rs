//! Quantities that change with time, as loads, prescribed motions and paths of instruments do.

use crate::math::Vec3;

/// A value along time: straight lines between given moments, held before the first and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve<V> {
    /// Moments [s], strictly ascending, and values.
    points: Vec<(f64, V)>,
}

/// Why a curve cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// There is no point.
    #[error("a curve needs at least one point (time, value)")]
    Empty,
    /// Time stands still, runs backwards, or is not a number.
    #[error("point {index} of the curve is at {time} s, after {before} s: times must ascend")]
    NotAscending {
        /// Point, from 0.
        index: usize,
        /// Its time [s].
        time: f64,
        /// The time before it [s].
        before: f64,
    },
    /// A time or value is NaN or infinite.
    #[error("point {index} of the curve has a time or value that is not a finite number")]
    NotFinite {
        /// Point, from 0.
        index: usize,
    },
}

/// What a curve can carry.
pub trait CurveValue: Copy {
    /// a + s (b − a).
    fn between(a: Self, b: Self, s: f64) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

impl CurveValue for f64 {
    fn between(a: Self, b: Self, s: f64) -> Self {
        a + s * (b - a)
    }
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}

impl CurveValue for Vec3<f64> {
    fn between(a: Self, b: Self, s: f64) -> Self {
        a + (b - a) * s
    }
    fn is_finite(self) -> bool {
        Vec3::is_finite(self)
    }
}

impl<V: CurveValue> Curve<V> {
    /// The same value at all times.
    pub fn constant(value: V) -> Self {
        Self { points: vec![(0.0, value)] }
    }

    /// Straight lines between points (time [s], value).
    ///
    /// # Errors
    /// [`CurveError`] for no points, times that do not ascend, and numbers that are not finite.
    pub fn piecewise_linear(points: Vec<(f64, V)>) -> Result<Self, CurveError> {
        if points.is_empty() {
            return Err(CurveError::Empty);
        }
        if let Some(index) = points.iter().position(|(time, value)| !(time.is_finite() && value.is_finite())) {
            return Err(CurveError::NotFinite { index });
        }
        if let Some(index) = (1..points.len()).find(|&index| points[index].0 <= points[index - 1].0) {
            return Err(CurveError::NotAscending { index, time: points[index].0, before: points[index - 1].0 });
        }
        Ok(Self { points })
    }

    /// The value at `time` [s].
    pub fn at(&self, time: f64) -> V {
        let next = self.points.partition_point(|&(moment, _)| moment <= time);
        match (next.checked_sub(1).map(|last| self.points[last]), self.points.get(next)) {
            (Some((t0, a)), Some(&(t1, b))) => V::between(a, b, (time - t0) / (t1 - t0)),
            (Some((_, last)), None) => last,
            (None, _) => self.points[0].1,
        }
    }

    /// The points (time [s], value).
    pub fn points(&self) -> &[(f64, V)] {
        &self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_on_the_line_between_neighbours_and_are_held_outside() {
        let curve = Curve::piecewise_linear(vec![(1.0, 0.0), (2.0, 4.0), (4.0, 0.0)]).unwrap();
        for (time, value) in [(0.0, 0.0), (1.0, 0.0), (1.25, 1.0), (2.0, 4.0), (3.0, 2.0), (9.0, 0.0)] {
            assert_eq!(curve.at(time), value, "at {time} s");
        }
    }

    #[test]
    fn times_that_run_backwards_are_refused() {
        let error = Curve::piecewise_linear(vec![(0.0, 1.0), (2.0, 1.0), (1.0, 1.0)]).unwrap_err();
        assert_eq!(error.to_string(), "point 2 of the curve is at 1 s, after 2 s: times must ascend");
        assert_eq!(Curve::<f64>::piecewise_linear(vec![]).unwrap_err(), CurveError::Empty);
        let error = Curve::piecewise_linear(vec![(0.0, f64::NAN)]).unwrap_err();
        assert_eq!(error, CurveError::NotFinite { index: 0 });
    }
}
