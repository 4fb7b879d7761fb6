//! The force on a hand between two samples of the simulation.

use viscera_validation::extrapolation::{self, Method, Samples};
use viscera_validation::{Settings, brief};

use super::{CURVE, Experiment};
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "extrapolation",
    title: "The force between two samples",
    source: "Picinbono, Lombardo et al. 2000, which RR builds on: extrapolation of the force for haptics",
    run,
};

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let study = extrapolation::study(settings.size)?;
    let at_32 = |method: Method| {
        let row = study.of(Samples::Late, method).find(|row| row.interval == 32);
        100.0 * row.map_or(f64::NAN, |row| row.rms)
    };
    let [held, time, position] = [Method::Hold, Method::Time, Method::Position].map(at_32);
    let rest = |method: Method| study.at_rest.iter().find(|row| row.0 == method).map_or(f64::NAN, |row| row.1);
    let words = |error: f64| format!("error {} % of the largest force", brief(error));
    let why = "Another device and organ. Here: samples every 32 ms that come one interval late, against \
               tissue stepped in every millisecond.";
    Ok(Section::new(
        "The simulation gives a force some tens of times a second, and a hand wants one a thousand times a second. In between the \
         last force is held, or goes on with time, or with the position of the hand.",
    )
    .setting("liver", format!("30 cm, {} tetrahedra, 3 kPa, ν = 0.4, held at its back", study.cells))
    .setting("hand", "holds the edge of the left lobe and moves it on a bent way of some 3 cm, up to 0.15 m/s")
    .setting("largest force", format!("{} N", brief(study.largest)))
    .compare_words("held", [CURVE, &words(held)], why)
    .compare_words("with time", [CURVE, &words(time)], why)
    .compare_words("with position", [CURVE, &words(position)], why)
    .relation(Relation::falls("errors of held force, with time, with position [%]", &[held, time, position]))
    .relation(Relation::near("a held force is off by the first power of the interval", study.order(Samples::Exact, Method::Hold), 1.0, 0.2))
    .relation(Relation::near("one that goes on with position by the second", study.order(Samples::Exact, Method::Position), 2.0, 0.1))
    .relation(Relation::at_most("on linear tissue at rest it is exact along a line", rest(Method::Position), 1e-9))
    .study(&study.report(), |name| match name {
        "exact" => "Errors [% of the largest force] with the true force, at once".into(),
        "late" => "Errors with the true force, one interval late".into(),
        "coarse" => "Errors with the force of implicit steps of the interval, one interval late".into(),
        _ => "Largest error on linear tissue that is at rest in every millisecond".into(),
    }))
}
