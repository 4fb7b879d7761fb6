//! The same as Markdown, for a book: a page for each experiment in the folder of its files, and one that lists them.

use std::fmt::Write as _;

use super::{Chapter, Report};
use crate::{Comparison, Part, Relation, Section};

/// The page that lists the experiments.
pub(super) fn contents(report: &Report) -> String {
    let mut page = format!(
        "# The papers, reproduced\n\nWritten by `{}` ({}; {}). Times are of this machine.\n\n| experiment | after | result | time |\n\
         |---|---|---|---|\n",
        report.command, report.program, report.machine
    );
    for chapter in &report.chapters {
        let experiment = chapter.experiment;
        let link = format!("[{}]({}/README.md)", experiment.title, experiment.name);
        let time = format!("{:.1} s", chapter.seconds);
        page.push_str(&row(&[link, experiment.source.into(), chapter.verdict(), time]));
    }
    page
}

/// The page of an experiment.
pub(super) fn chapter(chapter: &Chapter, section: &Section) -> String {
    let mut page =
        format!("# {}\n\n*After {}.* {}\n", chapter.experiment.title, chapter.experiment.source, section.shown);
    if let Some(missing) = &section.missing {
        let _ = writeln!(page, "\n{missing}");
    }
    let settings: Vec<String> = section.settings.iter().map(|(name, value)| format!("{name}: {value}")).collect();
    if !settings.is_empty() {
        let _ = writeln!(page, "\nSettings: {}.", settings.join("; "));
    }
    page.push_str(&comparisons(&section.comparisons));
    page.push_str(&relations(&section.relations));
    for part in &section.parts {
        let _ = match part {
            Part::Text(text) => writeln!(page, "\n{text}"),
            Part::Table(line, table) => write!(page, "\n{line}\n\n{}", table.markdown()),
            Part::Plot(plot) => writeln!(page, "\n![{}]({}.svg)", plot.title, plot.name),
            Part::Pictures(pictures) => pictures
                .iter()
                .try_for_each(|picture| writeln!(page, "\n![{0}]({1}.png)\n\n*{0}*", picture.caption, picture.name)),
        };
    }
    page
}

fn comparisons(rows: &[Comparison]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut table = "\n| quantity | published | here | difference | reason |\n|---|---|---|---|---|\n".to_owned();
    let mut before = "";
    for comparison in rows {
        let Comparison { quantity, published, ours, why } = comparison;
        let reason = if why == before && !why.is_empty() { "the same" } else { why };
        before = why;
        let difference = ours.difference_from(published);
        table.push_str(&row(&[quantity.clone(), published.text(), ours.text(), difference, reason.into()]));
    }
    table
}

fn relations(rows: &[Relation]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut table = "\n| what has to hold | measured | |\n|---|---|---|\n".to_owned();
    for Relation { claim, measured, holds } in rows {
        let mark = if *holds { "✓" } else { "✗" };
        table.push_str(&row(&[claim.clone(), measured.replace('-', "−"), mark.into()]));
    }
    table
}

fn row(cells: &[String]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}
