/// A parameter that no tissue can have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// The parameter lies outside the range in which the law is stable.
    #[error("{name} = {value} is out of range: it must be {range}{hint}")]
    OutOfRange {
        /// Name of the parameter.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do, in words.
        range: &'static str,
        /// What to do about it; empty, or starts with a space.
        hint: &'static str,
    },
    /// A fibre direction without a direction: zero, infinite or NaN.
    #[error("the fibre direction ({}, {}, {}) has no direction; give any vector that is not zero", direction[0], direction[1], direction[2])]
    NoDirection {
        /// What was given.
        direction: [f64; 3],
    },
    /// A field of laws has another number of entries than the mesh has cells.
    #[error("{given} laws are given for {cells} cells; give one for each cell, or one for all")]
    WrongCount {
        /// How many laws were given.
        given: usize,
        /// How many cells there are.
        cells: usize,
    },
}
