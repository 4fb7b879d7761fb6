//! What the engine does not compute, and whether it says so.

use viscera::mesh::Region;
use viscera::world::{World, WorldConfig};

use super::combination::{Combination, Method, Stiffness, refusal};
use super::shapes::EDGE;
use crate::ValidationError;

/// Whether a combination is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The force model of a law on a kind of cells.
    pub combination: Combination,
    /// The integrator.
    pub method: &'static str,
    /// Why it is refused; nothing where it is computed.
    pub why: Option<&'static str>,
}

/// Asks for every model of every law on both kinds of cells, with every integrator.
///
/// # Errors
/// [`ValidationError`] for an error that is no refusal.
pub(super) fn study() -> Result<Vec<Refusal>, ValidationError> {
    let mut found = Vec::new();
    for combination in Combination::all() {
        for method in Method::all() {
            let why = match build(combination, method) {
                Ok(()) => None,
                Err(error) => Some(refusal(&error).ok_or(error)?),
            };
            found.push(Refusal { combination, method: method.name, why });
        }
    }
    Ok(found)
}

fn build(combination: Combination, method: Method) -> Result<(), ValidationError> {
    let mut world = World::<f64>::new(WorldConfig { integrator: method.integrator, ..WorldConfig::default() })?;
    let body = combination.body(combination.cells.fill([1; 3], [EDGE; 3]), Stiffness::SOFT, 1000.0)?;
    // What rests at every step has to be held.
    world.add(if combination.model.info().moves { body } else { body.fix(Region::Named("z-min".into())) })?;
    Ok(())
}
