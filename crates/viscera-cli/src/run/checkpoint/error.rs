use std::path::PathBuf;

/// Why a checkpoint cannot be gone on from.
#[derive(Debug, thiserror::Error)]
pub(super) enum CheckpointError {
    /// The system does not let it be read.
    #[error("{}: the checkpoint cannot be read: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    /// Bytes are missing, or are not what they were when they were written.
    #[error("{}: the checkpoint is damaged: {why}", path.display())]
    Damaged { path: PathBuf, why: String },
    /// Another version of the program wrote it.
    #[error(
        "{}: the checkpoint was written by {found}, and this is {known}; go on with that program, or run without --resume to begin anew",
        path.display()
    )]
    OtherVersion { path: PathBuf, found: String, known: String },
    /// It belongs to a run of another scene, or of the same with other settings.
    #[error(
        "{}: the checkpoint is of another run: {difference}; resume with the same scene and settings, choose another folder \
         with --out, or run without --resume to begin anew",
        path.display()
    )]
    OtherScene { path: PathBuf, difference: String },
    /// None of several can be read.
    #[error("no checkpoint in {} can be gone on from; run without --resume to begin anew", folder.display())]
    NoneLeft { folder: PathBuf },
}

impl CheckpointError {
    /// Whether the checkpoint before it may do: damage is a matter of one file, another scene is not.
    pub(super) fn is_of_one_file(&self) -> bool {
        matches!(self, Self::Unreadable { .. } | Self::Damaged { .. })
    }
}
