//! Sums and products of nodal arrays, on all threads.
//!
//! The compiler makes whole registers of plain loops; of sums only where it need not keep their order, so that those are kept
//! for eight nodes apart.

use crate::executor::{Executor, NODE_BLOCK, NodeBlocks, ReadBlocks, node_blocks};
use crate::math::{Lanes, MAX_LANES, Part, Real, Scalar, Simd, Vec3, dispatch, dispatch_level};

/// Nodes at a time, and their numbers.
const NODES: usize = 8;
const NUMBERS: usize = 3 * NODES;

/// a·b over all nodes. Blocks of nodes add up in the precision of the vectors, their sums in double precision.
pub(crate) fn dot<T: Scalar>(executor: &Executor, a: &[Vec3<T>], b: &[Vec3<T>]) -> f64 {
    let work = |_, (ReadBlocks(a), ReadBlocks(b)): (ReadBlocks<'_, Vec3<T>>, ReadBlocks<'_, Vec3<T>>)| dispatch!(dispatch_level(), _simd => dot_of(a, b));
    executor.fold(node_blocks(a.len()), (ReadBlocks(a), ReadBlocks(b)), &work, &|a, b| a + b).unwrap_or(0.0)
}

/// x ← x + s p and r ← r − s q: a step of the conjugate gradient.
pub(crate) fn step_along<T: Scalar>(
    executor: &Executor,
    (x, r): (&mut [Vec3<T>], &mut [Vec3<T>]),
    s: T,
    (p, q): (&[Vec3<T>], &[Vec3<T>]),
) {
    let parts = node_blocks(x.len());
    let data = ((NodeBlocks(x), NodeBlocks(r)), (ReadBlocks(p), ReadBlocks(q)));
    let work = |_, ((NodeBlocks(x), NodeBlocks(r)), (ReadBlocks(p), ReadBlocks(q))): Pairs<'_, T>| {
        dispatch!(dispatch_level(), _simd => {
            combine_into(x, T::ONE, s, p);
            combine_into(r, T::ONE, -s, q);
        });
    };
    executor.each(parts, data, &work);
}

/// Two arrays to write and two to read.
type Pairs<'a, T> =
    ((NodeBlocks<'a, Vec3<T>>, NodeBlocks<'a, Vec3<T>>), (ReadBlocks<'a, Vec3<T>>, ReadBlocks<'a, Vec3<T>>));

/// y ← m x, with a number m for each node.
pub(crate) fn set_weighted<T: Scalar>(executor: &Executor, y: &mut [Vec3<T>], m: &[T], x: &[Vec3<T>]) {
    let work = |block: usize, (NodeBlocks(y), ReadBlocks(x)): (NodeBlocks<'_, Vec3<T>>, ReadBlocks<'_, Vec3<T>>)| {
        let m = &m[block * NODE_BLOCK..];
        dispatch!(dispatch_level(), _simd => y.iter_mut().zip(x).zip(m).for_each(|((y, &x), &m)| *y = x * m));
    };
    executor.each(node_blocks(x.len()), (NodeBlocks(y), ReadBlocks(x)), &work);
}

/// y ← y + m x, with a number m for each node.
pub(crate) fn add_weighted<T: Scalar>(executor: &Executor, y: &mut [Vec3<T>], m: &[T], x: &[Vec3<T>]) {
    let work = |block: usize, (NodeBlocks(y), ReadBlocks(x)): (NodeBlocks<'_, Vec3<T>>, ReadBlocks<'_, Vec3<T>>)| {
        let m = &m[block * NODE_BLOCK..];
        dispatch!(dispatch_level(), _simd => y.iter_mut().zip(x).zip(m).for_each(|((y, &x), &m)| *y = x.mul_add(m, *y)));
    };
    executor.each(node_blocks(x.len()), (NodeBlocks(y), ReadBlocks(x)), &work);
}

/// a·b over a block of nodes.
#[inline(always)]
pub(crate) fn dot_of<T: Scalar>(a: &[Vec3<T>], b: &[Vec3<T>]) -> f64 {
    let ((a, rest_of_a), (b, rest_of_b)) = (a.as_chunks::<NODES>(), b.as_chunks::<NODES>());
    let mut sums = [T::ZERO; NUMBERS];
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (numbers(a), numbers(b));
        for i in 0..NUMBERS {
            sums[i] = a[i].mul_add(b[i], sums[i]);
        }
    }
    // Taken one by one, they would be kept one by one: a sum took three times as long.
    let (thirds, _) = sums.as_chunks::<NODES>();
    let sums: [T; NODES] = std::array::from_fn(|i| thirds[0][i] + thirds[1][i] + thirds[2][i]);
    let rest: f64 = rest_of_a.iter().zip(rest_of_b).map(|(&a, &b)| a.dot(b).to_f64()).sum();
    sums.into_iter().fold(rest, |sum, number| sum + number.to_f64())
}

/// The same of rows of four numbers.
#[inline(always)]
pub(crate) fn dot_of_rows<T: Scalar, S: Simd>(simd: S, a: &[[T; 4]], b: &[[T; 4]]) -> f64 {
    const SUMS: usize = 4;
    // Halves of a block on every processor, for the same bits.
    let (lanes, part) = (T::Half::<S>::COUNT, Part::first(simd));
    let (mut a, mut b) = (a.as_flattened().chunks_exact(SUMS * lanes), b.as_flattened().chunks_exact(SUMS * lanes));
    let mut sums = [T::Half::<S>::splat(simd, T::ZERO); SUMS];
    for (a, b) in a.by_ref().zip(b.by_ref()) {
        for i in 0..SUMS {
            let (a, b) = (T::Half::<S>::load(part, &a[i * lanes..]), T::Half::<S>::load(part, &b[i * lanes..]));
            sums[i] = a.mul_add(b, sums[i]);
        }
    }
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(&a, &b)| (a * b).to_f64()).sum();
    let mut numbers = [T::ZERO; MAX_LANES];
    ((sums[0] + sums[1]) + (sums[2] + sums[3])).store(part, &mut numbers);
    numbers.into_iter().fold(rest, |sum, number| sum + number.to_f64())
}

/// y ← s y + t x.
#[inline(always)]
pub(super) fn combine_into<T: Scalar>(y: &mut [Vec3<T>], s: T, t: T, x: &[Vec3<T>]) {
    for (y, &x) in y.iter_mut().zip(x) {
        *y = x.mul_add(t, *y * s);
    }
}

/// The numbers of eight vectors.
#[inline(always)]
fn numbers<T: Scalar>(vectors: &[Vec3<T>; NODES]) -> [T; NUMBERS] {
    let mut numbers = [T::ZERO; NUMBERS];
    for node in 0..NODES {
        numbers[3 * node] = vectors[node].x;
        numbers[3 * node + 1] = vectors[node].y;
        numbers[3 * node + 2] = vectors[node].z;
    }
    numbers
}
