use super::{Instrument, InstrumentError, Path, Span, check_radius};
use crate::body::{NodeMotion, SimulatedBody};
use crate::math::{Scalar, Vec3};

/// Jaws that take the nodes between them when they close and carry them along until they open.
#[derive(Clone, Debug, PartialEq)]
pub struct Grasper {
    /// Where the jaws are.
    pub path: Path,
    /// The jaws reach this far from the tip [m, > 0].
    pub radius: f64,
    /// When they close [s].
    pub close: f64,
    /// When they open [s], if they do; after `close`.
    pub open: Option<f64>,
}

impl<T: Scalar> Instrument<T> for Grasper {
    fn kind(&self) -> &'static str {
        "grasper"
    }

    fn path(&self) -> &Path {
        &self.path
    }

    fn reach(&self) -> f64 {
        self.radius
    }

    fn check(&self) -> Result<(), InstrumentError> {
        check_radius("grasper", self.radius)?;
        match self.open.filter(|&open| open.is_nan() || open <= self.close) {
            Some(value) => Err(InstrumentError::OutOfRange {
                kind: "grasper",
                name: "open",
                value,
                range: "later than `close` [s]",
            }),
            None => Ok(()),
        }
    }

    fn grip(&self, number: u32, span: &Span, bodies: &mut [SimulatedBody<T>]) {
        if span.contains(self.close) {
            let tip = self.path.at(span.from);
            bodies.iter_mut().for_each(|body| take_hold(body, number, tip, self.radius));
        }
        if self.open.is_some_and(|open| span.contains(open)) {
            bodies.iter_mut().for_each(|body| let_go(body, number));
        }
    }

    fn is_active(&self, time: f64) -> bool {
        self.close <= time && self.open.is_none_or(|open| time < open)
    }
}

fn take_hold<T: Scalar>(body: &mut SimulatedBody<T>, number: u32, tip: Vec3<f64>, radius: f64) {
    let state = &mut body.state;
    for node in 0..state.positions.len() {
        let from_tip = state.positions[node].cast::<f64>() - tip;
        if state.motions[node] == NodeMotion::Free && from_tip.squared_norm() <= radius * radius {
            state.motions[node] = NodeMotion::Held(number);
            state.grips[node] = from_tip.cast();
        }
    }
}

fn let_go<T: Scalar>(body: &mut SimulatedBody<T>, number: u32) {
    for motion in &mut body.state.motions {
        if *motion == NodeMotion::Held(number) {
            *motion = NodeMotion::Free;
        }
    }
}
