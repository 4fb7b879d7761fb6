//! The direction of a product on copies of nodes: it follows the conjugate gradient there, so that an iteration reads of each node only
//! what changes it.

use super::{PatchRows, Patches, clear};
use crate::math::{Scalar, Vec3, dispatch, dispatch_level};
use crate::solver::{Turn, dot_of_rows};

impl Patches {
    /// Turns the direction p ← z + w p on the copies of a patch, and begins the sums with M p, of which the first copy of each node has all.
    pub(super) fn turn<T: Scalar>(
        &self,
        patch: usize,
        turn: &Turn<'_, T>,
        masses: &[T],
        ([sums, direction], inertia): ([&mut PatchRows<T>; 2], &mut [T]),
    ) {
        let nodes = self.nodes(patch);
        if turn.weight.is_none() {
            for (copy, (&node, mass)) in (self.row_starts[patch]..).zip(nodes.iter().zip(inertia.iter_mut())) {
                *mass = if self.copies.is_first(node, copy) { masses[node as usize] } else { T::ZERO };
            }
            clear(direction);
        }
        let weight = turn.weight.unwrap_or(T::ZERO);
        dispatch!(dispatch_level(), _simd => follow((nodes, inertia), weight, turn.product, [sums, direction]));
    }

    /// p·(M + K) p over the copies of a patch.
    pub(super) fn curvature<T: Scalar>(&self, patch: usize, direction: &PatchRows<T>, sums: &PatchRows<T>) -> f64 {
        let rows = ..self.nodes(patch).len();
        dispatch!(dispatch_level(), simd => dot_of_rows(simd, &direction[rows], &sums[rows]))
    }
}

/// p ← z + w p, and M p. Row by row, of which the compiler makes a register each.
#[inline(always)]
fn follow<T: Scalar>(
    (nodes, inertia): (&[u32], &[T]),
    weight: T,
    corrected: &[Vec3<T>],
    [sums, direction]: [&mut PatchRows<T>; 2],
) {
    for (((&node, &mass), sum), direction) in nodes.iter().zip(inertia).zip(sums).zip(direction) {
        let Vec3 { x, y, z } = corrected[node as usize];
        let (corrected, mut turned, mut product) = ([x, y, z, T::ZERO], *direction, [T::ZERO; 4]);
        for i in 0..4 {
            turned[i] = turned[i].mul_add(weight, corrected[i]);
            product[i] = turned[i] * mass;
        }
        (*direction, *sum) = (turned, product);
    }
}
