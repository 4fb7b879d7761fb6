use crate::statistics::Recorder;
use crate::{Channel, Clock, Device, DeviceError, Pose, Sample, Statistics};

/// Seconds from one telling of the figures to the next.
const TELL: f64 = 0.25;

/// Where samples come from.
pub trait Source {
    /// A sample, if there is a new one. `pose` is where the tool is in this period: a source that steps its tissue right here
    /// uses it, which is what [`Extrapolation::Direct`](crate::Extrapolation::Direct) is for; any other must not wait.
    fn sample(&mut self, pose: &Pose) -> Option<Sample>;
}

impl<F: FnMut(&Pose) -> Option<Sample>> Source for F {
    fn sample(&mut self, pose: &Pose) -> Option<Sample> {
        self(pose)
    }
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// It was asked to.
    Stopped,
    /// The device was lost, or gave no answer too often in a row.
    Device(DeviceError),
    /// The thread panicked, in the device or in the source: its message stands in the log of the program.
    Panicked,
}

/// A run: what takes part, and who is told.
pub struct Run<'a> {
    /// The device. It is released at the end, however that comes.
    pub device: &'a mut dyn Device,
    /// The channel.
    pub channel: &'a mut Channel,
    /// The tissue.
    pub source: &'a mut dyn Source,
    /// The time.
    pub clock: &'a mut dyn Clock,
    /// Whether to stop; asked in every period.
    pub stop: &'a dyn Fn() -> bool,
    /// Is told the figures four times a second. Must not wait.
    pub tell: &'a mut dyn FnMut(&Statistics),
}

/// Takes the force from a device when it goes, also in a panic.
struct Released<'a>(&'a mut dyn Device);

impl Drop for Released<'_> {
    fn drop(&mut self) {
        self.0.release();
    }
}

/// Runs the channel, a period after the other, until it is stopped or the device is lost. Periods that could not begin before the
/// next one was due are left out and counted: they are not made up for, as two forces at once are worth no more than one.
pub fn run(run: Run<'_>) -> (End, Statistics) {
    let Run { device, channel, source, clock, stop, tell } = run;
    let device = Released(device);
    let (period, patience) = (channel.settings().period, channel.settings().faults);
    let mut recorder = Recorder::new(period);
    let begin = clock.now();
    let (mut number, mut told, mut failures, mut reading) = (0_u64, begin, 0, None);
    let end = loop {
        if stop() {
            break End::Stopped;
        }
        let due = begin + number as f64 * period;
        clock.wait_until(due);
        let now = clock.now();
        recorder.begin(now, due);
        let read = device.0.read(now).and_then(|reading| match reading.is_finite() {
            true => Ok(reading),
            false => Err(DeviceError::Transient { what: "a reading of it is not a finite number".into() }),
        });
        let mut fault = read.map(|read| reading = Some(read)).err();
        if let Some(reading) = &reading {
            let pose = channel.pose(now, reading);
            let sample = source.sample(&pose);
            if let Some(sample) = &sample {
                recorder.sample(now - sample.time);
            }
            let force = channel.force(sample);
            fault = fault.or(device.0.command(force).err());
        }
        recorder.end(clock.now());
        failures = if fault.is_some() { failures + 1 } else { 0 };
        recorder.faults += u64::from(fault.is_some());
        match fault {
            Some(fault @ DeviceError::Lost { .. }) => break End::Device(fault),
            Some(fault) if failures > patience => break End::Device(fault),
            _ => {}
        }
        // How many periods are over already, but for rounding.
        let over = ((now - due) / period + 1e-9).floor().max(0.0) as u64;
        recorder.missed += over;
        number += 1 + over;
        if now - told >= TELL {
            told = now;
            tell(&figures(&recorder, channel));
        }
    };
    (end, figures(&recorder, channel))
}

fn figures(recorder: &Recorder, channel: &Channel) -> Statistics {
    let state = channel.state();
    recorder.statistics(channel.counts(), state.energy, state.warmth)
}
