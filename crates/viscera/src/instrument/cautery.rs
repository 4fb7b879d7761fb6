use super::{Capsule, Instrument, InstrumentError, Path, Span, check_radius};
use crate::body::SimulatedBody;
use crate::math::Scalar;
use crate::mesh::VolumeMesh;

/// A hot tip that removes the tetrahedra that it touches, all along its way from step to step.
#[derive(Clone, Debug, PartialEq)]
pub struct Cautery {
    /// Where the tip is.
    pub path: Path,
    /// The tip burns this far around [m, > 0].
    pub radius: f64,
    /// When the current is switched on and off [s].
    pub on: (f64, f64),
}

impl<T: Scalar> Instrument<T> for Cautery {
    fn kind(&self) -> &'static str {
        "cautery"
    }

    fn path(&self) -> &Path {
        &self.path
    }

    fn reach(&self) -> f64 {
        self.radius
    }

    fn check(&self) -> Result<(), InstrumentError> {
        check_radius("cautery", self.radius)?;
        let (on, off) = self.on;
        if on < off {
            Ok(())
        } else {
            Err(InstrumentError::OutOfRange { kind: "cautery", name: "off", value: off, range: "later than `on` [s]" })
        }
    }

    fn cut(&self, span: &Span, body: &SimulatedBody<T>, cells: &mut Vec<u32>) {
        let (from, to) = (span.from.max(self.on.0), span.to.min(self.on.1));
        if from >= to {
            return;
        }
        let burn = Capsule { from: self.path.at(from), to: self.path.at(to), radius: self.radius };
        let VolumeMesh::Tet(mesh) = &body.mesh else { return };
        for (cell, corners) in mesh.cells.iter().enumerate() {
            if !body.state.removed[cell] {
                let corners = corners.map(|node| body.state.positions[node as usize].cast());
                if burn.may_touch(&corners) && burn.touches(&corners) {
                    cells.push(cell as u32);
                }
            }
        }
    }

    fn is_active(&self, time: f64) -> bool {
        self.on.0 <= time && time < self.on.1
    }
}
