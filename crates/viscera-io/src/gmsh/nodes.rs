use std::collections::HashMap;

use crate::assembly::Assembly;
use crate::{ParseError, Place, Problem};

/// From the file's node numbers, which may have gaps, to positions in the list.
#[derive(Default)]
pub(super) struct NodeNumbers {
    index_of: HashMap<u64, u32>,
}

impl NodeNumbers {
    /// Adds a node under its number.
    pub(super) fn add(
        &mut self,
        assembly: &mut Assembly,
        number: u64,
        position: [f64; 3],
        place: impl Fn() -> Place,
    ) -> Result<(), ParseError> {
        let index = assembly.node(number, position, &place)?;
        match self.index_of.insert(number, index) {
            None => Ok(()),
            Some(_) => Err(Problem::NodeTwice { node: number }.at(place())),
        }
    }

    /// Position of a node that a cell names.
    pub(super) fn find(&self, cell: u64, node: i64, place: impl FnOnce() -> Place) -> Result<u32, ParseError> {
        let found = u64::try_from(node).ok().and_then(|number| self.index_of.get(&number));
        found.copied().ok_or_else(|| Problem::MissingNode { cell, node }.at(place()))
    }
}
