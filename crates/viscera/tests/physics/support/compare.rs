//! Comparisons relative to the largest entry: components that ought to vanish have no scale of their own.

use viscera::math::{Scalar, Vec3};

/// Largest norm of a set of vectors.
pub(crate) fn largest<T: Scalar>(vectors: &[Vec3<T>]) -> f64 {
    vectors.iter().map(|v| v.cast::<f64>().norm()).fold(0.0, f64::max)
}

/// Whether every pair of vectors differs by at most `tolerance` times `scale`; false where one is NaN.
pub(crate) fn near<T: Scalar, U: Scalar>(actual: &[Vec3<T>], expected: &[Vec3<U>], tolerance: f64, scale: f64) -> bool {
    actual.len() == expected.len()
        && actual.iter().zip(expected).all(|(a, e)| (a.cast::<f64>() - e.cast()).norm() <= tolerance * scale)
}

/// Fails unless the vectors agree to `tolerance`, relative to the largest of `expected`.
#[track_caller]
pub(crate) fn assert_near<T: Scalar, U: Scalar>(
    actual: &[Vec3<T>],
    expected: &[Vec3<U>],
    tolerance: f64,
    what: impl std::fmt::Display,
) {
    let scale = largest(expected);
    let error = actual.iter().zip(expected).map(|(a, e)| (a.cast::<f64>() - e.cast()).norm()).fold(0.0, f64::max);
    assert!(near(actual, expected, tolerance, scale), "{what}: off by {:.2e} of the largest, {scale:e}", error / scale);
}

/// Fails unless two numbers agree to `tolerance`, relative to the second.
#[track_caller]
pub(crate) fn assert_close(actual: f64, expected: f64, tolerance: f64, what: impl std::fmt::Display) {
    let error = (actual - expected).abs() / expected.abs();
    assert!(error <= tolerance, "{what}: {actual:e} instead of {expected:e}, off by {error:.2e}");
}
