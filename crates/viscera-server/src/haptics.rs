//! A haptic device beside the session: it leads an instrument, and feels what that touches, a thousand times a second.
//!
//! The device lives in its channel's thread, the session in its own. Before a step the instrument is led to where the hand is, by the
//! session's ordinary commands; after it, the channel hears the force. Neither waits for the other.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use viscera_haptics::{
    ChannelSettings, Contact, Device, Extrapolation, Figures, HapticThread, Priority, Report, Sample, SimulationSide,
    StartError, Vector,
};
use viscera_session::Session;
use viscera_session::message::{InstrumentShape, Level, Notice, Refusal};

/// A haptic device, and what it is to lead.
///
/// The instrument stays where it is when the device takes it: that is where the device is then, however its workspace lies.
pub struct Haptics {
    /// The device.
    pub device: Box<dyn Device>,
    /// Number of the instrument.
    pub instrument: u32,
    /// How the channel works.
    pub settings: ChannelSettings,
    /// How the system treats the channel's thread.
    pub priority: Priority,
}

/// Why a device cannot lead an instrument.
#[derive(Debug, thiserror::Error)]
pub enum HapticsError {
    /// The scene has no instrument of this number.
    #[error("the scene has no instrument {instrument}; it has {known}")]
    NoInstrument {
        /// The number.
        instrument: u32,
        /// Those that there are.
        known: String,
    },
    /// The scene has no instrument, or none but cauteries, and nobody has named one of those.
    #[error("the scene has no instrument that a hand could feel: add a grasper or a probe")]
    NoInstruments,
    /// The tissue is stepped beside the channel, not within its periods.
    #[error("the extrapolation `direct` is for tissue that is stepped within the channel's period; take `linearised`")]
    Direct,
    /// A step of the scene is longer than the channel waits for a sample.
    #[error(
        "a step of the scene lasts {} ms, and after {} ms without a sample the force fades: shorten `step`",
        1e3 * step,
        1e3 * patience
    )]
    LongSteps {
        /// Its length [s].
        step: f64,
        /// How long the channel waits [s].
        patience: f64,
    },
    /// The channel does not start.
    #[error(transparent)]
    Start(#[from] StartError),
}

/// What the simulation did for a device.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTimes {
    /// Steps made.
    pub steps: u64,
    /// Steps that the engine refused.
    pub refused: u64,
    /// Time that steps took, and the longest of them [s].
    pub busy: f64,
    /// See `busy` [s].
    pub longest: f64,
    /// How far simulated time was behind the clock after the last one [s].
    pub behind: f64,
}

impl StepTimes {
    /// A step took so much time [s], and was made or refused.
    pub fn add(&mut self, took: f64, made: bool) {
        *if made { &mut self.steps } else { &mut self.refused } += 1;
        self.busy += took;
        self.longest = self.longest.max(took);
    }
}

/// How a device fared beside a session.
pub struct HapticsReport {
    /// The channel, and the device, released.
    pub channel: Report<Box<dyn Device>>,
    /// The steps of the simulation.
    pub steps: StepTimes,
}

/// The instrument of this number, or the first that a hand feels: a cautery burns its way.
///
/// # Errors
/// Where there is none.
pub fn instrument_for_a_hand(session: &Session, wanted: Option<u32>) -> Result<InstrumentShape, HapticsError> {
    let all = session.scene().instruments;
    let found = match wanted {
        Some(number) => all.iter().find(|shape| shape.instrument == number),
        None => all.iter().find(|shape| shape.kind != "cautery"),
    };
    found.cloned().ok_or_else(|| match wanted {
        Some(instrument) if !all.is_empty() => {
            let name = |shape: &InstrumentShape| format!("{} ({})", shape.instrument, shape.name);
            HapticsError::NoInstrument { instrument, known: all.iter().map(name).collect::<Vec<_>>().join(", ") }
        }
        _ => HapticsError::NoInstruments,
    })
}

impl Haptics {
    /// Refuses what cannot work with this session.
    pub(crate) fn check(&self, session: &Session) -> Result<(), HapticsError> {
        instrument_for_a_hand(session, Some(self.instrument))?;
        if self.settings.extrapolation == Extrapolation::Direct {
            return Err(HapticsError::Direct);
        }
        let (step, patience) = (session.scene().step, self.settings.watchdog.patience);
        if step > patience {
            return Err(HapticsError::LongSteps { step, patience });
        }
        Ok(())
    }

