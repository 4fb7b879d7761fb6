use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::CurveFile;
use crate::quantity::{Angle, EnergyDensity, Force, Length, Power, Time};

/// An instrument that follows a path.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(title = "instrument")]
pub enum InstrumentFile {
    /// A round rod that pushes tissue and slides along it.
    Probe {
        /// Way of the centre of its round tip [m].
        path: CurveFile<[Length; 3]>,
        /// Its shape; by default 5 mm across and 30 cm long.
        #[serde(default)]
        shaft: ShaftFile,
        /// Coefficient of friction on tissue; by default 0.1, wet tissue on steel.
        #[serde(default = "tenth")]
        #[schemars(extend("minimum" = 0))]
        friction: f64,
        /// Where it points, from handle to tip, of any length but zero; by default down, along −y.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<[f64; 3]>,
        /// A point that the shaft always passes through [m]: the direction follows from it and the tip.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        trocar: Option<[Length; 3]>,
    },
    /// Two jaws that hold what they close on.
    Grasper {
        /// Way of the tip [m].
        path: CurveFile<[Length; 3]>,
        /// How near the tip has to come to where a hand leads it before the jaws close [m]; by default 10 mm. Without jaws, the tip
        /// takes the nodes within it; jaws take what they sweep over when they close, and the cells that reach in between them.
        #[serde(default = "ten_millimetres")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
        /// When the jaws close [s]; without it only a hand closes them.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        close: Option<Time>,
        /// When they open again [s]; without it they stay closed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        open: Option<Time>,
        /// The most force with which they hold [N]: beyond it tissue slips through. Without it they hold whatever comes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        grip: Option<Force>,
        /// Jaws that touch tissue while they are open; without them the tip takes hold and touches nothing.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        jaws: Option<JawsFile>,
        /// A shaft that touches tissue; without it there is none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        shaft: Option<ShaftFile>,
        /// Coefficient of friction of jaws and shaft; by default 0.1, wet tissue on steel.
        #[serde(default = "tenth")]
        #[schemars(extend("minimum" = 0))]
        friction: f64,
        /// Where it points, from handle to tip, of any length but zero; by default down, along −y.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<[f64; 3]>,
        /// How far the jaws are turned about the direction [rad].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        roll: Option<Angle>,
        /// A point that the shaft always passes through [m]: the direction follows from it and the tip.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        trocar: Option<[Length; 3]>,
    },
    /// A hot tip that destroys the tissue that it touches.
    Cautery {
        /// Way of the tip [m].
        path: CurveFile<[Length; 3]>,
        /// Cells within it of the tip are heated, and removed when they have taken in enough [m]; by default 5 mm, the width of
        /// a hook electrode.
        #[serde(default = "five_millimetres")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
        /// When it is switched on [s]; without it only a hand switches it on.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        on: Option<Time>,
        /// When it is switched off [s]; without it, it stays on.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        off: Option<Time>,
        /// Power that the touched cells share [W]; without it they go at once.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        power: Option<Power>,
        /// Energy that removes tissue [J/m³]; by default 2.4e9, which heats it to 100 °C and boils it away.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        heat: Option<EnergyDensity>,
        /// A rod that touches tissue, its end the tip; thinner than `radius`, or it cannot come near enough to burn.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        shaft: Option<ShaftFile>,
        /// Coefficient of friction of the rod; by default 0.1, wet tissue on steel.
        #[serde(default = "tenth")]
        #[schemars(extend("minimum" = 0))]
        friction: f64,
        /// Where it points, from handle to tip, of any length but zero; by default down, along −y.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<[f64; 3]>,
        /// A point that the shaft always passes through [m]: the direction follows from it and the tip.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        trocar: Option<[Length; 3]>,
    },
}

/// A round rod.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "shaft")]
pub struct ShaftFile {
    /// Its radius [m]; by default 2.5 mm.
    #[serde(default = "half_of_five_millimetres")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: Length,
    /// Its length from the tip, or from the hinge of the jaws [m]; by default 30 cm.
    #[serde(default = "thirty_centimetres")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: Length,
}

impl Default for ShaftFile {
    fn default() -> Self {
        Self { radius: half_of_five_millimetres(), length: thirty_centimetres() }
    }
}

/// Two rods on a hinge; closed, they meet at the tip.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "jaws")]
pub struct JawsFile {
    /// From hinge to tip [m]; by default 20 mm.
    #[serde(default = "twenty_millimetres")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: Length,
    /// Radius of a jaw [m]; by default 1.5 mm.
    #[serde(default = "half_of_three_millimetres")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: Length,
    /// Angle between the open jaws [rad]; by default 60 degrees.
    #[serde(default = "sixty_degrees")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub opening: Angle,
}

fn tenth() -> f64 {
    0.1
}

fn ten_millimetres() -> Length {
    Length(0.010)
}

fn twenty_millimetres() -> Length {
    Length(0.020)
}

fn five_millimetres() -> Length {
    Length(0.005)
}

fn half_of_five_millimetres() -> Length {
    Length(0.0025)
}

fn half_of_three_millimetres() -> Length {
    Length(0.0015)
}

fn thirty_centimetres() -> Length {
    Length(0.3)
}

fn sixty_degrees() -> Angle {
    Angle(std::f64::consts::FRAC_PI_3)
}
