//! The only list of parameters. A new one is an entry here; the page, its ranges and its refusals follow.

use viscera::material::TissuePreset;
use viscera_scene::file::{
    BodyFile, GenerateFile, IntegratorFile, IntegratorName, LawFile, LawName, MeshFile, ModelFile, ModelName,
    Precision, SceneFile,
};
use viscera_scene::quantity::{Acceleration, Density, Length, Pressure, Rate, Time};

use super::choices::{default_model, fits, free_choices, integrators, laws, model_choices, name_of, named};
use super::tissue;
use super::{Bound, Definition, Form};
use crate::message::{Choice, Effect, Scale, Value};

const ABOVE_ZERO: Option<(f64, Bound)> = Some((0.0, Bound::Excluded));
const FROM_ZERO: Option<(f64, Bound)> = Some((0.0, Bound::Included));

/// What every scene has.
pub(super) const OF_WORLD: &[Definition<SceneFile>] = &[
    Definition {
        key: "integrator.kind",
        title: "Integrator",
        summary: "How the equations of motion are stepped.",
        unit: "",
        effect: Effect::Continues,
        form: Form::Choice(|_, _| free_choices(integrators())),
        get: |scene| Some(Value::Text(name_of(scene.integrator.kind))),
        set: |scene, value, _| {
            let Some(kind) = text(value).and_then(named) else { return Vec::new() };
            // The settings of one integrator are refused by another.
            scene.integrator = IntegratorFile { kind, ..IntegratorFile::default() };
            let explicit = kind == IntegratorName::Explicit;
            let undamped = explicit || kind == IntegratorName::QuasiStatic;
            let damped = scene.body.values_mut().filter(|body| undamped && body.stiffness_damping.0 != 0.0);
            let undamped = damped.map(|body| body.stiffness_damping = Time(0.0)).count();
            if !explicit {
                scene.substep = viscera_scene::file::SubstepFile::default();
            }
            let notice = format!("{} steps know no damping by the stiffness: it is 0 now", kind.name());
            Vec::from_iter((undamped > 0).then_some(notice))
        },
    },
    Definition {
        key: "step",
        title: "Time step",
        summary: "Time from one step of the world to the next; an explicit integrator divides it further.",
        unit: "s",
        effect: Effect::Continues,
        form: Form::Number {
            least: Some((1e-5, Bound::Included)),
            most: Some((0.1, Bound::Included)),
            scale: Scale::Logarithmic,
            span: |_| (1e-3, 4e-2),
        },
        get: |scene| Some(Value::Number(scene.step.0)),
        set: |scene, value, _| plain(value.number().map(|number| scene.step = Time(number))),
    },
    Definition {
        key: "gravity",
        title: "Gravity",
        summary: "Acceleration of everything that falls.",
        unit: "m/s²",
        effect: Effect::Continues,
        form: Form::Vector,
        get: |scene| Some(Value::Vector(scene.gravity.map(|component| component.0))),
        set: |scene, value, _| plain(vector(value).map(|vector| scene.gravity = vector.map(Acceleration))),
    },
    Definition {
        key: "precision",
        title: "Precision",
        summary: "Digits of the simulation: single for play, double for comparisons.",
        unit: "",
        effect: Effect::Continues,
        form: Form::Choice(|_, _| {
            let choice = |name: &str, title: &str| Choice {
                name: name.into(),
                title: title.into(),
                available: true,
                reason: None,
            };
            vec![choice("single", "Single"), choice("double", "Double")]
        }),
        get: |scene| Some(Value::Text(name_of(scene.precision))),
        set: |scene, value, _| plain(text(value).and_then(named::<Precision>).map(|chosen| scene.precision = chosen)),
    },
];

