/// As many fans as there are lanes, all of one length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Batch {
    /// Where its nodes begin.
    pub(super) nodes: usize,
    /// The first of its slots.
    pub(super) slot: usize,
    /// How many slots it has.
    pub(super) length: usize,
    /// How many of its lanes have fans of their own.
    pub(super) fans: usize,
    /// Whether all its fans go all the way around.
    pub(super) is_closed: bool,
    /// Whether its halves share no node, so that it does not matter which of them is added up first.
    pub(super) is_apart: bool,
}

impl Batch {
    /// How many nodes each ring has.
    pub(super) fn ring(&self) -> usize {
        self.length + usize::from(!self.is_closed)
    }

    /// The places among its nodes of the corners of a slot.
    pub(super) fn corners(&self, slot: usize) -> [usize; 4] {
        [0, 1, 2 + slot, 2 + (slot + 1) % self.ring()]
    }
}
