//! Torture: every force model of every law, with every integrator, in shapes, scales, units and cuts that nothing should
//! survive. No number may be none, nothing may panic, backward Euler may not gain energy, and the rest shape has to come back
//! wherever the law can bring it back.

mod combination;
mod cuts;
mod elements;
mod page;
mod random;
mod ranges;
mod refusals;
mod release;
mod sameness;
mod shapes;

pub use self::combination::{Combination, Method};
pub use self::cuts::{Cuts, End};
pub use self::elements::ElementTally;
pub use self::ranges::{RangeTally, Undone};
pub use self::refusals::Refusal;
pub use self::release::{Outcome, Trial};
pub use self::sameness::Sameness;
pub use self::shapes::{Case, Obstacle, Shape};
use crate::{Size, ValidationError};

/// What was found.
pub struct Torture {
    /// How large the meshes were.
    pub size: Size,
    /// What the engine does not compute.
    pub refusals: Vec<Refusal>,
    /// Bodies released from impossible shapes.
    pub trials: Vec<Trial>,
    /// Every stiffness, step and unit.
    pub ranges: Vec<RangeTally>,
    /// The same motion told differently.
    pub sameness: Vec<Sameness>,
    /// Bodies cut while they are inside out.
    pub inverted_cuts: Vec<Cuts>,
    /// Bodies cut down to nothing.
    pub cuts_to_nothing: Vec<Cuts>,
    /// Single elements.
    pub elements: Vec<ElementTally>,
}

/// Does all of it.
///
/// # Errors
/// [`ValidationError`] for an error that is no answer to torture: a mistake in the study.
pub fn study(size: Size) -> Result<Torture, ValidationError> {
    Ok(Torture {
        size,
        refusals: refusals()?,
        trials: release(size)?,
        ranges: ranges(size)?,
        sameness: sameness(size)?,
        inverted_cuts: cut_while_inverted(size)?,
        cuts_to_nothing: cut_to_nothing(size)?,
        elements: elements(size)?,
    })
}

/// Asks for every combination.
///
/// # Errors
/// As [`study`].
pub fn refusals() -> Result<Vec<Refusal>, ValidationError> {
    refusals::study()
}

/// Releases bodies from impossible shapes.
///
/// # Errors
/// As [`study`].
pub fn release(size: Size) -> Result<Vec<Trial>, ValidationError> {
    release::study(size)
}

/// Tries every stiffness, step and unit.
///
/// # Errors
/// As [`study`].
pub fn ranges(size: Size) -> Result<Vec<RangeTally>, ValidationError> {
    over_methods(|combination, method| ranges::attempt(combination, method, size))
}

/// Tells the same motion differently.
///
/// # Errors
/// As [`study`].
pub fn sameness(size: Size) -> Result<Vec<Sameness>, ValidationError> {
    let found: Result<Vec<_>, _> =
        Combination::able().map(|combination| sameness::attempt(combination, size)).collect();
    Ok(found?.concat())
}

/// Cuts bodies that are inside out.
///
/// # Errors
/// As [`study`].
pub fn cut_while_inverted(size: Size) -> Result<Vec<Cuts>, ValidationError> {
    over_methods(|combination, method| cuts::inverted(combination, method, size))
}

/// Cuts bodies down to nothing.
///
/// # Errors
/// As [`study`].
pub fn cut_to_nothing(size: Size) -> Result<Vec<Cuts>, ValidationError> {
    Combination::able().map(|combination| cuts::to_nothing(combination, Method::EXPLICIT, size)).collect()
}

/// Asks single elements for their forces, in both precisions.
///
/// # Errors
/// As [`study`].
pub fn elements(size: Size) -> Result<Vec<ElementTally>, ValidationError> {
    let mut random = random::Random::new(3);
    let mut found = Vec::new();
    for combination in Combination::able() {
        found.push(elements::attempt::<f64>(combination, size, &mut random)?);
        found.push(elements::attempt::<f32>(combination, size, &mut random)?);
    }
    Ok(found)
}

fn over_methods<T>(
    attempt: impl Fn(Combination, Method) -> Result<T, ValidationError>,
) -> Result<Vec<T>, ValidationError> {
    Combination::able()
        .flat_map(|combination| Method::all().into_iter().map(move |method| (combination, method)))
        .map(|(combination, method)| attempt(combination, method))
        .collect()
}