/// What every body has.
pub(super) const OF_BODY: &[Definition<BodyFile>] = &[
    Definition {
        key: "model.kind",
        title: "Force model",
        summary: "How the law becomes forces.",
        unit: "",
        effect: Effect::Continues,
        form: Form::Choice(|body, _| model_choices(body)),
        get: |body| Some(Value::Text(name_of(model_of(body)))),
        set: |body, value, opened| {
            let chosen = text(value).and_then(named).filter(|&kind| kind != model_of(body));
            plain(chosen.map(|kind| body.model = Some(model(kind, body, opened))))
        },
    },
    Definition {
        key: "law.tissue",
        title: "Tissue",
        summary: "Law, stiffness and density as they were measured; parts of the body keep their own numbers.",
        unit: "",
        effect: Effect::Continues,
        form: Form::Choice(tissue::choices),
        get: |body| Some(Value::Text(tissue::of(body).map_or(tissue::OWN, |preset| preset.name).into())),
        set: choose_tissue,
    },
    Definition {
        key: "law.kind",
        title: "Law",
        summary: "How the tissue resists deformation.",
        unit: "",
        effect: Effect::Continues,
        form: Form::Choice(|_, _| free_choices(laws())),
        get: |body| Some(Value::Text(name_of(body.law.kind))),
        set: choose_law,
    },
    Definition {
        key: "law.young",
        title: "Young's modulus",
        summary: "How stiff the tissue is; liver about 5 kPa.",
        unit: "Pa",
        effect: Effect::Continues,
        form: Form::Number {
            least: ABOVE_ZERO,
            most: None,
            scale: Scale::Logarithmic,
            span: |default| (default / 20.0, default * 20.0),
        },
        get: |body| body.law.young.map(|young| Value::Number(young.0)),
        set: |body, value, _| plain(value.number().map(|number| body.law.young = Some(Pressure(number)))),
    },
    Definition {
        key: "law.poisson",
        title: "Poisson's ratio",
        summary: "How much it narrows when it is stretched; soft tissue lies between 0.4 and 0.49.",
        unit: "",
        effect: Effect::Continues,
        form: Form::Number {
            least: Some((-1.0, Bound::Excluded)),
            most: Some((0.5, Bound::Excluded)),
            scale: Scale::Linear,
            span: |_| (0.0, 0.49),
        },
        get: |body| body.law.poisson.map(Value::Number),
        set: |body, value, _| plain(value.number().map(|number| body.law.poisson = Some(number))),
    },
    Definition {
        key: "law.lambda",
        title: "First Lamé parameter",
        summary: "Resistance against change of volume, in part.",
        unit: "Pa",
        effect: Effect::Continues,
        form: Form::Number { least: None, most: None, scale: Scale::Linear, span: |default| (0.0, 10.0 * default) },
        get: |body| body.law.lambda.map(|lambda| Value::Number(lambda.0)),
        set: |body, value, _| plain(value.number().map(|number| body.law.lambda = Some(Pressure(number)))),
    },
    Definition {
        key: "law.mu",
        title: "Shear modulus",
        summary: "Resistance against change of shape.",
        unit: "Pa",
        effect: Effect::Continues,
        form: Form::Number {
            least: ABOVE_ZERO,
            most: None,
            scale: Scale::Logarithmic,
            span: |default| (default / 20.0, default * 20.0),
        },
        get: |body| body.law.mu.map(|mu| Value::Number(mu.0)),
        set: |body, value, _| plain(value.number().map(|number| body.law.mu = Some(Pressure(number)))),
    },
    Definition {
        key: "law.fibre.direction",
        title: "Fibre direction",
        summary: "Along which the tissue is stiffer than across; of any length but zero.",
        unit: "",
        effect: Effect::Continues,
        form: Form::Vector,
        get: |body| direction_of(&body.law).map(Value::Vector),
        set: |body, value, _| {
            plain(
                vector(value)
                    .and_then(|direction| fibre_of(&mut body.law).map(|fibre| fibre.direction = Some(direction))),
            )
        },
    },
    Definition {
        key: "law.fibre.factor",
        title: "Stiffness along the fibres",
        summary: "Times that across them; 1 is a tissue without fibres.",
        unit: "",
        effect: Effect::Continues,
        form: Form::Number { least: ABOVE_ZERO, most: None, scale: Scale::Logarithmic, span: |_| (0.2, 20.0) },
        get: |body| factor_of(&body.law).map(Value::Number),
        set: |body, value, _| {
            plain(value.number().and_then(|factor| {
                fibre_of(&mut body.law).map(|fibre| (fibre.young, fibre.factor) = (None, Some(factor)))
            }))
        },
    },
    Definition {
        key: "model.keep-volume",
        title: "Volume stiffness",
        summary: "Force against changes of the volume of each cell; 0 is none.",
        unit: "Pa",
        effect: Effect::Continues,
        form: Form::Number {
            least: FROM_ZERO,
            most: None,
            scale: Scale::Linear,
            span: |default| (0.0, default.max(2e4) * 5.0),
        },
        get: |body| {
            Some(Value::Number(body.model.as_ref().and_then(|model| model.keep_volume).map_or(0.0, |kappa| kappa.0)))
        },
        set: |body, value, _| {
            plain(value.number().map(|kappa| {
                let kind = model_of(body);
                body.model.get_or_insert_with(|| bare(kind)).keep_volume = (kappa > 0.0).then_some(Pressure(kappa));
            }))
        },
    },
    Definition {
        key: "model.adaptive",
        title: "Adaptive threshold",
        summary: "Displacement below which a node follows the linear law alone.",
        unit: "m",
        effect: Effect::Continues,
        form: Form::Number {
            least: ABOVE_ZERO,
            most: None,
            scale: Scale::Logarithmic,
            span: |default| (default / 20.0, default * 20.0),
        },
        get: |body| body.model.as_ref().and_then(|model| model.adaptive).map(|length| Value::Number(length.0)),
        set: |body, value, _| {
            plain(
                value
                    .number()
                    .and_then(|length| body.model.as_mut().map(|model| model.adaptive = Some(Length(length)))),
            )
        },
    },
    Definition {
        key: "density",
        title: "Density",
        summary: "Mass over volume; soft tissue about 1060 kg/m³.",
        unit: "kg/m³",
        effect: Effect::Continues,
        form: Form::Number {
            least: ABOVE_ZERO,
            most: None,
            scale: Scale::Linear,
            span: |default| (0.2 * default, 3.0 * default),
        },
        get: |body| Some(Value::Number(body.density.0)),
        set: |body, value, _| plain(value.number().map(|number| body.density = Density(number))),
    },
    Definition {
        key: "damping",
        title: "Damping",
        summary: "Against the surroundings: each node is held back with rate × mass × velocity.",
        unit: "1/s",
        effect: Effect::Continues,
        form: Form::Number {
            least: FROM_ZERO,
            most: None,
            scale: Scale::Linear,
            span: |default| (0.0, default.max(5.0) * 4.0),
        },
        get: |body| Some(Value::Number(body.damping.0)),
        set: |body, value, _| plain(value.number().map(|number| body.damping = Rate(number))),
    },
    Definition {
        key: "stiffness-damping",
        title: "Stiffness damping",
        summary: "For implicit integrators: a velocity acts as its displacement over this time would.",
        unit: "s",
        effect: Effect::Continues,
        form: Form::Number {
            least: FROM_ZERO,
            most: None,
            scale: Scale::Linear,
            span: |default| (0.0, default.max(0.01) * 5.0),
        },
        get: |body| Some(Value::Number(body.stiffness_damping.0)),
        set: |body, value, _| plain(value.number().map(|number| body.stiffness_damping = Time(number))),
    },
    Definition {
        key: "mesh.edge",
        title: "Edge of the cells",
        summary: "Half of it makes eight times as many cells.",
        unit: "m",
        effect: Effect::Restarts,
        form: Form::Number {
            least: ABOVE_ZERO,
            most: None,
            scale: Scale::Logarithmic,
            span: |default| (0.6 * default, 2.0 * default),
        },
        get: |body| edge_of(&body.mesh).map(|edge| Value::Number(edge.0)),
        set: |body, value, _| {
            plain(value.number().and_then(|number| edge_mut(&mut body.mesh).map(|edge| *edge = Length(number))))
        },
    },
];

