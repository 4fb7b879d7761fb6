//! Rigid tools that touch tissue, along a path or led by a hand. Adding one: a file with [`Instrument`] for it, and its line in
//! [`InstrumentKind`].

mod cautery;
mod grasper;
mod kind;
mod parts;
mod pose;
mod probe;
mod tool;

pub use crate::contact::Capsule;
pub use cautery::Cautery;
pub use grasper::Grasper;
pub use kind::InstrumentKind;
pub use parts::{Jaws, Shaft};
pub(crate) use pose::check_trocar;
pub use pose::{Mount, ToolInput, ToolPose};
pub use probe::Probe;
pub use tool::ToolState;

use crate::body::SimulatedBody;
use crate::curve::Curve;
use crate::math::{Scalar, Vec3};
use crate::mesh::Point;

/// Where the tip of an instrument is [m], along time [s].
pub type Path = Curve<Vec3<f64>>;

/// A tool. It sees every body of the world.
pub trait Instrument<T: Scalar>: std::fmt::Debug + Send + Sync {
    /// What kind of tool it is.
    fn kind(&self) -> &'static str;
    /// Where its tip is, unless a hand leads it.
    fn path(&self) -> &Path;
    /// How it is led along the path.
    fn mount(&self) -> &Mount;
    /// How far from its tip it reaches [m].
    fn reach(&self) -> f64;
    /// Checks the settings.
    ///
    /// # Errors
    /// [`InstrumentError`] naming the setting.
    fn check(&self) -> Result<(), InstrumentError>;
    /// Adds its rigid parts, which tissue does not pass, to `parts`: always as many.
    fn add_parts(&self, _pose: &ToolPose, _trigger: f64, _parts: &mut Vec<Capsule>) {}
    /// How many of the last parts are those that hold, and touch nothing else while they do.
    fn parts_that_hold(&self) -> usize {
        0
    }
    /// Coefficient of friction of its parts.
    fn friction(&self) -> f64 {
        0.0
    }
    /// The most force with which it holds [N].
    fn grip(&self) -> f64 {
        f64::INFINITY
    }
    /// Whether it takes hold of a node at this place when it closes.
    fn takes_hold_of(&self, _pose: &ToolPose, _place: Point) -> bool {
        false
    }
    /// Visits places between its jaws: it takes hold of the cells around them as well when it closes.
    fn each_place_between(&self, _pose: &ToolPose, _visit: &mut dyn FnMut(Point)) {}
    /// Whether it removes cells.
    fn cuts(&self) -> bool {
        false
    }
    /// Lists cells of `body` that are to be removed after a step, in `cells`.
    fn cut(&self, _tool: &ToolUse, _body: &mut SimulatedBody<T>, _cells: &mut Vec<u32>) {}
    /// Whether its script has it at work at this time: jaws closed, current on.
    fn is_active(&self, time: f64) -> bool;
    /// Whether its script has it at work right before this time.
    fn is_active_before(&self, time: f64) -> bool {
        self.is_active(time)
    }
}

impl<T: Scalar> Instrument<T> for Box<dyn Instrument<T>> {
    fn kind(&self) -> &'static str {
        self.as_ref().kind()
    }
    fn path(&self) -> &Path {
        self.as_ref().path()
    }
    fn mount(&self) -> &Mount {
        self.as_ref().mount()
    }
    fn reach(&self) -> f64 {
        self.as_ref().reach()
    }
    fn check(&self) -> Result<(), InstrumentError> {
        self.as_ref().check()
    }
    fn add_parts(&self, pose: &ToolPose, trigger: f64, parts: &mut Vec<Capsule>) {
        self.as_ref().add_parts(pose, trigger, parts);
    }
    fn parts_that_hold(&self) -> usize {
        self.as_ref().parts_that_hold()
    }
    fn friction(&self) -> f64 {
        self.as_ref().friction()
    }
    fn grip(&self) -> f64 {
        self.as_ref().grip()
    }
    fn takes_hold_of(&self, pose: &ToolPose, place: Point) -> bool {
        self.as_ref().takes_hold_of(pose, place)
    }
    fn each_place_between(&self, pose: &ToolPose, visit: &mut dyn FnMut(Point)) {
        self.as_ref().each_place_between(pose, visit);
    }
    fn cuts(&self) -> bool {
        self.as_ref().cuts()
    }
    fn cut(&self, tool: &ToolUse, body: &mut SimulatedBody<T>, cells: &mut Vec<u32>) {
        self.as_ref().cut(tool, body, cells);
    }
    fn is_active(&self, time: f64) -> bool {
        self.as_ref().is_active(time)
    }
    fn is_active_before(&self, time: f64) -> bool {
        self.as_ref().is_active_before(time)
    }
}

/// What a tool did in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolUse {
    /// When.
    pub span: Span,
    /// Where it was at the beginning.
    pub from: ToolPose,
    /// Where it is at the end.
    pub to: ToolPose,
    /// Its trigger at the end.
    pub trigger: f64,
    /// Whether a hand leads it.
    pub is_led: bool,
}

/// What an instrument does within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Time at the beginning [s].
    pub from: f64,
    /// Time at the end [s].
    pub to: f64,
}

impl Span {
    /// Time when a share of it, from 0 to 1, is over [s].
    pub(crate) fn at(&self, share: f64) -> f64 {
        self.from + (self.to - self.from) * share
    }
}

/// A setting of an instrument that makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InstrumentError {
    /// A setting is out of range.
    #[error("{kind}: {name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// Kind of tool.
        kind: &'static str,
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        range: &'static str,
    },
}

fn check_length(kind: &'static str, name: &'static str, value: f64) -> Result<(), InstrumentError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(InstrumentError::OutOfRange { kind, name, value, range: "positive [m]" })
    }
}

fn check_friction(kind: &'static str, value: f64) -> Result<(), InstrumentError> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(InstrumentError::OutOfRange { kind, name: "friction", value, range: "zero or positive" })
    }
}
