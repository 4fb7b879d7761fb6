use std::borrow::Cow;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::SceneErrors;
use crate::files::Files;
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

    /// Where a file that the scene names is looked for.
    pub(super) fn path(&self, file: &Path) -> PathBuf {
        self.scene.files.path(file)
    }

    /// What is in it.
    pub(super) fn read(&self, file: &Path) -> io::Result<Cow<'a, [u8]>> {
        self.scene.files.read(file)
    }

    /// A mesh file, in memory or on disk: the disk's errors are the reader's to tell.
    pub(super) fn in_memory(&self, file: &Path) -> Result<Option<Cow<'a, [u8]>>, SceneErrors> {
        match &self.scene.files {
            Files::Folder(_) => Ok(None),
            Files::Memory(_) => {
                let missing = |error| self.error(format!("cannot read {}: {error}", file.display()), "send it along");
                self.read(file).map(Some).map_err(missing)
            }
        }
    }
}
