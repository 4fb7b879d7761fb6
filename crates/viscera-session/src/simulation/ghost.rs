//! The linear model beside each body: what the same hands would do to it.

use viscera_scene::Meshes;
use viscera_scene::file::{IntegratorFile, IntegratorName, LawName, ModelName, SceneFile};

use super::build::{Fresh, Origin};
use super::surface::{Surface, follow};
use super::tools::{self, Tool};
use super::world::AnyWorld;
use crate::message::Refusal;
use crate::{parameter, refuse};

/// A second world, of the linear law, in which the same instruments are led.
pub(crate) struct Ghost {
    pub(crate) world: AnyWorld,
    pub(crate) surfaces: Vec<Surface>,
}

impl Ghost {
    /// The ghost of a scene, from where `from` is, or else from the beginning.
    pub(crate) fn of(
        file: &SceneFile,
        origin: &Origin,
        meshes: &mut Meshes,
        (tools, radius): (&[Tool], f64),
        from: Option<&AnyWorld>,
    ) -> Result<Self, Box<Refusal>> {
        let Fresh { mut world, mut surfaces, .. } = Fresh::of_file(&linear(file), origin, meshes)?;
        tools::match_slots(&mut world, radius, tools)?;
        if let Some(from) = from {
            world.continue_from(from).map_err(|error| refuse::because(error.to_string()))?;
        }
        follow(&world, &mut surfaces);
        Ok(Self { world, surfaces })
    }
}

/// The scene with the linear law everywhere, by the model that is its plainest form.
fn linear(file: &SceneFile) -> SceneFile {
    let mut file = file.clone();
    for body in file.body.values_mut() {
        body.law.kind = LawName::Linear;
        body.part.iter_mut().filter_map(|part| part.law.as_mut()).for_each(|law| law.kind = LawName::Linear);
        // Linear tensors are for tetrahedra; this model computes the same on whatever cells there are.
        body.model = Some(parameter::bare(ModelName::TotalLagrangian));
    }
    // Its equations are linear, and schemes that need another law would refuse it.
    if file.integrator.kind == IntegratorName::EnergyMomentum {
        file.integrator = IntegratorFile { kind: IntegratorName::Newmark, ..IntegratorFile::default() };
    }
    file
}
