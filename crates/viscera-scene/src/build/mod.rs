//! From a checked scene to a world.

mod action;
mod attachment;
mod body;
mod csv;
mod curve;
mod instrument;
mod integrator;
mod law;
mod mesh;
mod model;
mod precompute;
mod region;
mod site;

use indexmap::IndexMap;
use viscera::math::Scalar;
use viscera::model::Precision;
use viscera::world::{AttachmentId, BodyId, InstrumentId, World, WorldConfig, WorldError};

use crate::error::SceneErrors;
use crate::file::SceneFile;
use crate::scene::Scene;
pub use mesh::Meshes;
pub use precompute::BodyResponses;
use site::Site;

/// A world that is ready to run, and the names that the scene gives to what is in it.
pub struct BuiltScene<T: Scalar> {
    /// What the file says, defaults filled in.
    pub file: SceneFile,
    /// The world, at time 0.
    pub world: World<T>,
    /// Bodies by name, in the order of the file.
    pub bodies: IndexMap<String, BodyId>,
    /// Attachments by the name of the body that is attached, in the order of the file.
    pub attachments: IndexMap<String, Vec<AttachmentId>>,
    /// Instruments by name, in the order of the file.
    pub instruments: IndexMap<String, InstrumentId>,
    /// What was found and repaired in mesh files, and what tools cannot do, by the name of the body.
    pub notices: Vec<(String, String)>,
}

impl<T: Scalar> BuiltScene<T> {
    /// Steps of the world that the scene's duration takes.
    pub fn steps(&self) -> u64 {
        // A duration of whole steps is one, though 4 s / 5 ms is not 800 in every last bit.
        let steps = self.file.duration.0 / self.file.step.0;
        (steps - 1e-9 * steps).ceil().max(1.0) as u64
    }
}

impl Scene {
    /// Builds the world: reads meshes and curves, finds regions, assembles models. `T` is the precision, `f32` or `f64`;
    /// [`SceneFile::precision`] tells which one the scene asks for.
    ///
    /// # Errors
    /// All that [`check`](Self::check) finds; and the first file that cannot be read, region that selects nothing, law
    /// that the model does not compute, or substep that is too long.
    pub fn build<T: Precision>(&self) -> Result<BuiltScene<T>, SceneErrors> {
        self.build_reusing(&mut Meshes::default())
    }

    /// The same, where `meshes` has what was read and made before by scenes with the same files.
    ///
    /// # Errors
    /// As [`Scene::build`].
    pub fn build_reusing<T: Precision>(&self, meshes: &mut Meshes) -> Result<BuiltScene<T>, SceneErrors> {
        let file = self.check()?;
        let root = Site::root(self);
        let config = WorldConfig {
            gravity: file.gravity.map(|component| component.0),
            step: file.step.0,
            integrator: integrator::integrator(&file, &root)?,
        };
        let mut world = World::new(config).map_err(|error| root.error(error, ""))?;
        if let Some(solver) = integrator::static_solver(&file.integrator) {
            world.set_static_solver(solver).map_err(|error| root.key("integrator").error(error, ""))?;
        }
        let mut notices = Vec::new();
        let mut bodies = IndexMap::new();
        for (name, described) in &file.body {
            let site = root.key("body").key(name);
            let (body, of_mesh) = body::body(name, described, meshes, &site)?;
            notices.extend(of_mesh.into_iter().map(|notice| (name.clone(), notice)));
            let id = world.add(body).map_err(|error| match &error {
                WorldError::Body(of_body) => body::blame(of_body, &site),
                WorldError::UnstableSubstep { substep, stable, .. } => root.key("substep").error(
                    format!("body `{name}` blows up at substeps of {substep:.3e} s"),
                    format!("the longest stable one is {stable:.3e} s; \"auto\" finds it by itself"),
                ),
                WorldError::StiffnessDampingNeedsImplicit { .. } => site.key("stiffness-damping").error(
                    format!("the integrator `{}` knows no damping by the stiffness", file.integrator.kind.name()),
                    "take an implicit one, such as `backward-euler`, or `damping`",
                ),
                WorldError::NoMeanForces { model, law, .. } => root.key("integrator").key("kind").error(
                    format!("`energy-momentum` cannot step body `{name}`: `{model}` of the law `{law}`"),
                    "it needs the law `st-venant-kirchhoff` by the model `total-lagrangian`, without \
                     `keep-volume`",
                ),
                WorldError::ModelNeedsExplicit { model, advice, .. } => root.key("integrator").key("kind").error(
                    format!(
                        "this integrator cannot step body `{name}`: implicit steps are not for the model `{model}`"
                    ),
                    *advice,
                ),
                WorldError::FeatureNeedsExplicit { feature, .. } => root
                    .key("integrator")
                    .key("kind")
                    .error(format!("this integrator cannot step body `{name}`: it has {feature}"), "take `explicit`"),
                _ => site.error(&error, ""),
            })?;
            bodies.insert(name.clone(), id);
        }
        let mut attachments = IndexMap::new();
        for (name, described) in &file.body {
            let site = root.key("body").key(name);
            attachments.insert(name.clone(), attachment::attach(&mut world, &bodies, bodies[name], described, &site)?);
        }
        attachments.retain(|_, own| !own.is_empty());
        let mut instruments = IndexMap::new();
        for (name, described) in &file.instrument {
            let site = root.key("instrument").key(name);
            instruments.insert(name.clone(), instrument::add(&mut world, described, &site)?);
        }
        for (name, &id) in bodies.iter().filter(|_| !instruments.is_empty()) {
            let limits = world.body(id).model().info().tool_limits;
            notices.extend(limits.map(|limits| (name.clone(), limits.into())));
        }
        Ok(BuiltScene { file, world, bodies, attachments, instruments, notices })
    }
}
