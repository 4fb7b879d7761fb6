//! Stiffness, compressibility, length of steps and units over every range that anybody could think of.

use std::panic::{AssertUnwindSafe, catch_unwind};

use viscera::world::{BodyObservables, World, WorldConfig};

use super::combination::{Combination, Method, Stiffness, refusal};
use super::release::{is_unsolved, undone};
use super::shapes::EDGE;
use crate::setting::plane;
use crate::{Size, ValidationError};

/// Steps made in each setting.
pub(super) const STEPS: u32 = 4;

/// What steps that are undone here say.
pub(super) const KINDS: [&str; 4] = ["diverged", "too stiff", "not converged", "gained energy"];

/// What a combination and an integrator did over the ranges.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeTally {
    /// The force model of a law on a kind of cells.
    pub combination: Combination,
    /// The integrator.
    pub method: Method,
    /// Settings tried.
    pub tried: u32,
    /// Settings that are refused, as the whole combination is.
    pub refused: Option<&'static str>,
    /// Settings in which every step was made.
    pub made: u32,
    /// Those of them in which the equations of a step were not solved to what is asked.
    pub unsolved: u32,
    /// Settings in which a step was undone, with an error that says what to do.
    pub undone: Vec<Undone>,
    /// Settings in which a number that is none came through.
    pub not_numbers: u32,
    /// Panics.
    pub panics: u32,
    /// The largest gain of energy in a step, of all energies that were about.
    pub gain: f64,
    /// Where that was: E [Pa], ν, step [s], units of length in a metre.
    pub worst: (f64, f64, f64, f64),
}

impl RangeTally {
    /// Settings undone by an error of this kind.
    pub(super) fn undone_as(&self, kind: &str) -> impl Iterator<Item = &Undone> {
        self.undone.iter().filter(move |undone| undone.kind == kind)
    }
}

/// A setting in which a step was undone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Undone {
    /// What the error says, one of [`KINDS`].
    pub(super) kind: &'static str,
    /// E [Pa], in metres.
    pub(super) young: f64,
    /// ν.
    pub(super) poisson: f64,
    /// Length of a step [s].
    pub(super) step: f64,
}

/// One setting.
#[derive(Clone, Copy, Debug)]
struct Setting {
    stiffness: Stiffness,
    step: f64,
    /// Units of length in a metre.
    length: f64,
}

/// E [Pa], ν, and steps [s], each of which meets each.
pub(super) fn grids(size: Size) -> [&'static [f64]; 3] {
    match size {
        Size::Full => [&[1e2, 1e4, 1e6, 1e9], &[0.0, 0.45, 0.4999], &[1e-4, 1e-3, 1e-2, 0.1, 1.0]],
        Size::Small => [&[1e2, 1e5], &[0.0, 0.4999], &[1e-4, 1.0]],
    }
}

/// What is tried besides: E [Pa], ν, and the step [s]. A second of tissue so stiff would be half a million explicit sub-steps.
pub(super) fn besides(size: Size) -> Option<[f64; 3]> {
    (size == Size::Small).then_some([1e9, 0.4999, 1e-4])
}

fn settings(size: Size) -> Vec<Setting> {
    let [youngs, poissons, steps] = grids(size);
    let mut settings = Vec::new();
    let mut in_both_units = |stiffness: Stiffness, step: f64| {
        settings.extend([1.0, 1000.0].map(|length| Setting { stiffness, step, length }));
    };
    for &young in youngs {
        for &poisson in poissons {
            steps.iter().for_each(|&step| in_both_units(Stiffness { young, poisson }, step));
        }
    }
    if let Some([young, poisson, step]) = besides(size) {
        in_both_units(Stiffness { young, poisson }, step);
    }
    settings
}

/// Lets a held cube fall under its weight in every setting.
pub(super) fn attempt(combination: Combination, method: Method, size: Size) -> Result<RangeTally, ValidationError> {
    let mut tally = RangeTally {
        combination,
        method,
        tried: 0,
        refused: None,
        made: 0,
        unsolved: 0,
        undone: Vec::new(),
        not_numbers: 0,
        panics: 0,
        gain: 0.0,
        worst: Default::default(),
    };
    for setting in settings(size) {
        tally.tried += 1;
        match catch_unwind(AssertUnwindSafe(|| fall(setting, size, &mut tally))) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => match refusal(&error) {
                Some(why) => tally.refused = Some(why),
                None => return Err(error),
            },
            Err(_) => tally.panics += 1,
        }
        if tally.refused.is_some() {
            break;
        }
    }
    Ok(tally)
}

fn fall(setting: Setting, size: Size, tally: &mut RangeTally) -> Result<(), ValidationError> {
    let Setting { stiffness: Stiffness { young, poisson }, step, length } = setting;
    let across = if size == Size::Full { [1, 1, 2] } else { [1; 3] };
    // Pa = kg/(m s²), kg/m³
    let stiffness = Stiffness { young: young / length, poisson };
    let mesh = tally.combination.cells.fill(across, [EDGE * length; 3]);
    let body = tally.combination.body(mesh, stiffness, 1000.0 / length.powi(3))?.fix(plane(2, 0.0));
    let gravity = [0.0, -9.81 * length, 0.0];
    let mut world = World::<f64>::new(WorldConfig { gravity, step, integrator: tally.method.integrator })?;
    let id = world.add(body)?;
    let parts = |seen: &BodyObservables| [seen.kinetic_energy, seen.elastic_energy, seen.gravity_energy];
    let mut before = parts(&world.observe(id));
    let rest = before[2];
    let mut unsolved = false;
    for _ in 0..STEPS {
        match world.step() {
            Ok(report) => unsolved |= is_unsolved(&report),
            Err(error) => {
                let kind = KINDS.into_iter().find(|&name| name == undone(&error)).ok_or(error)?;
                tally.undone.push(Undone { kind, young, poisson, step });
                return Ok(());
            }
        }
        let now = parts(&world.observe(id));
        if now.iter().any(|part| !part.is_finite()) {
            tally.not_numbers += 1;
            return Ok(());
        }
        let scale = now[0] + now[1] + (now[2] - rest).abs() + before[0] + before[1] + (before[2] - rest).abs();
        let gain = (0..3).map(|part| now[part] - before[part]).sum::<f64>();
        if scale > 0.0 && gain / scale > tally.gain {
            tally.gain = gain / scale;
            tally.worst = (young, poisson, step, length);
        }
        before = now;
    }
    tally.made += 1;
    tally.unsolved += u32::from(unsolved);
    Ok(())
}
