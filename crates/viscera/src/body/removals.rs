use serde::{Deserialize, Serialize};

/// Which cells were removed, in which order, cut by cut.
///
/// Tables from which cells are subtracted keep the roundings of that order: a model that is built anew and loses the same cells
/// in the same order has the same bits. So a cut body is kept as this list, whatever its models keep in their tables.
#[derive(Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Removals {
    cells: Vec<u32>,
    /// Where in `cells` each cut ends.
    ends: Vec<u32>,
}

impl Removals {
    /// None yet, with room for all cells of a body, so that no cut allocates.
    pub(crate) fn for_cells(count: usize) -> Self {
        Self { cells: Vec::with_capacity(count), ends: Vec::with_capacity(count) }
    }

    /// Makes room for all cells of a body.
    pub(crate) fn reserve(&mut self, count: usize) {
        self.cells.reserve(count.saturating_sub(self.cells.len()));
        self.ends.reserve(count.saturating_sub(self.ends.len()));
    }

    /// Adds a cut.
    pub(crate) fn push(&mut self, cells: &[u32]) {
        self.cells.extend_from_slice(cells);
        self.ends.push(self.cells.len() as u32);
    }

    /// All removed cells, in their order.
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// The cells of each cut.
    pub fn cuts(&self) -> impl Iterator<Item = &[u32]> {
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        begins.zip(&self.ends).map(|(begin, &end)| &self.cells[begin as usize..end as usize])
    }

    /// How many cuts there were.
    pub fn cut_count(&self) -> usize {
        self.ends.len()
    }

    /// Whether these are all the cuts of `earlier`, and perhaps more.
    pub(crate) fn go_on_from(&self, earlier: &Self) -> bool {
        self.ends.starts_with(&earlier.ends) && self.cells.starts_with(&earlier.cells)
    }

    /// Whether each cut ends behind the one before it, and the last at the end of the list.
    pub(crate) fn are_sound(&self) -> bool {
        self.ends.is_sorted() && self.ends.last().map_or(0, |&end| end as usize) == self.cells.len()
    }
}

/// A copy with the same room: it may take the place of the original in a world that goes on cutting.
impl Clone for Removals {
    fn clone(&self) -> Self {
        let mut copy =
            Self { cells: Vec::with_capacity(self.cells.capacity()), ends: Vec::with_capacity(self.ends.capacity()) };
        copy.cells.extend_from_slice(&self.cells);
        copy.ends.extend_from_slice(&self.ends);
        copy
    }
}
