use crate::body::BodyError;

/// Why bytes are no snapshot of this world. Nothing is changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SnapshotError {
    /// The bytes do not begin as a snapshot does.
    #[error("these are not the bytes of a snapshot; give those that `Snapshot::to_bytes` made, from their beginning")]
    NotASnapshot,
    /// Bytes are missing or are not what they were when they were written.
    #[error("the snapshot is damaged: its checksum does not fit its {length} bytes; take an earlier one")]
    Damaged {
        /// How many bytes there are.
        length: usize,
    },
    /// Written by another version of the engine.
    #[error("the snapshot has format {found}, and this engine reads format {known}; take the version that wrote it")]
    OtherVersion {
        /// Format of the snapshot.
        found: u16,
        /// What is known here.
        known: u16,
    },
    /// Written by a world that computes in the other precision.
    #[error(
        "the snapshot is of a world in {found} bits, and this one computes in {wanted}; build the world in that precision"
    )]
    OtherPrecision {
        /// Bits of a number in the snapshot.
        found: u8,
        /// Bits of a number in the world.
        wanted: u8,
    },
    /// The world has other bodies or instruments.
    #[error("the snapshot is of another world: {what}; build the world from the same scene")]
    Foreign {
        /// What differs.
        what: String,
    },
    /// The models of a body cannot be built again.
    #[error(transparent)]
    Body(#[from] BodyError),
}
