//! Bodies forced into impossible shapes and released: what comes back, and whether energy is gained on the way.

use std::panic::{AssertUnwindSafe, catch_unwind};

use viscera::world::{BodyId, BodyObservables, Integrator, StepError, StepReport, World, WorldConfig};

use super::combination::{Combination, Method, Stiffness, refusal};
use super::random::Random;
use super::shapes::{Case, EDGE, Shape, put_at};
use crate::references::Vector;
use crate::setting::plane;
use crate::{Size, ValidationError};

/// Length of a step [s].
pub(super) const STEP: f64 = 0.02;
/// Damping rate [1/s]: about critical for the slowest vibration of the cube.
pub(super) const DAMPING: f64 = 50.0;
/// What counts as back, of the size.
const BACK: f64 = 1e-6;
/// How far a disturbance moves nodes, along each axis, of the size.
const DISTURBANCE: f64 = 1e-3;
/// How often a body that balances is disturbed.
const DISTURBANCES: u32 = 3;
/// A disturbance has died away when so much of it is left.
const DIED_AWAY: f64 = 0.1;
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
            Size::Full => Self { cells: [2, 2, 2], steps: [100, 3000], every: 1 },
            Size::Small => Self { cells: [1, 1, 2], steps: [40, 150], every: EVERY },
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
    /// Those of them whose equations were not solved to what is asked, as the report of the step says.
    pub unsolved: u32,
    /// Largest difference of a distance within a cell from that at rest, of the size of the body, at the end.
    pub deviation: f64,
    /// How often it was disturbed a little where it balanced.
    pub disturbances: u32,
}

/// What became of a shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The rest shape is back, to a millionth of the size.
    Back,
    /// At rest in another shape.
    Elsewhere {
        /// Cells that are inside out.
        inverted: usize,
        /// Whether that shape, disturbed a little, comes back to itself: the energy is least there too.
        is_steady: bool,
    },
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
            Self::Elsewhere { is_steady: true, .. } => "in another shape that holds",
            Self::Elsewhere { inverted: 0, .. } => "at rest elsewhere",
            Self::Elsewhere { .. } => "at rest inside out",
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
    let without = |outcome| Trial { outcome, peak: 0.0, deviation: f64::NAN, ..Trial::begun(case) };
    match tried {
        Ok(Ok(trial)) => Ok(trial),
        Ok(Err(error)) => refusal(&error).map(|why| without(Outcome::Refused(why))).ok_or(error),
        Err(_) => Ok(without(Outcome::Panicked)),
    }
}

fn release(case: Case, size: Size, seed: u64) -> Result<Trial, ValidationError> {
    let (mut world, id) = cube(&case, case.method.integrator, size)?;
    let mut random = Random::new(seed);
    case.shape.put_on(&mut world, id, &mut random);
    // At least what strains of one store: in its mirror image, tissue of a blind law has the energy of roundings.
    let scale = energy(&world.observe(id)).max(Stiffness::SOFT.young * EDGE.powi(3));
    let mut trial = Trial::begun(case);
    loop {
        trial.settle(&mut world, id, scale, size);
        let Outcome::Elsewhere { inverted, .. } = trial.outcome else { return Ok(trial) };
        let has_to = trial.case.obstacle().is_none();
        let is_steady = has_to && is_steady(&trial.case, world.body(id).positions(), size)?;
        trial.outcome = Outcome::Elsewhere { inverted, is_steady };
        if !has_to || is_steady || trial.disturbances == DISTURBANCES {
            return Ok(trial);
        }
        trial.disturbances += 1;
        disturb(&mut world, id, &mut random);
    }
}

impl Trial {
    /// Before the first step.
    fn begun(case: Case) -> Self {
        let (outcome, gain, peak, deviation) = (Outcome::Moving, 0.0, 1.0, 0.0);
        Self { case, outcome, gain, peak, steps: 0, unsolved: 0, deviation, disturbances: 0 }
    }

