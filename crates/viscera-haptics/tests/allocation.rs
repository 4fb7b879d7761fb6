//! The thread of a channel never asks for memory: who has to wait for it waits for other threads.

use allocation_counter::measure;
use viscera_haptics::{
    Channel, ChannelSettings, Contact, Device, DeviceError, Extrapolation, ManualClock, Pose, Rating, Reading, Run,
    Sample, Vector, run,
};

struct Still;

impl Device for Still {
    fn rating(&self) -> Rating {
        Rating::TOUCH
    }
    fn read(&mut self, now: f64) -> Result<Reading, DeviceError> {
        Ok(Reading { position: Vector::new(0.02 * (5.0 * now).sin(), 0.0, 0.0), ..Reading::default() })
    }
    fn command(&mut self, _: Vector) -> Result<(), DeviceError> {
        Ok(())
    }
    fn release(&mut self) {}
}

/// What a run of so many periods asks for, its start and its figures included.
fn asked_for(extrapolation: Extrapolation, periods: f64) -> u64 {
    let settings = ChannelSettings { extrapolation, ..ChannelSettings::default() };
    let mut channel = Channel::new(settings, Rating::TOUCH).unwrap();
    let mut clock = ManualClock::default();
    let over = std::cell::Cell::new(0.0);
    let mut source = |pose: &Pose| {
        over.set(over.get() + 1.0);
        let force = pose.position * -40.0;
        Some(Sample { time: pose.time, position: pose.position, force, stiffness: None, contact: Contact::Holding })
    };
    let used = measure(|| {
        run(Run {
            device: &mut Still,
            channel: &mut channel,
            source: &mut source,
            clock: &mut clock,
            stop: &|| over.get() >= periods,
            tell: &mut |_| {},
        });
    });
    used.count_total
}

#[test]
fn a_period_asks_for_no_memory() {
    for extrapolation in Extrapolation::ALL {
        // Ten thousand periods ask for as much as ten: the histograms of the start.
        assert_eq!(asked_for(extrapolation, 1e4), asked_for(extrapolation, 10.0), "{extrapolation:?}");
    }
}
