use super::{Instrument, InstrumentError, Mount, Path, Shaft, ToolPose, ToolUse, check_friction, check_length};
use crate::body::SimulatedBody;
use crate::contact::Capsule;
use crate::curve::Curve;
use crate::math::{Scalar, Vec3};
use crate::mesh::VolumeMesh;

/// A hot tip that removes the tetrahedra that it touches, all along its way from step to step.
///
/// Its power is shared by the cells that it touches, by their volume. A cell goes when it has taken in `heat` for each cubic metre, so
/// that tissue that is brushed past stays, and the cut does not grow with the size of the cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Cautery {
    /// Where the tip is.
    pub path: Path,
    /// How it is led along the path.
    pub mount: Mount,
    /// The tip burns this far around [m, > 0]; 5 mm by default.
    pub radius: f64,
    /// When the current is switched on and off [s]; never by default: for a hand that pulls the trigger.
    pub on: (f64, f64),
    /// Power at full trigger [W, > 0]; without bound by default: what is touched goes at once.
    pub power: f64,
    /// Energy that removes tissue [J/m³, > 0]; by default 2.4e9, what it takes to heat 1060 kg/m³ from 37 °C to 100 °C
    /// (3.6 kJ/kg K) and to boil it away (2.26 MJ/kg of water, nine tenths of it).
    pub heat: f64,
    /// The rod whose end the tip is, where it may touch tissue; thinner than `radius`, or it cannot come near enough to burn.
    pub shaft: Option<Shaft>,
    /// Coefficient of friction of the rod [≥ 0]; 0.1 by default.
    pub friction: f64,
}

impl Default for Cautery {
    fn default() -> Self {
        Self {
            path: Curve::constant(Vec3::ZERO),
            mount: Mount::default(),
            radius: 5e-3,
            on: (f64::INFINITY, f64::INFINITY),
            power: f64::INFINITY,
            heat: 2.4e9,
            shaft: None,
            friction: 0.1,
        }
    }
}

impl<T: Scalar> Instrument<T> for Cautery {
    fn kind(&self) -> &'static str {
        "cautery"
    }

    fn path(&self) -> &Path {
        &self.path
    }

    fn mount(&self) -> &Mount {
        &self.mount
    }

    fn reach(&self) -> f64 {
        self.radius
    }

    fn check(&self) -> Result<(), InstrumentError> {
        let out_of_range =
            |name, value, range| Err(InstrumentError::OutOfRange { kind: "cautery", name, value, range });
        check_length("cautery", "radius", self.radius)?;
        let (on, off) = self.on;
        if on.is_nan() || off.is_nan() || (off <= on && on.is_finite()) {
            return out_of_range("off", off, "later than `on` [s]");
        }
        if self.power.is_nan() || self.power <= 0.0 {
            return out_of_range("power", self.power, "positive [W]");
        }
        if !(self.heat.is_finite() && self.heat > 0.0) {
            return out_of_range("heat", self.heat, "positive [J/m³]");
        }
        self.mount.check("cautery")?;
        if let Some(shaft) = self.shaft {
            shaft.check("cautery")?;
            if shaft.radius >= self.radius {
                return out_of_range("shaft radius", shaft.radius, "below the radius that burns [m]");
            }
        }
        check_friction("cautery", self.friction)
    }

    fn add_parts(&self, pose: &ToolPose, _trigger: f64, parts: &mut Vec<Capsule>) {
        parts.extend(self.shaft.map(|shaft| shaft.capsule(pose, 0.0)));
    }

    fn friction(&self) -> f64 {
        self.friction
    }

    fn cuts(&self) -> bool {
        true
    }

    fn cut(&self, tool: &ToolUse, body: &mut SimulatedBody<T>, cells: &mut Vec<u32>) {
        let Some((burn, energy)) = self.burn(tool) else { return };
        let VolumeMesh::Tet(mesh) = &body.mesh else { return };
        for (cell, corners) in mesh.cells.iter().enumerate() {
            if !body.state.removed[cell] {
                let corners = corners.map(|node| body.state.positions[node as usize].cast());
                if burn.may_touch(&corners) && burn.touches(&corners) {
                    cells.push(cell as u32);
                }
            }
        }
        body.heat_up(cells, energy, self.heat);
    }

    fn is_active(&self, time: f64) -> bool {
        self.on.0 <= time && time < self.on.1
    }
}

impl Cautery {
    /// What the tip sweeps under current, and the energy that it gives off meanwhile [J].
    fn burn(&self, tool: &ToolUse) -> Option<(Capsule, f64)> {
        let span = tool.span;
        if tool.is_led {
            let burn = Capsule { from: tool.from.tip, to: tool.to.tip, radius: self.radius };
            let energy = self.power * tool.trigger * (span.to - span.from);
            return (tool.trigger > 0.0).then_some((burn, energy));
        }
        let (from, to) = (span.from.max(self.on.0), span.to.min(self.on.1));
        let burn = || Capsule { from: self.path.at(from), to: self.path.at(to), radius: self.radius };
        (from < to).then(|| (burn(), self.power * (to - from)))
    }
}
