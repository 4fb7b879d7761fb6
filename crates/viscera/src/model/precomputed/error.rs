use crate::solver::SolverError;

/// Why there are no responses.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ResponsesError {
    /// A body that floats answers no force.
    #[error("nothing holds the body, so that it has no answer to a force; fix or prescribe some of its nodes")]
    NothingHolds,
    /// The stiffness could not be factored.
    #[error("{0}")]
    Solver(SolverError),
    /// The responses are those of another body, or of this one before it was changed.
    #[error(
        "the responses were computed for another {what}; compute them again (`viscera precompute`), or leave them out to have it done at every start"
    )]
    Stale {
        /// What differs.
        what: &'static str,
    },
    /// The bytes are something else.
    #[error("these are no responses: their mark is missing; compute them with `viscera precompute`")]
    NotResponses,
    /// The bytes were cut short, or changed.
    #[error("the responses are damaged ({length} bytes that do not match their checksum); compute them again")]
    Damaged {
        /// How many bytes there are.
        length: usize,
    },
    /// The bytes were written by another version.
    #[error("the responses are of format {found}, and this version reads format {known}; compute them again")]
    OtherVersion {
        /// Their format.
        found: u16,
        /// The format that is known.
        known: u16,
    },
}
