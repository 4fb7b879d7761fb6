//! `viscera profile`: a scene with a clock on every stage, and what would lower the largest cost.

mod advice;
mod limit;
mod table;
mod trial;

use std::time::{Duration, Instant};

use tempfile::TempDir;
use viscera::executor::Executor;
use viscera::model::Precision;
use viscera_scene::BuiltScene;
use viscera_scene::file;

use crate::arguments::ProfileArguments;
use crate::built_in::OpenScene;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::mesh::order;
use crate::run::Ending;
use crate::run::folder::Folder;
use crate::run::recording::Recording;
use crate::stopwatch::{Cost, Stopwatch};
use crate::terminal;

/// Pictures are drawn when a run is over: they are no part of its pace.
const PICTURES: u64 = 0;

/// What a run with a clock came to.
pub(crate) struct Profile {
    /// The scene as it was built, after its last step.
    title: String,
    /// Length of a step [s].
    step: f64,
    /// Time of each step that was made.
    steps: Vec<Duration>,
    /// Sub-steps of all steps.
    substeps: u64,
    /// Iterations of the linear solver in all steps.
    linear_iterations: u64,
    spent: Vec<(Cost, crate::stopwatch::Spent)>,
    /// The time that a frame may take [s].
    frame: f64,
    limit: Option<limit::Limit>,
    /// Bodies from files whose nodes are in no order, and what is known of it.
    tangled: Vec<(String, String)>,
    cells: usize,
    single: bool,
    how: String,
    ending: Ending,
}

pub(crate) fn profile(arguments: &ProfileArguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    let executor = crate::run::executor(arguments.threads)?;
    let stopwatch = Stopwatch::default();
    let (open, precision) = stopwatch.time(Cost::Loading, || {
        let open = OpenScene::open(&arguments.scene)?;
        let precision = open.file()?.precision;
        Ok((open, precision))
    })?;
    let profile = match precision {
        file::Precision::Single => run::<f32>(&open, arguments.frame, &executor, &stopwatch, &interrupt),
        file::Precision::Double => run::<f64>(&open, arguments.frame, &executor, &stopwatch, &interrupt),
    }?;
    terminal::say(&table::text(&profile));
    terminal::say(&format!("\n{}", advice::text(&profile)));
    if !arguments.no_trials && profile.ending == Ending::Complete {
        terminal::say(&format!("\n{}", trial::text(&open, &interrupt)?));
    }
    match profile.ending {
        Ending::Complete => Ok(()),
        Ending::Interrupted => Err(Failure::Interrupted("interrupted; the profile is of the steps up to then".into())),
        Ending::Failed(why) => Err(Failure::problem(format!("{why}\nthe profile is of the steps up to then"))),
    }
}

fn run<T: Precision>(
    open: &OpenScene,
    frame: f64,
    executor: &Executor,
    stopwatch: &Stopwatch,
    interrupt: &Interrupt,
) -> Result<Profile, Failure> {
    let mut built = stopwatch.time(Cost::Building, || open.scene.build::<T>()).map_err(Failure::scene)?;
    let out = TempDir::new().map_err(|error| {
        Failure::input(format!("the temporary folder, for what the run writes, cannot be made: {error}"))
    })?;
    let folder = Folder::prepare(out.path())?;
    let mut recording = Recording::begin(&mut built, &open.name, folder, PICTURES, stopwatch)?;
    let (mut steps, mut substeps, mut linear_iterations) = (Vec::new(), 0, 0);
    let mut ending = Ending::Complete;
    for _ in 0..built.steps() {
        if interrupt.is_asked() {
            ending = Ending::Interrupted;
            break;
        }
        let begin = Instant::now();
        match built.world.step_observed(executor, stopwatch) {
            Ok(report) => {
                steps.push(begin.elapsed());
                substeps += u64::from(report.substeps);
                linear_iterations += report.implicit.map_or(0, |implicit| u64::from(implicit.linear_iterations));
                recording.record(&mut built, &report)?;
            }
            Err(error) => {
                ending = Ending::Failed(error.to_string());
                break;
            }
        }
    }
    recording.finish(&mut built, &ending)?;
    Ok(Profile {
        title: open.name.clone(),
        step: built.world.config().step,
        steps,
        substeps,
        linear_iterations,
        spent: stopwatch.spent().into_iter().collect(),
        frame,
        limit: limit::Limit::of(&built),
        tangled: tangled(&built),
        cells: cells(&built),
        single: built.file.precision == file::Precision::Single,
        how: built.file.integrator.kind.name().to_owned(),
        ending,
    })
}

fn cells<T: Precision>(built: &BuiltScene<T>) -> usize {
    built.bodies.values().map(|&id| built.world.body(id).mesh().cell_count()).sum()
}

/// What a mesh file could be reordered for; meshes that are made have an order.
fn tangled<T: Precision>(built: &BuiltScene<T>) -> Vec<(String, String)> {
    let is_read =
        |name: &str| matches!(built.file.body.get(name).map(|body| &body.mesh), Some(file::MeshFile::File(_)));
    let read = built.bodies.iter().filter(|(name, _)| is_read(name));
    read.filter_map(|(name, &id)| Some((name.clone(), order::remark(built.world.body(id).mesh())?))).collect()
}

impl Profile {
    /// Costs that come again with every step, the largest first, with their time in a step [s].
    fn recurring(&self) -> Vec<(Cost, f64, u64)> {
        let is_recurring = |cost: &Cost| !matches!(cost, Cost::Loading | Cost::Building);
        let each = 1.0 / self.steps.len().max(1) as f64;
        let mut costs: Vec<_> = self
            .spent
            .iter()
            .filter(|(cost, _)| is_recurring(cost))
            .map(|(cost, spent)| (*cost, spent.time.as_secs_f64() * each, spent.times))
            .collect();
        costs.sort_by(|a, b| b.1.total_cmp(&a.1));
        costs
    }

    /// Time of a step with all that goes with it [s].
    fn of_a_step(&self) -> f64 {
        self.recurring().iter().map(|(_, time, _)| time).sum()
    }

    /// Time of a step itself [s], without what is measured and written about it.
    fn of_the_stages(&self) -> f64 {
        let is_stage = |cost: &Cost| matches!(cost, Cost::Stage(_));
        self.recurring().iter().filter(|(cost, ..)| is_stage(cost)).map(|(_, time, _)| time).sum()
    }

    fn is_implicit(&self) -> bool {
        self.how != "explicit"
    }
}
