//! The blocks on the diagonal, for the preconditioner of a step: a quadratic form of each gradient.
//!
//! K_bb = V Σ_kl g_k g_l ∂²ψ/∂F_ik∂F_jl: six forms in k and l to a point, for i ≤ j, of which every node around asks one value each.

use std::ops::Range;

use super::batch::{Batch, Point};
use super::points::NodalPoints;
use super::tangent::load_deformation;
use crate::material::LawFamily;
use crate::math::{Lanes, MAX_LANES, Mat3, Part, Real, Scalar, Simd, Sym3, Vec3, dispatch, dispatch_level};
use crate::model::Scratch;
use crate::model::lane_vector::{Kept, keep, load, nothing, take_up};
use crate::model::sections::SectionScratch;

impl<T: Scalar, L: LawFamily> NodalPoints<T, L> {
    pub(super) fn add_nodal_diagonal(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Mat3<T>]) {
        self.with_deformations(x, scratch, |points, scratch| {
            let rows = points.section_rows();
            let SectionScratch { linearization, mut sums, .. } = scratch.sections(rows);
            points.sections.add_blocks(&mut sums, out, &|batches, rows| {
                dispatch!(dispatch_level(), simd => points.add_diagonal_with(simd, linearization, batches, rows));
            });
        });
    }

    #[inline(always)]
    fn add_diagonal_with<S: Simd>(&self, simd: S, kept: &[T], batches: Range<usize>, out: &mut [[T; 4]]) {
        let mut kept_forms = [nothing(); 12];
        for number in batches {
            for part in Part::all::<T>(simd) {
                let zero = T::Lanes::<S>::splat(simd, T::ZERO);
                let point = Point::<T::Lanes<S>>::load::<T, S, L>(part, self.constants.block(number));
                let forms = forms::<_, L>(&point, &load_deformation::<T, S>(part, kept, number), zero);
                for i in 0..6 {
                    let Sym3 { xx, yy, zz, xy, xz, yz } = forms[i];
                    keep(simd, Vec3::new(xx, yy, zz), &mut kept_forms[2 * i]);
                    keep(simd, Vec3::new(xy, xz, yz), &mut kept_forms[2 * i + 1]);
                }
                for half in part.halves::<T>() {
                    spread(half, self.batch(number), &kept_forms, out);
                }
            }
        }
    }
}

/// Adds what forms make of the gradients of half a batch, and its springs. The forms are two vectors each.
#[inline(always)]
fn spread<T: Scalar, S: Simd>(half: Part<S>, batch: Batch<'_, T>, kept: &[Kept<T>; 12], out: &mut [[T; 4]]) {
    let zero = T::Half::<S>::splat(half.simd, T::ZERO);
    let mut forms = [Sym3::diagonal(zero); 6];
    for i in 0..6 {
        let (on_axes, apart) = (take_up(half, &kept[2 * i]), take_up(half, &kept[2 * i + 1]));
        let (Vec3 { x: xx, y: yy, z: zz }, Vec3 { x: xy, y: xz, z: yz }) = (on_axes, apart);
        forms[i] = Sym3 { xx, yy, zz, xy, xz, yz };
    }
    // All springs of a point hold the point itself; the others have theirs from points of their own.
    let mut spring = zero;
    for (_, _, one) in batch.entries() {
        spring += T::Half::<S>::load(half, one);
    }
    let others = batch.rows.chunks_exact(T::LANES).zip(batch.gradients.chunks_exact(3 * T::LANES));
    for (rows, gradient) in others {
        let form = Sym3::square(load::<T, S, T::Half<S>>(half, gradient));
        // One by one: `map` of six is a call, which loses the instruction set (a tenth of a step).
        let mut values = [zero; 6];
        for i in 0..6 {
            values[i] = forms[i].contract(form);
        }
        let [xx, yy, zz, xy, xz, yz] = values;
        let on_axes = Vec3::new(xx, yy, zz) + Vec3::splat(spring);
        spring = zero;
        add_rows::<T, S>(half, [on_axes, Vec3::new(xy, xz, yz)], rows, out);
    }
}

/// The forms of xx, yy, zz, xy, xz, yz at F̄.
#[inline(always)]
fn forms<R: Real, L: LawFamily>(point: &Point<R>, f: &Mat3<R>, zero: R) -> [Sym3<R>; 6] {
    let mut derivatives = [[*f; 3]; 3];
    for row in 0..3 {
        for column in 0..3 {
            let mut direction = Mat3::diagonal(zero);
            direction.columns[column][row] = zero.like(1.0);
            derivatives[row][column] = point.tangent::<L>(f, &direction);
        }
    }
    [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|(i, j)| {
        let column = |l: usize| derivatives[j][l].columns.map(|stress| stress[i]);
        let [a, b, c] = [0, 1, 2].map(|l| Vec3::from(column(l)));
        Mat3::from_columns(a, b, c).symmetric_part()
    })
}

/// Adds the two rows of a block to those of a node, for each lane.
#[inline(always)]
fn add_rows<T: Scalar, S: Simd>(half: Part<S>, pair: [Vec3<T::Half<S>>; 2], rows: &[u32], out: &mut [[T; 4]]) {
    for (second, numbers) in pair.into_iter().enumerate() {
        let rows = half.of::<T, T::Half<S>, _>(rows);
        let mut places = [0; MAX_LANES];
        for lane in 0..T::Half::<S>::COUNT {
            places[lane] = 2 * rows[lane] + second as u32;
        }
        T::Half::<S>::scatter_add(numbers.to_array(), &places[..T::Half::<S>::COUNT], out);
    }
}
