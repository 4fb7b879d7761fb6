//! The direction of a product on copies of nodes: it follows the conjugate gradient there, so that an iteration reads of each node only
//! what changes it.

use super::{PatchRows, Patches, clear};
use crate::math::{Lanes, Part, Real, Scalar, Simd, Vec3, dispatch, dispatch_level};
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
        dispatch!(dispatch_level(), simd => follow(simd, (nodes, inertia), weight, turn.product, [sums, direction]));
    }

    /// p·(M + K) p over the copies of a patch.
    pub(super) fn curvature<T: Scalar>(&self, patch: usize, direction: &PatchRows<T>, sums: &PatchRows<T>) -> f64 {
        let rows = ..self.nodes(patch).len();
        dispatch!(dispatch_level(), simd => dot_of_rows(simd, &direction[rows], &sums[rows]))
    }
}

/// p ← z + w p, and M p. Several rows at a time, of which the fourth number is whatever comes next in the vectors; it has no part in M p.
#[inline(always)]
fn follow<T: Scalar, S: Simd>(
    simd: S,
    (nodes, inertia): (&[u32], &[T]),
    weight: T,
    corrected: &[Vec3<T>],
    [sums, direction]: [&mut PatchRows<T>; 2],
) {
    let count = T::Lanes::<S>::COUNT / 4;
    let weights = T::Lanes::<S>::splat(simd, weight);
    let own = T::Lanes::<S>::rows_of(
        simd,
        #[inline(always)]
        |_| [T::ONE, T::ONE, T::ONE, T::ZERO],
    );
    // The last node may be the last of all, behind which nothing comes.
    let groups = nodes.len().saturating_sub(1) / count;
    let rows = sums.chunks_exact_mut(count).zip(direction.chunks_exact_mut(count));
    for ((nodes, inertia), (sums, direction)) in
        nodes.chunks_exact(count).zip(inertia.chunks_exact(count)).zip(rows).take(groups)
    {
        let corrected = T::Lanes::<S>::rows_of(
            simd,
            #[inline(always)]
            |row| {
                let (next, own) = (corrected[nodes[row] as usize + 1], corrected[nodes[row] as usize]);
                [own.x, own.y, own.z, next.x]
            },
        );
        let masses = T::Lanes::<S>::rows_of(
            simd,
            #[inline(always)]
            |row| [inertia[row]; 4],
        );
        let before = T::Lanes::<S>::load(Part::first(simd), direction.as_flattened());
        let turned = before.mul_add(weights, corrected);
        turned.store(Part::first(simd), direction.as_flattened_mut());
        (turned * own * masses).store(Part::first(simd), sums.as_flattened_mut());
    }
    for row in groups * count..nodes.len() {
        let turned = Vec3::new(direction[row][0], direction[row][1], direction[row][2])
            .mul_add(weight, corrected[nodes[row] as usize]);
        direction[row] = [turned.x, turned.y, turned.z, T::ZERO];
        let product = turned * inertia[row];
        sums[row] = [product.x, product.y, product.z, T::ZERO];
    }
}

#[cfg(test)]
mod tests {
    use crate::math::{Level, Scalar, Vec3, dispatch, dispatch_level};
    use crate::model::patch::PATCH_NODES;

    /// However many nodes a patch has, on every instruction set, with the last of all nodes at its end; and what belongs to no node stays.
    #[test]
    fn a_direction_is_followed_at_every_node_of_a_patch() {
        check::<f32>(2.0 * f64::from(f32::EPSILON));
        check::<f64>(2.0 * f64::EPSILON);
    }

    fn check<T: Scalar>(within: f64) {
        let number = |i: usize| T::from_f64((0.37 * i as f64).sin());
        for level in [Level::baseline(), dispatch_level()] {
            for count in 1..20 {
                let nodes: Vec<u32> = (0..count).map(|node| 2 * node + 1).collect();
                let corrected: Vec<Vec3<T>> = (0..2 * count as usize)
                    .map(|i| Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2)))
                    .collect();
                let inertia: Vec<T> = (0..count as usize).map(|i| number(i) + T::ONE).collect();
                let mut before = [[T::ZERO; 4]; PATCH_NODES];
                for (row, direction) in before.iter_mut().enumerate() {
                    *direction = std::array::from_fn(|i| if i < 3 { number(5 * row + i) } else { T::ZERO });
                }
                let (mut sums, mut direction, weight) = ([[T::ONE; 4]; PATCH_NODES], before, T::from_f64(0.6));
                dispatch!(level, simd => {
                    super::follow(simd, (&nodes, &inertia), weight, &corrected, [&mut sums, &mut direction]);
                });
                for (row, &node) in nodes.iter().enumerate() {
                    let expected = before[row].map(Scalar::to_f64);
                    for (i, z) in corrected[node as usize].to_array().into_iter().enumerate() {
                        let turned = z.to_f64() + 0.6 * expected[i];
                        assert!((direction[row][i].to_f64() - turned).abs() <= within, "{count} nodes, node {row}");
                        let product = inertia[row].to_f64() * turned;
                        assert!((sums[row][i].to_f64() - product).abs() <= 2.0 * within, "{count} nodes, node {row}");
                    }
                    assert_eq!(sums[row][3], T::ZERO);
                }
                assert_eq!(direction[count as usize..], before[count as usize..]);
                assert!(sums[count as usize..].iter().all(|&row| row == [T::ONE; 4]));
            }
        }
    }
}