/// Takes a tissue by name, or goes back to what the scene had.
fn choose_tissue(body: &mut BodyFile, value: &Value, opened: &BodyFile) -> Vec<String> {
    let mut notices = Vec::new();
    // A tissue without fibres may come between: those of the scene run as they did.
    let course = body.law.fibre.as_ref().or(opened.law.fibre.as_ref());
    let preset = text(value).and_then(TissuePreset::named);
    match preset.and_then(|preset| Some((preset, tissue::numbers(preset, course)?))) {
        Some((preset, (law, density))) => {
            if body.law.fibre.is_some() && law.fibre.is_none() {
                notices.push(format!("the tissue `{}` has no fibres: they are left out", preset.name));
            }
            (body.law, body.density) = (law, density);
        }
        None if tissue::of(body).is_some() => {
            (body.law, body.density, body.part) = (opened.law.clone(), opened.density, opened.part.clone());
        }
        None => return notices,
    }
    let kind = Value::Text(name_of(body.law.kind));
    notices.extend(choose_law(body, &kind, opened));
    notices
}

/// Takes another law, and leaves out what it does not know.
fn choose_law(body: &mut BodyFile, value: &Value, opened: &BodyFile) -> Vec<String> {
    let Some(kind) = text(value).and_then(named::<LawName>) else { return Vec::new() };
    let mut notices = Vec::new();
    body.law.kind = kind;
    for part in &mut body.part {
        part.law.iter_mut().for_each(|law| law.kind = kind);
    }
    if matches!(kind, LawName::NeoHookean | LawName::StableNeoHookean) {
        let had = body.law.fibre.take().is_some();
        let parts = body.part.iter_mut().filter_map(|part| part.law.as_mut()?.fibre.take()).count();
        if had || parts > 0 {
            notices.push(format!("the law `{}` has no fibres: they are left out", name_of(kind)));
        }
    }
    let before = model_of(body);
    if !fits(before, body) {
        let instead = default_model(body);
        body.model = Some(model(instead, body, opened));
        notices.push(format!(
            "the model `{}` does not compute the law `{}`: the model is `{}` now",
            name_of(before),
            name_of(kind),
            name_of(instead)
        ));
    }
    notices
}

