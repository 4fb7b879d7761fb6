//! The loop around the channel: by a manual clock, to the bit; and in its thread, for what a clock cannot break.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use viscera_haptics::{
    Channel, ChannelSettings, Contact, Device, DeviceError, EmulatedDevice, End, Hand, HapticThread, Imperfections,
    ManualClock, Pose, Priority, Rating, Reading, Run, Sample, Statistics, Vector, run,
};

fn spring(pose: &Pose) -> Sample {
    Sample {
        time: pose.time,
        position: pose.position,
        force: pose.position * -50.0,
        stiffness: None,
        contact: Contact::Holding,
    }
}

fn to_and_fro(time: f64) -> Vector {
    Vector::new(0.01 * (6.0 * time).sin(), 0.0, 0.002)
}

/// Runs so many periods; gives what the device was asked for besides.
fn run_for(
    device: &mut EmulatedDevice,
    settings: ChannelSettings,
    clock: &mut ManualClock,
    ticks: usize,
) -> (End, Statistics, Vec<Vector>) {
    let mut channel = Channel::new(settings, device.rating()).unwrap();
    let asked = AtomicUsize::new(0);
    let mut forces = Vec::new();
    let mut recorded = Recording { device, forces: &mut forces };
    let (end, statistics) = run(Run {
        device: &mut recorded,
        channel: &mut channel,
        source: &mut |pose: &Pose| Some(spring(pose)),
        clock,
        stop: &|| asked.fetch_add(1, Ordering::Relaxed) == ticks,
        tell: &mut |_| {},
    });
    (end, statistics, forces)
}

struct Recording<'a> {
    device: &'a mut EmulatedDevice,
    forces: &'a mut Vec<Vector>,
}

impl Device for Recording<'_> {
    fn rating(&self) -> Rating {
        self.device.rating()
    }
    fn read(&mut self, now: f64) -> Result<Reading, DeviceError> {
        self.device.read(now)
    }
    fn command(&mut self, force: Vector) -> Result<(), DeviceError> {
        self.forces.push(force);
        self.device.command(force)
    }
    fn release(&mut self) {
        self.device.release();
    }
}

#[test]
fn periods_that_are_over_are_left_out_and_counted_not_made_up_for() {
    let mut device = EmulatedDevice::new(Rating::TOUCH, Hand::on_rails(to_and_fro));
    // The tenth wait ends 0.5 ms late, the twentieth 3.4 ms.
    let late = (0..30).map(|wait| {
        if wait == 10 {
            0.5e-3
        } else if wait == 20 {
            3.4e-3
        } else {
            0.0
        }
    });
    let mut clock = ManualClock::late_by(late);
    let (end, statistics, _) = run_for(&mut device, ChannelSettings::default(), &mut clock, 1000);
    assert_eq!(end, End::Stopped);
    assert_eq!((statistics.ticks, statistics.missed), (1000, 3));
    // 1.5 ms, 4.4 ms: two of 999 were no longer than 1.2 ms, and what came after them was short.
    assert!((statistics.punctual - 997.0 / 999.0).abs() < 1e-12, "{}", statistics.punctual);
    assert!((statistics.period.longest - 4.4e-3).abs() < 5e-6, "{}", statistics.period);
    assert!((statistics.duration - 1.002).abs() < 1e-9, "due times do not slip: {}", statistics.duration);
}

/// Noise, latency and lost readings, but the same seed.
#[test]
fn a_run_has_the_same_bits_every_time() {
    let imperfections =
        Imperfections { latency: 2.3e-3, noise: 20e-6, resolution: 55e-6, lost: 0.05, unplugged: None, seed: 7 };
    let go = |seed: u64| {
        let hand = Hand::yielding(0.045, 100.0, 1.0, to_and_fro);
        let imperfections = Imperfections { seed, ..imperfections };
        let mut device = EmulatedDevice::imperfect(Rating::TOUCH, hand, imperfections);
        let (end, statistics, forces) =
            run_for(&mut device, ChannelSettings::default(), &mut ManualClock::default(), 2000);
        assert_eq!(end, End::Stopped);
        (statistics, forces)
    };
    let (one, other) = (go(7), go(7));
    assert_eq!(one, other);
    // 5 % of 2000, give or take five standard deviations of 9.7.
    assert!((50..=150).contains(&one.0.faults), "{}", one.0.faults);
    assert_ne!(one.1, go(8).1, "another seed, another run");
}

