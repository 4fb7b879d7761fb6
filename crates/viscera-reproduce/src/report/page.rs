//! The page: one file with its style, plots and pictures in it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use viscera_validation::Table;

use super::{Chapter, Report};
use crate::{Amount, Comparison, Part, Photograph, Relation, ReproduceError, Section};

const STYLE: &str = include_str!("style.css");

pub(super) fn page(report: &Report) -> Result<String, ReproduceError> {
    let mut chapters = Vec::new();
    for chapter in &report.chapters {
        chapters.push(chapter_of(chapter)?);
    }
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "Viscera: the papers, reproduced" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                nav { (contents(report)) }
                main {
                    (head(report))
                    @for chapter in &chapters { (chapter) }
                }
            }
        }
    };
    Ok(page.into_string())
}

fn contents(report: &Report) -> Markup {
    html! {
        h2 { "Experiments" }
        ol {
            @for chapter in &report.chapters {
                li { a href={ "#" (chapter.experiment.name) } { (chapter.experiment.title) } }
            }
        }
    }
}

fn head(report: &Report) -> Markup {
    let seconds: f64 = report.chapters.iter().map(|chapter| chapter.seconds).sum();
    html! {
        header {
            h1 { "The papers, reproduced" }
            p {
                "Figures and tables of the papers that Viscera began with, computed again and set beside the published values. "
                "Where ours differ, the reason stands beside them. Relations are what has to hold on any mesh and machine; times and rates are "
                "measured and held to nothing."
            }
            dl .settings {
                dt { "command" } dd { code { (report.command) } }
                dt { "program" } dd { (report.program) }
                dt { "machine" } dd { (report.machine) }
                dt { "time" } dd { (duration(seconds)) }
            }
            div .wide {
                table .summary {
                    thead { tr { th { "experiment" } th { "after" } th { "result" } th .n { "time" } } }
                    tbody {
                        @for chapter in &report.chapters {
                            tr {
                                td { a href={ "#" (chapter.experiment.name) } { (chapter.experiment.name) } }
                                td { (chapter.experiment.source) }
                                td { (verdict(chapter)) }
                                td .n { (duration(chapter.seconds)) }
                            }
                        }
                    }
                }
            }
            p .papers {
                "RR: G. Picinbono, H. Delingette, N. Ayache, Non-linear anisotropic elasticity for real-time surgery simulation, INRIA "
                "RR-4028, 2000. N05: M. Nesme, M. Marchal, E. Promayon, M. Chabanas, Y. Payan, F. Faure, Physically realistic interactive "
                "simulation for biological soft tissues, 2005. What they misprint is computed as corrected."
            }
        }
    }
}

fn duration(seconds: f64) -> String {
    if seconds < 90.0 { format!("{seconds:.1} s") } else { format!("{:.1} min", seconds / 60.0) }
}

fn verdict(chapter: &Chapter) -> Markup {
    let class = match &chapter.found {
        Ok(section) if section.missing.is_some() || section.relations.is_empty() => "verdict",
        Ok(section) if section.holds() => "verdict good",
        _ => "verdict bad",
    };
    html! { span class=(class) { (chapter.verdict()) } }
}

fn chapter_of(chapter: &Chapter) -> Result<Markup, ReproduceError> {
    let body = match &chapter.found {
        Ok(section) => section_of(section, chapter.experiment.name)?,
        Err(error) => html! { p .failure { strong { "This experiment failed. " } (error) } },
    };
    Ok(html! {
        section id=(chapter.experiment.name) {
            h2 { (chapter.experiment.title) }
            p .source { code { (chapter.experiment.name) } " · " (chapter.experiment.source) " · " (verdict(chapter)) }
            (body)
        }
    })
}

