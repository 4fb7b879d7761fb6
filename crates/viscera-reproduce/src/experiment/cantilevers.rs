//! Cantilevers under large loads, against other programs, and under refinement.

use viscera_validation::{Settings, cantilevers};

use super::{CURVE, Experiment};
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "cantilevers",
    title: "Cantilevers that bend far",
    source: "RR and N05, whose models they are: large static deflection, with other programs as reference",
    run,
};

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let study = cantilevers::study(settings.size)?;
    let mut section = Section::new(
        "Neither paper has numbers of a beam that bends far. Here other programs give them, on the same meshes: the non-linear model of \
         RR, with and without fibres, and the corotational one of N05.",
    )
    .setting("beam", "10 × 10 × 40 cm, held at one end; E = 10 kPa, ν = 0.3")
    .setting("solver", "Newton's method over a sparse Cholesky factorisation, in double precision");
    for case in &study.cases {
        let (claim, limit) = (format!("{}: difference from the reference", case.name), case.tolerance);
        section = section.relation(Relation::at_most(claim, case.difference, limit));
    }
    let finest = |nodal: bool| {
        let kind = study.refinements.iter().find(|found| found.name.contains("nodes") == nodal);
        kind.and_then(|found| found.tips.last()).map_or(f64::NAN, |tip| tip.1)
    };
    section = section
        .compare_words(
            "deflection of the tip",
            [
                CURVE,
                &format!("{:.3} m with plain tetrahedra, {:.3} m integrated at the nodes", finest(false), finest(true)),
            ],
            "Plain elements come from below, those integrated at the nodes from above: the truth lies between.",
        )
        .relation(Relation::at_least(
            "tetrahedra integrated at the nodes bend farther than plain ones [times]",
            finest(true) / finest(false),
            1.0,
        ));
    Ok(section.study(&study.report(), |name| match name {
        "cases" => "Against other programs on the same meshes".into(),
        _ => "The tip under a weight of 0.5 m/s², on finer and finer meshes".into(),
    }))
}
