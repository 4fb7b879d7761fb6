//! The profile as a table.

use viscera::stage::Stage;
use viscera_io::grouped;

use super::Profile;
use crate::stopwatch::Cost;
use crate::tables::{table, table_text};
use crate::terminal::heading;
use crate::units::with_prefix;

/// Below this share of the step itself, costs are summed up in one line.
const WORTH_A_LINE: f64 = 0.002;

/// Everything that was measured.
pub(super) fn text(profile: &Profile) -> String {
    let Profile { title, step, steps, cells, frame, .. } = profile;
    let precision = if profile.single { "single" } else { "double" };
    let count = steps.len();
    let each = |of: u64| of as f64 / count.max(1) as f64;
    let how = match profile.is_implicit() {
        true => format!("by {}, {:.0} linear iterations each", profile.how, each(profile.linear_iterations)),
        false => format!("explicit, {:.1} sub-steps each", each(profile.substeps)),
    };
    let head = format!(
        "{}: {} cells, {precision} precision, {count} steps of {} {how}",
        heading(title),
        grouped(*cells),
        with_prefix(*step, "s")
    );
    let total = profile.of_a_step();
    let mut table = table(&["stage", "ms per step", "share", "calls per step", "of real time"]);
    let mut rest = 0.0;
    for (cost, time, times) in profile.recurring() {
        if time < WORTH_A_LINE * profile.of_the_stages() {
            rest += time;
            continue;
        }
        let calls = each(times);
        table.add_row([
            name(cost),
            format!("{:.4}", time * 1e3),
            format!("{:.1} %", 100.0 * time / total),
            if calls < 10.0 { format!("{calls:.1}") } else { format!("{calls:.0}") },
            format!("{:.1} %", 100.0 * time / step),
        ]);
    }
    let line = |name: &str, time: f64| {
        let share = format!("{:.1} %", 100.0 * time / total);
        [name.to_owned(), format!("{:.4}", time * 1e3), share, String::new(), format!("{:.1} %", 100.0 * time / step)]
    };
    if rest > 0.0 {
        table.add_row(line("all others", rest));
    }
    table.add_row(line("all", total));
    let slowest = steps.iter().max().map_or(0.0, |time| time.as_secs_f64());
    let of_a_frame = total * frame / step;
    let verdict = if of_a_frame <= *frame { "fits" } else { "does not fit" };
    let once: Vec<String> = [Cost::Loading, Cost::Building]
        .into_iter()
        .filter_map(|cost| profile.spent.iter().find(|(other, _)| *other == cost))
        .map(|(cost, spent)| format!("{} {}", name(*cost), with_prefix(spent.time.as_secs_f64(), "s")))
        .collect();
    format!(
        "{head}\n\n{}\n\n{}: {} of computing for every {} simulated, {:.0} % of the frame: it {verdict}; the slowest step alone took {}\nonce: {}",
        table_text(&table),
        heading("frame"),
        with_prefix(of_a_frame, "s"),
        with_prefix(*frame, "s"),
        100.0 * of_a_frame / frame,
        with_prefix(slowest, "s"),
        once.join(", "),
    )
}

/// What a cost is called.
pub(super) fn name(cost: Cost) -> String {
    match cost {
        Cost::Loading => "loading".into(),
        Cost::Building => "meshes and models".into(),
        Cost::Observables => "observables".into(),
        Cost::Output => "files".into(),
        Cost::Stage(stage) => match stage {
            Stage::Guard => "guard".into(),
            Stage::FrequencyBound => "frequency bound".into(),
            Stage::Instruments => "instruments".into(),
            Stage::Forces(model) => format!("forces: {model}"),
            Stage::Loads => "gravity and loads".into(),
            Stage::KickAndDrift => "kick and drift".into(),
            Stage::Constraints => "constraints".into(),
            Stage::Attachments => "attachments".into(),
            Stage::Newton => "vectors of the step".into(),
            Stage::Linearisation => "linearisation".into(),
            Stage::Preconditioner => "preconditioner".into(),
            Stage::LinearSolve => "vectors of the conjugate gradient".into(),
            Stage::Products(model) => format!("products: {model}"),
            Stage::Response => "static answers".into(),
            Stage::Cutting => "cutting".into(),
        },
    }
}
