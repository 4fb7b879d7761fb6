//! From a scene file to a world with surfaces, and on from a world that was there before.

use viscera_scene::file::SceneFile;
use viscera_scene::{Files, Meshes, Scene, SceneErrors};

use super::surface::Surface;
use super::tools::{self, Tool};
use super::world::{AnyWorld, Built};
use crate::message::Refusal;
use crate::refuse;

/// Where a scene came from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Origin {
    /// What it is called.
    pub(crate) name: String,
    /// The files that it may name.
    pub(crate) files: Files,
}

/// How a scene is to be changed.
pub(crate) enum Change {
    /// From the present positions.
    Continue,
    /// From the beginning.
    Restart,
}

/// A world that was just built, nothing cut and nothing moved.
pub(crate) struct Fresh {
    pub(crate) world: AnyWorld,
    pub(crate) surfaces: Vec<Surface>,
    /// Instruments of the scene.
    pub(crate) tools: Vec<Tool>,
    pub(crate) notices: Vec<String>,
}

impl Fresh {
    /// Builds a scene.
    pub(crate) fn build(scene: &Scene, meshes: &mut Meshes) -> Result<Self, SceneErrors> {
        let Built { world, instruments, notices } = AnyWorld::build(scene, meshes)?;
        let surfaces = (0..world.body_count()).map(|body| Surface::new(&world, body)).collect();
        let tool = |(number, name): (usize, String)| Tool {
            kind: tools::kind(&world, number as u32),
            name,
            of_scene: true,
            scripted: true,
            removed: false,
            stamp: None,
        };
        let tools = instruments.into_iter().enumerate().map(tool).collect();
        let notices = notices.into_iter().map(|(body, notice)| format!("{body}: {notice}")).collect();
        Ok(Self { world, surfaces, tools, notices })
    }

    /// Builds a file that a program made or changed.
    pub(crate) fn of_file(file: &SceneFile, origin: &Origin, meshes: &mut Meshes) -> Result<Self, Box<Refusal>> {
        let scene = Scene::from_file_with(file, origin.files.clone());
        scene.and_then(|scene| Self::build(&scene, meshes)).map_err(|errors| {
            // The text is not one that the user knows: its lines would only confuse.
            Box::new(Refusal { excerpt: None, ..refuse::scene(&errors) })
        })
    }
}
