//! What pulls and pushes on a body, and what in it pulls by itself.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{CurveFile, RegionFile};
use crate::quantity::{Force, ForceDensity, Length, Pressure, Stiffness};

/// A load. Give one of `force`, `force-per-node`, `pressure`, `traction`, `body-force`, `attraction`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(
    title = "load",
    extend("x-exactly-one-of" = [["force"], ["force-per-node"], ["pressure"], ["traction"], ["body-force"], ["attraction"]])
)]
pub struct LoadFile {
    /// Where it acts.
    pub region: RegionFile,
    /// Total force, shared equally by the nodes of the region [N].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<CurveFile<[Force; 3]>>,
    /// Force on every node of the region [N].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_per_node: Option<CurveFile<[Force; 3]>>,
    /// Pressure on the surface in the region, positive inwards [Pa]; it follows the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<CurveFile<Pressure>>,
    /// Force per area on the surface in the region [Pa], in a direction that stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub traction: Option<CurveFile<[Pressure; 3]>>,
    /// A field of one direction: force per rest volume of the cells in the region [N/m³].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body_force: Option<CurveFile<[ForceDensity; 3]>>,
    /// A field towards a place, on the cells in the region.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attraction: Option<AttractionFile>,
}

/// The field of a ball that attracts: strongest at its surface, falling by the square of the distance outside and in proportion to it
/// inside.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "attraction")]
pub struct AttractionFile {
    /// The place that it draws to [m].
    pub centre: [Length; 3],
    /// Radius of the ball [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: Length,
    /// Force per rest volume at that radius [N/m³], positive towards the place.
    pub per_volume: CurveFile<ForceDensity>,
}

/// A linear actuator between two regions: a spring whose length is commanded, a motor that pulls, or both. It pulls with
/// stiffness × (length now − `length` × length at rest) + `force`, and pushes where that is negative.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "actuator")]
pub struct ActuatorFile {
    /// One end: its nodes share the pull, and their mean place is the end.
    pub from: RegionFile,
    /// The other end.
    pub to: RegionFile,
    /// Stiffness [N/m]; by default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub stiffness: Option<Stiffness>,
    /// The length at which it is slack, over that at rest; by default 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<CurveFile<f64>>,
    /// Force that it pulls with besides [N]; by default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<CurveFile<Force>>,
}

/// Linear actuators in all cells of a region, along a direction that goes with the tissue. They pull with a tension, per rest area, of
/// `young` × (stretch − `length`) + `stress`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "active fibre")]
pub struct ActiveFibreFile {
    /// Which cells.
    pub region: RegionFile,
    /// Direction at rest, of any length but zero.
    pub direction: [f64; 3],
    /// Young's modulus along the direction, on top of that of the tissue [Pa]; by default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub young: Option<Pressure>,
    /// The stretch at which it is slack; by default 1, the rest shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<CurveFile<f64>>,
    /// Tension that it pulls with besides [Pa]; by default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stress: Option<CurveFile<Pressure>>,
}
