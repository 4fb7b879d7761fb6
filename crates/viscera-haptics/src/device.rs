use std::borrow::Cow;

use crate::setting::{not_negative, positive, positive_and_finite};
use crate::{Matrix, SettingError, Vector};

/// A haptic device, as its driver presents it: where the handle is, and a force on it.
///
/// **Units and frame.** Metres, newtons, seconds. The frame is the device's own, right-handed and at rest, with its origin wherever
/// the driver has it; [`Workspace`](crate::Workspace) puts it into a scene. A force is the one that the device exerts on the hand.
///
/// **Order of calls.** [`rating`](Device::rating) once, before everything. Then, a thousand times a second, [`read`](Device::read)
/// and [`command`](Device::command), in this order, each once. At the end [`release`](Device::release), once: after a stop, a
/// device that was lost, or a panic in the channel.
///
/// **Threads.** All calls come from one thread, the channel's, to which the device is moved (`Send`). Neither `read` nor `command`
/// may wait, allocate, log or take a lock that somebody else may hold: together they have a small part of a millisecond. A driver whose
/// library has a thread of its own exchanges with it by a [`mailbox`](crate::mailbox). Of `release` nothing is asked but that it
/// comes to an end.
///
/// **Errors.** [`DeviceError::Transient`] says that this once there was no answer: the channel goes on with the last reading, and
/// ends when too many follow each other. [`DeviceError::Lost`] ends it at once.
///
/// A driver for a library with calls in C, in full but for that library:
///
/// ```
/// use viscera_haptics::{Device, DeviceError, Matrix, Rating, Reading, Vector};
/// # mod library {
/// #     pub struct Handle;
/// #     pub fn position_in_millimetres(_: &Handle) -> Option<[f64; 3]> { Some([1.0, 2.0, 3.0]) }
/// #     pub fn axes(_: &Handle) -> [[f64; 3]; 3] { [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
/// #     pub fn is_button_down(_: &Handle) -> bool { false }
/// #     pub fn set_force(_: &mut Handle, _: [f64; 3]) -> bool { true }
/// # }
///
/// struct Stylus {
///     handle: library::Handle,
/// }
///
/// impl Device for Stylus {
///     fn rating(&self) -> Rating {
///         Rating::TOUCH
///     }
///
///     fn read(&mut self, _now: f64) -> Result<Reading, DeviceError> {
///         let Some(position) = library::position_in_millimetres(&self.handle) else {
///             return Err(DeviceError::Transient { what: "no position in this frame".into() });
///         };
///         let [x, y, z] = library::axes(&self.handle).map(Vector::from);
///         Ok(Reading {
///             position: Vector::from(position) * 1e-3,
///             orientation: Matrix::from_columns(x, y, z),
///             velocity: None, // the channel finds it from the positions
///             trigger: if library::is_button_down(&self.handle) { 1.0 } else { 0.0 },
///         })
///     }
///
///     fn command(&mut self, force: Vector) -> Result<(), DeviceError> {
///         match library::set_force(&mut self.handle, force.to_array()) {
///             true => Ok(()),
///             false => Err(DeviceError::Lost { what: "the library takes no force: is the cable in?".into() }),
///         }
///     }
///
///     fn release(&mut self) {
///         library::set_force(&mut self.handle, [0.0; 3]);
///     }
/// }
///
/// let mut stylus = Stylus { handle: library::Handle };
/// assert_eq!(stylus.read(0.0)?.position, Vector::new(0.001, 0.002, 0.003)); // m
/// # Ok::<(), DeviceError>(())
/// ```
pub trait Device: Send {
    /// What the device bears.
    fn rating(&self) -> Rating;

    /// Where its handle is. `now` is the time of the channel [s], for devices that have none of their own, as emulated ones.
    ///
    /// # Errors
    /// [`DeviceError`].
    fn read(&mut self, now: f64) -> Result<Reading, DeviceError>;

    /// The force on the hand [N] from now to the next call; never above [`Rating::peak_force`], always finite.
    ///
    /// # Errors
    /// [`DeviceError`].
    fn command(&mut self, force: Vector) -> Result<(), DeviceError>;

