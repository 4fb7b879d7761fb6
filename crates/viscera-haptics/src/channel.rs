use crate::setting::{positive, positive_and_finite};
use crate::statistics::Counts;
use crate::{
    Extrapolation, Limiter, Limits, LocalModel, Passivity, PassivityController, Pose, Rating, Reading, Sample,
    SettingError, Vector, VelocityEstimate, Watchdog, WatchdogState, Workspace,
};

/// How a channel works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelSettings {
    /// Length of a period [s, > 0]; 1 ms.
    pub period: f64,
    /// How the force goes on after a sample; linearised.
    pub extrapolation: Extrapolation,
    /// How far it goes on, in distances from the last sample but one to the last [> 0]; 2, as a sample may be one interval old when
    /// it comes, and another one passes before the next.
    pub reach: f64,
    /// What becomes of the force of a silent simulation.
    pub watchdog: Watchdog,
    /// What the force stays within; by default the limits of the device.
    pub limits: Option<Limits>,
    /// What energy the hand may get; by default that for the device.
    pub passivity: PassivityChoice,
    /// Where the device is in the scene.
    pub workspace: Workspace,
    /// How many readings or commands may fail in a row before the device is given up; 20.
    pub faults: u32,
}

/// Whether the channel keeps count of energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PassivityChoice {
    /// As [`Passivity::of`] has it for the device.
    #[default]
    OfDevice,
    /// With these settings.
    With(Passivity),
    /// It counts, and adds no damping.
    Off,
}

impl Default for ChannelSettings {
    fn default() -> Self {
        Self {
            period: 1e-3,
            extrapolation: Extrapolation::default(),
            reach: 2.0,
            watchdog: Watchdog::default(),
            limits: None,
            passivity: PassivityChoice::OfDevice,
            workspace: Workspace::default(),
            faults: 20,
        }
    }
}

/// What a channel is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChannelState {
    /// Time of the last period [s].
    pub time: f64,
    /// Force on the hand [N], in the device's frame.
    pub force: Vector,
    /// What it would be without watchdog, limits and passivity [N].
    pub wanted: Vector,
    /// Velocity of the hand [m/s].
    pub velocity: Vector,
    /// Share of the force that the watchdog lets through.
    pub gain: f64,
    /// Energy that the hand has put in and not got back [J].
    pub energy: f64,
    /// Mean of the squared force over what the motors bear for ever.
    pub warmth: f64,
}

/// The channel between a hand and tissue, as a function: no clock, no thread.
///
/// A period is [`Channel::pose`] and then [`Channel::force`]: between them whoever simulates may use the pose for the sample.
#[derive(Clone, Debug)]
pub struct Channel {
    settings: ChannelSettings,
    velocity: VelocityEstimate,
    model: LocalModel,
    watchdog: WatchdogState,
    limiter: Limiter,
    passivity: PassivityController,
    damps: bool,
    counts: Counts,
    /// The period that has begun.
    reading: Reading,
    pose: Pose,
    /// Since the beginning of the period before [s].
    elapsed: f64,
    state: Option<ChannelState>,
}

impl Channel {
    /// A channel for a device of this rating.
    ///
    /// # Errors
    /// [`SettingError`] naming the setting, or the number of the rating, that makes no sense.
    pub fn new(settings: ChannelSettings, rating: Rating) -> Result<Self, SettingError> {
        rating.check()?;
        positive_and_finite("period", settings.period)?;
        positive("reach", settings.reach)?;
        settings.watchdog.check()?;
        settings.workspace.check()?;
        let limits = settings.limits.unwrap_or(Limits::of(&rating));
        limits.check()?;
        // Whatever was set, no device is asked for more than it bears.
        let limits = Limits { peak_force: limits.peak_force.min(rating.peak_force), ..limits };
        let of_device = Passivity::of(&rating, settings.period);
        let (passivity, damps) = match settings.passivity {
            PassivityChoice::OfDevice => (of_device, true),
            PassivityChoice::With(passivity) => (passivity, true),
            PassivityChoice::Off => (of_device, false),
        };
        passivity.check()?;
        let workspace = &settings.workspace;
        let stiffest = workspace.stiffness_in_scene(rating.stiffness);
        let resolution = rating.resolution * workspace.scale;
        let rest = Pose {
            time: 0.0,
            position: workspace.origin,
            orientation: workspace.rotation,
            velocity: Vector::ZERO,
            trigger: 0.0,
        };
        Ok(Self {
            velocity: VelocityEstimate::new(rating.resolution),
            model: LocalModel::new(settings.extrapolation, settings.reach, stiffest, resolution),
            watchdog: WatchdogState::new(settings.watchdog),
            limiter: Limiter::new(limits),
            passivity: PassivityController::new(passivity),
            damps,
            counts: Counts::default(),
            reading: Reading::default(),
            pose: rest,
            elapsed: settings.period,
            state: None,
            settings,
        })
    }

