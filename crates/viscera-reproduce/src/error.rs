use std::path::PathBuf;

use viscera::curve::CurveError;
use viscera::dynamics::quasi_static::StaticError;
use viscera::material::MaterialError;
use viscera::mesh::{GenerateError, RegionError};
use viscera::world::{StepError, WorldError};
use viscera_io::picture::PictureError;
use viscera_io::write::WriteError;
use viscera_scene::SceneErrors;
use viscera_validation::ValidationError;

/// Why an experiment could not be run, or what it found could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReproduceError {
    /// A study of the validation could not be made.
    #[error(transparent)]
    Study(#[from] ValidationError),
    /// A body or world makes no sense: a mistake in the experiment.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A law makes no sense: a mistake in the experiment.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A mesh cannot be made: a mistake in the experiment.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// A region selects nothing: a mistake in the experiment.
    #[error(transparent)]
    Region(#[from] RegionError),
    /// A motion along time makes no sense: a mistake in the experiment.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// A built-in scene does not bear the changes that the experiment makes to it.
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// An equilibrium was not found.
    #[error(transparent)]
    Static(#[from] StaticError),
    /// A step was not made.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A picture cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A file cannot be written: the disk is full, or the folder is not to be written to. Choose another folder.
    #[error("{}: {error}; choose another folder", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// No linear load makes the volume grow by as much: a mistake in the experiment.
    #[error(
        "no force up to {most:.1e} N makes the linear tissue grow by {percent} %; take a softer tissue or another load"
    )]
    Unreachable {
        /// The growth that was asked for.
        percent: f64,
        /// The largest force that was tried [N].
        most: f64,
    },
}
