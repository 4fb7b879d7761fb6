use crate::library;
use crate::message::{Catalogue, ColouringEntry, RecordingEntry, SceneEntry};
use crate::parameter;
use crate::recording::Recording;
use crate::simulation::colour::Colouring;
use crate::simulation::tools;

/// Extensions of mesh files that can be read.
const MESH_FORMATS: [&str; 6] = ["stl", "obj", "msh", "vtk", "vtu", "vtp"];

/// What there is to choose from: the page knows no names of its own.
pub(crate) fn catalogue() -> Catalogue {
    let scene = |(name, _): (&str, &str)| {
        let title = library::scene(name).and_then(|scene| scene.ok()?.check().ok()?.title);
        SceneEntry { name: name.into(), title: title.unwrap_or_else(|| name.into()) }
    };
    let recording = |(name, bytes): (&str, &[u8])| {
        let recording = Recording::decode(bytes).ok()?;
        let seconds = recording.seconds();
        Some(RecordingEntry { name: name.into(), title: recording.title, scene: recording.scene, seconds })
    };
    let colouring = |colouring: Colouring| ColouringEntry {
        name: colouring.name().into(),
        title: colouring.title().into(),
        unit: colouring.unit().into(),
        summary: colouring.summary().into(),
    };
    // The scene that a session begins with comes first.
    let (first, others): (Vec<_>, Vec<_>) = library::scenes().partition(|(name, _)| *name == library::FIRST);
    Catalogue {
        scenes: first.into_iter().chain(others).map(scene).collect(),
        recordings: library::recordings().filter_map(recording).collect(),
        laws: parameter::laws(),
        models: parameter::models(),
        integrators: parameter::integrators(),
        instruments: tools::entries(),
        colourings: Colouring::ALL.into_iter().map(colouring).collect(),
        mesh_formats: MESH_FORMATS.map(Into::into).into(),
    }
}
