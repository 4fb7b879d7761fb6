//! The largest cost, and what it hangs on in this scene.

use viscera::stage::Stage;

use super::Profile;
use super::limit::Limit;
use super::table::name;
use crate::stopwatch::Cost;
use crate::terminal::heading;
use crate::units::with_prefix;

/// A cell whose height is below this share of the middle one is thin.
const THIN: f64 = 0.7;
/// A cell that is stretched more than this stiffens.
const STRETCHED: f64 = 1.2;

/// What costs most, and why; where that is not the step itself, what costs most in that as well.
pub(super) fn text(profile: &Profile) -> String {
    let costs = profile.recurring();
    let Some(&(largest, time, _)) = costs.first() else { return "no step was made".into() };
    let share = 100.0 * time / profile.of_a_step();
    let mut text = told("largest cost", profile, largest, &format!("{share:.0} % of all"));
    let of_the_step = costs.iter().find(|(cost, ..)| matches!(cost, Cost::Stage(_)));
    if let Some(&(cost, time, _)) = of_the_step.filter(|(cost, ..)| *cost != largest) {
        let share = 100.0 * time / profile.of_the_stages();
        text += &told("\n\nlargest cost of the step itself", profile, cost, &format!("{share:.0} % of it"));
    }
    text
}

fn told(what: &str, profile: &Profile, cost: Cost, share: &str) -> String {
    let mut why = why(profile, cost);
    if matches!(cost, Cost::Stage(stage) if goes_through_nodes(stage)) {
        why.extend(profile.tangled.iter().map(|(body, remark)| {
            format!("Body `{body}`: {remark}. `viscera mesh convert --reorder` on its file makes this faster.")
        }));
    }
    format!("{}: {}, {share}\n{}", heading(what), name(cost), why.join("\n"))
}

/// Whether a stage reads and writes the nodes of every cell.
fn goes_through_nodes(stage: Stage) -> bool {
    matches!(stage, Stage::Forces(_) | Stage::Products(_) | Stage::LinearSolve | Stage::KickAndDrift)
}

fn why(profile: &Profile, cost: Cost) -> Vec<String> {
    let steps = profile.steps.len().max(1) as f64;
    match cost {
        Cost::Observables => vec![
            "Measuring every step costs more than stepping: longer steps have fewer rows. The session and the library measure only \
             when they are asked."
                .into(),
        ],
        Cost::Output | Cost::Loading | Cost::Building => vec![
            "Files are written through to the disk, which waits: `--set output.interval='0.2 s'` writes fewer frames.".into(),
        ],
        Cost::Stage(stage) => match stage {
            Stage::Products(_) | Stage::LinearSolve => vec![format!(
                "{:.0} iterations of the linear solver in a step, one product with the stiffness in each. \
                 `--set integrator.linear={{iterations=25}}` gives every step the same time; shorter steps and softer tissue need fewer.",
                profile.linear_iterations as f64 / steps
            )],
            Stage::Preconditioner => {
                vec!["Blocks are gathered anew in every iteration of Newton's method: a linearised step has one.".into()]
            }
            Stage::Linearisation | Stage::Newton => {
                vec!["Newton's method is at work: a linearised step (`integrator.newton = \"linearised\"`) has one iteration.".into()]
            }
            Stage::Response => {
                vec!["It goes with the nodes that tools touch and hold, times all nodes: smaller jaws, or longer edges, cost less.".into()]
            }
            Stage::Attachments => {
                vec!["Ties are solved twice in every explicit sub-step, and once in every iteration of an implicit one: fewer tied nodes, and softer or coarser bodies, cost less.".into()]
            }
            Stage::Cutting => {
                vec!["Instruments look at every cell of every body in each step that they are at work: switch them off in time.".into()]
            }
            _ if profile.is_implicit() => {
                vec!["It goes with the number of cells: longer edges, or longer steps, cost less.".into()]
            }
            _ => explicit(profile),
        },
    }
}

/// What the sub-steps hang on.
fn explicit(profile: &Profile) -> Vec<String> {
    let substeps = profile.substeps as f64 / profile.steps.len().max(1) as f64;
    let mut lines = vec![format!(
        "It goes with cells times sub-steps, {substeps:.1} in a step of {}.",
        with_prefix(profile.step, "s")
    )];
    if let Some(limit) = &profile.limit {
        lines.extend(of_the_limit(limit, substeps));
    }
    lines
}

fn of_the_limit(limit: &Limit, substeps: f64) -> Vec<String> {
    let Limit { body, cell, stable_step, height, median_height, stretch } = limit;
    let stable = with_prefix(*stable_step, "s");
    let (Some(height), Some(median)) = (height, median_height) else {
        return vec![format!("The stable step of {stable} is set by cell {cell} of body `{body}`.")];
    };
    let mut lines = vec![format!(
        "The stable step of {stable} is set by cell {cell} of body `{body}`: {} high where the middle one is {}, and stretched {stretch:.2} times.",
        with_prefix(*height, "m"),
        with_prefix(*median, "m")
    )];
    if *stretch > STRETCHED {
        lines.push("Its law stiffens with the stretch: pull less, hold it over a larger region, or take a law that stiffens less.".into());
    } else if *height < THIN * median && substeps > 1.0 {
        let fewer = (substeps * height / median).max(1.0);
        lines.push(format!(
            "Were no cell thinner than the middle one, {fewer:.1} sub-steps would do: take such cells out of the mesh, or mesh the body anew."
        ));
    } else if substeps > 1.0 {
        lines.push(
            "Its cells are alike: only longer edges, softer tissue or an implicit integrator have longer steps.".into(),
        );
    }
    lines
}
