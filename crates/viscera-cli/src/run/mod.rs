//! `viscera run`: a scene from start to end, and what is written about it.

mod album;
mod checkpoint;
mod equilibria;
pub(crate) mod folder;
mod frames;
mod instrument_shape;
mod moment;
mod observables;
mod progress;
pub(crate) mod recording;
pub(crate) mod summary;
mod tables;
mod tally;

use std::path::{Path, PathBuf};

use viscera::executor::Executor;
use viscera::math::Scalar;
use viscera_scene::BuiltScene;
use viscera_scene::file::Precision;

use crate::arguments::RunArguments;
use crate::built_in::OpenScene;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::stopwatch::Stopwatch;
use crate::terminal;
use checkpoint::{Checkpoints, Resumption, RunMark};
use folder::Folder;
use progress::Progress;
use recording::Recording;

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ending {
    /// All steps were made.
    Complete,
    /// The user stopped it.
    Interrupted,
    /// A step could not be made, because of this.
    Failed(String),
}

pub(crate) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    let open = OpenScene::open(&arguments.scene)?;
    match open.file()?.precision {
        Precision::Single => play::<f32>(arguments, &open, &interrupt),
        Precision::Double => play::<f64>(arguments, &open, &interrupt),
    }
}

fn play<T: viscera::model::Precision>(
    arguments: &RunArguments,
    open: &OpenScene,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let mut built = open.scene.build::<T>().map_err(Failure::scene)?;
    let path = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(&open.name));
    let stopwatch = Stopwatch::default();
    let (mut recording, mut checkpoints) = set_out(arguments, open, &mut built, &path, &stopwatch)?;
    let progress = Progress::new(recording.steps(), built.steps(), arguments.quiet);
    if !arguments.quiet {
        tell_notices(&built, &progress);
    }
    let executor = executor(arguments.threads)?;
    let ending = make_steps(&mut built, &executor, &mut recording, checkpoints.as_mut(), &progress, interrupt);
    progress.finish();
    let ended = ending.and_then(|ending| Ok((recording.finish(&mut built, &ending)?, ending)));
    let (summary, ending) =
        ended.map_err(|failure| recording.abandon(&failure, checkpoints.as_ref().and_then(Checkpoints::last)))?;
    if !arguments.quiet {
        terminal::say(&tables::tables(&summary));
    }
    report(ending, summary.simulated_time, checkpoints.is_some(), path)
}

/// The threads that were asked for.
pub(crate) fn executor(threads: u16) -> Result<Executor, Failure> {
    Executor::threads(threads.into()).map_err(Failure::problem)
}

/// Begins at the start, or goes on from the last checkpoint.
fn set_out<'a, T: viscera::model::Precision>(
    arguments: &RunArguments,
    open: &OpenScene,
    built: &mut BuiltScene<T>,
    path: &Path,
    stopwatch: &'a Stopwatch,
) -> Result<(Recording<'a>, Option<Checkpoints>), Failure> {
    let pictures = arguments.pictures;
    let run = RunMark::of(open, pictures)?;
    let resumption = if arguments.resume { checkpoint::resume(path, &run, built)? } else { None };
    if let Some(Resumption { kept, interval }) = resumption {
        let folder = Folder::reopen(path, kept.frame_count())?;
        let time = built.world.time();
        if !arguments.quiet {
            terminal::complain(&format!("going on from the checkpoint at {time:.4} s, after {} steps", kept.steps()));
        }
        let checkpoints = Checkpoints::new(path, run, arguments.checkpoint.unwrap_or(interval))?.going_on_from(time);
        return Ok((Recording::resume(built, kept, folder, pictures, stopwatch)?, Some(checkpoints)));
    }
    if arguments.resume && !arguments.quiet {
        terminal::complain("there is no checkpoint yet: the run begins at the start");
    }
    let folder = Folder::prepare(path)?;
    let checkpoints = arguments.checkpoint.map(|interval| Checkpoints::new(path, run, interval)).transpose()?;
    Ok((Recording::begin(built, &open.name, folder, pictures, stopwatch)?, checkpoints))
}

/// Steps until the end of the scene, or what comes before it.
fn make_steps<T: viscera::model::Precision>(
    built: &mut BuiltScene<T>,
    executor: &Executor,
    recording: &mut Recording,
    mut checkpoints: Option<&mut Checkpoints>,
    progress: &Progress,
    interrupt: &Interrupt,
) -> Result<Ending, Failure> {
    let mut ending = Ending::Complete;
    while recording.steps() < built.steps() {
        if interrupt.is_asked() {
            ending = Ending::Interrupted;
            break;
        }
        match recording.clock.time(|| built.world.step_on(executor)) {
            Ok(report) => recording.record(built, &report)?,
            Err(error) => return Ok(Ending::Failed(error.to_string())),
        }
        if let Some(checkpoints) = &mut checkpoints {
            checkpoints.write_if_due(built, recording)?;
        }
        progress.show(built, &recording.clock);
    }
    // Before the last frame and the pictures, which a run that goes on has elsewhere.
    if let Some(checkpoints) = checkpoints {
        checkpoints.write(built, recording)?;
    }
    Ok(ending)
}

/// What was found and repaired in mesh files.
fn tell_notices<T: Scalar>(built: &BuiltScene<T>, progress: &Progress) {
    for (body, notice) in &built.notices {
        for line in notice.lines() {
            progress.tell(&match line.strip_prefix("warning: ") {
                Some(warning) => format!("warning: body `{body}`: {warning}"),
                None => format!("body `{body}`: {line}"),
            });
        }
    }
}

fn report(ending: Ending, time: f64, can_resume: bool, folder: PathBuf) -> Result<(), Failure> {
    let folder = folder.display();
    match ending {
        Ending::Complete => Ok(()),
        Ending::Interrupted => Err(Failure::Interrupted(format!(
            "interrupted at {time:.4} s; what was computed up to then is in {folder}{}",
            if can_resume { "; the same command with --resume goes on from there" } else { "" }
        ))),
        Ending::Failed(why) => {
            Err(Failure::problem(format!("{why}\nwhat was computed up to {time:.4} s is in {folder}")))
        }
    }
}
