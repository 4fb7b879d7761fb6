//! The summary on the screen.

use viscera_io::grouped;
use viscera_scene::file::IntegratorName;

use super::summary::{BodyResult, Summary};
use crate::tables::{table, table_text};
use crate::terminal::heading;
use crate::units::with_prefix;

/// Everything about a run, for a person.
pub(super) fn tables(summary: &Summary) -> String {
    let mut parts = vec![bodies(&summary.bodies)];
    for body in &summary.bodies {
        parts.extend(body.inside_out.as_ref().map(|found| format!("{}: {found}", heading(&body.name))));
    }
    if let Some(comparison) = comparison(&summary.bodies) {
        parts.push(format!("{}\n{comparison}", heading("volume variation")));
    }
    if !summary.instruments.is_empty() {
        parts.push(instruments(summary));
    }
    parts.push(speed(summary));
    let (folder, files) = &summary.files;
    parts.push(format!("{}: {}", folder.display(), files.join(", ")));
    parts.join("\n\n")
}

fn bodies(bodies: &[BodyResult]) -> String {
    let cut = bodies.iter().any(|body| body.removed_cells > 0);
    let inverted = bodies.iter().any(|body| body.peak_inverted_cells > 0);
    let adaptive = bodies.iter().any(|body| (1..body.nodes_left).contains(&body.nonlinear_nodes));
    let mut head = vec!["body", "cells"];
    head.extend(cut.then_some("removed"));
    head.extend(inverted.then_some("inverted, at most"));
    head.extend(adaptive.then_some("non-linear nodes"));
    head.extend(["volume", "variation", "displacement", "elastic", "kinetic", "at rest"]);
    let mut table = table(&head);
    for body in bodies {
        let mut row = vec![body.name.clone(), grouped(body.cells - body.removed_cells)];
        row.extend(cut.then(|| grouped(body.removed_cells)));
        row.extend(
            inverted.then(|| format!("{}, {}", grouped(body.inverted_cells), grouped(body.peak_inverted_cells))),
        );
        row.extend(adaptive.then(|| format!("{} of {}", grouped(body.nonlinear_nodes), grouped(body.nodes_left))));
        row.extend([
            format!("{:.1} cm³", body.volume * 1e6),
            percent(body.volume_variation),
            format!("{:.1} mm", body.max_displacement * 1e3),
            with_prefix(body.elastic_energy, "J"),
            with_prefix(body.kinetic_energy, "J"),
            if body.at_rest { "yes" } else { "no" }.to_owned(),
        ]);
        table.add_row(row);
    }
    table_text(&table)
}

/// Bodies whose names are `ROW-COLUMN`, as in `linear-2F`, side by side: one row for each law, one column for each load.
fn comparison(bodies: &[BodyResult]) -> Option<String> {
    let (mut rows, mut columns) = (Vec::new(), Vec::new());
    for body in bodies {
        let (row, column) = body.name.rsplit_once('-')?;
        if !rows.contains(&row) {
            rows.push(row);
        }
        if !columns.contains(&column) {
            columns.push(column);
        }
    }
    // Only a full table is one: names with a hyphen are common.
    if rows.len() < 2 || columns.len() < 2 || rows.len() * columns.len() != bodies.len() {
        return None;
    }
    let mut table = table(&[&[""], &columns[..]].concat());
    for row in rows {
        let of = |column: &&str| bodies.iter().find(|body| body.name == format!("{row}-{column}"));
        let values =
            columns.iter().map(|column| of(column).map_or_else(String::new, |body| percent(body.volume_variation)));
        table.add_row([row.to_owned()].into_iter().chain(values).collect::<Vec<_>>());
    }
    Some(table_text(&table))
}

fn instruments(summary: &Summary) -> String {
    let mut table = table(&["instrument", "kind", "peak force", "at", "most nodes held"]);
    for instrument in &summary.instruments {
        let or_nothing = |is_there: bool, text: String| if is_there { text } else { "–".to_owned() };
        let (felt, held) = (instrument.peak_force > 0.0, instrument.held_nodes > 0);
        table.add_row([
            instrument.name.clone(),
            instrument.kind.clone(),
            or_nothing(felt, with_prefix(instrument.peak_force, "N")),
            or_nothing(felt, format!("{:.2} s", instrument.time_of_peak_force)),
            or_nothing(held, instrument.held_nodes.to_string()),
        ]);
    }
    table_text(&table)
}

fn speed(summary: &Summary) -> String {
    let Summary { simulated_time, computing_time, real_time_factor, steps, .. } = summary;
    let step = with_prefix(summary.step, "s");
    let how = match &summary.implicit {
        None => {
            let (fewest, most) = (summary.fewest_substeps_of_a_step, summary.most_substeps_of_a_step);
            let substeps = if fewest == most { format!("{most}") } else { format!("{fewest} to {most}") };
            let again = match summary.retries {
                0 => String::new(),
                count => format!("; {count} made again with more"),
            };
            let stable = with_prefix(summary.stable_step_at_end, "s");
            format!("{steps} steps of {step} in {substeps} sub-steps{again}; the stable step is {stable}")
        }
        Some(implicit) if summary.integrator == IntegratorName::QuasiStatic.name() => {
            let each = implicit.newton_iterations as f64 / (*steps as f64).max(1.0);
            let again = match summary.retries {
                0 => String::new(),
                count => format!("; {count} shares of a load were tried in vain"),
            };
            format!("{steps} equilibria, {step} apart, {each:.1} iterations of Newton's method to each{again}")
        }
        Some(implicit) => {
            let each = implicit.linear_iterations as f64 / (*steps as f64).max(1.0);
            let most = implicit.most_linear_iterations_of_a_step;
            let early = match implicit.steps_not_converged {
                0 => String::new(),
                count => format!("; {count} ended above the tolerance"),
            };
            format!(
                "{steps} steps of {step} by {}, {each:.0} iterations of the linear solver in each, {most} at most{early}",
                summary.integrator
            )
        }
    };
    format!(
        "{simulated_time:.2} s simulated in {computing_time:.2} s: {} {real_time_factor:.2}\n{how}",
        heading("real-time factor"),
    )
}

/// A variation with its sign, three digits where it is small.
fn percent(value: f64) -> String {
    let percent = 100.0 * value;
    let decimals = if percent.abs() < 1.0 { 3 } else { 2 };
    format!("{percent:+.decimals$} %")
}