fn model_of(body: &BodyFile) -> ModelName {
    body.model.as_ref().map_or_else(|| default_model(body), |model| model.kind)
}

/// Another model for a body, with the settings that the scene had for it when it was opened, or else its default ones.
fn model(kind: ModelName, body: &BodyFile, opened: &BodyFile) -> ModelFile {
    let keep_volume = body.model.as_ref().and_then(|model| model.keep_volume);
    let of_scene = opened.model.clone().filter(|model| model.kind == kind);
    let settings = of_scene.unwrap_or_else(|| bare(kind));
    // Responses are of one tissue on one mesh; to others they are found again.
    let same = (&body.law, &body.part, &body.mesh) == (&opened.law, &opened.part, &opened.mesh);
    let responses = settings.responses.filter(|_| same);
    ModelFile { keep_volume, responses, ..settings }
}

/// A model with its default settings.
pub(crate) fn bare(kind: ModelName) -> ModelFile {
    ModelFile {
        kind,
        keep_volume: None,
        adaptive: None,
        stabilise: None,
        rotation: None,
        strain_displacement: None,
        volume: None,
        tangent: None,
        responses: None,
        dynamic: None,
    }
}

/// The direction of the fibres where there is one; along x where a law that could have fibres has none.
fn direction_of(law: &LawFile) -> Option<[f64; 3]> {
    match (&law.fibre, law.kind) {
        (Some(fibre), _) => fibre.direction,
        (None, LawName::Linear | LawName::StVenantKirchhoff) => Some([1.0, 0.0, 0.0]),
        (None, _) => None,
    }
}

/// How many times stiffer the tissue is along the fibres, where that can be said.
fn factor_of(law: &LawFile) -> Option<f64> {
    match (&law.fibre, law.kind) {
        (Some(fibre), _) => fibre.factor.or_else(|| Some(fibre.young?.0 / law.young?.0)),
        (None, LawName::Linear | LawName::StVenantKirchhoff) => Some(1.0),
        (None, _) => None,
    }
}

/// The fibres of a law that can have some; made where there are none.
fn fibre_of(law: &mut LawFile) -> Option<&mut viscera_scene::file::FibreFile> {
    let (direction, factor) = (direction_of(law), factor_of(law));
    match law.kind {
        LawName::NeoHookean | LawName::StableNeoHookean => None,
        LawName::Linear | LawName::StVenantKirchhoff => Some(law.fibre.get_or_insert(viscera_scene::file::FibreFile {
            direction,
            along: None,
            file: None,
            young: None,
            factor,
            lambda: None,
            mu: None,
        })),
    }
}

fn edge_of(mesh: &MeshFile) -> Option<Length> {
    match mesh {
        MeshFile::Surface(surface) => Some(surface.edge),
        MeshFile::Generate(
            GenerateFile::Cylinder { edge, .. }
            | GenerateFile::Tube { edge, .. }
            | GenerateFile::Liver { edge, .. }
            | GenerateFile::Trunk { edge, .. },
        ) => Some(*edge),
        _ => None,
    }
}

fn edge_mut(mesh: &mut MeshFile) -> Option<&mut Length> {
    match mesh {
        MeshFile::Surface(surface) => Some(&mut surface.edge),
        MeshFile::Generate(
            GenerateFile::Cylinder { edge, .. }
            | GenerateFile::Tube { edge, .. }
            | GenerateFile::Liver { edge, .. }
            | GenerateFile::Trunk { edge, .. },
        ) => Some(edge),
        _ => None,
    }
}

fn text(value: &Value) -> Option<&str> {
    match value {
        Value::Text(text) => Some(text),
        _ => None,
    }
}

fn vector(value: &Value) -> Option<[f64; 3]> {
    match value {
        Value::Vector(vector) => Some(*vector),
        _ => None,
    }
}

/// A change that changes nothing else.
fn plain(_: Option<()>) -> Vec<String> {
    Vec::new()
}