fn section_of(section: &Section, folder: &str) -> Result<Markup, ReproduceError> {
    let mut parts = Vec::new();
    for part in &section.parts {
        parts.push(part_of(part, folder)?);
    }
    Ok(html! {
        p .shown { (section.shown) }
        @if let Some(missing) = &section.missing { p .missing { (missing) } }
        @if !section.settings.is_empty() {
            dl .settings { @for (name, value) in &section.settings { dt { (name) } dd { (value) } } }
        }
        @if !section.comparisons.is_empty() { (comparisons(&section.comparisons)) }
        @if !section.relations.is_empty() { (relations(&section.relations)) }
        @for part in &parts { (part) }
    })
}

/// Rows whose differences have one reason share its cell.
fn comparisons(rows: &[Comparison]) -> Markup {
    let groups: Vec<&[Comparison]> = rows.chunk_by(|a, b| a.why == b.why).collect();
    // Where there are numbers, words between them stand flush right as well.
    let is_number = |row: &Comparison| matches!(row.ours, Amount::Number { .. });
    let class = if rows.iter().any(is_number) { "n" } else { "words" };
    let reasons = rows.iter().any(|row| !row.why.is_empty());
    html! {
        h3 { "Published and here" }
        div .wide {
            table .comparison {
                thead { tr {
                    th { "quantity" } th class=(class) { "published" } th class=(class) { "here" }
                    th .n { "difference" } @if reasons { th { "reason" } }
                } }
                tbody {
                    @for group in groups {
                        @for (number, row) in group.iter().enumerate() {
                            tr {
                                td { (row.quantity) }
                                td class=(class) { (row.published.text()) }
                                td class=(class) { (row.ours.text()) }
                                td .n { (row.ours.difference_from(&row.published)) }
                                @if reasons && number == 0 { td .why rowspan=(group.len()) { (row.why) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn relations(rows: &[Relation]) -> Markup {
    html! {
        h3 { "What has to hold" }
        div .wide {
            table .relations {
                tbody {
                    @for row in rows {
                        tr {
                            td .mark { @if row.holds { span .good { "✓" } } @else { span .bad { "✗" } } }
                            td { (row.claim) }
                            td .n { (row.measured.replace('-', "−")) }
                        }
                    }
                }
            }
        }
    }
}

fn part_of(part: &Part, folder: &str) -> Result<Markup, ReproduceError> {
    Ok(match part {
        Part::Text(text) => html! { p { (text) } },
        Part::Table(line, table) => table_of(line, table, folder),
        Part::Plot(plot) => html! {
            figure .plot role="img" aria-label=(plot.title) { (PreEscaped(plot.svg()?)) }
        },
        Part::Pictures(pictures) => {
            let mut figures = Vec::new();
            for picture in pictures {
                figures.push(picture_of(picture)?);
            }
            html! { div .pictures { @for figure in &figures { (figure) } } }
        }
    })
}

fn table_of(line: &str, table: &Table, folder: &str) -> Markup {
    // A column of numbers is set flush right, its head as well.
    let numbers: Vec<bool> =
        (0..table.head().len()).map(|column| table.rows().iter().all(|row| is_number(&row[column]))).collect();
    let class = |column: usize| if numbers[column] { "n" } else { "" };
    html! {
        h3 { (line) }
        div .wide {
            table {
                thead { tr { @for (column, title) in table.head().iter().enumerate() { th class=(class(column)) { (title) } } } }
                tbody {
                    @for row in table.rows() {
                        tr { @for (column, cell) in row.iter().enumerate() { td class=(class(column)) { (cell) } } }
                    }
                }
            }
        }
        p .file { "As a file: " code { (folder) "/" (table.name()) ".csv" } }
    }
}

fn is_number(text: &str) -> bool {
    text == "–"
        || text.starts_with(|first: char| first.is_ascii_digit() || "−-+".contains(first)) && !text.contains(' ')
}

fn picture_of(picture: &Photograph) -> Result<Markup, ReproduceError> {
    let mut bytes = Vec::new();
    picture.image.write_png(&mut bytes)?;
    let source = format!("data:image/png;base64,{}", STANDARD.encode(bytes));
    Ok(html! {
        figure {
            img src=(source) alt=(picture.caption) width=(picture.image.width) height=(picture.image.height);
            figcaption { (picture.caption) }
        }
    })
}