    /// Starts the channel. Gives its thread, and the simulation's part.
    pub(crate) fn start(self) -> Result<(Channel, Reins), StartError> {
        let Self { device, instrument, settings, priority } = self;
        let (thread, side) = HapticThread::start(device, settings, priority)?;
        let times = Arc::new(Mutex::new(StepTimes::default()));
        let channel = Channel { thread, times: Arc::clone(&times) };
        let reins =
            Reins { side, instrument, offset: Vector::ZERO, asked: None, comes: true, told: false, lost: false, times };
        Ok((channel, reins))
    }
}

/// The channel at work. Dropped, it releases the device.
pub(crate) struct Channel {
    thread: HapticThread<Box<dyn Device>>,
    times: Arc<Mutex<StepTimes>>,
}

impl Channel {
    pub(crate) fn figures(&self) -> Figures {
        self.thread.figures()
    }

    pub(crate) fn is_running(&self) -> bool {
        self.thread.is_running()
    }

    /// Ends it.
    pub(crate) fn stop(self) -> HapticsReport {
        let channel = self.thread.stop();
        HapticsReport { channel, steps: *self.times.lock().unwrap_or_else(PoisonError::into_inner) }
    }
}

/// What the thread of the simulation does for the device.
pub(crate) struct Reins {
    side: SimulationSide,
    instrument: u32,
    /// From where the device says it is to the tip [m].
    offset: Vector,
    /// Time of the pose that the next step answers, in the channel [s].
    asked: Option<f64>,
    /// Whether the instrument has not been led yet: it comes to the hand open, as closed jaws would take hold of what is there.
    comes: bool,
    /// Whether people were told that the device leads nothing.
    told: bool,
    lost: bool,
    times: Arc<Mutex<StepTimes>>,
}

impl Reins {
    /// Whether somebody holds the device.
    pub(crate) fn is_held(&self) -> bool {
        self.side.is_connected()
    }

    /// Before a step: by its end the instrument is where the hand is now. Gives what people should know.
    pub(crate) fn lead(&mut self, session: &mut Session) -> Option<Notice> {
        self.asked = None;
        if !self.is_held() {
            session.let_go();
            return (!std::mem::replace(&mut self.lost, true)).then(|| Notice {
                level: Level::Warning,
                text: "the haptic device is lost".into(),
                help: format!("instrument {} stays where it is, for the page to lead", self.instrument),
            });
        }
        let pose = self.side.pose()?;
        if session.in_hand() != Some(self.instrument) {
            match session.take_in_hand(self.instrument) {
                Ok(tool) => {
                    self.offset = Vector::from(tool.tip) - pose.position;
                    (self.comes, self.told) = (true, false);
                }
                Err(refusal) => return self.tell(*refusal),
            }
        }
        let tool = pose.tool_pose();
        let trigger = if self.comes { 0.0 } else { pose.trigger.clamp(0.0, 1.0) };
        let tip = (tool.tip + self.offset).to_array();
        match session.lead(tip, tool.direction.to_array(), tool.roll, trigger) {
            Ok(()) => {
                (self.asked, self.comes) = (Some(pose.time), false);
                None
            }
            Err(refusal) => {
                session.let_go();
                self.tell(*refusal)
            }
        }
    }

    /// After a step, or one that was refused, which took so long: the channel hears what the tissue says.
    pub(crate) fn answer(&mut self, session: &Session, took: Duration) {
        let made = !session.is_stopped();
        let Some(time) = self.asked.take() else { return };
        let mut times = self.times.lock().unwrap_or_else(PoisonError::into_inner);
        times.add(took.as_secs_f64(), made);
        times.behind = session.pace().lag;
        drop(times);
        let Some(tool) = session.instrument(self.instrument).filter(|_| made) else { return };
        let sample = Sample {
            time,
            position: Vector::from(tool.tip) - self.offset,
            force: tool.force.into(),
            stiffness: None,
            contact: if tool.holds { Contact::Holding } else { Contact::Pressing },
        };
        // What is no number is not sent, and the watchdog takes the force away.
        let _ = self.side.send(&sample);
    }

    fn tell(&mut self, refusal: Refusal) -> Option<Notice> {
        (!std::mem::replace(&mut self.told, true)).then(|| Notice {
            level: Level::Warning,
            text: format!("the haptic device leads nothing: {}", refusal.reason),
            help: refusal.help,
        })
    }
}
