//! The folder for results.

use std::fs;
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// A folder that can be written to and holds nothing of an earlier run.
#[derive(Debug)]
pub(super) struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes the folder where it is missing and removes what an earlier run left: a shorter run must not end with pictures
    /// of a longer one. Files of other names stay.
    pub(super) fn prepare(path: &Path) -> Result<Self, Failure> {
        let refuse = |error: std::io::Error| {
            Failure::input(format!(
                "{}: results cannot be written there: {error}; choose another folder with --out",
                path.display()
            ))
        };
        fs::create_dir_all(path.join("frames")).map_err(refuse)?;
        for folder in [path.to_owned(), path.join("frames")] {
            for entry in fs::read_dir(folder).map_err(refuse)? {
                let file = entry.map_err(refuse)?.path();
                if file.is_file() && is_result(&file) {
                    fs::remove_file(file).map_err(refuse)?;
                }
            }
        }
        Ok(Self { path: path.to_owned() })
    }

    /// A file in it.
    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The folder.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }
}

/// Whether a file has a name that a run gives.
fn is_result(file: &Path) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let numbered = |stem: Option<&str>| {
        stem.and_then(|stem| stem.rsplit_once('-'))
            .is_some_and(|(_, number)| number.len() == 6 && number.bytes().all(|digit| digit.is_ascii_digit()))
    };
    let in_frames = file.parent().is_some_and(|folder| folder.ends_with("frames"));
    match &*name {
        "bodies.pvd" | "observables.csv" | "summary.json" | "start.png" | "middle.png" | "end.png" => !in_frames,
        _ if in_frames => numbered(name.strip_suffix(".vtu")),
        _ => name.starts_with("picture-") && numbered(name.strip_suffix(".png")),
    }
}
