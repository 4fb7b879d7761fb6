use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::quantity::Time;

/// A value that may change with time: constant, given at times `[["0 s", value], ["1 s", value]]`, or read from a file.
/// Straight lines join the given values; before the first and after the last it stays as it is there.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "curve")]
pub enum CurveFile<V> {
    /// Read from a file.
    File(CurvePath),
    /// Values at times that ascend.
    Keyed(#[schemars(length(min = 1))] Vec<(Time, V)>),
    /// The same at all times.
    Constant(V),
}

/// A curve that is read from a file.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "curve file")]
pub struct CurvePath {
    /// CSV file, from the scene file's folder: time [s] in the first column, the value in the next one or three. A first
    /// row of names may carry units: `time [ms], x [mm], y [mm], z [mm]`.
    pub file: PathBuf,
}
