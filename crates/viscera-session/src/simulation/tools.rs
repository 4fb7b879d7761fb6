//! The instruments of a world, as a page sees and leads them.

use serde::{Deserialize, Serialize};
use viscera::curve::Curve;
use viscera::instrument::{
    Capsule, Cautery, Grasper, Instrument, InstrumentKind, Jaws, Mount, Probe, Shaft, ToolInput, ToolPose,
};
use viscera::math::{Scalar, Vec3};
use viscera::world::{BodyId, InstrumentId, World, WorldError};

use super::way_out::TissueAtRest;
use super::world::{AnyWorld, with};
use crate::message::{F32s, InstrumentEntry, InstrumentFrame, InstrumentShape, Manner, Part, PartKind, Refusal};
use crate::refuse;

/// Radius of a scene [m] for which instruments have their real measures; much smaller and much larger ones get instruments in
/// proportion.
const USUAL_RADIUS: f64 = 0.15;
/// Power of the cautery [W], as surgeons set it for cutting.
const POWER: f64 = 60.0;
/// Share of the heat of evaporation that a cell takes in before it goes. A real cut is a line: to evaporate the ten cells of 16 mm edges
/// that the tip touches at once takes minutes, and with this share a seventh of a second.
const HASTE: f64 = 5e-4;

/// How fast a hand leads an instrument at most [m/s], in the time of the simulation. Without a bound, jaws that hold tissue tore at it with
/// 7.6e10 N when a slow simulation made one step of what a hand did in a second. Eight times what the page's hands do: at 1 m/s tools came
/// after their hands where a simulation was only a little late, and jaws closed on the way.
const SPEED: f64 = 10.0;

/// What the jaws of a grasper hold at most [N]: about what the surgeon's hand pulls at an organ with.
const GRIP: f64 = 10.0;

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
    /// Whether the scene brought it in: its world is built with it.
    pub(crate) of_scene: bool,
    /// Whether the scene leads it.
    pub(crate) scripted: bool,
    pub(crate) removed: bool,
    /// What the page called the moment of the last move.
    #[serde(skip)]
    pub(crate) stamp: Option<f64>,
}

impl Hand {
    /// In a scene of this radius [m].
    fn input(&self, radius: f64) -> ToolInput {
        let pose = ToolPose { tip: self.tip.into(), direction: self.direction.into(), roll: self.roll };
        ToolInput { speed: SPEED * proportion(radius), ..ToolInput::new(pose, self.trigger) }
    }
}

fn id(instrument: u32) -> InstrumentId {
    InstrumentId(instrument as usize)
}

/// The instruments that can be brought in.
pub(crate) fn entries() -> Vec<InstrumentEntry> {
    let entry = |kind: &InstrumentKind| {
        let (title, summary, trigger) = match kind {
            InstrumentKind::Probe => ("Probe", "A round rod that pushes tissue and slides along it.", ""),
            InstrumentKind::Grasper => ("Grasper", "Jaws that hold what they close on.", "closes the jaws"),
            InstrumentKind::Cautery => {
                ("Cautery", "A hot tip that burns away what it stays on.", "switches the current on")
            }
        };
        InstrumentEntry {
            kind: kind.name().into(),
            title: title.into(),
            summary: summary.into(),
            trigger: trigger.into(),
        }
    };
    InstrumentKind::ALL.iter().map(entry).collect()
}

/// Gives a world that was just built the instruments that another one has, under the same numbers.
pub(crate) fn match_slots(world: &mut AnyWorld, radius: f64, tools: &[Tool]) -> Result<(), Box<Refusal>> {
    for (number, tool) in tools.iter().enumerate() {
        let hand = Hand { tip: [0.0; 3], direction: [0.0, -1.0, 0.0], roll: 0.0, trigger: 0.0 };
        if !tool.of_scene {
            add(world, &tool.kind, radius, &hand, None).map_err(refuse::because)?;
        }
        if tool.removed {
            remove(world, number as u32).map_err(refuse::because)?;
        }
    }
    Ok(())
}

