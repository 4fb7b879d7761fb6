//! `viscera run`: a scene from start to end, and what is written about it.

mod album;
mod folder;
mod frames;
mod instrument_shape;
mod moment;
mod observables;
mod progress;
mod recording;
mod summary;
mod tables;

use std::path::{Path, PathBuf};

use viscera::math::Scalar;
use viscera_scene::BuiltScene;
use viscera_scene::file::Precision;

use crate::arguments::RunArguments;
use crate::built_in::OpenScene;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal;
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
    let folder = Folder::prepare(&path)?;
    let progress = Progress::new(built.steps(), arguments.quiet);
    if !arguments.quiet {
        tell_notices(&built, &progress);
    }
    let mut recording = Recording::begin(&mut built, &open.name, folder, arguments.pictures)?;
    let ending = make_steps(&mut built, &mut recording, &progress, interrupt)?;
    progress.finish();
    let summary = recording.finish(&mut built, &ending)?;
    if !arguments.quiet {
        terminal::say(&tables::tables(&summary));
    }
    report(ending, summary.simulated_time, path)
}

/// Steps until the end of the scene, or what comes before it.
fn make_steps<T: Scalar>(
    built: &mut BuiltScene<T>,
    recording: &mut Recording,
    progress: &Progress,
    interrupt: &Interrupt,
) -> Result<Ending, Failure> {
    for _ in 0..built.steps() {
        if interrupt.is_asked() {
            return Ok(Ending::Interrupted);
        }
        match recording.clock.time(|| built.world.step()) {
            Ok(report) => recording.record(built, &report)?,
            Err(error) => return Ok(Ending::Failed(error.to_string())),
        }
        progress.show(built, &recording.clock);
    }
    Ok(Ending::Complete)
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

fn report(ending: Ending, time: f64, folder: PathBuf) -> Result<(), Failure> {
    let folder = folder.display();
    match ending {
        Ending::Complete => Ok(()),
        Ending::Interrupted => Err(Failure::Interrupted(format!(
            "interrupted at {time:.4} s; what was computed up to then is in {folder}"
        ))),
        Ending::Failed(why) => {
            Err(Failure::problem(format!("{why}\nwhat was computed up to {time:.4} s is in {folder}")))
        }
    }
}
