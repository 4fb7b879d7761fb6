use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::quantity::Time;

/// Pictures and results.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
#[schemars(title = "output")]
pub struct OutputFile {
    /// Width and height of pictures in pixels, by default 1280 × 720.
    #[schemars(inner(range(min = 16, max = 16384)))]
    pub size: [u32; 2],
    /// Time from one picture to the next [s]; by default 40 ms, which is 25 a second.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub interval: Time,
    /// From where the pictures are taken.
    pub camera: CameraFile,
}

/// From where pictures are taken; distance and aim follow from what there is to see.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
#[schemars(title = "camera")]
pub struct CameraFile {
    /// Direction in which the camera looks; any length. By default from the front, a little from above and the right.
    pub look: [f64; 3],
    /// Direction that is upwards in the picture; by default y.
    pub up: [f64; 3],
}

impl Default for OutputFile {
    fn default() -> Self {
        Self { size: [1280, 720], interval: Time(0.04), camera: CameraFile::default() }
    }
}

impl Default for CameraFile {
    fn default() -> Self {
        Self { look: [-0.3, -0.4, -1.0], up: [0.0, 1.0, 0.0] }
    }
}
