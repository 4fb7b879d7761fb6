//! Everything that is kept of a run while it goes.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use viscera::math::Scalar;
use viscera::world::StepReport;
use viscera_scene::BuiltScene;

use super::Ending;
use super::album::Album;
use super::equilibria::{self, Equilibria};
use super::folder::Folder;
use super::frames::Frames;
use super::moment::Moment;
use super::observables::{self, Observables};
use super::summary::Summary;
use super::tally::Tally;
use crate::failure::Failure;
use crate::stopwatch::{Cost, Stopwatch};

/// Time that the machine has spent on stepping, without writing.
#[derive(Debug, Default)]
pub(crate) struct Clock {
    spent: Duration,
}

impl Clock {
    /// Does something and counts the time it takes.
    pub(crate) fn time<R>(&mut self, work: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = work();
        self.spent += start.elapsed();
        result
    }

    /// Time spent [s]; above zero, so that it can be divided by.
    pub(crate) fn seconds(&self) -> f64 {
        self.spent.as_secs_f64().max(1e-9)
    }
}

/// The records of a run.
pub(crate) struct Recording<'a> {
    pub(crate) clock: Clock,
    folder: Folder,
    frames: Frames,
    observables: Observables,
    /// Residuals, where the run goes from equilibrium to equilibrium.
    equilibria: Option<Equilibria>,
    album: Album,
    tally: Tally,
    began: Instant,
    /// Time that the run took before it was stopped and went on.
    before: Duration,
    steps: u64,
    stopwatch: &'a Stopwatch,
}

/// What a checkpoint keeps of the records.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Kept {
    computing: Duration,
    wall: Duration,
    steps: u64,
    frames: Vec<f64>,
    observables: observables::Kept,
    equilibria: Vec<f64>,
    moments: Vec<Moment>,
    tally: Tally,
}

impl Kept {
    /// How many frames were written.
    pub(crate) fn frame_count(&self) -> usize {
        self.frames.len()
    }

    /// How many steps were made.
    pub(crate) fn steps(&self) -> u64 {
        self.steps
    }
}

impl<'a> Recording<'a> {
    /// Records the start.
    pub(crate) fn begin<T: Scalar>(
        built: &mut BuiltScene<T>,
        scene: &str,
        folder: Folder,
        pictures: u64,
        stopwatch: &'a Stopwatch,
    ) -> Result<Self, Failure> {
        let mut recording = Self {
            clock: Clock::default(),
            frames: Frames::new(&folder, built),
            observables: Observables::new(&folder, built),
            equilibria: Equilibria::of(&folder, built),
            album: Album::new(pictures, built.steps()),
            tally: Tally::new(scene, built),
            folder,
            began: Instant::now(),
            before: Duration::ZERO,
            steps: 0,
            stopwatch,
        };
        match recording.look(built, 0) {
            Ok(()) => Ok(recording),
            Err(failure) => Err(recording.abandon(&failure, None)),
        }
    }

    /// Goes on from what a checkpoint has kept. What was written later is written anew.
    pub(crate) fn resume<T: Scalar>(
        built: &mut BuiltScene<T>,
        kept: Kept,
        folder: Folder,
        pictures: u64,
        stopwatch: &'a Stopwatch,
    ) -> Result<Self, Failure> {
        Ok(Self {
            clock: Clock { spent: kept.computing },
            frames: Frames::going_on(&folder, built, kept.frames)?,
            observables: Observables::going_on(&folder, built, kept.observables).map_err(Failure::problem)?,
            equilibria: Equilibria::going_on(&folder, built, &kept.equilibria).map_err(Failure::problem)?,
            album: Album::going_on(pictures, built.steps(), kept.moments),
            tally: kept.tally,
            folder,
            began: Instant::now(),
            before: kept.wall,
            steps: kept.steps,
            stopwatch,
        })
    }

