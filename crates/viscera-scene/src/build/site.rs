use std::fmt::Display;
use std::path::{Path, PathBuf};

use crate::error::SceneErrors;
use crate::scene::Scene;

/// A value of a scene, to point at when it turns out to be wrong while the world is built.
#[derive(Clone, Debug)]
pub(super) struct Site<'a> {
    scene: &'a Scene,
    path: Vec<String>,
}

impl<'a> Site<'a> {
    /// The whole scene.
    pub(super) fn root(scene: &'a Scene) -> Self {
        Self { scene, path: Vec::new() }
    }

    /// A key of the table here, or an entry of the list here.
    pub(super) fn key(&self, part: impl Display) -> Self {
        let mut site = self.clone();
        site.path.push(part.to_string());
        site
    }

    /// The error `message` here, or as near as the file goes: a key that is left out is shown where it would stand.
    pub(super) fn error(&self, message: impl Display, help: impl Into<String>) -> SceneErrors {
        let path: Vec<_> = self.path.iter().map(String::as_str).collect();
        self.scene.document.error_at(&path, message.to_string(), help).into()
    }

    /// A file that the scene names.
    pub(super) fn path(&self, file: &Path) -> PathBuf {
        self.scene.path(file)
    }
}
