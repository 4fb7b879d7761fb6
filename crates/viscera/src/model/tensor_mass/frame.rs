//! The frame that follows a body as it moves and turns, in which its displacements are as small as they can be.
//!
//! u' = Rᵀ (x − x̄) − (X − X̄),   with x̄ and X̄ the mean places now and at rest,   R = polar(Σ x (X − X̄)ᵀ)
//!
//! An objective law gives f(X + u) = R f(X + u'), for any rotation R and any shift. The polynomials of the displacements lose
//! (|u|/h)³ roundings, h the size of a cell: in single precision, and by a hundred cells, some per cent of the forces of a
//! body that has only moved. In its own frame it loses none.

use crate::math::rotation::svd;
use crate::math::{Mat3, Scalar, Vec3, dispatch, dispatch_level};
use crate::model::BlockSink;

/// Where a body is as a whole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<T> {
    centre: Vec3<T>,
    turn: Mat3<T>,
}

impl<T: Scalar> Frame<T> {
    /// The frame that moves along with nodes now at `x` and does not turn: for forces that turning changes.
    pub(crate) fn along<U: Scalar>(x: &[Vec3<U>]) -> Self {
        let first = x.first().map_or(Vec3::ZERO, |x| x.cast::<f64>());
        let sum = dispatch!(dispatch_level(), _simd => sum_from(first, x));
        let centre = first + sum / x.len().max(1) as f64;
        Self { centre: centre.cast(), turn: Mat3::IDENTITY }
    }

    /// The frame that also turns with the nodes, whose places at rest, counted from their mean, are `arms`.
    pub(super) fn following<U: Scalar>(x: &[Vec3<U>], arms: impl Iterator<Item = Vec3<T>>) -> Self {
        let Self { centre, .. } = Self::along(x);
        let mut covariance = Mat3::<f64>::ZERO;
        for (x, arm) in x.iter().zip(arms) {
            let (from_centre, arm) = ((x.cast::<T>() - centre).cast::<f64>(), arm.cast::<f64>());
            for (column, component) in covariance.columns.iter_mut().zip(arm.to_array()) {
                *column += from_centre * component;
            }
        }
        Self { centre, turn: svd(&covariance).rotation().cast() }
    }

    /// Displacement seen from the frame of a node at `x`.
    #[inline(always)]
    pub(crate) fn displacement(&self, x: Vec3<T>, arm: Vec3<T>) -> Vec3<T> {
        self.turn.transpose_mul(x - self.centre) - arm
    }

    /// Rows of the displacements of nodes at `x`, and of weights of 1.
    #[inline(always)]
    pub(crate) fn write_displacements(&self, x: &[Vec3<T>], arms: &[Vec3<T>], rows: &mut [[T; 4]]) {
        for (row, (x, arm)) in rows.iter_mut().zip(x.iter().zip(arms)) {
            let u = self.displacement(*x, *arm);
            *row = [u.x, u.y, u.z, T::ONE];
        }
    }

    /// Makes directions in the frame of directions in the world.
    pub(super) fn enter(&self, directions: &mut [[T; 4]]) {
        dispatch!(dispatch_level(), _simd => turn(directions, &self.turn.transpose()));
    }

    /// Makes forces in the world of forces in the frame.
    pub(super) fn leave(&self, forces: &mut [[T; 4]]) {
        dispatch!(dispatch_level(), _simd => turn(forces, &self.turn));
    }

    /// A sink of blocks in the frame that gives them to `sink` in the world: R K' Rᵀ.
    pub(super) fn leaving<'a>(&self, sink: &'a mut dyn BlockSink<T>) -> Leaving<'a, T> {
        Leaving { turn: self.turn, sink }
    }
}

/// Turns the blocks that go through it.
pub(super) struct Leaving<'a, T> {
    turn: Mat3<T>,
    sink: &'a mut dyn BlockSink<T>,
}

impl<T: Scalar> BlockSink<T> for Leaving<'_, T> {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        self.sink.add(row, column, self.turn * block * self.turn.transpose());
    }

    fn keeps_diagonal_only(&self) -> bool {
        self.sink.keeps_diagonal_only()
    }
}

/// Σ (x − `first`). In several sums, as each would wait for the one before it: a twentieth of linear forces.
#[inline(always)]
fn sum_from<T: Scalar>(first: Vec3<f64>, x: &[Vec3<T>]) -> Vec3<f64> {
    let mut sums = [Vec3::ZERO; 8];
    for x in x.chunks(sums.len()) {
        for (sum, x) in sums.iter_mut().zip(x) {
            *sum += x.cast::<f64>() - first;
        }
    }
    sums.into_iter().fold(Vec3::ZERO, |all, sum| all + sum)
}

#[inline(always)]
fn turn<T: Scalar>(rows: &mut [[T; 4]], by: &Mat3<T>) {
    for row in rows {
        let turned = *by * Vec3::new(row[0], row[1], row[2]);
        *row = [turned.x, turned.y, turned.z, row[3]];
    }
}
