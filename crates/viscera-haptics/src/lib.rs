//! A force channel of 1 kHz between a haptic device and tissue that is simulated more slowly: the pose of the device in, the
//! force on the hand out.
//!
//! A hand feels steps in force up to some hundred hertz and a stiff contact trembles below, so that a device wants a force every
//! millisecond. Tissue takes ten or thirty for a step. Between two steps the channel answers from what it knows locally: the last
//! force, its change with time, its change with place, or a stiffness ([`Extrapolation`]). Whatever comes out of that stays within
//! what the device bears ([`Limits`]), gives the hand no energy that the hand has not brought ([`Passivity`]), and fades away when
//! the simulation falls silent ([`Watchdog`]).
//!
//! * [`Channel`] is all of this as one function of time, reading and sample: no clock, no thread, the same bits every time.
//! * [`run`] calls it once a millisecond by a [`Clock`], in a thread of its own with [`HapticThread::start`].
//! * [`Device`] is what a driver provides. [`EmulatedDevice`] is one for tests and for whoever has none.
//! * [`Tool`] is the simulation's part: it leads an instrument of a world to the pose, and asks the tissue for the sample.
//!
//! The simulation and the channel share nothing but two [`mailbox`]es: neither ever waits for the other.
//!
//! ```
//! use viscera_haptics::{Channel, ChannelSettings, Contact, Rating, Reading, Sample, Vector};
//!
//! let mut channel = Channel::new(ChannelSettings::default(), Rating::TOUCH)?;
//! let tissue = |position: Vector| Sample {
//!     time: 0.0,
//!     position,
//!     force: position * -100.0, // N, from a spring of 100 N/m
//!     stiffness: None,
//!     contact: Contact::Holding,
//! };
//! let reading = Reading { position: Vector::new(0.01, 0.0, 0.0), ..Reading::default() };
//! for tick in 0..500 {
//!     let pose = channel.pose(tick as f64 * 1e-3, &reading);
//!     channel.tick(pose.time, &reading, Some(Sample { time: pose.time, ..tissue(pose.position) }));
//! }
//! assert!((channel.state().force.x + 1.0).abs() < 1e-12); // N
//! # Ok::<(), viscera_haptics::SettingError>(())
//! ```

mod channel;
mod clock;
mod device;
mod emulated;
mod extrapolation;
mod hand;
mod limits;
pub mod mailbox;
mod passivity;
mod run;
mod sample;
mod setting;
mod statistics;
mod thread;
mod tool;
mod velocity;
mod watchdog;
mod workspace;

pub use channel::{Channel, ChannelSettings, ChannelState, PassivityChoice};
pub use clock::{Clock, ManualClock, WallClock};
pub use device::{Device, DeviceError, Rating, Reading};
pub use emulated::{EmulatedDevice, Imperfections};
pub use extrapolation::{Extrapolation, LocalModel};
pub use hand::Hand;
pub use limits::{Limiter, Limits};
pub use passivity::{Passivity, PassivityController};
pub use run::{End, Run, Source, run};
pub use sample::{Contact, Pose, Sample, SampleError};
pub use setting::SettingError;
pub use statistics::{Recorder, Spread, Statistics};
pub use thread::{Figures, HapticThread, Priority, Report, SimulationSide, StartError};
pub use tool::{Tool, ToolError};
pub use velocity::VelocityEstimate;
pub use watchdog::{Watchdog, WatchdogState};
pub use workspace::Workspace;

/// Three components in double precision.
pub type Vector = viscera::math::Vec3<f64>;
/// Three by three of them.
pub type Matrix = viscera::math::Mat3<f64>;
