//! Laws, models and integrators, from the registries and from the documentation of the scene file's keys.

use serde::Serialize;
use serde::de::DeserializeOwned;
use viscera::material::LawKind;
use viscera::model::ModelKind;
use viscera_scene::file::CellShape;
use viscera_scene::file::{BodyFile, GenerateFile, LawName, MeshFile, ModelName};

use crate::message::{Choice, Entry};

/// The laws.
pub(crate) fn laws() -> Vec<Entry> {
    entries("LawName")
}

/// The force models.
pub(crate) fn models() -> Vec<Entry> {
    let purpose = |name: &str| ModelKind::ALL.iter().map(|kind| kind.info()).find(|info| info.name == name);
    let mut models = entries("ModelName");
    for model in &mut models {
        if let Some(info) = purpose(&model.name) {
            model.summary = info.purpose.into();
        }
    }
    models
}

/// The integrators.
pub(crate) fn integrators() -> Vec<Entry> {
    entries("IntegratorName")
}

/// The names of an enumeration of the scene file, with what its documentation says.
fn entries(definition: &str) -> Vec<Entry> {
    let schema = viscera_scene::schema();
    let names = schema["definitions"][definition]["oneOf"].as_array().cloned().unwrap_or_default();
    let entry = |name: serde_json::Value| {
        let text = |key: &str| name[key].as_str().unwrap_or_default().to_owned();
        Entry { title: title(&text("const")), name: text("const"), summary: text("description") }
    };
    names.into_iter().map(entry).collect()
}

/// `st-venant-kirchhoff` as a person writes it: "St Venant–Kirchhoff".
fn title(name: &str) -> String {
    match name {
        "st-venant-kirchhoff" => return "St Venant–Kirchhoff".into(),
        "neo-hookean" => return "Neo-Hookean".into(),
        "stable-neo-hookean" => return "Stable neo-Hookean".into(),
        "total-lagrangian" => return "Total Lagrangian".into(),
        "backward-euler" => return "Backward Euler".into(),
        "bdf2" => return "BDF2".into(),
        "newmark" => return "Newmark".into(),
        "energy-momentum" => return "Energy–momentum".into(),
        _ => {}
    }
    let words = name.replace('-', " ");
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The name of a value as it stands in scenes.
pub(super) fn name_of(value: impl Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
}

/// The value of a name.
pub(super) fn named<V: DeserializeOwned>(name: &str) -> Option<V> {
    serde_json::from_value(name.into()).ok()
}

/// The engine's law for one of the scene, with fibres or without.
fn kind_of(law: LawName, has_fibres: bool) -> LawKind {
    match (law, has_fibres) {
        (LawName::Linear, false) => LawKind::LinearElastic,
        (LawName::Linear, true) => LawKind::TransverseLinear,
        (LawName::StVenantKirchhoff, false) => LawKind::StVenantKirchhoff,
        (LawName::StVenantKirchhoff, true) => LawKind::TransverseStVenantKirchhoff,
        (LawName::NeoHookean, _) => LawKind::NeoHookean,
        (LawName::StableNeoHookean, _) => LawKind::StableNeoHookean,
    }
}

/// Whether the cells of a body are known to be hexahedra: those of a file show when it is read.
fn is_of_hexahedra(body: &BodyFile) -> bool {
    matches!(&body.mesh, MeshFile::Generate(GenerateFile::Box { shape: CellShape::Hexahedra, .. }))
}

/// The model that a body has where the scene names none.
pub(super) fn default_model(body: &BodyFile) -> ModelName {
    match body.law.kind {
        _ if is_of_hexahedra(body) => ModelName::TotalLagrangian,
        LawName::Linear => ModelName::LinearTensorMass,
        LawName::StVenantKirchhoff => ModelName::TensorMass,
        LawName::NeoHookean | LawName::StableNeoHookean => ModelName::TotalLagrangian,
    }
}

/// Whether a model computes the law of a body on its cells.
pub(super) fn fits(model: ModelName, body: &BodyFile) -> bool {
    let (name, law) = (name_of(model), kind_of(body.law.kind, body.law.fibre.is_some()));
    let mut infos = ModelKind::ALL.iter().map(|kind| kind.info());
    infos.any(|info| info.name == name && info.laws.contains(&law) && (info.hexahedra || !is_of_hexahedra(body)))
}

/// Models, and which of them fit.
pub(super) fn model_choices(body: &BodyFile) -> Vec<Choice> {
    let choice = |entry: Entry| {
        let available = named(&entry.name).is_some_and(|model| fits(model, body));
        let law = kind_of(body.law.kind, body.law.fibre.is_some()).name();
        let reason = (!available).then(|| {
            let cells = if is_of_hexahedra(body) { " on hexahedra" } else { "" };
            format!("it does not compute the law `{law}`{cells}; choose another law first")
        });
        Choice { name: entry.name, title: entry.title, available, reason }
    };
    models().into_iter().map(choice).collect()
}

/// Entries of which every one can be chosen.
pub(super) fn free_choices(entries: Vec<Entry>) -> Vec<Choice> {
    let choice = |Entry { name, title, .. }| Choice { name, title, available: true, reason: None };
    entries.into_iter().map(choice).collect()
}
