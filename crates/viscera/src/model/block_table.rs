use crate::math::{large_pages, prefetch};

/// A table whose rows lie in blocks of as many rows as a batch has lanes, column after column within a block: a batch of
/// lanes reads one column of its rows as one contiguous load.
#[derive(Debug, PartialEq)]
pub(crate) struct BlockTable<V> {
    lanes: usize,
    columns: usize,
    rows: usize,
    values: Vec<V>,
}

/// On large pages as well: a world that was put back to a snapshot goes on with clones.
impl<V: Copy> Clone for BlockTable<V> {
    fn clone(&self) -> Self {
        let mut values = large_pages::room_for(self.values.len());
        values.extend_from_slice(&self.values);
        Self { values, ..*self }
    }
}

impl<V: Copy> BlockTable<V> {
    /// A table of `rows` rows, padded with further rows to whole blocks, every entry `fill`.
    pub(crate) fn new(lanes: usize, rows: usize, columns: usize, fill: V) -> Self {
        Self { lanes, columns, rows, values: large_pages::filled(rows.div_ceil(lanes) * lanes * columns, fill) }
    }

    /// Rows, without the padding.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Rows, with the padding.
    pub(crate) fn padded_rows(&self) -> usize {
        self.values.len() / self.columns
    }

    /// Size of the stored numbers [bytes].
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice())
    }

    #[inline(always)]
    fn index(&self, row: usize, column: usize) -> usize {
        (row / self.lanes * self.columns + column) * self.lanes + row % self.lanes
    }

    #[inline(always)]
    pub(crate) fn get(&self, row: usize, column: usize) -> V {
        self.values[self.index(row, column)]
    }

    #[inline(always)]
    pub(crate) fn get_mut(&mut self, row: usize, column: usize) -> &mut V {
        let index = self.index(row, column);
        &mut self.values[index]
    }

    /// The entries of a row, column by column.
    pub(crate) fn row_mut(&mut self, row: usize) -> impl Iterator<Item = &mut V> {
        let start = self.index(row, 0);
        self.values[start..].iter_mut().step_by(self.lanes).take(self.columns)
    }

    /// Writes a row, from its first column on.
    pub(crate) fn set_row(&mut self, row: usize, values: impl IntoIterator<Item = V>) {
        for (entry, value) in self.row_mut(row).zip(values) {
            *entry = value;
        }
    }

    /// Block number `number`, of `lanes · columns` entries.
    #[inline(always)]
    pub(crate) fn block(&self, number: usize) -> &[V] {
        let size = self.lanes * self.columns;
        &self.values[number * size..(number + 1) * size]
    }

    /// The same where the compiler knows the size of the table's blocks: a block is checked once then, and not column by column.
    #[inline(always)]
    pub(crate) fn block_of(&self, lanes: usize, columns: usize, number: usize) -> &[V] {
        let size = lanes * columns;
        &self.values[number * size..][..size]
    }

    /// The same, to be written.
    #[inline(always)]
    pub(crate) fn block_of_mut(&mut self, lanes: usize, columns: usize, number: usize) -> &mut [V] {
        let size = lanes * columns;
        &mut self.values[number * size..][..size]
    }

    /// Asks for a block that a loop will come to, if there is one.
    #[inline(always)]
    pub(crate) fn prefetch(&self, lanes: usize, columns: usize, number: usize) {
        if let Some(block) = self.values.get(number * lanes * columns..(number + 1) * lanes * columns) {
            prefetch(block);
        }
    }

    /// Blocks of `lanes · columns` entries.
    #[inline(always)]
    pub(crate) fn blocks(&self) -> std::slice::ChunksExact<'_, V> {
        self.values.chunks_exact(self.lanes * self.columns)
    }
}
