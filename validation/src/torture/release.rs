//! Bodies forced into impossible shapes and released: what comes back, and whether energy is gained on the way.

use std::panic::{AssertUnwindSafe, catch_unwind};

use viscera::world::{BodyId, BodyObservables, StepError, World, WorldConfig};

use super::combination::{Combination, Method, Stiffness, refusal};
use super::random::Random;
use super::shapes::{Case, EDGE, Shape};
use crate::references::Vector;
use crate::setting::plane;
use crate::{Size, ValidationError};

/// Length of a step [s].
pub(super) const STEP: f64 = 0.02;
/// Damping rate [1/s]: about critical for the slowest vibration of the cube.
pub(super) const DAMPING: f64 = 50.0;
/// What counts as back, of the size.
const BACK: f64 = 1e-6;
/// The small study takes one case in so many: prime to the numbers of integrators and shapes, so that every combination meets every
/// integrator, and every shape each of them.
const EVERY: usize = 5;

/// What the size of a study decides.
pub(super) struct Extent {
    /// Cells along the edges of the cube.
    pub(super) cells: [usize; 3],
    /// Steps that are made at least, and at most.
    pub(super) steps: [u32; 2],
    /// Of so many cases one is tried.
    pub(super) every: usize,
}

impl Extent {
    pub(super) fn of(size: Size) -> Self {
        match size {
            Size::Full => Self { cells: [2, 2, 2], steps: [100, 300], every: 1 },
            Size::Small => Self { cells: [1, 1, 2], steps: [40, 100], every: EVERY },
        }
    }
}

/// How it went.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// What was tried.
    pub case: Case,
    /// What became of the shape.
    pub outcome: Outcome,
    /// Largest gain of energy in a step, of that before the first.
    pub gain: f64,
    /// Largest energy, of that before the first step.
    pub peak: f64,
    /// Steps made.
    pub steps: u32,
    /// Largest difference of a distance within a cell from that at rest, of the size of the body, at the end.
    pub deviation: f64,
}

/// What became of a shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The rest shape is back, to a millionth of the size.
    Back,
    /// At rest with cells inside out.
    Inverted(usize),
    /// At rest in another shape, without an inverted cell.
    Elsewhere,
    /// Not at rest in the time that was given.
    Moving,
    /// Refused by an error that says what to do: the engine does not compute this combination.
    Refused(&'static str),
    /// A step was undone, with an error that says what to do.
    Undone(&'static str),
    /// A number that is none came through.
    NotANumber,
    /// The engine panicked.
    Panicked,
}

impl Outcome {
    /// In a word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Back => "back",
            Self::Inverted(_) => "at rest inside out",
            Self::Elsewhere => "at rest elsewhere",
            Self::Moving => "still moving",
            Self::Refused(_) => "refused",
            Self::Undone(_) => "undone",
            Self::NotANumber => "not a number",
            Self::Panicked => "panicked",
        }
    }
}

/// Releases bodies of every combination, with every integrator, from every shape, held on one side and free.
pub(super) fn study(size: Size) -> Result<Vec<Trial>, ValidationError> {
    let mut cases = Vec::new();
    for combination in Combination::able() {
        for method in Method::all() {
            for shape in Shape::ALL {
                cases.extend([true, false].map(|held| Case { combination, method, shape, held }));
            }
        }
    }
    let every = Extent::of(size).every;
    let chosen = cases.into_iter().enumerate().filter(|(number, _)| number % every == 0);
    chosen.map(|(number, case)| attempt(case, size, number as u64)).collect()
}

/// Tries a case.
fn attempt(case: Case, size: Size, seed: u64) -> Result<Trial, ValidationError> {
    let tried = catch_unwind(AssertUnwindSafe(|| release(case, size, seed)));
    let without = |outcome| Trial { case, outcome, gain: 0.0, peak: 0.0, steps: 0, deviation: f64::NAN };
    match tried {
        Ok(Ok(trial)) => Ok(trial),
        Ok(Err(error)) => refusal(&error).map(|why| without(Outcome::Refused(why))).ok_or(error),
        Err(_) => Ok(without(Outcome::Panicked)),
    }
}

