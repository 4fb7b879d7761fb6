//! A haptic device beside a page: it presses into tissue, the page sees it, the hand feels it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, LazyLock, Mutex};

use viscera::executor::Executor;
use viscera_haptics::{
    ChannelSettings, Device, DeviceError, EmulatedDevice, End, Extrapolation, Hand, Imperfections, Priority, Rating,
    Reading, Vector, Workspace,
};
use viscera_server::{Haptics, Server, Settings, instrument_for_a_hand};
use viscera_session::Session;
use viscera_session::message::{Answer, Bytes, Command, Request};

use crate::ask;
use crate::visitor::{BAR, Visitor, runtime, session};

/// The bar without weight, damped, and a probe whose round tip is 8 mm above its free end, pointing down. It is too thick to pass between
/// nodes.
static PRESSED: LazyLock<String> = LazyLock::new(|| {
    let damped = BAR.replace("density = 1000\n", "density = 1000\ndamping = 5\n");
    let probe = "[instrument.probe]\nkind = \"probe\"\npath = [0.02, 0.06, 0.1]\nshaft = { radius = 0.012 }\n";
    format!("gravity = [0, 0, 0]\n{damped}\n{probe}")
});

/// How far the hand presses [m], and in which time [s].
const DEPTH: f64 = 0.02;
const TIME: f64 = 0.5;

/// An emulated device, and what it tells of itself to the test.
struct Watched {
    device: EmulatedDevice,
    /// Bits of the force along the handle [N].
    felt: Arc<AtomicU64>,
    released: Arc<AtomicBool>,
}

impl Device for Watched {
    fn rating(&self) -> Rating {
        self.device.rating()
    }
    fn read(&mut self, now: f64) -> Result<Reading, DeviceError> {
        self.device.read(now)
    }
    fn command(&mut self, force: Vector) -> Result<(), DeviceError> {
        self.felt.store(force.z.to_bits(), Ordering::Relaxed);
        self.device.command(force)
    }
    fn release(&mut self) {
        self.device.release();
        self.released.store(true, Ordering::Relaxed);
    }
}

/// A hand that rests until it is told to press, and then presses along its handle.
fn pressing_hand(press: Arc<AtomicBool>) -> Hand {
    let began = Mutex::new(None);
    Hand::on_rails(move |time| {
        if !press.load(Ordering::Relaxed) {
            return Vector::ZERO;
        }
        let began = *began.lock().unwrap().get_or_insert(time);
        Vector::new(0.0, 0.0, DEPTH * ((time - began) / TIME).clamp(0.0, 1.0))
    })
}

/// The device takes the first instrument over as it is.
fn haptics(session: &Session, device: impl Device + 'static) -> Haptics {
    let shape = instrument_for_a_hand(session, None).unwrap();
    let tool = session.instrument(shape.instrument).unwrap();
    let pose =
        viscera::instrument::ToolPose { tip: tool.tip.into(), direction: tool.direction.into(), roll: tool.roll };
    let settings = ChannelSettings { workspace: Workspace::of_tool(&pose), ..ChannelSettings::default() };
    Haptics { device: Box::new(device), instrument: shape.instrument, settings, priority: Priority::Ordinary }
}

fn start(session: Session, haptics: Haptics) -> Server {
    Server::start_with(Settings { port: 0, ..Settings::default() }, session, Some(haptics)).unwrap()
}

