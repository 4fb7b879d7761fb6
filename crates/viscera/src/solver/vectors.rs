//! Sums and products of nodal arrays, on all threads.
//!
//! Eight nodes at a time are as many numbers in a row as the compiler makes whole registers of.

use fearless_simd::dispatch;

use crate::executor::{Executor, NODE_BLOCK, NodeBlocks, ReadBlocks, node_blocks};
use crate::math::{Scalar, Vec3, dispatch_level};

/// Nodes at a time, and their numbers.
const NODES: usize = 8;
const NUMBERS: usize = 3 * NODES;

/// a·b over all nodes. Blocks of nodes add up in the precision of the vectors, their sums in double precision.
pub(crate) fn dot<T: Scalar>(executor: &Executor, a: &[Vec3<T>], b: &[Vec3<T>]) -> f64 {
    let work = |_, (ReadBlocks(a), ReadBlocks(b)): (ReadBlocks<'_, Vec3<T>>, ReadBlocks<'_, Vec3<T>>)| dispatch!(dispatch_level(), _simd => dot_of(a, b));
    executor.fold(node_blocks(a.len()), (ReadBlocks(a), ReadBlocks(b)), &work, &|a, b| a + b).unwrap_or(0.0)
}

/// y ← y + s x.
pub(crate) fn add_scaled<T: Scalar>(executor: &Executor, y: &mut [Vec3<T>], s: T, x: &[Vec3<T>]) {
    let work = |_, (NodeBlocks(y), ReadBlocks(x)): (NodeBlocks<'_, Vec3<T>>, ReadBlocks<'_, Vec3<T>>)| {
        dispatch!(dispatch_level(), _simd => combine_into(y, T::ONE, s, x));
    };
    executor.each(node_blocks(x.len()), (NodeBlocks(y), ReadBlocks(x)), &work);
}

/// y ← s y + x.
pub(crate) fn scale_and_add<T: Scalar>(executor: &Executor, y: &mut [Vec3<T>], s: T, x: &[Vec3<T>]) {
    let work = |_, (NodeBlocks(y), ReadBlocks(x)): (NodeBlocks<'_, Vec3<T>>, ReadBlocks<'_, Vec3<T>>)| {
        dispatch!(dispatch_level(), _simd => combine_into(y, s, T::ONE, x));
    };
    executor.each(node_blocks(x.len()), (NodeBlocks(y), ReadBlocks(x)), &work);
}

/// y ← s y + m x, with a number m for each node.
pub(crate) fn scale_and_add_masses<T: Scalar>(
    executor: &Executor,
    y: &mut [Vec3<T>],
    s: T,
    masses: &[T],
    x: &[Vec3<T>],
) {
    let work = |block: usize, (NodeBlocks(y), ReadBlocks(x)): (NodeBlocks<'_, Vec3<T>>, ReadBlocks<'_, Vec3<T>>)| {
        let masses = &masses[block * NODE_BLOCK..];
        for ((y, &x), &mass) in y.iter_mut().zip(x).zip(masses) {
            *y = x.mul_add(mass, *y * s);
        }
    };
    executor.each(node_blocks(x.len()), (NodeBlocks(y), ReadBlocks(x)), &work);
}

#[inline(always)]
fn dot_of<T: Scalar>(a: &[Vec3<T>], b: &[Vec3<T>]) -> f64 {
    let ((a, rest_of_a), (b, rest_of_b)) = (a.as_chunks::<NODES>(), b.as_chunks::<NODES>());
    let mut sums = [T::ZERO; NUMBERS];
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (numbers(a), numbers(b));
        for i in 0..NUMBERS {
            sums[i] = a[i].mul_add(b[i], sums[i]);
        }
    }
    let rest: f64 = rest_of_a.iter().zip(rest_of_b).map(|(&a, &b)| a.dot(b).to_f64()).sum();
    sums.into_iter().fold(rest, |sum, number| sum + number.to_f64())
}

/// y ← s y + t x.
#[inline(always)]
fn combine_into<T: Scalar>(y: &mut [Vec3<T>], s: T, t: T, x: &[Vec3<T>]) {
    let ((y, rest_of_y), (x, rest_of_x)) = (y.as_chunks_mut::<NODES>(), x.as_chunks::<NODES>());
    for (y, x) in y.iter_mut().zip(x) {
        let (mut sum, x) = (numbers(y), numbers(x));
        for i in 0..NUMBERS {
            sum[i] = x[i].mul_add(t, sum[i] * s);
        }
        *y = vectors(&sum);
    }
    for (y, &x) in rest_of_y.iter_mut().zip(rest_of_x) {
        *y = x.mul_add(t, *y * s);
    }
}

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

#[inline(always)]
fn vectors<T: Scalar>(numbers: &[T; NUMBERS]) -> [Vec3<T>; NODES] {
    let mut vectors = [Vec3::ZERO; NODES];
    for node in 0..NODES {
        vectors[node] = Vec3::new(numbers[3 * node], numbers[3 * node + 1], numbers[3 * node + 2]);
    }
    vectors
}