    /// The settings.
    pub fn settings(&self) -> &ChannelSettings {
        &self.settings
    }

    /// Begins a period at the time `now` [s] with what the device reads. Gives the pose of the tool in the scene.
    pub fn pose(&mut self, now: f64, reading: &Reading) -> Pose {
        let velocity = self.velocity.update(now, reading.position);
        let velocity = reading.velocity.unwrap_or(velocity);
        let workspace = &self.settings.workspace;
        self.elapsed = self.state.map_or(self.settings.period, |last| now - last.time).max(0.0);
        self.reading = Reading { velocity: Some(velocity), ..*reading };
        self.pose = Pose {
            time: now,
            position: workspace.to_scene(reading.position),
            orientation: workspace.rotation * reading.orientation,
            velocity: workspace.turn(velocity) * workspace.scale,
            trigger: reading.trigger,
        };
        self.pose
    }

    /// Ends the period with the sample that came in it, if one did. Gives the force on the hand [N], in the device's frame.
    pub fn force(&mut self, sample: Option<Sample>) -> Vector {
        let (now, elapsed, period) = (self.pose.time, self.elapsed, self.settings.period);
        let (position, velocity) = (self.reading.position, self.reading.velocity.unwrap_or(Vector::ZERO));
        // What the last force did.
        self.limiter.heat_for(elapsed);
        self.passivity.observe(position);
        // What the tissue says.
        let fresh = self.take(sample);
        let gain = self.watchdog.gain(now, fresh);
        let tissue = self.model.force(now, self.pose.position).unwrap_or(Vector::ZERO);
        let wanted = self.settings.workspace.to_hand(tissue);
        // What the hand may get.
        let limited = self.limiter.limit(wanted * gain, velocity, elapsed);
        let damped = self.passivity.control(limited, velocity, period);
        let force = self.limiter.within_force(if self.damps { damped } else { limited });
        self.limiter.gave(force);
        self.passivity.gave(force, position);
        self.counts.limited += u64::from(limited != wanted * gain);
        self.counts.damped += u64::from(self.damps && damped != limited);
        let silent = self.watchdog.is_late() || (self.settings.extrapolation == Extrapolation::Direct && !fresh);
        self.counts.silent += u64::from(silent);
        let (energy, warmth) = (self.passivity.energy(), self.limiter.warmth());
        self.state = Some(ChannelState { time: now, force, wanted, velocity, gain, energy, warmth });
        force
    }

    /// A whole period: [`Channel::pose`], then [`Channel::force`].
    pub fn tick(&mut self, now: f64, reading: &Reading, sample: Option<Sample>) -> Vector {
        self.pose(now, reading);
        self.force(sample)
    }

    /// Puts a sample into the local model; says whether there was one and it was good.
    fn take(&mut self, sample: Option<Sample>) -> bool {
        match sample.map(|sample| self.model.push(sample)) {
            None => false,
            Some(Ok(())) => {
                self.counts.samples += 1;
                true
            }
            Some(Err(_)) => {
                self.counts.refused += 1;
                false
            }
        }
    }

    /// What it did in the last period; nothing before the first.
    pub fn state(&self) -> ChannelState {
        self.state.unwrap_or_default()
    }

    /// What is known of the tissue.
    pub fn model(&self) -> &LocalModel {
        &self.model
    }

    pub(crate) fn counts(&self) -> Counts {
        self.counts
    }
}