    /// No force any more, whatever state the device is in.
    fn release(&mut self);
}

/// A device whose kind is known only when the program runs.
impl<D: Device + ?Sized> Device for Box<D> {
    fn rating(&self) -> Rating {
        (**self).rating()
    }

    fn read(&mut self, now: f64) -> Result<Reading, DeviceError> {
        (**self).read(now)
    }

    fn command(&mut self, force: Vector) -> Result<(), DeviceError> {
        (**self).command(force)
    }

    fn release(&mut self) {
        (**self).release();
    }
}

/// Where the handle of a device is, in the device's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Of the point on which the force acts [m].
    pub position: Vector,
    /// Axes of the handle as columns, a rotation. The third points from the handle to its tip.
    pub orientation: Matrix,
    /// Of that point [m/s], where the device measures it; found from the positions otherwise.
    pub velocity: Option<Vector>,
    /// Trigger, button or grip: 0 is open, 1 is closed.
    pub trigger: f64,
}

impl Default for Reading {
    /// At rest in the origin, turned by nothing, open.
    fn default() -> Self {
        Self { position: Vector::ZERO, orientation: Matrix::IDENTITY, velocity: None, trigger: 0.0 }
    }
}

impl Reading {
    pub(crate) fn is_finite(&self) -> bool {
        self.position.is_finite()
            && self.orientation.is_finite()
            && self.velocity.is_none_or(Vector::is_finite)
            && self.trigger.is_finite()
    }
}

/// What a device bears, from its data sheet. Infinite where the maker states nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rating {
    /// The largest force that it may be asked for [N, > 0].
    pub peak_force: f64,
    /// The force that it bears for ever [N, > 0]. Above it, its motors grow hot.
    pub continuous_force: f64,
    /// Time in which its motors grow hot [s, > 0]: that of the mean of the squared force which must not pass the square of the
    /// continuous one.
    pub thermal_time: f64,
    /// Power that it may give to the hand [W, > 0].
    pub power: f64,
    /// The stiffest spring that it can play [N/m, > 0]; stiffer ones make it tremble.
    pub stiffness: f64,
    /// The smallest distance that it tells from none [m, ≥ 0].
    pub resolution: f64,
    /// Width of its workspace [m, > 0].
    pub workspace: f64,
    /// What its handle seems to weigh, for its inertia [kg, > 0].
    pub mass: f64,
}

impl Rating {
    /// The stylus of 3D Systems known as Touch (before that Geomagic Touch, Phantom Omni): 3.3 N at its nominal position, 0.88 N for
    /// ever, 1.02 N/mm in its softest direction, 0.055 mm, 160 mm wide, 45 g at its tip. Its maker states no time for its motors; ten
    /// seconds are assumed. Source: its data sheet.
    pub const TOUCH: Self = Self {
        peak_force: 3.3,
        continuous_force: 0.88,
        thermal_time: 10.0,
        power: f64::INFINITY,
        stiffness: 1020.0,
        resolution: 0.055e-3,
        workspace: 0.16,
        mass: 0.045,
    };

    /// Checks the numbers.
    ///
    /// # Errors
    /// [`SettingError::OutOfRange`] naming the first that makes no sense.
    pub fn check(&self) -> Result<(), SettingError> {
        positive_and_finite("rating.peak_force", self.peak_force)?;
        positive("rating.continuous_force", self.continuous_force)?;
        positive("rating.thermal_time", self.thermal_time)?;
        positive("rating.power", self.power)?;
        positive("rating.stiffness", self.stiffness)?;
        not_negative("rating.resolution", self.resolution)?;
        positive_and_finite("rating.workspace", self.workspace)?;
        positive_and_finite("rating.mass", self.mass)
    }
}

/// Why a device does not answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeviceError {
    /// This once there was no answer: a frame on the bus was lost, a reading made no sense. The next one may be good.
    #[error("the device gave no answer: {what}")]
    Transient {
        /// What was missing.
        what: Cow<'static, str>,
    },
    /// The device is gone: unplugged, switched off, or its emergency stop was pressed. Mend that and start the channel again.
    #[error("the device is lost: {what}")]
    Lost {
        /// What happened.
        what: Cow<'static, str>,
    },
}
