//! What experiments found, as one page and as files.

mod markdown;
mod page;

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use viscera_io::write::write_atomically;
use viscera_validation::{Settings, Table};

use crate::{Comparison, Experiment, Part, ReproduceError, Section};

/// The page, in the folder of the report.
const PAGE: &str = "index.html";
/// Its text as Markdown, there and in the folder of each experiment.
const MARKDOWN: &str = "README.md";

/// All that was run, and on what.
#[derive(Debug, Default)]
pub struct Report {
    /// What was typed.
    pub command: String,
    /// The program and how it was built.
    pub program: String,
    /// The machine.
    pub machine: String,
    /// The experiments, in the order in which they were run.
    pub chapters: Vec<Chapter>,
}

/// An experiment and what came of it.
#[derive(Debug)]
pub struct Chapter {
    /// Which.
    pub experiment: Experiment,
    /// How long it took [s].
    pub seconds: f64,
    /// What was found, or why nothing was.
    pub found: Result<Section, ReproduceError>,
}

impl Chapter {
    /// Runs an experiment.
    pub fn run(experiment: Experiment, settings: &Settings) -> Self {
        let start = Instant::now();
        let found = experiment.run(settings);
        Self { experiment, seconds: start.elapsed().as_secs_f64(), found }
    }

    /// Whether it was run and everything holds that has to, or cannot be run for want of what it needs.
    pub fn is_good(&self) -> bool {
        self.found.as_ref().is_ok_and(Section::holds)
    }

    /// In a few words, what came of it.
    pub fn verdict(&self) -> String {
        match &self.found {
            Err(_) => "failed".into(),
            Ok(Section { missing: Some(_), .. }) => "not run".into(),
            Ok(Section { relations, .. }) if relations.is_empty() => "measured".into(),
            Ok(Section { relations, .. }) => {
                let held = relations.iter().filter(|relation| relation.holds).count();
                format!("{held} of {} relations hold", relations.len())
            }
        }
    }
}

impl Report {
    /// Writes the files of the last chapter, and the page with all that there are; so a run that is stopped leaves what it has. Gives
    /// the path of the page.
    ///
    /// # Errors
    /// [`ReproduceError`] where the folder cannot be written to.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, ReproduceError> {
        make(folder)?;
        if let Some(chapter @ Chapter { experiment, found: Ok(section), .. }) = self.chapters.last() {
            let own = folder.join(experiment.name);
            write_files(section, &own)?;
            write(&own.join(MARKDOWN), markdown::chapter(chapter, section).as_bytes())?;
        }
        write(&folder.join(MARKDOWN), markdown::contents(self).as_bytes())?;
        let page = folder.join(PAGE);
        write(&page, page::page(self)?.as_bytes())?;
        Ok(page)
    }
}

fn make(folder: &Path) -> Result<(), ReproduceError> {
    fs::create_dir_all(folder).map_err(|error| ReproduceError::Folder { path: folder.into(), error })
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), ReproduceError> {
    Ok(write_atomically(path, |out| out.write_all(bytes))?)
}

/// Writes tables, plots and pictures, each as a file.
fn write_files(section: &Section, folder: &Path) -> Result<(), ReproduceError> {
    make(folder)?;
    if !section.comparisons.is_empty() {
        let table = published(&section.comparisons);
        write(&folder.join(format!("{}.csv", table.name())), table.csv().as_bytes())?;
    }
    for part in &section.parts {
        match part {
            Part::Text(_) => {}
            Part::Table(_, table) => write(&folder.join(format!("{}.csv", table.name())), table.csv().as_bytes())?,
            Part::Plot(plot) => write(&folder.join(format!("{}.svg", plot.name)), plot.svg()?.as_bytes())?,
            Part::Pictures(pictures) => {
                for picture in pictures {
                    let mut bytes = Vec::new();
                    picture.image.write_png(&mut bytes)?;
                    write(&folder.join(format!("{}.png", picture.name)), &bytes)?;
                }
            }
        }
    }
    Ok(())
}

/// Published values and ours, for other programs to read.
fn published(comparisons: &[Comparison]) -> Table {
    let mut table = Table::new("published", &["quantity", "published", "here", "difference", "reason"]);
    for Comparison { quantity, published, ours, why } in comparisons {
        let difference = ours.difference_from(published);
        table.push(vec![quantity.clone(), published.text(), ours.text(), difference, why.clone()]);
    }
    table
}
