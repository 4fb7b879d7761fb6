use crate::math::Mat3;

/// Takes the 3×3 blocks of a matrix that has a row and a column of blocks for every node.
pub trait BlockSink<T> {
    /// Adds `block` at the nodes (`row`, `column`).
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>);

    /// Whether it keeps the blocks of the diagonal only, so that models may leave out the others.
    fn keeps_diagonal_only(&self) -> bool {
        false
    }
}
