//! The instruments of a world, as a page sees them.

use serde::{Deserialize, Serialize};
use viscera::math::Vec3;
use viscera::world::{InstrumentId, World};

use super::world::{AnyWorld, with};
use crate::message::{F32s, InstrumentEntry, InstrumentFrame, InstrumentShape, Refusal, Rod};

/// What a hand asks of an instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hand {
    pub(crate) tip: [f64; 3],
    pub(crate) direction: [f64; 3],
    pub(crate) roll: f64,
    pub(crate) trigger: f64,
}

/// One that was brought in: its number in the world is its place among all that there ever were.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub(crate) struct Tool {
    pub(crate) kind: String,
    pub(crate) name: String,
    pub(crate) scripted: bool,
    pub(crate) removed: bool,
    /// What the page called the moment of the last move.
    #[serde(skip)]
    pub(crate) stamp: Option<f64>,
}

/// The instruments that can be brought in.
pub(crate) fn entries() -> Vec<InstrumentEntry> {
    Vec::new()
}

/// Gives a world that was just built the instruments that another one has, under the same numbers.
pub(crate) fn match_slots(_world: &mut AnyWorld, _tools: &[Tool]) -> Result<(), Box<Refusal>> {
    Ok(())
}

/// Leads the instruments of a world that begins again to where hands hold them.
pub(crate) fn lead_as_before(_world: &mut AnyWorld, _before: &AnyWorld, _tools: &[Tool]) {}

/// Brings an instrument in, sized for bodies within a ball of `radius` [m].
pub(crate) fn add(_world: &mut AnyWorld, kind: &str, _radius: f64, _hand: Option<&Hand>) -> Result<(), String> {
    Err(format!("there is no instrument `{kind}`"))
}

pub(crate) fn lead(_world: &mut AnyWorld, _instrument: u32, _hand: &Hand) -> Result<(), String> {
    Err("instruments follow their paths".into())
}

pub(crate) fn remove(_world: &mut AnyWorld, _instrument: u32) -> Result<(), String> {
    Err("instruments stay".into())
}

pub(crate) fn kind(world: &AnyWorld, instrument: u32) -> String {
    with!(world, world => world.instrument(InstrumentId(instrument as usize)).kind().into())
}

pub(crate) fn shape(world: &AnyWorld, instrument: u32, tool: &Tool) -> InstrumentShape {
    InstrumentShape {
        instrument,
        kind: tool.kind.clone(),
        name: tool.name.clone(),
        scripted: tool.scripted,
        shaft: Rod { radius: 0.0025, length: 0.3 },
        reach: with!(world, world => world.instrument(InstrumentId(instrument as usize)).reach()),
        jaw: None,
        hook: None,
        trocar: None,
    }
}

pub(crate) fn frame(world: &mut AnyWorld, instrument: u32, tool: &Tool) -> InstrumentFrame {
    fn of<T: viscera::math::Scalar>(world: &mut World<T>, instrument: u32) -> (Vec3<f64>, bool, usize, Vec3<f64>) {
        let seen = world.observe_instrument(InstrumentId(instrument as usize));
        (seen.tip, seen.active, seen.held_nodes, seen.force)
    }
    let (tip, active, held, force) = with!(world, world => of(world, instrument));
    InstrumentFrame {
        instrument,
        tip: tip.to_array(),
        direction: [0.0, -1.0, 0.0],
        roll: 0.0,
        trigger: f64::from(u8::from(active)),
        opening: 0.0,
        active,
        holds: held > 0,
        force: (-force).to_array(),
        torque: [0.0; 3],
        parts: F32s(Vec::new()),
        stamp: tool.stamp,
    }
}

/// How burnt these nodes are [0 … 1]; none where nothing is.
pub(crate) fn seared(_world: &AnyWorld, _body: usize, _nodes: &[u32]) -> Option<Vec<f32>> {
    None
}
