//! Scenes: those that are built in, and those in files.

use std::fs;
use std::path::Path;

use tempfile::TempDir;
use viscera_scene::Scene;
use viscera_scene::file::SceneFile;
use viscera_session::library;

use crate::arguments::SceneArguments;
use crate::failure::Failure;

/// A scene with its name, and the folder that holds the files of a built-in one as long as it is needed.
pub(crate) struct OpenScene {
    pub(crate) scene: Scene,
    pub(crate) name: String,
    _folder: Option<TempDir>,
}

/// Writes the built-in scenes and their files into a folder.
pub(crate) fn copy_to(folder: &Path) -> std::io::Result<()> {
    for (path, bytes) in library::FILES {
        let path = folder.join(path);
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        fs::write(path, bytes)?;
    }
    Ok(())
}

impl OpenScene {
    /// Opens the scene that the arguments name and makes the changes that they ask for.
    pub(crate) fn open(arguments: &SceneArguments) -> Result<Self, Failure> {
        let mut open = Self::find(&arguments.scene)?;
        let mut set = |key: &str, value: &str| open.scene.set(key, value).map_err(Failure::scene);
        for change in &arguments.set {
            let (key, value) = change.split_once('=').ok_or_else(|| {
                Failure::input(format!(
                    "--set {change}: there is no `=`; write it as --set body.liver.law.young=\"8 kPa\""
                ))
            })?;
            set(key.trim(), value.trim())?;
        }
        if let Some(time) = &arguments.time {
            set("duration", time)?;
        }
        if let Some(precision) = &arguments.precision {
            set("precision", precision)?;
        }
        Ok(open)
    }

    fn find(scene: &str) -> Result<Self, Failure> {
        let path = Path::new(scene);
        if path.is_file() {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            return Ok(Self { scene: Scene::load(path).map_err(Failure::scene)?, name, _folder: None });
        }
        let wanted = scene.strip_suffix(".toml").unwrap_or(scene);
        let Some((name, text)) = library::scenes().find(|(name, _)| *name == wanted) else {
            let known: Vec<_> = library::scenes().map(|(name, _)| name).collect();
            return Err(Failure::input(format!(
                "{scene}: there is no such file, and no built-in scene of that name; built in are {}",
                known.join(", ")
            )));
        };
        let unpacked = TempDir::new().and_then(|folder| copy_to(folder.path()).map(|()| folder));
        let folder = unpacked.map_err(|error| {
            Failure::input(format!("the built-in scene cannot be unpacked into the temporary folder: {error}"))
        })?;
        let scene = Scene::parse(text, folder.path()).map_err(Failure::scene)?;
        Ok(Self { scene, name: name.to_owned(), _folder: Some(folder) })
    }

    /// The checked file.
    pub(crate) fn file(&self) -> Result<SceneFile, Failure> {
        self.scene.check().map_err(Failure::scene)
    }
}
