//! Other settings, tried on the scene itself: what each would save, measured and not guessed.

use std::time::{Duration, Instant};

use viscera::model::Precision;
use viscera_scene::Scene;
use viscera_scene::file::{
    self, BodyFile, GenerateFile, IntegratorName, LawName, MeshFile, ModelName, SceneFile, SurfaceFile,
};

use crate::built_in::OpenScene;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::tables::{table, table_text};
use crate::terminal::heading;

/// A trial ends after so many steps, or so much time.
const MOST_STEPS: usize = 100;
const MOST_TIME: Duration = Duration::from_secs(2);
/// What saves less than this is within what a measurement can tell.
const WORTH_TELLING: f64 = 0.05;

/// A change of the scene.
struct Trial {
    what: &'static str,
    /// Keys and values, as `--set` takes them.
    changes: Vec<(String, String)>,
}

/// What the other settings came to.
pub(super) fn text(open: &OpenScene, interrupt: &Interrupt) -> Result<String, Failure> {
    let mut rows = Vec::new();
    // The scene as it is, measured as the trials are: without a clock on its stages, and with nothing between its steps.
    let as_it_is = times(&open.scene, interrupt).unwrap_or_default();
    for trial in trials(&open.file()?) {
        if interrupt.is_asked() {
            break;
        }
        let mut scene = open.scene.clone();
        let changed = trial.changes.iter().try_for_each(|(key, value)| scene.set(key, value));
        // Settings that do not go together with the scene's others are no advice.
        let Some(times) = changed.ok().and_then(|()| times(&scene, interrupt)) else { continue };
        let steps = times.len().min(as_it_is.len());
        let (own, other) = (median(&as_it_is[..steps]), median(&times[..steps]));
        if other < (1.0 - WORTH_TELLING) * own {
            rows.push((own / other, other, steps, trial));
        }
    }
    if rows.is_empty() {
        return Ok(format!("{}: no other setting that was tried has faster steps", heading("what would lower it")));
    }
    rows.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut table = table(&["measured over the same steps", "faster", "ms per step", "steps", "how"]);
    for (faster, time, steps, trial) in rows {
        let how: Vec<_> = trial.changes.iter().map(|(key, value)| format!("--set {key}='{value}'")).collect();
        table.add_row([
            trial.what.to_owned(),
            format!("{faster:.2} times"),
            format!("{:.4}", 1e3 * time),
            steps.to_string(),
            how.join(" "),
        ]);
    }
    Ok(format!("{}\n{}", heading("what would lower it"), table_text(&table)))
}

/// What could be tried with a scene.
fn trials(scene: &SceneFile) -> Vec<Trial> {
    let mut trials = Vec::new();
    let of_bodies = |change: &dyn Fn(&BodyFile) -> Option<(&'static str, String)>| {
        let changed = scene.body.iter().filter_map(|(name, body)| {
            let (key, value) = change(body)?;
            Some((format!("body.{name}.{key}"), value))
        });
        changed.collect::<Vec<_>>()
    };
    let mut try_out = |what, changes: Vec<(String, String)>| {
        if !changes.is_empty() {
            trials.push(Trial { what, changes });
        }
    };
    let key = |key: &str, value: &str| vec![(key.to_owned(), value.to_owned())];
    if scene.precision == file::Precision::Double {
        try_out("single precision", key("precision", "single"));
    }
    // What rests at the end of every step is not integrated.
    let rests = |body: &BodyFile| body.model.as_ref().is_some_and(|model| model.kind == ModelName::Precomputed);
    let is_integrated = !scene.body.values().all(rests);
    if is_integrated && scene.integrator.kind == IntegratorName::Explicit {
        let implicit = r#"{ kind = "backward-euler", linear = { iterations = 25 } }"#;
        try_out("implicit steps of 25 iterations", key("integrator", implicit));
    } else if is_integrated && scene.integrator.kind != IntegratorName::QuasiStatic {
        try_out("explicit steps", key("integrator", r#"{ kind = "explicit" }"#));
        let settings = |rest: &str| format!(r#"{{ kind = "{}", {rest} }}"#, scene.integrator.kind.name());
        let cut_short = settings(r#"newton = "linearised", linear = { iterations = 25 }"#);
        try_out("one linear solve of 25 iterations", key("integrator", &cut_short));
        if scene.integrator.matrix != Some(file::MatrixFile::Assembled) {
            try_out("a matrix put together", key("integrator.matrix", "assembled"));
        }
    }
    let tables_to_law = |body: &BodyFile| {
        let is_tables =
            body.model.as_ref().is_none_or(|model| model.kind == ModelName::TensorMass && model.adaptive.is_none());
        let has_law = body.law.kind == LawName::StVenantKirchhoff;
        (is_tables && has_law).then(|| match body.model {
            Some(_) => ("model.kind", "total-lagrangian".to_owned()),
            None => ("model", r#"{ kind = "total-lagrangian" }"#.to_owned()),
        })
    };
    try_out("straight from the law, without tables", of_bodies(&tables_to_law));
    let averaged = |body: &BodyFile| {
        let model = body.model.as_ref()?;
        (model.kind == ModelName::NodallyIntegrated).then(|| ("model", r#"{ kind = "total-lagrangian" }"#.to_owned()))
    };
    try_out("without averages at the nodes (it may lock)", of_bodies(&averaged));
    let coarser = |body: &BodyFile| match &body.mesh {
        MeshFile::File(_) | MeshFile::Generate(GenerateFile::Box { .. }) => None,
        MeshFile::Surface(SurfaceFile { edge, .. })
        | MeshFile::Generate(
            GenerateFile::Cylinder { edge, .. }
            | GenerateFile::Tube { edge, .. }
            | GenerateFile::Liver { edge, .. }
            | GenerateFile::Trunk { edge, .. },
        ) => Some(("mesh.edge", format!("{:.4} mm", 1.25e3 * edge.0))),
    };
    try_out("edges a quarter longer", of_bodies(&coarser));
    trials
}

/// Times of the steps of a scene, as many as a trial takes; nothing if it cannot be built or a step cannot be made.
fn times(scene: &Scene, interrupt: &Interrupt) -> Option<Vec<Duration>> {
    match scene.check().ok()?.precision {
        file::Precision::Single => times_in::<f32>(scene, interrupt),
        file::Precision::Double => times_in::<f64>(scene, interrupt),
    }
}

fn times_in<T: Precision>(scene: &Scene, interrupt: &Interrupt) -> Option<Vec<Duration>> {
    let mut built = scene.build::<T>().ok()?;
    let (begin, mut times) = (Instant::now(), Vec::new());
    let most = MOST_STEPS.min(built.steps() as usize);
    while times.len() < most && (times.is_empty() || begin.elapsed() < MOST_TIME) && !interrupt.is_asked() {
        let begin = Instant::now();
        built.world.step().ok()?;
        times.push(begin.elapsed());
    }
    Some(times).filter(|times| !times.is_empty())
}

fn median(times: &[Duration]) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort();
    sorted.get(sorted.len() / 2).map_or(f64::INFINITY, Duration::as_secs_f64)
}