/// Leads the instruments of a world that begins again to where hands hold them, through the trocars that they have, or out of the tissue
/// that is back in its place. Those that a hand brought in are there at once: on the way they would sweep up what is in between.
pub(crate) fn lead_as_before(
    world: &mut AnyWorld,
    radius: f64,
    before: &AnyWorld,
    tools: &[Tool],
) -> Result<(), Box<Refusal>> {
    let rest = TissueAtRest::of(world);
    for (number, tool) in tools.iter().enumerate().filter(|(_, tool)| !tool.removed) {
        let number = number as u32;
        let state = with!(before, before => *before.tool(id(number)));
        set_trocar(world, number, state.trocar.map(Vec3::to_array)).map_err(refuse::because)?;
        let Some(hand) = state.hand else { continue };
        let hand = Hand {
            tip: rest.drawn_out(hand.pose, state.trocar, radius).to_array(),
            direction: hand.pose.direction.to_array(),
            roll: hand.pose.roll,
            trigger: hand.trigger,
        };
        if !tool.of_scene {
            place(world, number, &tool.kind, radius, &hand, state.trocar).map_err(refuse::because)?;
        }
        lead(world, number, radius, &hand).map_err(refuse::because)?;
    }
    Ok(())
}

/// Brings an instrument in where the hand is, sized for bodies within a ball of `radius` [m], its shaft through `trocar` [m]. It stays
/// in the hand: on the path of a world that is built anew, it would be where that path begins.
pub(crate) fn add(
    world: &mut AnyWorld,
    kind: &str,
    radius: f64,
    hand: &Hand,
    trocar: Option<[f64; 3]>,
) -> Result<(), String> {
    let kind = named(kind)?;
    with!(world, world => {
        let instrument = instrument(kind, radius, hand, trocar.map(Vec3::from));
        world.add_instrument(instrument).and_then(|id| world.set_tool(id, hand.input(radius)))
    })
    .map_err(text)
}

/// Puts an instrument where the hand is, at once: a hand that led it before would take it there from where it was.
fn place(
    world: &mut AnyWorld,
    number: u32,
    kind: &str,
    radius: f64,
    hand: &Hand,
    trocar: Option<Vec3<f64>>,
) -> Result<(), String> {
    let kind = named(kind)?;
    with!(world, world => {
        let instrument = instrument(kind, radius, hand, trocar);
        world.release_tool(id(number)).and_then(|()| world.replace_instrument(id(number), instrument))
    })
    .map_err(text)
}

/// Says where an instrument should be at the end of the next step, or go as fast as it may, among bodies within a ball of `radius` [m].
pub(crate) fn lead(world: &mut AnyWorld, instrument: u32, radius: f64, hand: &Hand) -> Result<(), String> {
    with!(world, world => world.set_tool(id(instrument), hand.input(radius))).map_err(text)
}

/// Leads the shaft of an instrument through a point [m], or lets it go.
pub(crate) fn set_trocar(world: &mut AnyWorld, instrument: u32, trocar: Option<[f64; 3]>) -> Result<(), String> {
    with!(world, world => world.set_trocar(id(instrument), trocar.map(Vec3::from))).map_err(text)
}

/// The trocar of an instrument [m], where it has one.
pub(crate) fn trocar(world: &AnyWorld, instrument: u32) -> Option<Vec3<f64>> {
    with!(world, world => world.tool(id(instrument)).trocar)
}

/// Where the tip of an instrument is [m].
pub(crate) fn tip(world: &AnyWorld, instrument: u32) -> Vec3<f64> {
    with!(world, world => world.tool(id(instrument)).pose.tip)
}

pub(crate) fn remove(world: &mut AnyWorld, instrument: u32) -> Result<(), String> {
    with!(world, world => world.remove_instrument(id(instrument))).map_err(text)
}

pub(crate) fn kind(world: &AnyWorld, instrument: u32) -> String {
    with!(world, world => world.instrument(id(instrument)).kind().into())
}

fn text(error: WorldError) -> String {
    error.to_string()
}

fn named(kind: &str) -> Result<InstrumentKind, String> {
    let known = InstrumentKind::ALL.iter().find(|known| known.name() == kind);
    known.copied().ok_or_else(|| format!("there is no instrument `{kind}`"))
}

/// Factor on the real measures of instruments for bodies within a ball of `radius` [m].
fn proportion(radius: f64) -> f64 {
    if (0.2..5.0).contains(&(radius / USUAL_RADIUS)) { 1.0 } else { radius / USUAL_RADIUS }
}

