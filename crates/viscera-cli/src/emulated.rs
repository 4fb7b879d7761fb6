//! The hand of whoever has no haptic device.

use std::f64::consts::TAU;

use viscera::curve::Curve;
use viscera::instrument::ToolPose;
use viscera::math::Vec3;
use viscera_haptics::{EmulatedDevice, Hand, Rating, Workspace};
use viscera_session::message::InstrumentFrame;

use crate::units::length;

/// The hand trembles by this much [m], at this frequency [1/s], as hands do.
const TREMOR: (f64, f64) = (0.3e-3, 9.0);
/// How far a hand presses where nobody says [m]: the tools of the scene `liver` wait 75 mm from its tissue.
const DEPTH: f64 = 0.09;
/// Time in which it presses and comes back [s].
const PRESS: f64 = 3.0;

/// A hand without hardware, as it is typed: `emulated`, or with how far it presses, as `emulated:80mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Emulated {
    depth: Option<f64>,
}

impl Emulated {
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "emulated" => Ok(Self { depth: None }),
            Some(("emulated", depth)) => Ok(Self { depth: Some(length(depth)?) }),
            _ => Err("the devices that are built in are `emulated` and, with how far it presses, `emulated:90mm`; \
                      a driver is linked by the trait `viscera_haptics::Device`"
                .into()),
        }
    }

    /// A device in a hand that takes over a tool as it is: along its path in the scene where it has one and no depth is given,
    /// otherwise to and fro along its direction. Gives it with its workspace, and what it does in words.
    pub(crate) fn device(
        self,
        tool: &InstrumentFrame,
        path: Option<(Curve<Vec3<f64>>, f64)>,
    ) -> (EmulatedDevice, Workspace, String) {
        let pose = ToolPose { tip: tool.tip.into(), direction: tool.direction.into(), roll: tool.roll };
        let workspace = Workspace::of_tool(&pose);
        match (self.depth, path.filter(|(path, _)| path.points().len() > 1)) {
            (None, Some((path, duration))) => {
                let rotation = workspace.rotation;
                let origin = path.at(0.0);
                let way = move |time: f64| {
                    rotation.transpose_mul(path.at(to_and_fro(time, duration)) - origin) + tremor(time)
                };
                (closed(way), workspace, "goes along its path and back".into())
            }
            (depth, _) => {
                let depth = depth.unwrap_or(DEPTH);
                let way = move |time: f64| {
                    Vec3::new(0.0, 0.0, 0.5 * depth * (1.0 - (TAU * time / PRESS).cos())) + tremor(time)
                };
                let device = EmulatedDevice::new(Rating::TOUCH, Hand::on_rails(way));
                (device, workspace, format!("presses by {:.0} mm and comes back", 1e3 * depth))
            }
        }
    }
}

/// A device that goes along `way` [m] with its trigger pressed.
pub(crate) fn closed(way: impl Fn(f64) -> Vec3<f64> + Send + 'static) -> EmulatedDevice {
    EmulatedDevice::new(Rating::TOUCH, Hand::on_rails(way)).trigger(1.0)
}

/// The time of a path that goes to its end after `duration` and back in as much [s].
pub(crate) fn to_and_fro(time: f64, duration: f64) -> f64 {
    let phase = time % (2.0 * duration);
    phase.min(2.0 * duration - phase)
}

pub(crate) fn tremor(time: f64) -> Vec3<f64> {
    let (amplitude, frequency) = TREMOR;
    let angle = TAU * frequency * time;
    Vec3::new(angle.sin(), (1.3 * angle).sin(), (0.7 * angle).sin()) * amplitude
}

#[cfg(test)]
mod tests {
    use viscera_haptics::Device;
    use viscera_session::message::F32s;

    use super::*;

    fn tool() -> InstrumentFrame {
        InstrumentFrame {
            instrument: 0,
            tip: [0.1, 0.2, 0.3],
            direction: [0.6, -0.8, 0.0],
            roll: 0.5,
            trigger: 0.0,
            active: false,
            holds: false,
            force: [0.0; 3],
            torque: [0.0; 3],
            parts: F32s(Vec::new()),
            trocar: None,
            stamp: None,
        }
    }

    /// Where the hand has the tool in the scene [m].
    fn place(device: &mut EmulatedDevice, workspace: &Workspace, time: f64) -> Vec3<f64> {
        workspace.to_scene(device.read(time).expect("it answers").position)
    }

    #[test]
    fn a_hand_presses_along_the_tool_as_deep_as_it_is_told() {
        let emulated = Emulated::parse("emulated:40 mm").expect("a depth");
        let constant = Curve::constant(Vec3::from(tool().tip));
        let (mut device, workspace, words) = emulated.device(&tool(), Some((constant, 2.0)));
        let deepest = place(&mut device, &workspace, 0.5 * PRESS);
        let expected = Vec3::from(tool().tip) + Vec3::from(tool().direction) * 0.04;
        // But for the tremor.
        assert!((deepest - expected).norm() < 0.6e-3, "{deepest:?}, not {expected:?}");
        assert_eq!(words, "presses by 40 mm and comes back");
    }

    #[test]
    fn a_hand_goes_along_the_path_of_the_scene_and_back() {
        let [from, to] = [tool().tip, [0.15, 0.2, 0.25]].map(Vec3::from);
        let path = Curve::piecewise_linear(vec![(0.0, from), (2.0, to)]).expect("a path");
        let emulated = Emulated::parse("emulated").expect("a device");
        let (mut device, workspace, _) = emulated.device(&tool(), Some((path, 2.0)));
        for (time, expected) in [(1.0, (from + to) * 0.5), (2.0, to), (3.0, (from + to) * 0.5), (4.0, from)] {
            let there = place(&mut device, &workspace, time);
            assert!((there - expected).norm() < 0.6e-3, "{there:?} at {time} s, not {expected:?}");
        }
    }

    #[test]
    fn devices_that_are_not_built_in_are_refused_with_those_that_are() {
        for text in ["touch", "emulated:", "emulated:-3mm", "touch:3mm"] {
            assert!(Emulated::parse(text).is_err(), "{text}");
        }
        assert!(Emulated::parse("touch").expect_err("unknown").contains("`emulated`"));
    }
}
