//! A world that Python described, as a scene file: its meshes beside it, its laws, models, regions, loads and instruments in the scene's
//! words. What a scene has no words for is refused: the file runs to the same bits.

mod fibre;
mod instrument;

use std::path::Path;

use indexmap::IndexMap;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use viscera::body::{Actuator, ActuatorLine, Load, LoosePieces, Muscle, NodeMotion};
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, MatrixForm, Newton, Preconditioning, Scheme};
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{Lame, LawKind};
use viscera::math::{Scalar, Vec3};
use viscera::mesh::{Region, VolumeMesh};
use viscera::solver::Stop;
use viscera::world::{Attachment, BodyId, InstrumentId, Integrator, Substep, World};
use viscera_io::read_volume;
use viscera_io::write::{write_hex_msh, write_tet_msh};

use crate::body::Description;
use crate::error::OrRaise;
use crate::model::AnyModel;
use crate::world::{PyWorld, in_world};

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

use object;

type Json = serde_json::Value;

fn refuse(why: impl Into<String>) -> PyErr {
    PyValueError::new_err(why.into())
}

/// The scene as JSON; writes the meshes of its bodies into `folder` as MSH.
pub(crate) fn scene(world: &PyWorld, duration: f64, folder: &Path) -> PyResult<Json> {
    if !in_world!(&world.world, inner => is_at_its_beginning(inner)) {
        return Err(refuse(
            "a scene begins with bodies at rest, whole, and tools on their paths; this world has moved or was changed. Write it before",
        ));
    }
    let bodies = described(world)?;
    let names: Vec<&String> = bodies.keys().collect();
    if !world.attachments.is_sorted_by_key(|attachment| attachment.body) {
        return Err(refuse(
            "a scene attaches body by body, in their order: attach in the order in which bodies were added",
        ));
    }
    let mut written = serde_json::Map::new();
    for (number, (name, body)) in bodies.iter().enumerate() {
        let file = format!("{name}.msh");
        write_mesh(&body.mesh, &folder.join(&file))?;
        let own = world.attachments.iter().filter(|attachment| attachment.body == BodyId(number));
        written.insert((*name).clone(), self::body(body, &file, &attached(own, &names))?);
    }
    let mut instruments = serde_json::Map::new();
    let present: Vec<InstrumentId> = in_world!(&world.world, inner => inner.instrument_ids().collect());
    for id in present {
        let (name, tool) = &world.instruments[id.0];
        let tool = tool.as_ref().ok_or_else(built_from_a_scene)?;
        if instruments.insert(name.clone(), instrument::instrument(name, tool)?).is_some() {
            return Err(refuse(format!("two instruments are named `{name}`; names in a scene differ")));
        }
    }
    let (config, factorises) =
        in_world!(&world.world, inner => (inner.config().clone(), inner.static_solver().factorises()));
    let (integrator, substep) = integrator(config.integrator, factorises);
    Ok(object! {
        "gravity": Json::from(config.gravity.to_vec()),
        "duration": Json::from(duration),
        "step": Json::from(config.step),
        "substep": substep,
        "precision": Json::from(world.precision()),
        "integrator": integrator,
        "body": Json::Object(written),
        "instrument": Json::Object(instruments),
    })
}

fn built_from_a_scene() -> PyErr {
    refuse("the world was built from a scene: write that, with `Scene.to_toml`")
}

/// Bodies by name.
fn described(world: &PyWorld) -> PyResult<IndexMap<String, &Description>> {
    let mut bodies = IndexMap::new();
    for body in &world.descriptions {
        let body = body.as_ref().ok_or_else(built_from_a_scene)?;
        if bodies.insert(body.name.clone(), body).is_some() {
            return Err(refuse(format!("two bodies are named `{}`; names in a scene differ", body.name)));
        }
    }
    Ok(bodies)
}

/// Whether nothing has happened that a scene cannot say. Nodes that are moved along a way stand where it begins.
fn is_at_its_beginning<T: Scalar>(world: &World<T>) -> bool {
    let is_whole = |id: BodyId| {
        let (body, rest) = (world.body(id), world.body(id).mesh().nodes());
        let state = body.state();
        let at_rest = |node: usize| {
            state.velocities[node] == Vec3::ZERO
                && (state.motions[node] != NodeMotion::Free || state.positions[node] == rest[node].cast())
        };
        state.removed_count == 0 && (0..rest.len()).all(at_rest)
    };
    world.steps() == 0
        && world.body_ids().all(is_whole)
        && world.instrument_ids().all(|id| world.tool(id).hand.is_none())
}

/// Writes a mesh, and sees that it comes back as it is: reading repairs, and may leave out nodes of no cell.
fn write_mesh(mesh: &VolumeMesh, path: &Path) -> PyResult<()> {
    match mesh {
        VolumeMesh::Tet(mesh) => write_tet_msh(path, mesh),
        VolumeMesh::Hex(mesh) => write_hex_msh(path, mesh),
    }
    .or_raise()?;
    let back = read_volume(path, 1.0).or_raise()?.mesh;
    let cells = |mesh: &VolumeMesh| match mesh {
        VolumeMesh::Tet(mesh) => mesh.cells.concat(),
        VolumeMesh::Hex(mesh) => mesh.cells.concat(),
    };
    if back.nodes() == mesh.nodes() && cells(&back) == cells(mesh) {
        Ok(())
    } else {
        Err(refuse(
            "a mesh that is read is repaired, and this one needs it: describe the body with what `checked` gives",
        ))
    }
}

