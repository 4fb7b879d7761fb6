use super::{Instrument, InstrumentError, Mount, Path, Shaft, ToolPose, check_friction};
use crate::contact::Capsule;
use crate::curve::Curve;
use crate::math::{Scalar, Vec3};

/// A round rod that pushes tissue and slides along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Where the centre of its round tip is.
    pub path: Path,
    /// How it is led along the path.
    pub mount: Mount,
    /// Its shape.
    pub shaft: Shaft,
    /// Coefficient of friction [≥ 0]; 0.1 by default, wet tissue on steel.
    pub friction: f64,
}

impl Default for Probe {
    fn default() -> Self {
        let path = Curve::constant(Vec3::ZERO);
        Self { path, mount: Mount::default(), shaft: Shaft::default(), friction: 0.1 }
    }
}

impl<T: Scalar> Instrument<T> for Probe {
    fn kind(&self) -> &'static str {
        "probe"
    }

    fn path(&self) -> &Path {
        &self.path
    }

    fn mount(&self) -> &Mount {
        &self.mount
    }

    fn reach(&self) -> f64 {
        self.shaft.radius
    }

    fn check(&self) -> Result<(), InstrumentError> {
        self.mount.check("probe")?;
        self.shaft.check("probe")?;
        check_friction("probe", self.friction)
    }

    fn add_parts(&self, pose: &ToolPose, _trigger: f64, parts: &mut Vec<Capsule>) {
        parts.push(self.shaft.capsule(pose, 0.0));
    }

    fn friction(&self) -> f64 {
        self.friction
    }

    fn is_active(&self, _time: f64) -> bool {
        false
    }
}