    /// Lets the body move until it is back or at rest elsewhere, as long as there is time, or a step is undone.
    fn settle(&mut self, world: &mut World<f64>, id: BodyId, scale: f64, size: Size) {
        let Extent { steps: [patience, steps], .. } = Extent::of(size);
        let (start, mut before) = (self.steps, energy(&world.observe(id)));
        while self.steps - start < steps {
            let report = match world.step() {
                Ok(report) => report,
                Err(error) => {
                    self.outcome = Outcome::Undone(undone(&error));
                    self.deviation = deviation(world, id);
                    return;
                }
            };
            self.steps += 1;
            self.unsolved += u32::from(is_unsolved(&report));
            let seen = world.observe(id);
            let now = energy(&seen);
            if !now.is_finite() || !world.body(id).state().is_finite() {
                self.outcome = Outcome::NotANumber;
                return;
            }
            self.gain = self.gain.max((now - before) / scale);
            self.peak = self.peak.max(now / scale);
            before = now;
            self.deviation = deviation(world, id);
            if self.deviation < 0.1 * BACK && seen.inverted_cells == 0 {
                self.outcome = Outcome::Back;
                return;
            }
            if self.steps - start >= patience && is_at_rest(world, id) {
                break;
            }
        }
        let inverted = world.observe(id).inverted_cells;
        self.outcome = if self.deviation < BACK && inverted == 0 {
            Outcome::Back
        } else if is_at_rest(world, id) {
            Outcome::Elsewhere { inverted, is_steady: false }
        } else {
            Outcome::Moving
        };
    }
}

/// The cube of a case, at rest.
fn cube(case: &Case, integrator: Integrator, size: Size) -> Result<(World<f64>, BodyId), ValidationError> {
    let combination = case.combination;
    let mesh = combination.cells.fill(Extent::of(size).cells, [EDGE; 3]);
    let mut body = combination.body(mesh, Stiffness::SOFT, 1000.0)?.damping(DAMPING);
    if case.held {
        body = body.fix(plane(2, 0.0));
    }
    let mut world = World::new(WorldConfig { gravity: [0.0; 3], step: STEP, integrator })?;
    let id = world.add(body)?;
    Ok((world, id))
}

/// Whether a shape at rest, disturbed a little and let go, comes back to itself: in explicit steps, since long implicit ones also
/// hold tissue where its energy is stationary and not least.
fn is_steady(case: &Case, shape: &[Vector], size: Size) -> Result<bool, ValidationError> {
    let (mut world, id) = cube(case, Method::EXPLICIT.integrator, size)?;
    put_at(&mut world, id, |node| shape[node]);
    disturb(&mut world, id, &mut Random::new(0));
    for _ in 0..Extent::of(size).steps[1] {
        if world.step().is_err() {
            return Ok(false);
        }
        if is_at_rest(&world, id) {
            break;
        }
    }
    Ok(difference(&world, id, shape) < DIED_AWAY * DISTURBANCE)
}

/// Moves the free nodes a little.
fn disturb(world: &mut World<f64>, id: BodyId, random: &mut Random) {
    let places = world.body(id).positions().to_vec();
    let far = DISTURBANCE * world.body(id).mesh().size();
    put_at(world, id, |node| places[node] + random.vector() * far);
}

fn energy(seen: &BodyObservables) -> f64 {
    seen.kinetic_energy + seen.elastic_energy
}

/// The [`difference`] to the rest shape.
fn deviation(world: &World<f64>, id: BodyId) -> f64 {
    difference(world, id, world.body(id).mesh().nodes())
}

/// Largest difference of the distance of two corners of a cell to that in another shape, of the size: it knows no pose.
fn difference(world: &World<f64>, id: BodyId, other: &[Vector]) -> f64 {
    let body = world.body(id);
    let now = body.positions();
    let mut largest = 0.0_f64;
    for cell in (0..body.mesh().cell_count()).filter(|&cell| !body.state().removed[cell]) {
        let corners = body.mesh().cell(cell);
        for (i, &a) in corners.iter().enumerate() {
            for &b in &corners[..i] {
                let length = |x: &[Vector]| (x[a as usize] - x[b as usize]).norm();
                largest = largest.max((length(now) - length(other)).abs());
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

/// Whether equations of the step were not solved to what is asked.
pub(super) fn is_unsolved(report: &StepReport) -> bool {
    report.implicit.is_some_and(|implicit| !implicit.converged)
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
