//! Tissues by name, as scenes take them: law, numbers and density that were measured.

use viscera::material::TissuePreset;
use viscera_scene::file::{BodyFile, FibreFile, LawFile};
use viscera_scene::quantity::{Density, Pressure};

use super::choices::named;
use crate::message::Choice;

/// What a tissue that has no name is called.
pub(super) const OWN: &str = "own";

/// Every tissue, and the numbers that the scene gives of its own.
pub(super) fn choices(body: &BodyFile, opened: &BodyFile) -> Vec<Choice> {
    let choice = |preset: &TissuePreset| Choice {
        name: preset.name.into(),
        title: preset.title.into(),
        available: true,
        reason: None,
    };
    let of_scene = of(opened).filter(|_| of(body).is_some());
    let own = Choice {
        name: OWN.into(),
        title: "Numbers of its own".into(),
        available: of_scene.is_none(),
        reason: of_scene.map(|preset| format!("the scene has those of `{}`; change one of them", preset.name)),
    };
    std::iter::once(own).chain(TissuePreset::ALL.iter().map(choice)).collect()
}

/// The tissue whose law, numbers and density a body has.
pub(super) fn of(body: &BodyFile) -> Option<&'static TissuePreset> {
    TissuePreset::ALL.iter().find(|preset| {
        numbers(preset, body.law.fibre.as_ref())
            .is_some_and(|(law, density)| law == body.law && density == body.density)
    })
}

/// The law and the density of a tissue, with fibres that run so, if it has any.
pub(super) fn numbers(preset: &TissuePreset, course: Option<&FibreFile>) -> Option<(LawFile, Density)> {
    let (mut young, mut fibre) = (preset.young.value, None);
    // Fibres hold the sides of what is pulled across them: the matrix between them is softer than the tissue.
    if let (Some(course), Ok(Some((matrix, factor)))) = (course, preset.matrix_and_factor()) {
        young = matrix.young();
        fibre = Some(FibreFile { young: None, factor: Some(factor), lambda: None, mu: None, ..course.clone() });
    }
    let law = LawFile {
        kind: named(preset.law.name())?,
        young: Some(Pressure(young)),
        poisson: Some(preset.poisson.value),
        lambda: None,
        mu: None,
        fibre,
    };
    Some((law, Density(preset.density.value)))
}
