//! The derivative of the forces: the means F̄_a are found once for all products at one place.

use std::ops::Range;

use super::batch::{Batch, Point};
use super::points::NodalPoints;
use crate::material::LawFamily;
use crate::math::{Lanes, Mat3, Part, Scalar, Simd, Vec3, baseline, dispatch, dispatch_level};
use crate::model::block_sink::add_block;
use crate::model::lane_vector::{load, nothing};
use crate::model::sections::SectionScratch;
use crate::model::{BlockSink, Scratch};

/// Numbers that a point keeps: F̄ by columns.
const DEFORMATION: usize = 9;

impl<T: Scalar, L: LawFamily> NodalPoints<T, L> {
    pub(super) fn kept_len(&self) -> usize {
        DEFORMATION * self.constants.padded_rows()
    }

    /// Keeps the means at `x`.
    pub(super) fn keep_deformations(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) {
        scratch.start(x);
        let (executor, nodal, kept) = scratch.start_linearization(self.kept_len());
        self.sections.each(executor, kept, DEFORMATION * T::LANES, &|batches, kept| {
            dispatch!(dispatch_level(), simd => self.keep_with(simd, nodal, batches, kept));
        });
    }

    #[inline(always)]
    fn keep_with<S: Simd>(&self, simd: S, x: &[[T; 4]], batches: Range<usize>, kept: &mut [T]) {
        for (number, kept) in batches.zip(kept.chunks_exact_mut(DEFORMATION * T::LANES)) {
            for part in Part::all::<T>(simd) {
                let (f, _) = self.batch(number).around::<S>(part, x);
                for i in 0..DEFORMATION {
                    f.columns[i / 3].to_array()[i % 3].store(part, &mut kept[i * T::LANES..]);
                }
            }
        }
    }

    /// Does `work` with the means at `x`: those that are kept, where there are any.
    pub(super) fn with_deformations(
        &self,
        x: &[Vec3<T>],
        scratch: &mut Scratch<T>,
        work: impl FnOnce(&Self, &mut Scratch<T>),
    ) {
        let was_linearized = scratch.is_linearized;
        if !was_linearized {
            self.keep_deformations(x, scratch);
        }
        work(self, scratch);
        scratch.is_linearized = was_linearized;
    }

    pub(super) fn add_nodal_product(
        &self,
        x: &[Vec3<T>],
        dx: &[Vec3<T>],
        scratch: &mut Scratch<T>,
        out: &mut [Vec3<T>],
    ) {
        self.with_deformations(x, scratch, |points, scratch| {
            scratch.start_direction(dx);
            scratch.clear_forces();
            let rows = points.section_rows();
            let SectionScratch { direction, linearization, mut sums, .. } = scratch.sections(rows);
            points.sections.add(&mut sums, &|batches, rows| {
                dispatch!(dispatch_level(), simd => {
                    points.add_product_with(simd, linearization, direction, batches, rows);
                });
            });
            scratch.finish(out);
        });
    }

    #[inline(always)]
    fn add_product_with<S: Simd>(&self, simd: S, kept: &[T], dx: &[[T; 4]], batches: Range<usize>, out: &mut [[T; 4]]) {
        let mut kept_vectors = [nothing(); 4];
        for number in batches {
            let batch = self.batch(number);
            for part in Part::all::<T>(simd) {
                let point = Point::<T::Lanes<S>>::load::<T, S, L>(part, self.constants.block(number));
                let (df, pull) = batch.around::<S>(part, dx);
                let f = load_deformation::<T, S>(part, kept, number);
                batch.spread::<S>(part, (point.tangent::<L>(&f, &df), pull), &mut kept_vectors, out);
            }
        }
    }

    pub(super) fn add_nodal_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        self.with_deformations(x, scratch, |points, scratch| {
            points.add_blocks_with(baseline(), &scratch.linearization, sink);
        });
    }

    // K_bc = V Σ A:(g_b ⊗ g_c): the law's nine derivatives once, then products with gradients.
    #[inline(always)]
    fn add_blocks_with<S: Simd>(&self, simd: S, kept: &[T], sink: &mut dyn BlockSink<T>) {
        for number in 0..self.starts.len() - 1 {
            for part in Part::all::<T>(simd) {
                self.add_blocks_of::<S>(part, kept, number, sink);
            }
        }
    }

    #[inline(always)]
    fn add_blocks_of<S: Simd>(&self, part: Part<S>, kept: &[T], number: usize, sink: &mut dyn BlockSink<T>) {
        let zero = T::Lanes::<S>::splat(part.simd, T::ZERO);
        let one = T::Lanes::<S>::splat(part.simd, T::ONE);
        let point = Point::<T::Lanes<S>>::load::<T, S, L>(part, self.constants.block(number));
        let f = load_deformation::<T, S>(part, kept, number);
        let Batch { nodes, gradients, springs, .. } = self.batch(number);
        let mut derivatives = [[f; 3]; 3];
        for row in 0..3 {
            for column in 0..3 {
                let mut direction = Mat3::from_columns(Vec3::splat(zero), Vec3::splat(zero), Vec3::splat(zero));
                direction.columns[column][row] = one;
                derivatives[row][column] = point.tangent::<L>(&f, &direction);
            }
        }
        let count = nodes.len() / T::LANES;
        let points = self.constants.rows() - number * T::LANES;
        for c in 0..count {
            let g = load::<T, S, T::Lanes<S>>(part, &gradients[3 * c * T::LANES..]);
            let along = [0, 1, 2].map(|row: usize| {
                let [a, b, c] = derivatives[row];
                a * g.x + b * g.y + c * g.z
            });
            let rows = if sink.keeps_diagonal_only() { c..c + 1 } else { 0..count };
            for b in rows {
                let g = load::<T, S, T::Lanes<S>>(part, &gradients[3 * b * T::LANES..]);
                let [x, y, z] = along.map(|stress| stress * g);
                let block = Mat3::from_columns(x, y, z);
                add_block::<T, S>(part, &block, nodes, [b, c], points, sink);
            }
        }
        self.add_springs::<S>(part, nodes, springs, points, sink);
    }

    /// Springs hold a point to its neighbours: its own row of the matrix, as the neighbours' points have theirs.
    #[inline(always)]
    fn add_springs<S: Simd>(
        &self,
        part: Part<S>,
        nodes: &[u32],
        springs: &[T],
        points: usize,
        sink: &mut dyn BlockSink<T>,
    ) {
        let mut sum = T::Lanes::<S>::splat(part.simd, T::ZERO);
        for (entry, spring) in springs.chunks_exact(T::LANES).enumerate().skip(1) {
            let spring = T::Lanes::<S>::load(part, spring);
            sum += spring;
            if !sink.keeps_diagonal_only() {
                add_block::<T, S>(part, &Mat3::diagonal(-spring), nodes, [0, entry], points, sink);
            }
        }
        add_block::<T, S>(part, &Mat3::diagonal(sum), nodes, [0, 0], points, sink);
    }
}

/// F̄ of the points of a batch.
#[inline(always)]
pub(super) fn load_deformation<T: Scalar, S: Simd>(part: Part<S>, kept: &[T], batch: usize) -> Mat3<T::Lanes<S>> {
    let kept = &kept[batch * DEFORMATION * T::LANES..(batch + 1) * DEFORMATION * T::LANES];
    let column = |i: usize| load::<T, S, T::Lanes<S>>(part, &kept[3 * i * T::LANES..]);
    Mat3::from_columns(column(0), column(1), column(2))
}
