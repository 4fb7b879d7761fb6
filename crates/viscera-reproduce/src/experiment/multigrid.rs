//! Iterations of an implicit step on finer and finer meshes, with and without multigrid.

use viscera_validation::multigrid::{self, MultigridStudy, Row};
use viscera_validation::{Settings, Size, brief};

use super::Experiment;
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "multigrid",
    title: "Iterations of fine tissue",
    source: "N05, section 5: five iterations of the conjugate gradient per step, on 2 000 tetrahedra",
    run,
};

/// By how much iterations at rest grow from one mesh of a body to its finest.
fn growth(study: &MultigridStudy, body: &str, from: usize, iterations: impl Fn(&Row) -> u32) -> f64 {
    let counts: Vec<f64> = study.of(body, false, 1.0).map(|row| f64::from(iterations(row))).collect();
    match (counts.get(from), counts.last()) {
        (Some(first), Some(last)) => last / first,
        _ => f64::NAN,
    }
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    // A million tetrahedra would take longer than all else together; the study by itself goes as far.
    let study = match settings.size {
        Size::Small => multigrid::study(Size::Small)?,
        Size::Full => multigrid::study_on(Size::Full, &[3, 4, 8, 12], &[1_000, 10_000, 40_000])?,
    };
    let mut section = Section::new(
        "The paper makes five iterations a step, whatever is left. How many it takes until nothing is left grows with the number of cells \
         along the body, unless a multigrid preconditions.",
    )
    .setting("tissue", "E = 10 kPa, ν = 0.45, 1000 kg/m³; corotational tetrahedra, double precision, one core")
    .setting("step", "linearised backward Euler from rest, 10 ms and 1 s, to a residual of 1e-6");
    for body in ["cantilever", "liver"] {
        if let Some(row) = study.of(body, false, 0.01).last() {
            let (plain, multigrid) = (row.block_jacobi.iterations, row.multigrid.iterations);
            let ours = format!("{multigrid} with multigrid, {plain} without, {} tetrahedra", brief(row.cells as f64));
            let why = "Five leave a residual; here they go on until it has fallen to 1e-6.";
            section = section.compare_words(format!("iterations, {body}, 10 ms"), ["5", &ours], why);
        }
        // A thousand cells have one lattice, which is solved: the second mesh is the first with several.
        let multigrid = growth(&study, body, 1, |row| row.multigrid.iterations);
        let plain = growth(&study, body, 0, |row| row.block_jacobi.iterations);
        section = section
            .relation(Relation::at_most(format!("{body} at rest, with multigrid: growth [times]"), multigrid, 1.2))
            .relation(Relation::at_least(format!("{body} at rest, without: growth [times]"), plain, 1.8));
    }
    Ok(section.study(&study.report(), |_| "One step, with and without multigrid".into()))
}
