//! Time per step against the number of tetrahedra, for every model and the variants of the corotational one.

use viscera_validation::step_cost::{self, Cost};
use viscera_validation::{Settings, brief};

use super::{CURVE, Experiment};
use crate::{ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "speed",
    title: "Time per step",
    source: "N05, section 5: time against the number of tetrahedra; RR, section 5",
    run,
};

/// Time of a cell in the largest mesh [ns].
fn per_cell(costs: &[Cost], name: &str) -> f64 {
    let last = costs.iter().find(|cost| cost.name == name).and_then(|cost| cost.times.last());
    last.map_or(f64::NAN, |&(cells, time)| 1e6 * time / cells as f64)
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let study = step_cost::study(settings.size)?;
    let most = study.explicit.iter().filter_map(|cost| cost.times.last()).map(|last| last.0).max().unwrap_or(0);
    let tables = format!(
        "{} ns a tetrahedron explicitly, {} in an implicit step",
        brief(per_cell(&study.explicit, "corotational")),
        brief(per_cell(&study.implicit, "corotational"))
    );
    Ok(Section::new(
        "The time of a step grows in proportion to the number of cells. Which model is dear depends on what it computes anew: the \
         tables of the tensor-mass model are read from memory, rotations and laws are computed.",
    )
    .setting("body", format!("cubes of up to {most} cells, E = 10 kPa, ν = 0.4, under their weight"))
    .setting("time", "single precision, one thread, the best of six; implicit steps of 25 iterations")
    .setting(
        "hybrid and pre-computed",
        "smaller cubes, as what they keep grows faster than the mesh; what is pre-computed makes whole steps, at the end of which it rests",
    )
    .compare_words(
        "corotational tetrahedra",
        [CURVE, &tables],
        "The numbers are those of a machine of the year 2004; ours are of this one, and held to nothing.",
    )
    .study(&study.report(), |name| match name {
        "explicit" => "One explicit sub-step".into(),
        _ => "One implicit step of 25 iterations".into(),
    }))
}
