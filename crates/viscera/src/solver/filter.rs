use crate::math::{Scalar, Vec3};

/// Which directions of a node's unknown the equations decide; the others are prescribed.
///
/// Source: Baraff, Witkin, Large steps in cloth simulation (1998), section 5.1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Filter<T> {
    /// All three: S = I.
    #[default]
    Free,
    /// Those in the plane across this unit vector: S = I − p pᵀ.
    Plane(Vec3<T>),
    /// The one across these two orthogonal unit vectors: S = I − p pᵀ − q qᵀ.
    Line(Vec3<T>, Vec3<T>),
    /// None: S = 0.
    Held,
}

impl<T: Scalar> Filter<T> {
    /// S v: the part of `v` that the equations decide.
    #[inline]
    pub fn apply(&self, v: Vec3<T>) -> Vec3<T> {
        match *self {
            Self::Free => v,
            Self::Plane(p) => v - p * p.dot(v),
            Self::Line(p, q) => v - p * p.dot(v) - q * q.dot(v),
            Self::Held => Vec3::ZERO,
        }
    }

    /// The same in another precision.
    pub fn cast<U: Scalar>(&self) -> Filter<U> {
        match self {
            Self::Free => Filter::Free,
            Self::Plane(p) => Filter::Plane(p.cast()),
            Self::Line(p, q) => Filter::Line(p.cast(), q.cast()),
            Self::Held => Filter::Held,
        }
    }

    /// S v + (I − S) prescribed.
    #[inline]
    pub fn merge(&self, v: Vec3<T>, prescribed: Vec3<T>) -> Vec3<T> {
        match self {
            Self::Free => v,
            Self::Held => prescribed,
            _ => self.apply(v) + prescribed - self.apply(prescribed),
        }
    }
}