    /// What a checkpoint has to keep.
    pub(crate) fn kept(&self) -> Kept {
        Kept {
            computing: self.clock.spent,
            wall: self.wall(),
            steps: self.steps,
            frames: self.frames.times().to_vec(),
            observables: self.observables.kept(),
            equilibria: self.equilibria.as_ref().map_or_else(Vec::new, Equilibria::kept),
            moments: self.album.moments().to_vec(),
            tally: self.tally.clone(),
        }
    }

    /// Steps that were made.
    pub(crate) fn steps(&self) -> u64 {
        self.steps
    }

    fn wall(&self) -> Duration {
        self.before + self.began.elapsed()
    }

    /// Records a step.
    pub(crate) fn record<T: Scalar>(&mut self, built: &mut BuiltScene<T>, report: &StepReport) -> Result<(), Failure> {
        self.steps += 1;
        self.tally.count(report);
        if let Some(equilibria) = &mut self.equilibria {
            self.stopwatch.time(Cost::Output, || equilibria.record(built, self.steps)).map_err(Failure::problem)?;
        }
        self.look(built, report.substeps)
    }

    fn look<T: Scalar>(&mut self, built: &mut BuiltScene<T>, substeps: u32) -> Result<(), Failure> {
        self.stopwatch.time(Cost::Observables, || self.observables.measure(built, self.steps, substeps));
        self.tally.observe(built, self.observables.last());
        self.stopwatch.time(Cost::Output, || {
            self.observables.write_if_due().map_err(Failure::problem)?;
            self.album.look(built, self.steps);
            if self.frames.is_due(built) {
                self.frames.write(built).map_err(Failure::problem)?;
            }
            Ok(())
        })
    }

    /// Writes what is still to be written.
    pub(crate) fn finish<T: Scalar>(&mut self, built: &mut BuiltScene<T>, ending: &Ending) -> Result<Summary, Failure> {
        self.stopwatch.time(Cost::Output, || {
            if !self.frames.is_up_to_date(built) {
                self.frames.write(built).map_err(Failure::problem)?;
            }
            self.observables.finish().map_err(Failure::problem)?;
            if let Some(equilibria) = &mut self.equilibria {
                equilibria.write().map_err(Failure::problem)?;
            }
            let pictures = self.album.write(&self.folder, built, self.steps)?;
            let mut files = vec![format!("bodies.pvd ({} frames)", self.frames.count())];
            files.push("observables.csv".to_owned());
            files.extend(self.equilibria.is_some().then(|| equilibria::FILE.to_owned()));
            files.push("summary.json".to_owned());
            files.extend(pictures);
            let summary = self.tally.summary(built, ending, self.clock.seconds(), self.wall().as_secs_f64());
            summary.write(&self.folder).map_err(Failure::problem)?;
            Ok(summary.with_files(self.folder.path(), files))
        })
    }

    /// Ends a run whose results cannot be written: the disk is full, or the folder was taken away. Says what stands, and the time of
    /// the checkpoint from which the run can go on, if there is one [s].
    pub(crate) fn abandon(&mut self, failure: &Failure, checkpoint: Option<f64>) -> Failure {
        let folder = self.folder.path().display();
        if !self.folder.path().is_dir() {
            return Failure::Problem(format!("{failure}\nnothing of the run stands: the folder {folder} is gone"));
        }
        // The rows in memory may find room where the file that failed did not; if not, those in the file stand.
        let _ = self.observables.finish();
        let _ = self.equilibria.as_mut().map(Equilibria::write);
        let mut standing = Vec::new();
        if let Some(last) = self.frames.times().last() {
            standing.push(format!("{} frames up to {last:.4} s", self.frames.count()));
        }
        if let Some((rows, last)) = self.observables.written() {
            standing.push(format!("observables.csv with {rows} rows up to {last:.4} s"));
        }
        let standing = if standing.is_empty() { "nothing".to_owned() } else { standing.join(", ") };
        let next = match checkpoint {
            Some(time) => {
                format!("mend that, and the same command with --resume goes on from the checkpoint at {time:.4} s")
            }
            None => "mend that and run again; with --checkpoint a run can go on from where it was".to_owned(),
        };
        Failure::Problem(format!("{failure}\nwhat stands in {folder}: {standing}\n{next}"))
    }
}
