//! The experiments. One is one file; [`EXPERIMENTS`] is the only list of them.

mod adaptive;
mod assembly;
mod beam;
mod cantilevers;
mod cost;
mod cylinder;
mod extrapolation;
mod inversion;
mod liver;
mod multigrid;
mod nearly_incompressible;
mod resection;
mod rotation;
mod speed;
mod torque;
mod truth_cube;
mod tubes;

pub use truth_cube::beads_in;
use viscera_validation::Settings;

use crate::{ReproduceError, Section};

/// What stands for a published value where a paper has a picture or a curve, and no number is at hand.
const PICTURE: &str = "a picture, no number";
const CURVE: &str = "a curve, no number at hand";

/// An experiment of a paper.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// What it is called on the command line; its folder as well.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// The paper, and where in it.
    pub source: &'static str,
    /// Runs it.
    run: fn(&Settings) -> Result<Section, ReproduceError>,
}

/// All of them, in the order of the report.
pub const EXPERIMENTS: [Experiment; 17] = [
    rotation::EXPERIMENT,
    cylinder::EXPERIMENT,
    tubes::EXPERIMENT,
    liver::EXPERIMENT,
    adaptive::EXPERIMENT,
    resection::EXPERIMENT,
    cost::EXPERIMENT,
    torque::EXPERIMENT,
    assembly::EXPERIMENT,
    inversion::EXPERIMENT,
    speed::EXPERIMENT,
    multigrid::EXPERIMENT,
    beam::EXPERIMENT,
    cantilevers::EXPERIMENT,
    nearly_incompressible::EXPERIMENT,
    truth_cube::EXPERIMENT,
    extrapolation::EXPERIMENT,
];

impl Experiment {
    /// The experiment of this name, if there is one.
    pub fn named(name: &str) -> Option<Self> {
        EXPERIMENTS.into_iter().find(|experiment| experiment.name == name)
    }

    /// Runs it. `settings.measured` is a file of measured beads, for the one that needs it.
    ///
    /// # Errors
    /// [`ReproduceError`] where a solve or a step fails.
    pub fn run(&self, settings: &Settings) -> Result<Section, ReproduceError> {
        (self.run)(settings)
    }
}