#[test]
fn a_device_presses_tissue_that_the_page_sees_and_the_hand_feels_and_is_released_in_the_end() {
    let (press, felt) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
    let released = Arc::new(AtomicBool::new(false));
    let device = EmulatedDevice::new(Rating::TOUCH, pressing_hand(Arc::clone(&press)));
    let device = Watched { device, felt: Arc::clone(&felt), released: Arc::clone(&released) };
    let session = session(&PRESSED);
    let haptics = haptics(&session, device);
    let server = start(session, haptics);
    runtime().block_on(async {
        let (mut visitor, _) = Visitor::enter(server.address()).await;
        visitor.until_a_hand_has_the_tool().await;
        let rest = visitor.frame().await;
        assert!((rest.instruments[0].tip[1] - 0.06).abs() < 1e-9, "it stays where it was: {:?}", rest.instruments);
        press.store(true, Ordering::Relaxed);
        let pressed = loop {
            let frame = visitor.frame().await;
            if frame.instruments[0].tip[1] < 0.06 - DEPTH + 1e-6 && frame.instruments[0].force[1] > 0.02 {
                break frame;
            }
        };
        assert_ne!(pressed.bodies[0].positions, rest.bodies[0].positions);
        // The force of the tissue goes up, against the handle.
        while f64::from_bits(felt.load(Ordering::Relaxed)) > -0.01 {
            visitor.frame().await;
        }
        while server.haptics().is_none_or(|statistics| statistics.samples == 0) {
            visitor.frame().await;
        }
        let address = server.address();
        let (status, text) = ask(address, &format!("GET /haptics HTTP/1.1\r\nHost: {address}\r\n")).await;
        assert!(status == 200 && text.contains("latency of samples: median"), "{text}");
    });
    assert!(server.has_haptics());
    let report = server.stop().expect("there was a device");
    let statistics = report.channel.statistics.expect("it came to a good end");
    assert_eq!(report.channel.end, End::Stopped);
    assert!(released.load(Ordering::Relaxed) && report.channel.device.is_some());
    assert!(statistics.samples > 0 && statistics.refused == 0, "{statistics:?}");
    assert!(report.steps.steps > 0 && report.steps.refused == 0, "{:?}", report.steps);
}

#[test]
fn the_device_wins_over_a_page_that_wants_its_instrument_and_the_page_hears_why() {
    let session = session(&PRESSED);
    let device = EmulatedDevice::new(Rating::TOUCH, Hand::on_rails(|_| Vector::ZERO));
    let haptics = haptics(&session, device);
    let server = start(session, haptics);
    runtime().block_on(async {
        let (mut visitor, _) = Visitor::enter(server.address()).await;
        visitor.until_a_hand_has_the_tool().await;
        let tip = [0.02, 0.2, 0.1];
        let direction = [0.0, -1.0, 0.0];
        let lead = Command::MoveInstrument { instrument: 0, tip, direction, roll: 0.0, trigger: 0.0, stamp: None };
        for (request, command) in [(7, lead), (8, Command::RemoveInstrument { instrument: 0 })] {
            visitor.send(Request { command, request: Some(request) }.encode()).await;
            let refusal =
                visitor.until(|answer| if let Answer::Refusal(refusal) = answer { Some(refusal) } else { None }).await;
            assert!(refusal.reason.contains("device") && refusal.request == Some(request), "{refusal:?}");
        }
        // Another instrument is the page's to lead.
        visitor
            .say(Command::AddInstrument {
                kind: "probe".into(),
                tip: Some(tip),
                direction: Some(direction),
                trocar: None,
            })
            .await;
        let lead = Command::MoveInstrument {
            instrument: 1,
            tip: [0.02, 0.3, 0.1],
            direction,
            roll: 0.0,
            trigger: 0.0,
            stamp: None,
        };
        visitor.say(lead).await;
        visitor
            .until(|answer| match answer {
                Answer::Frame(frame) => {
                    assert!((frame.instruments[0].tip[1] - 0.06).abs() < 1e-9, "{:?}", frame.instruments[0]);
                    frame.instruments.get(1).filter(|tool| (tool.tip[1] - 0.3).abs() < 1e-9).map(|_| ())
                }
                _ => None,
            })
            .await;
    });
}