#[test]
fn a_device_that_is_unplugged_ends_the_run_and_is_released() {
    let imperfections = Imperfections { unplugged: Some(0.25), ..Imperfections::default() };
    let mut device = EmulatedDevice::imperfect(Rating::TOUCH, Hand::on_rails(to_and_fro), imperfections);
    let (end, statistics, _) = run_for(&mut device, ChannelSettings::default(), &mut ManualClock::default(), 1000);
    assert_eq!(end, End::Device(DeviceError::Lost { what: "its cable was pulled out".into() }));
    assert!(device.is_released() && device.felt() == Vector::ZERO);
    assert_eq!(statistics.ticks, 251);
}

#[test]
fn a_device_that_stays_silent_is_given_up_after_its_patience() {
    let imperfections = Imperfections { lost: 1.0, ..Imperfections::default() };
    let mut device = EmulatedDevice::imperfect(Rating::TOUCH, Hand::on_rails(to_and_fro), imperfections);
    let settings = ChannelSettings { faults: 20, ..ChannelSettings::default() };
    let (end, statistics, forces) = run_for(&mut device, settings, &mut ManualClock::default(), 1000);
    assert!(matches!(end, End::Device(DeviceError::Transient { .. })), "{end:?}");
    assert_eq!(statistics.ticks, 21);
    assert!(forces.is_empty() && device.is_released());
}

/// A latency of 20 ms there and 20 ms back: the hand feels the force of where it was 40 ms ago.
#[test]
fn latency_delays_readings_and_forces_alike() {
    let imperfections = Imperfections { latency: 0.02, ..Imperfections::default() };
    let ramp = |time: f64| Vector::new(0.02 * time, 0.0, 0.0);
    let mut device = EmulatedDevice::imperfect(Rating::TOUCH, Hand::on_rails(ramp), imperfections);
    for tick in 0..=800 {
        let time = f64::from(tick) * 1e-3;
        let seen = device.read(time).unwrap().position;
        device.command(seen * -50.0).unwrap();
        let (saw, felt) = ((time - 0.02).max(0.0), (time - 0.04).max(0.0));
        assert!((seen - ramp(saw)).norm() < 1e-12, "{seen:?} at {time} s");
        // Forces are steps of a millisecond.
        assert!(
            (device.felt().x + 50.0 * 0.02 * felt).abs() <= 50.0 * 0.02 * 1e-3 + 1e-12,
            "{:?} at {time} s",
            device.felt()
        );
    }
}

#[test]
fn a_thread_exchanges_poses_and_samples_and_releases_the_device() {
    let device = EmulatedDevice::new(Rating::TOUCH, Hand::on_rails(|_| Vector::new(0.01, 0.0, 0.0)));
    let (thread, mut simulation) = HapticThread::start(device, ChannelSettings::default(), Priority::Ordinary).unwrap();
    // However slow the machine: until 300 poses have been answered.
    let (mut answered, mut last) = (0, -1.0);
    while answered < 300 {
        match simulation.pose() {
            Some(pose) if pose.time > last => {
                last = pose.time;
                answered += 1;
                simulation.send(&spring(&pose)).unwrap();
            }
            _ => std::thread::yield_now(),
        }
    }
    assert!(thread.is_running() && simulation.is_connected());
    let report = thread.stop();
    assert!(!simulation.is_connected(), "the simulation sees that the channel is over");
    let statistics = report.statistics.unwrap();
    assert_eq!(report.end, End::Stopped);
    assert!(statistics.ticks >= 300 && statistics.samples > 0 && statistics.refused == 0, "{statistics:?}");
    assert!(report.device.unwrap().is_released());
}

#[test]
fn a_panic_in_the_tissue_releases_the_device_and_is_reported() {
    struct Watched(Arc<Mutex<Vec<&'static str>>>);
    impl Device for Watched {
        fn rating(&self) -> Rating {
            Rating::TOUCH
        }
        fn read(&mut self, _: f64) -> Result<Reading, DeviceError> {
            Ok(Reading::default())
        }
        fn command(&mut self, _: Vector) -> Result<(), DeviceError> {
            Ok(())
        }
        fn release(&mut self) {
            self.0.lock().unwrap().push("released");
        }
    }
    let calls = Arc::new(Mutex::new(Vec::new()));
    let source = |pose: &Pose| if pose.time > 0.01 { panic!("the tissue burst") } else { None };
    let thread =
        HapticThread::start_direct(Watched(Arc::clone(&calls)), ChannelSettings::default(), Priority::Ordinary, source)
            .unwrap();
    while thread.is_running() {
        std::thread::yield_now();
    }
    assert_eq!(thread.stop().end, End::Panicked);
    assert_eq!(*calls.lock().unwrap(), ["released"]);
}
