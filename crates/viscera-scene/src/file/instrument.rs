use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::CurveFile;
use crate::quantity::{Length, Time};

/// An instrument that follows a path.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(title = "instrument")]
pub enum InstrumentFile {
    /// Two jaws that hold what they close on.
    Grasper {
        /// Way of the tip [m].
        path: CurveFile<[Length; 3]>,
        /// The jaws take the nodes within it of the tip [m]; by default 10 mm, the half length of a bowel grasper's jaws.
        #[serde(default = "ten_millimetres")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
        /// When the jaws close [s].
        #[schemars(extend("minimum" = 0))]
        close: Time,
        /// When they open again [s]; without it they stay closed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        open: Option<Time>,
    },
    /// A hot tip that destroys the tissue that it touches.
    Cautery {
        /// Way of the tip [m].
        path: CurveFile<[Length; 3]>,
        /// Cells within it of the tip are removed [m]; by default 5 mm, the width of a hook electrode.
        #[serde(default = "five_millimetres")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
        /// When it is switched on [s]; by default at the start.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        on: Option<Time>,
        /// When it is switched off [s]; without it, it stays on.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        off: Option<Time>,
    },
}

fn ten_millimetres() -> Length {
    Length(0.010)
}

fn five_millimetres() -> Length {
    Length(0.005)
}
