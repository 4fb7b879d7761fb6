//! `viscera check`: what is in a scene, what it takes to run it, and what is odd about it.

use viscera_scene::file::SceneFile;
use viscera_scene::{BodySummary, SceneSummary};

use crate::arguments::SceneArguments;
use crate::built_in::OpenScene;
use crate::failure::Failure;
use crate::terminal;

/// More substeps than this in a step make a run slow.
const MANY_SUBSTEPS: u64 = 500;

pub(crate) fn check(arguments: &SceneArguments) -> Result<(), Failure> {
    let open = OpenScene::open(arguments)?;
    // A scene that is there and wrong is what this command is for: a finding, no wrong usage.
    let found = |errors: viscera_scene::SceneErrors| Failure::Problem(errors.to_string());
    let file = open.scene.check().map_err(found)?;
    let summary = open.scene.summary().map_err(found)?;
    terminal::say(&summary.to_string());
    let warnings = warnings(&file, &summary);
    for warning in &warnings {
        terminal::complain(&format!("warning: {warning}"));
    }
    terminal::say(&match warnings.len() {
        0 => "\nthe scene is good".to_owned(),
        1 => "\nthe scene runs; 1 warning".to_owned(),
        count => format!("\nthe scene runs; {count} warnings"),
    });
    Ok(())
}

/// What runs, but is perhaps not meant.
fn warnings(file: &SceneFile, summary: &SceneSummary) -> Vec<String> {
    let mut warnings = Vec::new();
    if summary.bodies.is_empty() {
        warnings.push("the scene has no body: nothing will move".to_owned());
    }
    let heavy = file.gravity.iter().any(|component| component.0 != 0.0);
    let grown = |body: &BodySummary| {
        !body.grown_to.is_empty() || summary.bodies.iter().any(|other| other.grown_to.contains(&body.name))
    };
    let held = |body: &BodySummary| body.fixed.0 > 0 || body.prescribed > 0 || body.guided > 0 || grown(body);
    for body in summary.bodies.iter().filter(|body| heavy && !held(body)) {
        warnings.push(format!("nothing holds body `{}`: it falls; `fix` a region of it", body.name));
    }
    for body in &summary.bodies {
        let remarks = body.notices.iter().flat_map(|notice| notice.lines());
        let of_body = remarks.filter_map(|line| line.strip_prefix("warning: "));
        warnings.extend(of_body.map(|remark| format!("body `{}`: {remark}", body.name)));
    }
    if let Some(substeps) = summary.substeps.filter(|&substeps| substeps > MANY_SUBSTEPS) {
        let stiffest = summary.bodies.iter().min_by(|a, b| a.stable_step.total_cmp(&b.stable_step));
        if let Some(body) = stiffest {
            warnings.push(format!(
                "a step of {} s takes {substeps} substeps, because of body `{}`; coarser cells, softer tissue or an \
                 implicit integrator make it faster",
                summary.step, body.name
            ));
        }
    }
    for instrument in &summary.instruments {
        let (name, duration) = (&instrument.name, summary.duration);
        match instrument.active {
            Some((begins, _)) if begins >= duration => warnings.push(format!(
                "instrument `{name}` begins its work at {begins} s, when the run of {duration} s is over"
            )),
            None if instrument.path > 0.0 => warnings.push(format!(
                "instrument `{name}` follows a path and does no work on it, as nothing says when: give `close` for a grasper, \
                 `on` for a cautery"
            )),
            _ => {}
        }
    }
    warnings
}