/// The device leads by commands, and so a recording has what it did.
#[test]
fn a_recording_of_a_device_replays_to_the_same_bits() {
    let press = Arc::new(AtomicBool::new(false));
    let session = session(&PRESSED);
    let haptics = haptics(&session, EmulatedDevice::new(Rating::TOUCH, pressing_hand(Arc::clone(&press))));
    let server = start(session, haptics);
    let file = runtime().block_on(async {
        let (mut visitor, _) = Visitor::enter(server.address()).await;
        visitor.say(Command::StartRecording {}).await;
        visitor.until(|answer| matches!(answer, Answer::Frame(frame) if frame.recording.is_some()).then_some(())).await;
        press.store(true, Ordering::Relaxed);
        while visitor.frame().await.instruments[0].tip[1] > 0.06 - DEPTH + 1e-6 {}
        visitor.say(Command::StopRecording {}).await;
        visitor.until(|answer| if let Answer::File(file) = answer { Some(file) } else { None }).await
    });
    drop(server);
    let mut session = Session::new(Executor::serial());
    session.handle(Request::from(Command::Replay { name: None, bytes: Some(Bytes(file.bytes.0)) }));
    let told = loop {
        session.elapse(0.05);
        while session.work() {}
        let text = session.take_answers().into_iter().find_map(|answer| match answer {
            Answer::Notice(notice) if notice.text.starts_with("replayed") => Some(notice.text),
            Answer::Refusal(refusal) => panic!("{refusal:?}"),
            _ => None,
        });
        if let Some(text) = text {
            break text;
        }
    };
    assert!(told.ends_with("to the same bits"), "{told}");
    let tip = session.instrument(0).unwrap().tip;
    assert!(tip[1] < 0.06 - DEPTH + 1e-6, "{tip:?}");
}

#[test]
fn when_the_device_is_lost_the_page_may_lead_its_instrument() {
    let session = session(&PRESSED);
    let imperfections = Imperfections { unplugged: Some(0.3), ..Imperfections::default() };
    let device = EmulatedDevice::imperfect(Rating::TOUCH, Hand::on_rails(|_| Vector::ZERO), imperfections);
    let haptics = haptics(&session, device);
    let server = start(session, haptics);
    runtime().block_on(async {
        let (mut visitor, _) = Visitor::enter(server.address()).await;
        let (tip, direction) = ([0.02, 0.2, 0.1], [0.0, -1.0, 0.0]);
        loop {
            let lead = Command::MoveInstrument { instrument: 0, tip, direction, roll: 0.0, trigger: 0.0, stamp: None };
            visitor.say(lead).await;
            let led = (visitor.frame().await.instruments[0].tip[1] - tip[1]).abs() < 1e-9;
            // Before the first step it is nobody's, and the page may lead it as well.
            if led && !server.has_haptics() {
                break;
            }
        }
    });
    let report = server.stop().expect("there was a device");
    assert!(matches!(report.channel.end, End::Device(DeviceError::Lost { .. })), "{:?}", report.channel.end);
}

#[test]
fn what_a_device_cannot_lead_is_refused_at_the_start_with_its_reason() {
    let refused = |text: &str, instrument: u32, extrapolation: Extrapolation| {
        let device = Box::new(EmulatedDevice::new(Rating::TOUCH, Hand::on_rails(|_| Vector::ZERO)));
        let settings = ChannelSettings { extrapolation, ..ChannelSettings::default() };
        let haptics = Haptics { device, instrument, settings, priority: Priority::Ordinary };
        let at = Settings { port: 0, ..Settings::default() };
        Server::start_with(at, session(text), Some(haptics)).err().expect("it is refused").to_string()
    };
    let linearised = Extrapolation::Linearised;
    assert_eq!(refused(&PRESSED, 5, linearised), "the scene has no instrument 5; it has 0 (probe)");
    assert!(refused(BAR, 0, linearised).contains("add a grasper or a probe"));
    assert!(refused(&PRESSED, 0, Extrapolation::Direct).contains("take `linearised`"));
    let slow = refused(&PRESSED.replace("10 ms", "200 ms"), 0, linearised);
    assert!(slow.contains("lasts 200 ms") && slow.contains("shorten `step`"), "{slow}");
    assert!(instrument_for_a_hand(&session(BAR), None).is_err());
}
