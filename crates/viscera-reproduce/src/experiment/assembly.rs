//! From how many iterations on it pays to assemble the matrix.

use viscera_validation::{Settings, assembly_crossover, brief};

use super::Experiment;
use crate::{ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "assembly",
    title: "When to assemble the matrix",
    source: "N05, section 4: products element by element or with an assembled matrix",
    run,
};

/// Iterations from which on assembling pays, as published.
const PUBLISHED: f64 = 50.0;

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let study = assembly_crossover::study(settings.size)?;
    let why = "What the paper computes for every product, rotations and strains, is here kept from one linearisation; so a product \
               without a matrix costs little more than one with it, and assembling has less to win back. Both are measured.";
    let section = Section::new(
        "A step of linearised backward Euler takes so many iterations of the conjugate gradient. Each needs a product with the \
         stiffness: element by element, or with a matrix that is assembled once for the step.",
    )
    .setting("bar", format!("{} corotational tetrahedra, polar", study.cells))
    .setting("time", "of one implicit step, double precision, one thread, the best of eight");
    let section = match study.crossover() {
        Some(count) => section.compare("assembling pays from", "iterations", [PUBLISHED, count], why),
        None => {
            let most = study.times.last().map_or(0, |(count, _)| *count);
            let ours = format!("not within {most} iterations");
            section.compare_words("assembling pays from", [&format!("{} iterations", brief(PUBLISHED)), &ours], why)
        }
    };
    Ok(section.study(&study.report(), |_| "Time of a step".into()))
}
