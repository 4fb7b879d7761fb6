//! The folder for results.

use std::fs;
use std::path::{Path, PathBuf};

use super::equilibria;
use crate::failure::Failure;

/// The folder in it for checkpoints, and how their names end.
pub(super) const CHECKPOINTS: &str = "checkpoints";
pub(super) const ENDING: &str = ".checkpoint";

/// A folder that can be written to and holds nothing of an earlier run.
#[derive(Debug)]
pub(crate) struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes the folder where it is missing and removes what an earlier run left: a shorter run must not end with pictures
    /// of a longer one. Files of other names stay.
    pub(crate) fn prepare(path: &Path) -> Result<Self, Failure> {
        Self::clear(path, |_| false)
    }

    /// The folder of a run that goes on after so many frames: of its results, just these frames and the checkpoints stay.
    pub(super) fn reopen(path: &Path, frames: usize) -> Result<Self, Failure> {
        let is_earlier = |file: &Path| number(file, ".vtu").is_some_and(|number| number < frames);
        Self::clear(path, |file| is_earlier(file) || is_in(file, CHECKPOINTS))
    }

    /// Removes results but for those to be kept, and what a run that was killed had begun to write.
    fn clear(path: &Path, keep: impl Fn(&Path) -> bool) -> Result<Self, Failure> {
        let refuse = |error: std::io::Error| {
            Failure::input(format!(
                "{}: results cannot be written there: {error}; choose another folder with --out",
                path.display()
            ))
        };
        fs::create_dir_all(path.join("frames")).map_err(refuse)?;
        for folder in [path.to_owned(), path.join("frames"), path.join(CHECKPOINTS)] {
            if !folder.exists() {
                continue;
            }
            for entry in fs::read_dir(folder).map_err(refuse)? {
                let file = entry.map_err(refuse)?.path();
                if file.is_file() && (is_partial(&file) || is_result(&file) && !keep(&file)) {
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
    if is_in(file, "frames") {
        return number(file, ".vtu").is_some();
    }
    if is_in(file, CHECKPOINTS) {
        return number(file, ENDING).is_some();
    }
    match &*name {
        "bodies.pvd"
        | "observables.csv"
        | equilibria::FILE
        | "summary.json"
        | "start.png"
        | "middle.png"
        | "end.png" => true,
        _ => name.starts_with("picture-") && number(file, ".png").is_some(),
    }
}

/// Whether this is a result that was being written when the program was killed: `.NAME.PROCESS-COUNT.partial`.
fn is_partial(file: &Path) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let whole = name.strip_prefix('.').and_then(|name| name.strip_suffix(".partial"));
    let whole = whole.and_then(|name| name.rsplit_once('.')).map(|(name, _)| file.with_file_name(name));
    whole.is_some_and(|whole| is_result(&whole))
}

fn is_in(file: &Path, folder: &str) -> bool {
    file.parent().is_some_and(|parent| parent.ends_with(folder))
}

/// The number of a file `NAME-NUMBER` with this ending; six digits or more.
pub(super) fn number(file: &Path, ending: &str) -> Option<usize> {
    let name = file.file_name()?.to_str()?;
    let (_, number) = name.strip_suffix(ending)?.rsplit_once('-')?;
    let is_number = number.len() >= 6 && number.bytes().all(|digit| digit.is_ascii_digit());
    is_number.then(|| number.parse().ok())?
}
