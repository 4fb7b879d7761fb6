//! A clamped beam under its weight, against beam theory.

use viscera::body::Body;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{StVenantKirchhoff, Tissue};
use viscera::mesh::TetMesh;
use viscera::model::NodallyIntegrated;
use viscera_validation::setting::{Settled, plane};
use viscera_validation::{Settings, Size, fixed_beam};

use super::{CURVE, Experiment};
use crate::deformed::{Deformed, Vector, camera, photograph};
use crate::section::Photograph;
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "beam",
    title: "A clamped beam",
    source: "N05, section 5: beam under its weight against beam theory",
    run,
};

/// How many times as large as they are the picture shows displacements.
const SHOWN: f64 = 200.0;

/// The beam of the study, integrated at the nodes.
fn picture(size: Size) -> Result<Photograph, ReproduceError> {
    let fine = if size == Size::Full { 2 } else { 1 };
    let mesh = TetMesh::box_grid([40 * fine, 4 * fine, 2 * fine], [40.0, 4.0, 2.0]);
    // In one linear solve a quadratic law is a linear one.
    let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(20e3, 0.3)?);
    let body = Body::new(mesh.clone(), 1.0).model(NodallyIntegrated::new(tissue)).fix(plane(0, 0.0));
    let once = QuasiStatic { small_strain: true, ..QuasiStatic::default() };
    let moved = Settled::new(body, [0.0, 0.0, -1e-3], &once)?.displacements();
    let shape = Deformed::new(&mesh, &moved.into_iter().map(|u| u * SHOWN).collect::<Vec<Vector>>());
    let view = camera([&shape], [-0.3, 1.0, -0.3], [0.0, 0.0, 1.0]);
    let caption = format!("The beam at rest and under its weight; displacements {SHOWN} times as large as they are");
    Ok(photograph("beam", caption, view, [shape.ghost(), shape.body()])?)
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let study = fixed_beam::study(settings.size)?;
    let finest = study.deflections.iter().map(|found| found.level).max().unwrap_or(1);
    let at =
        |poisson: f64| study.deflections.iter().filter(move |found| found.poisson == poisson && found.level == finest);
    let mut section = Section::new(
        "A beam of 40 × 4 × 2 m, held at one end, sinks under its weight; linear statics. Beam theory gives its line, and quadratic \
         hexahedra what a continuum does. Plain elements of low order are too stiff in bending, those integrated at the nodes \
         too soft, by less the more cells there are over the height.",
    )
    .setting("tissue", "E = 20 kPa, ν = 0, 0.3 and 0.45, density 1 kg/m³")
    .setting("gravity", "0.001 m/s²: with 9.81 m/s², as printed, the tip would sink by 471 m")
    .setting("cells", format!("40 × 4 × 2, refined up to {finest} times"));
    for found in at(0.3) {
        let name = found.element.name();
        let ours = format!("{:.1} % of the converged deflection", 100.0 * found.of_converged);
        let why = if found.element.nodal {
            "Too soft, by less the more cells lie over the height; no element of the paper is of this kind."
        } else {
            "Two to six cells of low order over the height: they lock in bending."
        };
        section = section.compare_words(format!("tip, {name}"), [CURVE, &ours], why);
    }
    let worst = study.deflections.iter().filter_map(|found| found.difference).fold(0.0, f64::max);
    section = section.relation(Relation::at_most("difference from three other programs on the same mesh", worst, 1e-8));
    for length in &study.lengths {
        let claim = format!("the tip sinks as the fourth power of the length, {}", length.element.name());
        section = section.relation(Relation::near(claim, length.power(), 4.0, 0.04));
    }
    let mut between = at(0.3).map(|found| (found.of_converged, found.element.nodal));
    let holds_between = between.all(|(ratio, nodal)| (ratio > 1.0) == nodal);
    section = section.relation(Relation::at_least(
        "plain elements are too stiff and those integrated at the nodes too soft: the truth lies between (1: yes)",
        f64::from(u8::from(holds_between)),
        1.0,
    ));
    Ok(section.pictures(vec![picture(settings.size)?]).study(&study.report(), |name| match name {
        "length" => "By which power of the length the tip sinks; 4 by beam theory".into(),
        _ => "The tip".into(),
    }))
}
