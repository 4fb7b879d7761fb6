use std::path::PathBuf;

use viscera::curve::CurveError;
use viscera::dynamics::quasi_static::StaticError;
use viscera::material::MaterialError;
use viscera::mesh::GenerateError;
use viscera::model::ModelError;
use viscera::world::{StepError, WorldError};
use viscera_haptics::SampleError;

/// Why a study could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    /// A body or world of a study makes no sense: a mistake in the study.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A law of a study makes no sense: a mistake in the study.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A model of a study cannot be built: a mistake in the study.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// An equilibrium was not found.
    #[error(transparent)]
    Static(#[from] StaticError),
    /// A step was not made.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A mesh of a study cannot be made: a mistake in the study.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// A path of a hand makes no sense: a mistake in the study.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// A sample for the haptic channel makes no sense: the simulation of a study has diverged.
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// A reference mesh cannot be read.
    #[error(transparent)]
    Mesh(#[from] viscera_io::ReadError),
    /// A file cannot be read or written.
    #[error("{path}: {error}", path = path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The measured beads are not in the form that they were published in.
    #[error("{path}, line {line}: {what}", path = path.display())]
    Beads {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What was expected.
        what: String,
    },
    /// A plot cannot be drawn.
    #[error("the plot {file} cannot be drawn: {why}")]
    Plot {
        /// Its file.
        file: String,
        /// Why.
        why: String,
    },
}