fn attached<'a>(attachments: impl Iterator<Item = &'a Attachment>, names: &[&String]) -> Vec<Json> {
    let one = |attachment: &Attachment| {
        object! { "region": region(&attachment.region), "to": Json::from(names[attachment.to.0].as_str()) }
    };
    attachments.map(one).collect()
}

fn body(body: &Description, file: &str, attached: &[Json]) -> PyResult<Json> {
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
        "model": model(&body.model, body.keep_volume)?,
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
        "attach": Json::from(attached.to_vec()),
        "exact-volume": Json::from(body.exact_volumes.iter().map(|(name, at)| object! {
            "name": Json::from(name.as_str()),
            "region": region(at),
        }).collect::<Vec<_>>()),
        "rigid": each(&body.rigid),
        "muscle": Json::from(body.muscles.iter().map(muscle).collect::<Vec<_>>()),
        "actuator": Json::from(body.actuators.iter().filter_map(actuator).collect::<Vec<_>>()),
        "active-fibre": Json::from(body.actuators.iter().filter_map(active_fibre).collect::<Vec<_>>()),
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

fn muscle(muscle: &Muscle) -> Json {
    object! {
        "region": region(&muscle.region),
        "stiffness": Json::from(muscle.stiffness),
        "contraction": Json::from(muscle.contraction),
        "activation": curve(&muscle.activation, Json::from),
    }
}

fn actuator(actuator: &Actuator) -> Option<Json> {
    let ActuatorLine::Between { from, to } = &actuator.line else { return None };
    Some(object! {
        "from": region(from),
        "to": region(to),
        "stiffness": Json::from(actuator.stiffness),
        "length": curve(&actuator.length, Json::from),
        "force": curve(&actuator.tension, Json::from),
    })
}

fn active_fibre(actuator: &Actuator) -> Option<Json> {
    let ActuatorLine::Along { region: at, direction } = &actuator.line else { return None };
    Some(object! {
        "region": region(at),
        "direction": Json::from(direction.to_vec()),
        "young": Json::from(actuator.stiffness),
        "length": curve(&actuator.length, Json::from),
        "stress": curve(&actuator.tension, Json::from),
    })
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
        Load::BodyForce { region: at, per_volume } => {
            object! { "region": region(at), "body-force": curve(per_volume, vector) }
        }
        Load::Attraction { region: at, centre, radius, per_volume } => object! {
            "region": region(at),
            "attraction": object! {
                "centre": Json::from(centre.to_vec()),
                "radius": Json::from(*radius),
                "per-volume": curve(per_volume, Json::from),
            },
        },
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

/// The law, if it is the same everywhere.
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
    let matrix = Lame { lambda: values[0], mu: values[1] };
    let fibre = has_fibres.then(|| fibre::fibre(matrix, rest.direction, rest.fibre_stiffness)).transpose()?;
    Ok(object! {
        "kind": Json::from(name),
        "lambda": Json::from(values[0]),
        "mu": Json::from(values[1]),
        "fibre": fibre,
    })
}

fn model(model: &AnyModel, keep_volume: f64) -> PyResult<Json> {
    if matches!(model, AnyModel::TotalLagrangian(_, false)) {
        return Err(refuse(
            "a scene has no words for `gauss` and `plain`: it takes 2 points along an edge, and the faster form",
        ));
    }
    let word = |word: &Option<String>| word.clone().map(Json::from);
    let number = |number: Option<f64>| number.map(Json::from);
    let none = [const { None }; 4];
    let (adaptive, stabilise, words) = match model {
        AnyModel::TensorMass(_, adaptive) => (*adaptive, None, &none),
        AnyModel::NodallyIntegrated(_, stabilise) => (None, *stabilise, &none),
        AnyModel::Corotational(_, words) => (None, None, words),
        _ => (None, None, &none),
    };
    let dynamic = match model {
        AnyModel::Hybrid(_, dynamic) => dynamic.as_ref().map(region),
        _ => None,
    };
    Ok(object! {
        "kind": Json::from(model.recipe().kind().info().name),
        "keep-volume": (keep_volume != 0.0).then(|| Json::from(keep_volume)),
        "adaptive": number(adaptive),
        "stabilise": number(stabilise),
        "rotation": word(&words[0]),
        "strain-displacement": word(&words[1]),
        "volume": word(&words[2]),
        "tangent": word(&words[3]),
        "dynamic": dynamic,
    })
}

/// The integrator, and the sub-step where it has one.
fn integrator(integrator: Integrator, factorises: bool) -> (Json, Json) {
    match integrator {
        Integrator::Explicit(Substep::Automatic) => (object! { "kind": Json::from("explicit") }, "auto".into()),
        Integrator::Explicit(Substep::Fixed(time)) => (object! { "kind": Json::from("explicit") }, time.into()),
        Integrator::Implicit(settings) => (implicit(settings), "auto".into()),
        Integrator::QuasiStatic(settings) => (quasi_static(settings, factorises), "auto".into()),
    }
}

fn quasi_static(settings: QuasiStatic, factorises: bool) -> Json {
    let full = object! { "tolerance": Json::from(settings.tolerance), "iterations": Json::from(settings.iterations) };
    let newton = if settings.small_strain { Json::from("linearised") } else { full };
    let solver = factorises.then(|| Json::from("direct"));
    object! { "kind": Json::from("quasi-static"), "newton": newton, "solver": solver }
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
