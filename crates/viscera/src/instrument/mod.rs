//! Tools that touch tissue along a path. Adding one: a file with [`Instrument`] for it.

mod capsule;
mod cautery;
mod grasper;

pub use capsule::Capsule;
pub use cautery::Cautery;
pub use grasper::Grasper;

use crate::body::{NodeMotion, SimulatedBody};
use crate::curve::Curve;
use crate::math::{Scalar, Vec3};

/// Where the tip of an instrument is [m], along time [s].
pub type Path = Curve<Vec3<f64>>;

/// A tool. It sees every body of the world.
pub trait Instrument<T: Scalar>: std::fmt::Debug + Send + Sync {
    /// What kind of tool it is.
    fn kind(&self) -> &'static str;
    /// Where its tip is.
    fn path(&self) -> &Path;
    /// How far from its tip it reaches [m].
    fn reach(&self) -> f64;
    /// Checks the settings.
    ///
    /// # Errors
    /// [`InstrumentError`] naming the setting.
    fn check(&self) -> Result<(), InstrumentError>;
    /// Takes hold of nodes, or lets go, at the beginning of a step.
    fn grip(&self, _number: u32, _span: &Span, _bodies: &mut [SimulatedBody<T>]) {}
    /// Lists cells of `body` that are to be removed after a step, in `cells`.
    fn cut(&self, _span: &Span, _body: &SimulatedBody<T>, _cells: &mut Vec<u32>) {}
    /// Whether it is at work at this time: jaws closed, current on.
    fn is_active(&self, time: f64) -> bool;
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
    /// Whether the moment lies in the span, its beginning included.
    pub fn contains(&self, moment: f64) -> bool {
        self.from <= moment && moment < self.to
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

fn check_radius(kind: &'static str, value: f64) -> Result<(), InstrumentError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(InstrumentError::OutOfRange { kind, name: "radius", value, range: "positive [m]" })
    }
}

/// The force with which instrument `number` holds a body [N]: the sum over the held nodes of F − R + γv, what the tissue
/// and the loads on these nodes need to be held, apart from the inertia of the nodes themselves.
pub(crate) fn holding_force<T: Scalar>(body: &SimulatedBody<T>, motion: NodeMotion) -> Vec3<f64> {
    let state = &body.state;
    let mut force = Vec3::ZERO;
    for node in (0..state.motions.len()).filter(|&node| state.motions[node] == motion) {
        let damping = state.velocities[node] * (body.damping * state.masses[node]);
        force += (state.internal_forces[node] - body.external_forces[node] + damping).cast::<f64>();
    }
    force
}
