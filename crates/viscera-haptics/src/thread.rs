use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use thread_priority::ThreadPriority;

use crate::mailbox::{POSE_WORDS, Reader, SAMPLE_WORDS, Writer, mailbox};
use crate::{
    Channel, ChannelSettings, Device, End, Pose, Run, Sample, SampleError, SettingError, Source, Statistics, WallClock,
    run,
};

/// How the system treats the thread of the channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Priority {
    /// Before everything else, where the system allows it; as any other thread otherwise. On Linux it takes `CAP_SYS_NICE`, or
    /// a line `@audio - rtprio 50` or the like in `/etc/security/limits.conf`.
    #[default]
    RealTime,
    /// As any other thread.
    Ordinary,
}

/// Why a channel cannot start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// A setting makes no sense.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// The system gives no thread: there are too many, or no memory is left.
    #[error("there is no thread for the haptic channel: {0}; end other programs and start again")]
    Thread(#[from] std::io::Error),
}

/// A channel in a thread of its own. Dropped, it stops and releases the device.
#[derive(Debug)]
pub struct HapticThread<D> {
    stop: Arc<AtomicBool>,
    figures: Figures,
    thread: Option<JoinHandle<(D, End, Statistics, bool)>>,
}

/// The figures of a channel, for whoever likes to look at them while it runs.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    newest: Arc<Mutex<Option<Statistics>>>,
}

impl Figures {
    /// Those of a moment ago; none in the first quarter of a second.
    pub fn newest(&self) -> Option<Statistics> {
        // A thread that panicked while it held the lock has left whole figures: they are copied in one go.
        *self.newest.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// How a thread ended.
#[derive(Debug)]
pub struct Report<D> {
    /// Why.
    pub end: End,
    /// The figures; none after a panic.
    pub statistics: Option<Statistics>,
    /// Whether the system gave it real-time priority.
    pub real_time: bool,
    /// The device, released; none after a panic.
    pub device: Option<D>,
}

/// The simulation's end of a channel: poses out, samples in. Neither waits.
#[derive(Debug)]
pub struct SimulationSide {
    poses: Reader<Pose, POSE_WORDS>,
    samples: Writer<Sample, SAMPLE_WORDS>,
    pose: Option<Pose>,
}

impl SimulationSide {
    /// Where the tool is to be: the newest pose, again and again until there is a newer one. None before the first.
    pub fn pose(&mut self) -> Option<Pose> {
        if let Some(newer) = self.poses.take() {
            self.pose = Some(newer);
        }
        self.pose
    }

    /// Whether the channel still runs: it ends when it is stopped, and when its device is lost.
    pub fn is_connected(&self) -> bool {
        self.poses.is_connected()
    }

    /// Sends what the tissue said to such a pose; its time goes into the sample.
    ///
    /// # Errors
    /// [`SampleError::NotFinite`]; nothing is sent.
    pub fn send(&mut self, sample: &Sample) -> Result<(), SampleError> {
        sample.check()?;
        self.samples.write(sample);
        Ok(())
    }
}

/// The channel's end.
struct ChannelSide {
    poses: Writer<Pose, POSE_WORDS>,
    samples: Reader<Sample, SAMPLE_WORDS>,
}

impl Source for ChannelSide {
    fn sample(&mut self, pose: &Pose) -> Option<Sample> {
        self.poses.write(pose);
        self.samples.take()
    }
}

impl<D: Device + 'static> HapticThread<D> {
    /// Starts a channel for a simulation in another thread.
    ///
    /// # Errors
    /// [`StartError`]. The device is dropped, untouched.
    pub fn start(
        device: D,
        settings: ChannelSettings,
        priority: Priority,
    ) -> Result<(Self, SimulationSide), StartError> {
        let (pose_writer, pose_reader) = mailbox();
        let (sample_writer, sample_reader) = mailbox();
        let source = ChannelSide { poses: pose_writer, samples: sample_reader };
        let thread = Self::start_direct(device, settings, priority, source)?;
        Ok((thread, SimulationSide { poses: pose_reader, samples: sample_writer, pose: None }))
    }

    /// Starts a channel whose source works within its periods: tissue that is stepped at 1 kHz, a wall.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn start_direct(
        device: D,
        settings: ChannelSettings,
        priority: Priority,
        source: impl Source + Send + 'static,
    ) -> Result<Self, StartError> {
        let channel = Channel::new(settings, device.rating())?;
        let (stop, figures) = (Arc::new(AtomicBool::new(false)), Figures::default());
        let (stop_there, figures_there) = (Arc::clone(&stop), Arc::clone(&figures.newest));
        let thread = std::thread::Builder::new()
            .name("haptics".into())
            .spawn(move || carry_out(device, channel, source, priority, &stop_there, &figures_there))?;
        Ok(Self { stop, figures, thread: Some(thread) })
    }

    /// The figures of a moment ago; none in the first quarter of a second.
    pub fn statistics(&self) -> Option<Statistics> {
        self.figures.newest()
    }

    /// The same for somebody else to read.
    pub fn figures(&self) -> Figures {
        self.figures.clone()
    }

    /// Whether the channel still runs. It ends by itself when the device is lost.
    pub fn is_running(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// Stops the channel, which takes a period at most, and says how it went.
    pub fn stop(mut self) -> Report<D> {
        self.stop.store(true, Ordering::Relaxed);
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok((device, end, statistics, real_time))) => {
                Report { end, statistics: Some(statistics), real_time, device: Some(device) }
            }
            _ => Report { end: End::Panicked, statistics: None, real_time: false, device: None },
        }
    }
}

impl<D> Drop for HapticThread<D> {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic has been said by the thread itself, and its device is released.
            let _ = thread.join();
        }
    }
}

/// What the thread does.
fn carry_out<D: Device>(
    mut device: D,
    mut channel: Channel,
    mut source: impl Source,
    priority: Priority,
    stop: &AtomicBool,
    figures: &Mutex<Option<Statistics>>,
) -> (D, End, Statistics, bool) {
    let real_time = priority == Priority::RealTime && ask_for_real_time();
    let (end, statistics) = run(Run {
        device: &mut device,
        channel: &mut channel,
        source: &mut source,
        clock: &mut WallClock::start(),
        stop: &|| stop.load(Ordering::Relaxed),
        tell: &mut |statistics| {
            // Whoever reads has the lock for a copy: then these figures are left out, and nobody waits.
            if let Ok(mut figures) = figures.try_lock() {
                *figures = Some(*statistics);
            }
        },
    });
    (device, end, statistics, real_time)
}

/// Asks the system for real-time priority; says whether it gave it.
#[cfg(unix)]
fn ask_for_real_time() -> bool {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriorityValue, ThreadSchedulePolicy, set_thread_priority_and_policy,
        thread_native_id,
    };
    // In the middle: above ordinary threads, below what the system itself needs.
    let Ok(value) = ThreadPriorityValue::try_from(50_u8) else { return false };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Crossplatform(value), policy).is_ok()
}

/// Asks the system for its highest priority; says whether it gave it.
#[cfg(not(unix))]
fn ask_for_real_time() -> bool {
    thread_priority::set_current_thread_priority(ThreadPriority::Max).is_ok()
}
