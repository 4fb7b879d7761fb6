//! Nearly incompressible tissue: what locks and what does not.

use viscera_validation::nearly_incompressible::{self, Convergence};
use viscera_validation::{Settings, brief};

use super::{CURVE, Experiment};
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "nearly-incompressible",
    title: "Tissue that keeps its volume",
    source: "N05, section 5: ν = 0.499 in the truth cube; RR, section 4: volume",
    run,
};

/// The result on the finest mesh over the converged one.
fn finest(found: &Convergence) -> f64 {
    found.ratios.last().map_or(f64::NAN, |last| last.1)
}

/// What of the converged result elements reach at least and at most.
fn span(study: &[Convergence], nodal: bool) -> (f64, f64) {
    let ratios = study.iter().filter(|found| found.element.nodal == nodal).map(finest);
    ratios.fold((f64::INFINITY, 0.0), |(least, most), ratio| (least.min(ratio), most.max(ratio)))
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let study = nearly_incompressible::study(settings.size)?;
    let mut section = Section::new(
        "Tissue is mostly water and keeps its volume. Elements of low order that keep the volume of every cell have then hardly any way \
         left to deform: they lock. Tetrahedra integrated at the nodes do not.",
    )
    .setting("reference", "mixed elements of second and third order (dolfinx)");
    let bodies = [("Cook's membrane", "deflection", &study.cook), ("glued cube", "force", &study.cube)];
    for (body, what, found) in bodies {
        let (plain, nodal) = (span(found, false), span(found, true));
        let ours = format!(
            "plain elements {} to {} of the converged {what}, integrated at the nodes {} to {}",
            brief(plain.0),
            brief(plain.1),
            brief(nodal.0),
            brief(nodal.1)
        );
        section = section.compare_words(body, [CURVE, &ours], "Plain elements lock; the papers have no other.");
        let off = f64::max(1.0 - nodal.0, nodal.1 - 1.0);
        let claim = format!("{body}, integrated at the nodes: off the converged {what}");
        section = section.relation(Relation::at_most(claim, off, 0.12));
        let nearest = f64::min((1.0 - plain.0).abs(), (1.0 - plain.1).abs());
        let claim = format!("{body}, plain elements: off it");
        section = section.relation(Relation::at_least(claim, nearest, 0.4));
    }
    let worst = study.locked.iter().map(|locked| locked.difference).fold(0.0, f64::max);
    section = section.relation(Relation::at_most("what locks, locks as in another program: difference", worst, 1e-6));
    Ok(section.study(&study.report(), |name| match name {
        "cook" => "Cook's membrane, ν = 0.4999: deflection over the converged one".into(),
        "cube" => "A glued cube, ν = 0.499, pressed by 5 %: force over the converged one".into(),
        _ => "What locks, beside the same elements of another program".into(),
    }))
}
