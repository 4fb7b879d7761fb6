//! The experiments of the papers that Viscera began with, run again: their figures and tables, the published values beside ours, and
//! what has to hold between the numbers.
//!
//! RR: Picinbono, Delingette, Ayache, *Non-linear anisotropic elasticity for real-time surgery simulation*, INRIA RR-4028 (2000).
//! N05: Nesme, Marchal, Promayon, Chabanas, Payan, Faure, *Physically realistic interactive simulation for biological soft tissues* (2005).
//!
//! An experiment is one file in `experiment/`, and [`EXPERIMENTS`] is the only list of them. It gives a [`Section`]: text, settings,
//! comparisons, tables, plots, pictures, and [`Relation`]s, which the tests hold it to. A [`Report`] collects sections and writes them
//! as one page that needs nothing else, and each table, plot and picture as a file.

mod amount;
mod deformed;
mod error;
mod experiment;
mod linear_response;
mod relation;
mod report;
mod section;

pub use amount::Amount;
pub use error::ReproduceError;
pub use experiment::{EXPERIMENTS, Experiment, beads_in};
pub use relation::Relation;
pub use report::{Chapter, Report};
pub use section::{Comparison, Part, Photograph, Section};
pub use viscera_validation::{Settings, Size};