/// Length of the shafts of instruments that are brought in [m].
pub(crate) fn shaft_length(radius: f64) -> f64 {
    0.3 * proportion(radius)
}

fn instrument<T: Scalar>(
    kind: InstrumentKind,
    radius: f64,
    hand: &Hand,
    trocar: Option<Vec3<f64>>,
) -> Box<dyn Instrument<T>> {
    let size = proportion(radius);
    let path = Curve::constant(Vec3::from(hand.tip));
    let mount = Mount { roll: hand.roll, trocar, ..Mount::along(hand.direction.into()) };
    let shaft = Shaft { radius: 2.5e-3 * size, length: shaft_length(radius) };
    match kind {
        InstrumentKind::Probe => Box::new(Probe { path, mount, shaft, ..Probe::default() }),
        InstrumentKind::Grasper => Box::new(Grasper {
            path,
            mount,
            radius: 0.012 * size,
            jaws: Some(Jaws { length: 0.02 * size, radius: 1.5e-3 * size, ..Jaws::default() }),
            shaft: Some(shaft),
            grip: GRIP * size * size,
            ..Grasper::default()
        }),
        InstrumentKind::Cautery => {
            let (radius, heat) = (5e-3 * size, HASTE * Cautery::default().heat);
            let power = POWER * size.powi(3);
            Box::new(Cautery { path, mount, radius, heat, power, shaft: Some(shaft), ..Cautery::default() })
        }
    }
}

pub(crate) fn shape(world: &AnyWorld, instrument: u32, tool: &Tool) -> InstrumentShape {
    let (parts, reach, jaws) = with!(world, world => {
        let this = world.instrument(id(instrument));
        (world.tool_capsules(id(instrument)), this.reach(), this.parts_that_hold())
    });
    let first_jaw = parts.len() - jaws;
    let part = |(number, part): (usize, &Capsule)| Part {
        kind: if number < first_jaw { PartKind::Shaft } else { PartKind::Jaw },
        radius: part.radius,
        length: (part.to - part.from).norm(),
    };
    InstrumentShape {
        instrument,
        kind: tool.kind.clone(),
        name: tool.name.clone(),
        scripted: tool.scripted,
        manner: match named(&tool.kind) {
            Ok(InstrumentKind::Grasper) => Manner::Hold,
            Ok(InstrumentKind::Cautery) => Manner::Burn,
            Ok(InstrumentKind::Probe) | Err(_) => Manner::Push,
        },
        reach,
        parts: parts.iter().enumerate().map(part).collect(),
    }
}

pub(crate) fn frame(world: &AnyWorld, instrument: u32, tool: &Tool) -> InstrumentFrame {
    fn of<T: Scalar>(world: &World<T>, instrument: u32, tool: &Tool) -> InstrumentFrame {
        let id = id(instrument);
        let state = world.tool(id);
        let parts = world.tool_capsules(id);
        let numbers = |part: &Capsule| {
            let ends = [part.from, part.to].map(|end| end.cast::<f32>().to_array());
            ends.into_iter().flatten().chain([part.radius as f32])
        };
        InstrumentFrame {
            instrument,
            tip: state.pose.tip.to_array(),
            direction: state.pose.direction.to_array(),
            roll: state.pose.roll,
            trocar: state.trocar.map(Vec3::to_array),
            trigger: state.trigger,
            active: world.is_at_work(id),
            holds: state.held_nodes > 0,
            force: (Vec3::ZERO - state.force()).to_array(),
            torque: (Vec3::ZERO - state.torque()).to_array(),
            parts: F32s(parts.iter().flat_map(numbers).collect()),
            stamp: tool.stamp,
        }
    }
    with!(world, world => of(world, instrument, tool))
}

/// How burnt these nodes are [0 … 1]; none where nothing is.
pub(crate) fn seared(world: &AnyWorld, body: usize, nodes: &[u32]) -> Option<Vec<f32>> {
    with!(world, world => {
        let seared = world.body(BodyId(body)).seared();
        let values: Vec<f32> = nodes.iter().map(|&node| seared[node as usize].to_f64() as f32).collect();
        values.iter().any(|&value| value > 0.0).then_some(values)
    })
}
