//! Checkpoints: from the last one a run that was killed goes on, to the same bits.
//!
//! The last two are kept. Each is written aside and renamed, and the one before it stays until then: at any moment there is a
//! whole one, and should the newest turn out damaged, the one before it does.

mod content;
mod error;
mod mark;

use std::fs;
use std::path::{Path, PathBuf};

use viscera::model::Precision;
use viscera::world::SnapshotError;
use viscera_scene::BuiltScene;

use self::content::{Content, Head};
use self::error::CheckpointError;
pub(super) use self::mark::RunMark;
use super::folder::{CHECKPOINTS, ENDING, number};
use super::recording::{Kept, Recording};
use crate::failure::Failure;
use crate::instruction_set::instruction_set;
use crate::terminal;

/// How many are kept.
const KEPT: usize = 2;

/// Where and when a run keeps checkpoints.
pub(super) struct Checkpoints {
    folder: PathBuf,
    run: RunMark,
    /// Simulated time between them [s].
    interval: f64,
    /// When the last one was written [s].
    last: Option<f64>,
}

/// What a run goes on from.
pub(super) struct Resumption {
    pub(super) kept: Kept,
    pub(super) interval: f64,
}

impl Checkpoints {
    /// Checkpoints in the folder of a run, after every so much simulated time [s].
    pub(super) fn new(folder: &Path, run: RunMark, interval: f64) -> Result<Self, Failure> {
        let folder = folder.join(CHECKPOINTS);
        fs::create_dir_all(&folder).map_err(|error| {
            Failure::input(format!(
                "{}: checkpoints cannot be written there: {error}; choose another folder with --out",
                folder.display()
            ))
        })?;
        Ok(Self { folder, run, interval, last: None })
    }

    /// Takes note of the checkpoint that the run goes on from, at this time [s].
    pub(super) fn going_on_from(mut self, time: f64) -> Self {
        self.last = Some(time);
        self
    }

    /// When the last one was written [s].
    pub(super) fn last(&self) -> Option<f64> {
        self.last
    }

    /// Writes one if the time has come.
    pub(super) fn write_if_due<T: Precision>(
        &mut self,
        built: &BuiltScene<T>,
        recording: &Recording,
    ) -> Result<(), Failure> {
        // A thousandth of a step is for rounding; an interval below the step takes every step.
        let slack = 1e-3 * built.world.config().step;
        let intervals = |time: f64| ((time + slack) / self.interval).floor();
        if intervals(built.world.time()) > intervals(self.last.unwrap_or(0.0)) {
            self.write(built, recording)?;
        }
        Ok(())
    }

    /// Writes one now, unless this moment has one.
    pub(super) fn write<T: Precision>(&mut self, built: &BuiltScene<T>, recording: &Recording) -> Result<(), Failure> {
        let time = built.world.time();
        if self.last == Some(time) {
            return Ok(());
        }
        let head = Head::new(self.run.clone(), self.interval, recording.kept());
        let path = self.folder.join(format!("step-{:09}{ENDING}", recording.steps()));
        Content { head, world: built.world.snapshot().to_bytes() }.write(&path).map_err(Failure::problem)?;
        self.last = Some(time);
        for old in newest_first(&self.folder).into_iter().skip(KEPT) {
            // One too many does no harm.
            let _ = fs::remove_file(old);
        }
        Ok(())
    }
}

/// Puts the world to the last checkpoint in the folder of a run that is whole; nothing if there is none at all.
pub(super) fn resume<T: Precision>(
    folder: &Path,
    run: &RunMark,
    built: &mut BuiltScene<T>,
) -> Result<Option<Resumption>, Failure> {
    let folder = folder.join(CHECKPOINTS);
    let files = newest_first(&folder);
    if files.is_empty() {
        return Ok(None);
    }
    for (place, path) in files.iter().enumerate() {
        match read(path, run, built) {
            Ok(resumption) => return Ok(Some(resumption)),
            Err(error) if error.is_of_one_file() => {
                let next = if place + 1 < files.len() { "; the one before it is tried" } else { "" };
                terminal::complain(&format!("warning: {error}{next}"));
            }
            Err(error) => return Err(Failure::input(error)),
        }
    }
    Err(Failure::input(CheckpointError::NoneLeft { folder }))
}

fn read<T: Precision>(path: &Path, run: &RunMark, built: &mut BuiltScene<T>) -> Result<Resumption, CheckpointError> {
    let Content { head, world } = Content::read(path)?;
    if let Some(difference) = run.difference(&head.run) {
        return Err(CheckpointError::OtherScene { path: path.to_owned(), difference });
    }
    let snapshot = built.world.read_snapshot(&world).map_err(|error| match error {
        SnapshotError::OtherVersion { found, known } => CheckpointError::OtherVersion {
            path: path.to_owned(),
            found: format!("an engine of format {found}"),
            known: format!("one of format {known}"),
        },
        SnapshotError::Foreign { what } => CheckpointError::OtherScene { path: path.to_owned(), difference: what },
        other => CheckpointError::Damaged { path: path.to_owned(), why: other.to_string() },
    })?;
    built
        .world
        .restore(&snapshot)
        .map_err(|error| CheckpointError::OtherScene { path: path.to_owned(), difference: error.to_string() })?;
    if head.instructions != instruction_set() {
        terminal::complain(&format!(
            "warning: the checkpoint was computed with {}, and this machine has {}: the run goes on, but not to the same bits",
            head.instructions,
            instruction_set()
        ));
    }
    Ok(Resumption { kept: head.kept, interval: head.interval })
}

/// The checkpoints of a folder, the newest first.
fn newest_first(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut files: Vec<_> = entries.filter_map(|path| Some((number(&path, ENDING)?, path))).collect();
    files.sort();
    files.into_iter().rev().map(|(_, path)| path).collect()
}
