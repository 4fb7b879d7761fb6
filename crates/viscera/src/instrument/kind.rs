//! The only list of instruments.

use super::{Cautery, Grasper, Instrument, Jaws, Probe, Shaft};
use crate::math::Scalar;

/// A kind of instrument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum InstrumentKind {
    /// [`Probe`].
    Probe,
    /// [`Grasper`].
    Grasper,
    /// [`Cautery`].
    Cautery,
}

impl InstrumentKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Probe, Self::Grasper, Self::Cautery];

    /// Name in scenes and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Probe => "probe",
            Self::Grasper => "grasper",
            Self::Cautery => "cautery",
        }
    }

    /// One with all its parts, to be led by a hand: 5 mm across, in a world whose unit of length is `unit` metres.
    pub fn example<T: Scalar>(self, unit: f64) -> Box<dyn Instrument<T>> {
        let shaft = Shaft { radius: 2.5e-3 / unit, length: 0.3 / unit };
        match self {
            Self::Probe => Box::new(Probe { shaft, ..Probe::default() }),
            Self::Grasper => Box::new(Grasper {
                radius: 0.01 / unit,
                jaws: Some(Jaws { length: 0.02 / unit, radius: 1.5e-3 / unit, ..Jaws::default() }),
                shaft: Some(shaft),
                ..Grasper::default()
            }),
            Self::Cautery => Box::new(Cautery { radius: 5e-3 / unit, shaft: Some(shaft), ..Cautery::default() }),
        }
    }
}
