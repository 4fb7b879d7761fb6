use super::Filtered;
use super::vectors::combine_into;
use crate::executor::{Executor, NodeBlocks, node_blocks};
use crate::math::{Scalar, Vec3, dispatch, dispatch_level};

/// The next direction of the conjugate gradient, p ← z + w p, and its product.
#[derive(Debug)]
pub struct Turn<'a, T> {
    /// w; none for the first direction, which is z.
    pub weight: Option<T>,
    /// p.
    pub direction: &'a mut [Vec3<T>],
    /// z, with no part in the prescribed directions; afterwards S A p.
    pub product: &'a mut [Vec3<T>],
    /// S.
    pub filtered: Filtered<'a, T>,
}

impl<T: Scalar> Turn<'_, T> {
    /// Turns the direction at all nodes.
    pub(crate) fn make(&mut self, executor: &Executor) {
        let data = (NodeBlocks(&mut *self.direction), NodeBlocks(&mut *self.product));
        executor.each(node_blocks(data.0.0.len()), data, &|_, (NodeBlocks(direction), NodeBlocks(product))| {
            turn_block(self.weight, direction, product);
        });
    }
}

/// p ← z + w p on a block of nodes.
#[inline]
pub(crate) fn turn_block<T: Scalar>(weight: Option<T>, direction: &mut [Vec3<T>], corrected: &[Vec3<T>]) {
    match weight {
        Some(weight) => dispatch!(dispatch_level(), _simd => combine_into(direction, weight, T::ONE, corrected)),
        None => direction.copy_from_slice(corrected),
    }
}
