//! A world of either precision under one face.

use viscera::body::SurfaceTriangle;
use viscera::executor::Executor;
use viscera::math::Vec3;
use viscera::world::{BodyId, BodyObservables, StepError, StepReport, World, WorldError};
use viscera_scene::file::Precision;
use viscera_scene::{Meshes, Scene, SceneErrors};

use super::colour::{Colouring, nodal_scalars};

/// A world of either precision.
pub(crate) enum AnyWorld {
    Single(World<f32>),
    Double(World<f64>),
}

/// Does the same with a world of either precision.
macro_rules! with {
    ($any:expr, $world:ident => $what:expr) => {
        match $any {
            AnyWorld::Single($world) => $what,
            AnyWorld::Double($world) => $what,
        }
    };
}
pub(crate) use with;

/// A world, what its scene calls its instruments, and what was found about meshes.
pub(crate) struct Built {
    pub(crate) world: AnyWorld,
    pub(crate) instruments: Vec<String>,
    pub(crate) notices: Vec<(String, String)>,
}

impl AnyWorld {
    /// Builds a scene in the precision that it asks for.
    pub(crate) fn build(scene: &Scene, meshes: &mut Meshes) -> Result<Built, SceneErrors> {
        match scene.check()?.precision {
            Precision::Single => {
                let built = scene.build_reusing::<f32>(meshes)?;
                let instruments = built.instruments.into_keys().collect();
                Ok(Built { world: Self::Single(built.world), instruments, notices: built.notices })
            }
            Precision::Double => {
                let built = scene.build_reusing::<f64>(meshes)?;
                let instruments = built.instruments.into_keys().collect();
                Ok(Built { world: Self::Double(built.world), instruments, notices: built.notices })
            }
        }
    }

    pub(crate) fn step(&mut self, executor: &Executor) -> Result<StepReport, StepError> {
        with!(self, world => world.step_on(executor))
    }

    /// Goes on from where `other` is, whatever its precision.
    pub(crate) fn continue_from(&mut self, other: &Self) -> Result<(), WorldError> {
        with!(self, world => with!(other, other => world.continue_from(other)))
    }

    pub(crate) fn time(&self) -> f64 {
        with!(self, world => world.time())
    }

    pub(crate) fn steps(&self) -> u64 {
        with!(self, world => world.steps())
    }

    /// Length of a step [s].
    pub(crate) fn step_length(&self) -> f64 {
        with!(self, world => world.config().step)
    }

    pub(crate) fn body_count(&self) -> usize {
        with!(self, world => world.body_ids().count())
    }

    pub(crate) fn surface(&self, body: usize) -> Vec<SurfaceTriangle> {
        with!(self, world => world.body(BodyId(body)).surface())
    }

    pub(crate) fn removed_cells(&self, body: usize) -> usize {
        with!(self, world => world.body(BodyId(body)).state().removed_count)
    }

    pub(crate) fn cell_count(&self, body: usize) -> usize {
        with!(self, world => world.body(BodyId(body)).cell_count())
    }

    pub(crate) fn rest(&self, body: usize) -> &[Vec3<f64>] {
        with!(self, world => world.body(BodyId(body)).mesh().nodes())
    }

    pub(crate) fn law_and_model(&self, body: usize) -> (String, String) {
        with!(self, world => {
            let body = world.body(BodyId(body));
            (body.law().into(), body.model().to_string())
        })
    }

    /// Coordinates of these nodes, one after the other [m].
    pub(crate) fn positions(&self, body: usize, nodes: &[u32]) -> Vec<f32> {
        with!(self, world => {
            let places = world.body(BodyId(body)).positions();
            nodes.iter().flat_map(|&node| places[node as usize].cast::<f32>().to_array()).collect()
        })
    }

    /// What a colouring shows at these nodes; none where it shows nothing.
    pub(crate) fn scalars(&self, body: usize, by: Colouring, nodes: &[u32]) -> Option<Vec<f32>> {
        with!(self, world => nodal_scalars(world.body(BodyId(body)), by, nodes))
    }

    pub(crate) fn observe(&mut self, body: usize) -> BodyObservables {
        with!(self, world => world.observe(BodyId(body)))
    }

    /// The state as bytes: equal states give equal bytes.
    pub(crate) fn snapshot(&self) -> Vec<u8> {
        with!(self, world => world.snapshot().to_bytes())
    }

    /// Goes back to a state.
    pub(crate) fn restore(&mut self, bytes: &[u8]) -> Result<(), String> {
        with!(self, world => {
            let snapshot = world.read_snapshot(bytes).map_err(|error| error.to_string())?;
            world.restore(&snapshot).map_err(|error| error.to_string())
        })
    }
}
