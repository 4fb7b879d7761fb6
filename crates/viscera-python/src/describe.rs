//! A world that Python described, as a scene file: its meshes beside it, its laws, models, regions and loads in the scene's words.

use std::path::Path;

use indexmap::IndexMap;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use viscera::body::{Load, LoosePieces};
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, MatrixForm, Newton, Preconditioning, Scheme};
use viscera::material::LawKind;
use viscera::math::Vec3;
use viscera::mesh::{Region, VolumeMesh};
use viscera::solver::Stop;
use viscera::world::{Integrator, Substep, WorldConfig};
use viscera_io::write::{write_hex_msh, write_tet_msh};

use crate::body::Description;
use crate::error::OrRaise;
use crate::model::AnyModel;

/// A JSON object from pairs, without those that are not given.
macro_rules! object {
    ($($key:literal: $value:expr),* $(,)?) => {{
        let mut object = serde_json::Map::new();
        $(if let Some(value) = Option::<serde_json::Value>::from($value) {
            object.insert($key.into(), value);
        })*
        serde_json::Value::Object(object)
    }};
}

type Json = serde_json::Value;

fn refuse(why: impl Into<String>) -> PyErr {
    PyValueError::new_err(why.into())
}

/// The scene as JSON; writes the meshes of `bodies` into `folder` as MSH.
pub(crate) fn scene(
    config: &WorldConfig,
    precision: &str,
    duration: f64,
    bodies: &IndexMap<String, Description>,
    folder: &Path,
) -> PyResult<Json> {
    let mut described = serde_json::Map::new();
    for (name, body) in bodies {
        let file = format!("{name}.msh");
        match &*body.mesh {
            VolumeMesh::Tet(mesh) => write_tet_msh(folder.join(&file), mesh),
            VolumeMesh::Hex(mesh) => write_hex_msh(folder.join(&file), mesh),
        }
        .or_raise()?;
        described.insert(name.clone(), self::body(body, &file)?);
    }
    let (integrator, substep) = integrator(config.integrator);
    Ok(object! {
        "gravity": Json::from(config.gravity.to_vec()),
        "duration": Json::from(duration),
        "step": Json::from(config.step),
        "substep": substep,
        "precision": Json::from(precision),
        "integrator": integrator,
        "body": Json::Object(described),
    })
}

fn body(body: &Description, file: &str) -> PyResult<Json> {
    let &[density] = &body.densities[..] else {
        return Err(refuse(
            "a scene file has one density for a body, and `part`s with others; this one has one for each cell",
        ));
    };
    let each = |regions: &[Region]| Json::from(regions.iter().map(region).collect::<Vec<_>>());
    Ok(object! {
        "mesh": object! { "file": Json::from(file) },
        "density": Json::from(density),
        "law": law(&body.model)?,
        "model": model(&body.model, body.keep_volume),
        "damping": Json::from(body.damping),
        "stiffness-damping": (body.stiffness_damping != 0.0).then(|| Json::from(body.stiffness_damping)),
        "fix": (!body.fixed.is_empty()).then(|| each(&body.fixed)),
        "loose-pieces": Json::from(match body.loose_pieces {
            LoosePieces::Free => "free",
            LoosePieces::Drop => "drop",
        }),
        "slide": Json::from(body.guided.iter().map(|(at, normal, way)| object! {
            "region": region(at),
            "normal": Json::from(normal.to_vec()),
            "displacement": curve(way, Json::from),
        }).collect::<Vec<_>>()),
        "prescribe": Json::from(body.prescribed.iter().map(|(at, way)| object! {
            "region": region(at),
            "displacement": curve(way, vector),
        }).collect::<Vec<_>>()),
        "load": Json::from(body.loads.iter().map(load).collect::<Vec<_>>()),
    })
}

fn vector(value: Vec3<f64>) -> Json {
    Json::from(value.to_array().to_vec())
}

fn curve<V: viscera::curve::CurveValue>(curve: &Curve<V>, value: impl Fn(V) -> Json) -> Json {
    match curve.points() {
        [(_, constant)] => value(*constant),
        points => points.iter().map(|&(time, at)| Json::from(vec![Json::from(time), value(at)])).collect(),
    }
}

fn load(load: &Load) -> Json {
    match load {
        Load::Force { region: at, total } => object! { "region": region(at), "force": curve(total, vector) },
        Load::Pressure { region: at, pressure } => {
            object! { "region": region(at), "pressure": curve(pressure, Json::from) }
        }
        Load::Traction { region: at, traction } => {
            object! { "region": region(at), "traction": curve(traction, vector) }
        }
    }
}

