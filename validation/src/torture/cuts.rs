//! Cutting where nobody would: bodies that are inside out, and bodies down to nothing.

use std::panic::{AssertUnwindSafe, catch_unwind};

use viscera::world::{StepError, World, WorldConfig};

use super::combination::{Combination, Method, Stiffness, refusal};
use super::random::Random;
use super::release::undone;
use super::shapes::{EDGE, Shape};
use crate::setting::plane;
use crate::{Size, ValidationError};

/// Cuts of a body, until nothing is left.
#[derive(Clone, Debug, PartialEq)]
pub struct Cuts {
    /// The force model of a law on a kind of cells.
    pub combination: Combination,
    /// The integrator.
    pub method: Method,
    /// Cuts made, each of one cell.
    pub cuts: usize,
    /// Steps made between them.
    pub steps: u32,
    /// Steps undone, with an error that says what to do.
    pub undone: u32,
    /// Why the first of them.
    pub why: Option<&'static str>,
    /// How it ended.
    pub end: End,
}

/// How cutting ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Nothing is left, and the world goes on.
    Nothing,
    /// The engine does not compute this combination, and says so.
    Refused(&'static str),
    /// Something is left that should not be: mass, energy, a number that is none.
    Leftover,
    /// The engine panicked.
    Panicked,
}

/// A body that is turned inside out is cut, cell after cell, a step after each.
pub(super) fn inverted(combination: Combination, method: Method, size: Size) -> Result<Cuts, ValidationError> {
    let across = if size == Size::Full { [2, 2, 2] } else { [1, 1, 2] };
    let job = Job { across, shape: Some(Shape::Mirrored), gravity: [0.0; 3], cuts_per_step: 1, step: 0.02 };
    job.attempt(combination, method)
}

/// A body under its weight is cut at random, a hundred thousand times, down to nothing.
pub(super) fn to_nothing(combination: Combination, method: Method, size: Size) -> Result<Cuts, ValidationError> {
    // 26³ cells of six tetrahedra, 105 456; or 47³ hexahedra, 103 823.
    let edge = match (size, combination.cells) {
        (Size::Full, crate::setting::Cells::Hexahedra) => 47,
        (Size::Full, _) => 26,
        (Size::Small, _) => 3,
    };
    let cuts_per_step = if size == Size::Full { 2500 } else { 8 };
    let job = Job { across: [edge; 3], shape: None, gravity: [0.0, -9.81, 0.0], cuts_per_step, step: 1e-3 };
    job.attempt(combination, method)
}

struct Job {
    across: [usize; 3],
    shape: Option<Shape>,
    gravity: [f64; 3],
    cuts_per_step: usize,
    step: f64,
}

impl Job {
    fn attempt(&self, combination: Combination, method: Method) -> Result<Cuts, ValidationError> {
        let without = |end| Cuts { combination, method, cuts: 0, steps: 0, undone: 0, why: None, end };
        match catch_unwind(AssertUnwindSafe(|| self.cut(combination, method))) {
            Ok(Ok(cuts)) => Ok(cuts),
            Ok(Err(error)) => refusal(&error).map(|why| without(End::Refused(why))).ok_or(error),
            Err(_) => Ok(without(End::Panicked)),
        }
    }

    fn cut(&self, combination: Combination, method: Method) -> Result<Cuts, ValidationError> {
        let mesh = combination.cells.fill(self.across, [EDGE; 3]);
        let mut random = Random::new(11);
        let order = random.permutation(mesh.cell_count());
        let body = combination.body(mesh, Stiffness::SOFT, 1000.0)?.damping(5.0).fix(plane(2, 0.0));
        let config = WorldConfig { gravity: self.gravity, step: self.step, integrator: method.integrator };
        let mut world = World::<f64>::new(config)?;
        let id = world.add(body)?;
        if let Some(shape) = self.shape {
            shape.put_on(&mut world, id, &mut random);
        }
        let mut found =
            Cuts { combination, method, cuts: order.len(), steps: 0, undone: 0, why: None, end: End::Leftover };
        let mut step = |world: &mut World<f64>| match world.step() {
            Ok(_) => found.steps += 1,
            Err(error) => {
                found.undone += 1;
                let why: fn(&StepError) -> &'static str = undone;
                found.why = found.why.or(Some(why(&error)));
            }
        };
        for cells in order.chunks(self.cuts_per_step) {
            for &cell in cells {
                world.remove_cells(id, &[cell])?;
            }
            step(&mut world);
        }
        step(&mut world);
        let seen = world.observe(id);
        let nothing = world.body(id).cell_count() == 0 && seen.mass == 0.0 && seen.volume == 0.0;
        let quiet = seen.kinetic_energy == 0.0 && seen.elastic_energy == 0.0;
        if nothing && quiet && world.body(id).state().is_finite() {
            found.end = End::Nothing;
        }
        Ok(found)
    }
}
