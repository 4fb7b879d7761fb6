//! Viscera against closed forms, other programs and measurements. A study is a folder here: what is compared with what, and
//! why the number means something.
//!
//! `cargo run --release -p viscera-validation -- [STUDY…]` runs them at full size and writes a page with tables and plots for
//! each; the tests run them small and assert.

mod error;
mod references;
mod report;

pub mod assembly_crossover;
pub mod cantilevers;
pub mod extrapolation;
pub mod fixed_beam;
pub mod frequencies;
pub mod multigrid;
pub mod nearly_incompressible;
pub mod plot;
pub mod setting;
pub mod step_cost;
pub mod torture;
pub mod truth_cube;

use std::path::PathBuf;

pub use error::ValidationError;
pub use report::{Block, Report, Table, brief};
pub use setting::Element;

/// How large the meshes are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// For tests.
    Small,
    /// For the record.
    Full,
}

impl Size {
    /// What a page says of the run that it is of.
    pub(crate) fn sentence(self) -> &'static str {
        match self {
            Self::Small => "This page is of the small run (`--small`, as in the tests).",
            Self::Full => "This page is of the full run.",
        }
    }
}

/// What is asked of a study.
#[derive(Clone, Debug)]
pub struct Settings {
    /// How large the meshes are.
    pub size: Size,
    /// The measured beads of the truth cube, where the file is at hand.
    pub measured: Option<PathBuf>,
}

/// The studies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum StudyKind {
    /// A clamped beam under its weight, linear: beam theory and three programs.
    FixedBeam,
    /// Large static deflection: three programs.
    Cantilevers,
    /// Natural frequencies, free flight and release: three programs.
    Frequencies,
    /// Cook's membrane and a pressed cube: what locks and what does not.
    NearlyIncompressible,
    /// A silicone cube with measured beads.
    TruthCube,
    /// From how many iterations on the assembled matrix pays.
    AssemblyCrossover,
    /// Iterations against number of cells, with and without multigrid.
    Multigrid,
    /// Time per step against number of cells, for every model.
    StepCost,
    /// Every model, law and integrator in shapes, scales and cuts that nothing should survive.
    Torture,
    /// The force on a hand between two samples of the simulation.
    Extrapolation,
}

impl StudyKind {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::FixedBeam,
        Self::Cantilevers,
        Self::Frequencies,
        Self::NearlyIncompressible,
        Self::TruthCube,
        Self::AssemblyCrossover,
        Self::Multigrid,
        Self::StepCost,
        Self::Torture,
        Self::Extrapolation,
    ];

    /// Its name on the command line, and of its folder.
    pub fn name(self) -> &'static str {
        match self {
            Self::FixedBeam => "fixed-beam",
            Self::Cantilevers => "cantilevers",
            Self::Frequencies => "frequencies",
            Self::NearlyIncompressible => "nearly-incompressible",
            Self::TruthCube => "truth-cube",
            Self::AssemblyCrossover => "assembly-crossover",
            Self::Multigrid => "multigrid",
            Self::StepCost => "step-cost",
            Self::Torture => "torture",
            Self::Extrapolation => "extrapolation",
        }
    }

    /// Runs it.
    ///
    /// # Errors
    /// [`ValidationError`] where a solve fails or a file cannot be read.
    pub fn run(self, settings: &Settings) -> Result<Report, ValidationError> {
        match self {
            Self::FixedBeam => Ok(fixed_beam::study(settings.size)?.report()),
            Self::Cantilevers => Ok(cantilevers::study(settings.size)?.report()),
            Self::Frequencies => Ok(frequencies::study(settings.size)?.report()),
            Self::NearlyIncompressible => Ok(nearly_incompressible::study(settings.size)?.report()),
            Self::TruthCube => Ok(truth_cube::study(settings)?.report()),
            Self::AssemblyCrossover => Ok(assembly_crossover::study(settings.size)?.report()),
            Self::Multigrid => Ok(multigrid::study(settings.size)?.report()),
            Self::StepCost => Ok(step_cost::study(settings.size)?.report()),
            Self::Torture => Ok(torture::study(settings.size)?.report()),
            Self::Extrapolation => Ok(extrapolation::study(settings.size)?.report()),
        }
    }
}