fn region(region: &Region) -> Json {
    let list = |parts: &[Region]| Json::from(parts.iter().map(self::region).collect::<Vec<_>>());
    match region {
        Region::All => "all".into(),
        Region::Surface => "surface".into(),
        Region::Named(name) => object! { "group": Json::from(name.as_str()) },
        Region::Nodes(numbers) => object! { "nodes": Json::from(numbers.clone()) },
        Region::Nearest(place) => object! { "nearest": vector(*place) },
        Region::Box { low, high } => object! { "box": object! { "low": vector(*low), "high": vector(*high) } },
        Region::Sphere { centre, radius } => {
            object! { "sphere": object! { "centre": vector(*centre), "radius": Json::from(*radius) } }
        }
        Region::Plane { point, normal, thickness } => object! { "plane": object! {
            "point": vector(*point),
            "normal": vector(*normal),
            "thickness": (*thickness > 0.0).then(|| Json::from(*thickness)),
        } },
        Region::HalfSpace { point, normal } => {
            object! { "half-space": object! { "point": vector(*point), "normal": vector(*normal) } }
        }
        Region::Union(parts) => list(parts),
        Region::Intersection(parts) => object! { "intersection": list(parts) },
    }
}

/// The law, if it is the same everywhere. Fibres stand in the file by their λ and μ, of which only κ_a = (λL − λ)/2 + μL − μ acts:
/// μL = μ then, and λL is what κ_a asks for.
fn law(model: &AnyModel) -> PyResult<Json> {
    let recipe = model.recipe();
    let tissue = recipe.tissue();
    if !tissue.is_uniform() {
        return Err(refuse(
            "a scene file has one law for a body, and `part`s with others; this one has one for each cell",
        ));
    }
    let (values, kind) = (tissue.values(0), tissue.kind());
    let (name, has_fibres) = match kind {
        LawKind::LinearElastic => ("linear", false),
        LawKind::TransverseLinear => ("linear", true),
        LawKind::TransverseStVenantKirchhoff => ("st-venant-kirchhoff", true),
        isotropic => (isotropic.name(), false),
    };
    let rest = tissue.at_rest(0);
    let fibre = has_fibres.then(|| {
        object! {
            "direction": vector(rest.direction),
            "lambda": Json::from(rest.lame.lambda + 2.0 * rest.fibre_stiffness),
            "mu": Json::from(rest.lame.mu),
        }
    });
    Ok(object! {
        "kind": Json::from(name),
        "lambda": Json::from(values[0]),
        "mu": Json::from(values[1]),
        "fibre": fibre,
    })
}

fn model(model: &AnyModel, keep_volume: f64) -> Json {
    let word = |word: &Option<String>| word.clone().map(Json::from);
    let number = |number: Option<f64>| number.map(Json::from);
    let none = [const { None }; 4];
    let (adaptive, stabilise, words) = match model {
        AnyModel::TensorMass(_, adaptive) => (*adaptive, None, &none),
        AnyModel::NodallyIntegrated(_, stabilise) => (None, *stabilise, &none),
        AnyModel::Corotational(_, words) => (None, None, words),
        _ => (None, None, &none),
    };
    object! {
        "kind": Json::from(model.recipe().kind().info().name),
        "keep-volume": (keep_volume != 0.0).then(|| Json::from(keep_volume)),
        "adaptive": number(adaptive),
        "stabilise": number(stabilise),
        "rotation": word(&words[0]),
        "strain-displacement": word(&words[1]),
        "volume": word(&words[2]),
        "tangent": word(&words[3]),
    }
}

/// The integrator, and the sub-step where it has one.
fn integrator(integrator: Integrator) -> (Json, Json) {
    match integrator {
        Integrator::Explicit(Substep::Automatic) => (object! { "kind": Json::from("explicit") }, "auto".into()),
        Integrator::Explicit(Substep::Fixed(time)) => (object! { "kind": Json::from("explicit") }, time.into()),
        Integrator::Implicit(settings) => (implicit(settings), "auto".into()),
    }
}

fn implicit(settings: Implicit) -> Json {
    let (kind, numbers) = match settings.scheme {
        Scheme::BackwardEuler => ("backward-euler", None),
        Scheme::Newmark { beta, gamma } => ("newmark", Some((beta, gamma))),
        Scheme::Bdf2 => ("bdf2", None),
        Scheme::EnergyMomentum => ("energy-momentum", None),
    };
    let linear = match settings.linear {
        Stop::Iterations(count) => object! { "iterations": Json::from(count) },
        Stop::Tolerance { relative, at_most } => {
            object! { "tolerance": Json::from(relative), "iterations": Json::from(at_most) }
        }
    };
    object! {
        "kind": Json::from(kind),
        "newton": match settings.newton {
            Newton::Linearised => Json::from("linearised"),
            Newton::Full { relative, at_most } => {
                object! { "tolerance": Json::from(relative), "iterations": Json::from(at_most) }
            }
        },
        "linear": linear,
        "matrix": Json::from(match settings.matrix {
            MatrixForm::Free => "matrix-free",
            MatrixForm::Assembled => "assembled",
        }),
        "preconditioner": Json::from(match settings.preconditioner {
            Preconditioning::BlockJacobi => "block-jacobi",
            Preconditioning::Multigrid => "multigrid",
        }),
        "beta": numbers.map(|(beta, _)| Json::from(beta)),
        "gamma": numbers.map(|(_, gamma)| Json::from(gamma)),
    }
}
