use std::fmt;
use std::path::{Path, PathBuf};

use crate::check::check;
use crate::document::Document;
use crate::error::{SceneError, SceneErrors};
use crate::file::SceneFile;
use crate::files::Files;
use crate::schema::schema;
use crate::tissue::{without_names, written_out};

/// A scene file and its overrides.
///
/// The text is kept, so that whatever turns out to be wrong later can be shown in its line.
#[derive(Clone, PartialEq)]
pub struct Scene {
    pub(crate) document: Document,
    pub(crate) files: Files,
}

impl fmt::Debug for Scene {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.debug_struct("Scene").field("files", &self.files).finish_non_exhaustive()
    }
}

impl Scene {
    /// Reads a scene file. Files that it names are looked for in its folder.
    ///
    /// # Errors
    /// Where the file cannot be read or is not TOML.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneErrors> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|error| {
            let message = format!("cannot read the scene {}: {error}", path.display());
            SceneError::without_place(message, "give the path of a TOML scene file")
        })?;
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        Ok(Self { document: Document::parse(&path.display().to_string(), &text)?, files: Files::Folder(folder) })
    }

    /// Takes a scene from its text. Files that it names are looked for in `folder`.
    ///
    /// # Errors
    /// Where the text is not TOML.
    pub fn parse(text: &str, folder: impl Into<PathBuf>) -> Result<Self, SceneErrors> {
        Self::parse_with("scene", text, Files::Folder(folder.into()))
    }

    /// Takes a scene from its text; `name` is what messages call it, and `files` has those that it names.
    ///
    /// # Errors
    /// Where the text is not TOML.
    pub fn parse_with(name: &str, text: &str, files: Files) -> Result<Self, SceneErrors> {
        Ok(Self { document: Document::parse(name, text)?, files })
    }

    /// A scene that was made by a program instead of written.
    ///
    /// # Errors
    /// Where a number is not one that TOML can hold.
    pub fn from_file(file: &SceneFile, folder: impl Into<PathBuf>) -> Result<Self, SceneErrors> {
        Self::from_file_with(file, Files::Folder(folder.into()))
    }

    /// The same with `files`.
    ///
    /// # Errors
    /// As [`Scene::from_file`].
    pub fn from_file_with(file: &SceneFile, files: Files) -> Result<Self, SceneErrors> {
        let text = file.to_toml().map_err(|error| SceneError::without_place(error.to_string(), ""))?;
        Self::parse_with("scene", &text, files)
    }

    /// Sets the value of a dotted key, such as `body.liver.law.young` to `8 kPa`: a TOML value, or else a string.
    /// Entries of lists have numbers from 0 (`body.liver.load.0.force`). What is wrong with the value is found by
    /// [`check`](Self::check) and shown in the override.
    ///
    /// # Errors
    /// Where the key leads into a value that has no keys, or to an entry that a list does not have.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), SceneErrors> {
        self.document.set(key, value)
    }

    /// Checks keys, types, units and ranges.
    ///
    /// # Errors
    /// Everything that is wrong, in the order of the file.
    pub fn check(&self) -> Result<SceneFile, SceneErrors> {
        let document = written_out(&self.document);
        SceneErrors::unless_empty(check(&document, &schema()))?;
        serde_json::from_value(without_names(document.root.to_json()))
            .map_err(|error| self.document.error_at(&[], error.to_string(), "").into())
    }

    /// The files that the scene may name.
    pub fn source_of_files(&self) -> &Files {
        &self.files
    }

    /// Every file that the scene names, meshes and tables, where it is looked for; in the order of the keys.
    ///
    /// # Errors
    /// All that [`check`](Self::check) finds.
    pub fn files(&self) -> Result<Vec<PathBuf>, SceneErrors> {
        let file = self.check()?;
        let tree = serde_json::to_value(file).map_err(|error| SceneError::without_place(error.to_string(), ""))?;
        let mut files = Vec::new();
        files_in(&tree, &mut |file| files.push(self.files.path(file)));
        Ok(files)
    }

    /// The folder in which files that it names are looked for; empty for a scene whose files are in memory.
    pub fn folder(&self) -> &Path {
        match &self.files {
            Files::Folder(folder) => folder,
            Files::Memory(_) => Path::new(""),
        }
    }
}

/// Paths stand under the keys `file`, `surface` and `responses`, wherever these are.
fn files_in(tree: &serde_json::Value, found: &mut impl FnMut(&Path)) {
    match tree {
        serde_json::Value::Object(entries) => {
            for (key, value) in entries {
                match (key.as_str(), value) {
                    ("file" | "surface" | "responses", serde_json::Value::String(path)) => found(Path::new(path)),
                    _ => files_in(value, found),
                }
            }
        }
        serde_json::Value::Array(items) => items.iter().for_each(|item| files_in(item, found)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_meshes_surfaces_curves_and_fibres_are_found() {
        let text = r#"
            duration = 1
            [body.a]
            mesh = { file = "a.msh" }
            density = 1000
            law = { kind = "linear", young = 1, poisson = 0.3, fibre = { file = "fibres.csv", young = 2 } }
            [body.b]
            mesh = { surface = "b.stl", edge = 0.01 }
            density = 1000
            law = { kind = "linear", young = 1, poisson = 0.3 }
            [instrument.tool]
            kind = "cautery"
            radius = 0.01
            path = { file = "path.csv" }
        "#;
        let files = Scene::parse(text, "here").and_then(|scene| scene.files()).map_err(|error| error.to_string());
        let names = ["a.msh", "fibres.csv", "b.stl", "path.csv"].map(|name| Path::new("here").join(name));
        assert_eq!(
            files.map(|mut files| {
                files.sort();
                files
            }),
            Ok({
                let mut names = names.to_vec();
                names.sort();
                names
            })
        );
    }
}
