//! Everything that is kept of a run while it goes.

use std::time::{Duration, Instant};

use viscera::math::Scalar;
use viscera::world::StepReport;
use viscera_io::write::WriteError;
use viscera_scene::BuiltScene;

use super::Ending;
use super::album::Album;
use super::folder::Folder;
use super::frames::Frames;
use super::observables::Observables;
use super::summary::{Summary, Tally};
use crate::failure::Failure;

/// Time that the machine has spent on stepping, without writing.
#[derive(Debug, Default)]
pub(super) struct Clock {
    spent: Duration,
}

impl Clock {
    /// Does something and counts the time it takes.
    pub(super) fn time<R>(&mut self, work: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = work();
        self.spent += start.elapsed();
        result
    }

    /// Time spent [s]; above zero, so that it can be divided by.
    pub(super) fn seconds(&self) -> f64 {
        self.spent.as_secs_f64().max(1e-9)
    }
}

/// The records of a run.
pub(super) struct Recording {
    pub(super) clock: Clock,
    folder: Folder,
    frames: Frames,
    observables: Observables,
    album: Album,
    tally: Tally,
    began: Instant,
    steps: u64,
}

impl Recording {
    /// Records the start.
    pub(super) fn begin<T: Scalar>(
        built: &mut BuiltScene<T>,
        scene: &str,
        folder: Folder,
        pictures: u64,
    ) -> Result<Self, Failure> {
        let mut recording = Self {
            clock: Clock::default(),
            frames: Frames::new(&folder, built),
            observables: Observables::new(&folder, built),
            album: Album::new(pictures, built.steps()),
            tally: Tally::new(scene, built),
            folder,
            began: Instant::now(),
            steps: 0,
        };
        recording.look(built, 0)?;
        Ok(recording)
    }

    /// Records a step.
    pub(super) fn record<T: Scalar>(&mut self, built: &mut BuiltScene<T>, report: &StepReport) -> Result<(), Failure> {
        self.steps += 1;
        self.tally.count(report);
        self.look(built, report.substeps)
    }

    fn look<T: Scalar>(&mut self, built: &mut BuiltScene<T>, substeps: u32) -> Result<(), Failure> {
        self.observables.observe(built, self.steps, substeps).map_err(unwritten)?;
        self.tally.observe(built, self.observables.last());
        self.album.look(built, self.steps);
        if self.frames.is_due(built) {
            self.frames.write(built).map_err(unwritten)?;
        }
        Ok(())
    }

    /// Writes what is still to be written.
    pub(super) fn finish<T: Scalar>(mut self, built: &mut BuiltScene<T>, ending: &Ending) -> Result<Summary, Failure> {
        if !self.frames.is_up_to_date(built) {
            self.frames.write(built).map_err(unwritten)?;
        }
        self.observables.finish().map_err(unwritten)?;
        let pictures = self.album.write(&self.folder, built, self.steps)?;
        let wall = self.began.elapsed().as_secs_f64();
        let mut files = vec![format!("bodies.pvd ({} frames)", self.frames.count())];
        files.extend(["observables.csv".to_owned(), "summary.json".to_owned()]);
        files.extend(pictures);
        let summary = self.tally.summary(built, ending, self.clock.seconds(), wall);
        summary.write(&self.folder).map_err(unwritten)?;
        Ok(summary.with_files(self.folder.path(), files))
    }
}

/// A file that cannot be written while the run goes: the disk is full, or the folder was taken away.
fn unwritten(error: WriteError) -> Failure {
    Failure::problem(error)
}