fn release(case: Case, size: Size, seed: u64) -> Result<Trial, ValidationError> {
    let Case { combination, method, shape, held } = case;
    let Extent { cells, steps: [patience, steps], .. } = Extent::of(size);
    let mut body =
        combination.body(combination.cells.fill(cells, [EDGE; 3]), Stiffness::SOFT, 1000.0)?.damping(DAMPING);
    if held {
        body = body.fix(plane(2, 0.0));
    }
    let mut world = World::<f64>::new(WorldConfig { gravity: [0.0; 3], step: STEP, integrator: method.integrator })?;
    let id = world.add(body)?;
    shape.put_on(&mut world, id, &mut Random::new(seed));
    let first = energy(&world.observe(id));
    let mut trial = Trial { case, outcome: Outcome::Moving, gain: 0.0, peak: 1.0, steps: 0, deviation: 0.0 };
    // At least what strains of one store: in its mirror image, tissue of a blind law has the energy of roundings.
    let scale = first.max(Stiffness::SOFT.young * EDGE.powi(3));
    let mut before = first;
    for _ in 0..steps {
        if let Err(error) = world.step() {
            trial.outcome = Outcome::Undone(undone(&error));
            trial.deviation = deviation(&world, id);
            return Ok(trial);
        }
        trial.steps += 1;
        let seen = world.observe(id);
        let now = energy(&seen);
        if !now.is_finite() || !world.body(id).state().is_finite() {
            trial.outcome = Outcome::NotANumber;
            return Ok(trial);
        }
        trial.gain = trial.gain.max((now - before) / scale);
        trial.peak = trial.peak.max(now / scale);
        before = now;
        trial.deviation = deviation(&world, id);
        if trial.deviation < 0.1 * BACK && seen.inverted_cells == 0 {
            trial.outcome = Outcome::Back;
            return Ok(trial);
        }
        if trial.steps >= patience && is_at_rest(&world, id) {
            break;
        }
    }
    let seen = world.observe(id);
    trial.outcome = if trial.deviation < BACK && seen.inverted_cells == 0 {
        Outcome::Back
    } else if !is_at_rest(&world, id) {
        Outcome::Moving
    } else if seen.inverted_cells > 0 {
        Outcome::Inverted(seen.inverted_cells)
    } else {
        Outcome::Elsewhere
    };
    Ok(trial)
}

fn energy(seen: &BodyObservables) -> f64 {
    seen.kinetic_energy + seen.elastic_energy
}

/// Largest difference of the distance of two corners of a cell to that at rest, of the size: it knows no pose.
fn deviation(world: &World<f64>, id: BodyId) -> f64 {
    let body = world.body(id);
    let (now, rest) = (body.positions(), body.mesh().nodes());
    let mut largest = 0.0_f64;
    for cell in (0..body.mesh().cell_count()).filter(|&cell| !body.state().removed[cell]) {
        let corners = body.mesh().cell(cell);
        for (i, &a) in corners.iter().enumerate() {
            for &b in &corners[..i] {
                let length = |x: &[Vector]| (x[a as usize] - x[b as usize]).norm();
                largest = largest.max((length(now) - length(rest)).abs());
            }
        }
    }
    largest / body.mesh().size()
}

/// Whether no node would move by a millionth of the size in a second.
fn is_at_rest(world: &World<f64>, id: BodyId) -> bool {
    let body = world.body(id);
    body.velocities().iter().all(|v| v.norm() < BACK * body.mesh().size())
}

pub(super) fn undone(error: &StepError) -> &'static str {
    match error {
        StepError::Diverged { .. } => "diverged",
        StepError::TooStiff { .. } => "too stiff",
        StepError::NotConverged { .. } => "not converged",
        StepError::GainedEnergy { .. } => "gained energy",
        StepError::UnstableSubstep { .. } => "sub-step too long",
        StepError::VolumeNotKept { .. } => "volume not kept",
        StepError::NoEquilibrium { .. } => "no equilibrium",
    }
}
