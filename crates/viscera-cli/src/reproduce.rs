//! `viscera reproduce`: the experiments of the founding papers, run again.

use std::path::PathBuf;
use std::thread::available_parallelism;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use viscera_reproduce::{Chapter, EXPERIMENTS, Experiment, Report, ReproduceError, Settings, Size, beads_in};

use crate::arguments::ReproduceArguments;
use crate::failure::Failure;
use crate::instruction_set::instruction_set;
use crate::interrupt::Interrupt;
use crate::tables::{table, table_text};
use crate::terminal::say;

pub(crate) fn reproduce(arguments: &ReproduceArguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    let settings =
        Settings { size: if arguments.quick { Size::Small } else { Size::Full }, measured: measured_beads(arguments)? };
    let mut report =
        Report { command: command(arguments), program: program(), machine: machine(), chapters: Vec::new() };
    // A folder that cannot be written to is found before minutes are spent.
    let mut page = report.write(&arguments.out).map_err(unwritten)?;

    let experiments = wanted(arguments);
    let progress = Progress::new(experiments.len(), arguments.quiet);
    for experiment in experiments {
        if interrupt.is_asked() {
            break;
        }
        progress.begin(experiment);
        report.chapters.push(Chapter::run(experiment, &settings));
        page = report.write(&arguments.out).map_err(unwritten)?;
    }
    progress.finish();
    if !arguments.quiet {
        say(&results(&report, &page));
    }
    judge(&report, interrupt.is_asked())
}

/// The experiments that are named, each once and in the order of the report; all of them if none is.
fn wanted(arguments: &ReproduceArguments) -> Vec<Experiment> {
    let is_wanted = |experiment: &Experiment| {
        arguments.names.is_empty() || arguments.names.iter().any(|name| name == experiment.name)
    };
    EXPERIMENTS.into_iter().filter(is_wanted).collect()
}

fn measured_beads(arguments: &ReproduceArguments) -> Result<Option<PathBuf>, Failure> {
    let Some(path) = &arguments.data else { return Ok(None) };
    match beads_in(path) {
        Some(file) => Ok(Some(file)),
        None => Err(Failure::input(format!(
            "{}: the measured beads are not there; --data wants the file `uniaxial_positions.csv` of Kerdok et al. (2003), or the folder \
             that holds it",
            path.display()
        ))),
    }
}

/// What was typed, as far as it bears on the results.
fn command(arguments: &ReproduceArguments) -> String {
    let mut words = vec!["viscera reproduce".to_owned()];
    words.extend(arguments.names.iter().cloned());
    words.extend(arguments.quick.then(|| "--quick".to_owned()));
    words.extend(arguments.data.as_ref().map(|_| "--data DIR".to_owned()));
    words.join(" ")
}

fn program() -> String {
    let build = if cfg!(debug_assertions) { "not optimised: times mean little" } else { "optimised" };
    format!("viscera {}, {build}", env!("CARGO_PKG_VERSION"))
}

fn machine() -> String {
    let cores = available_parallelism().map_or(1, usize::from);
    format!("{} {}, kernels in {}, {cores} cores", std::env::consts::OS, std::env::consts::ARCH, instruction_set())
}

fn unwritten(error: ReproduceError) -> Failure {
    Failure::input(error)
}

/// One line for each experiment, and where the page is.
fn results(report: &Report, page: &std::path::Path) -> String {
    let mut lines = table(&["experiment", "time", "result"]);
    for chapter in &report.chapters {
        lines.add_row([chapter.experiment.name.into(), format!("{:.1} s", chapter.seconds), chapter.verdict()]);
    }
    format!("{}\n\n{}", table_text(&lines), page.display())
}

/// Fails where an experiment failed, or something does not hold that has to.
fn judge(report: &Report, interrupted: bool) -> Result<(), Failure> {
    let mut wrong = Vec::new();
    for Chapter { experiment, found, .. } in &report.chapters {
        match found {
            Err(error) => wrong.push(format!("error: {}: {error}", experiment.name)),
            Ok(section) => wrong.extend(section.relations.iter().filter(|relation| !relation.holds).map(|relation| {
                format!("error: {}: does not hold: {} ({})", experiment.name, relation.claim, relation.measured)
            })),
        }
    }
    if !wrong.is_empty() {
        return Err(Failure::Problem(wrong.join("\n")));
    }
    match interrupted {
        true => Err(Failure::Interrupted("interrupted; the page holds what was run until then".into())),
        false => Ok(()),
    }
}

/// A bar on stderr, with the experiment that is running; nothing where stderr is no terminal, or nothing is to be said.
struct Progress {
    bar: ProgressBar,
}

impl Progress {
    fn new(experiments: usize, quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(experiments as u64) };
        // The template is fixed: should a later indicatif refuse it, its own default serves as well.
        if let Ok(style) = ProgressStyle::with_template("{bar:24.red/dim} {pos} of {len}  {msg}  {elapsed}") {
            bar.set_style(style.progress_chars("━━─"));
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        Self { bar }
    }

    fn begin(&self, experiment: Experiment) {
        // The one before is done.
        if !self.bar.message().is_empty() {
            self.bar.inc(1);
        }
        self.bar.set_message(format!("{} ({})", experiment.title, experiment.name));
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use viscera_reproduce::{Relation, Section};

    use super::*;

    fn found(relations: Vec<Relation>) -> Report {
        let section = Section { relations, ..Section::default() };
        let chapter = Chapter { experiment: EXPERIMENTS[0], seconds: 0.0, found: Ok(section) };
        Report { chapters: vec![chapter], ..Report::default() }
    }

    /// A relation that does not hold is a problem, named with what was measured, and the program ends with 1.
    #[test]
    fn a_relation_that_does_not_hold_is_a_problem() {
        let holds = || Relation::at_most("volume falls", 0.5, 1.0);
        assert!(judge(&found(vec![holds()]), false).is_ok());
        let failure = judge(&found(vec![holds(), Relation::at_most("volume stays", 2.0, 1.0)]), false).unwrap_err();
        assert!(matches!(failure, Failure::Problem(_)), "{failure}");
        let said = failure.to_string();
        assert!(said.contains("rotation: does not hold: volume stays (2.00 ≤ 1.00)"), "{said}");
        assert!(!said.contains("volume falls"), "{said}");
        assert!(matches!(judge(&found(vec![holds()]), true), Err(Failure::Interrupted(_))));
    }
}
