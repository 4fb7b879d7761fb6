//! What a page gets over a socket of this machine: frames with new positions in a second, for a surface of ten thousand triangles,
//! and the time from a pose that is said to the frame in which the surface has given way to it.
//!
//!     cargo bench -p viscera-server --bench loopback
//!     cargo bench -p viscera-server --bench loopback -- --bars    # fails where a bar does not hold

use std::process::ExitCode;
use std::time::{Duration, Instant};

use futures_util::{SinkExt, StreamExt};
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};
use viscera::executor::Executor;
use viscera_server::{Server, Settings};
use viscera_session::Session;
use viscera_session::message::{Answer, Command, FrameMessage, Request, VERSION};

/// A soft sheet that hangs from one side: 14 700 tetrahedra, nearly all of them at the surface.
const SHEET: &str = r#"
duration = "1 s"
step = "10 ms"

[body.sheet]
mesh = { generate = "box", size = [0.35, 0.175, 0.01], cells = [70, 35, 1] }
density = 1000
damping = 1
law = { kind = "st-venant-kirchhoff", young = 2e3, poisson = 0.3 }
model = { kind = "total-lagrangian" }
fix = "x-min"
"#;

const WARM_UP: Duration = Duration::from_secs(2);
const MEASURED: Duration = Duration::from_secs(10);
/// How many poses are timed.
const POSES: usize = 200;
/// From one pose to the next at least.
const PAUSE: Duration = Duration::from_millis(50);
/// How long the surface may take to follow before something is wrong.
const PATIENCE: Duration = Duration::from_secs(10);

/// Where the probe goes, over a node of the upper side: its round tip has a radius of 2.5 mm, and the sheet is 10 mm thick.
const PLACE: [f64; 2] = [0.175, 0.09];
/// Heights of its tip [m]: a millimetre off the sheet, and 2 mm into it.
const OFF: f64 = 0.0135;
const INTO: f64 = 0.0105;
/// The node has given way below this height, and has come back above that [m].
const GIVEN_WAY: f64 = 0.0085;
const COME_BACK: f64 = 0.0095;

/// Frames with new positions in a second, to half a one.
const LEAST_FRAMES: f64 = 59.5;
/// From pose to surface for 95 % of the poses.
const LONGEST_LATENCY: Duration = Duration::from_millis(50);

type Socket = WebSocketStream<MaybeTlsStream<TcpStream>>;

fn main() -> ExitCode {
    let mut session = Session::new(Executor::serial());
    session.handle(Request::from(Command::OpenText { text: SHEET.into(), name: None }));
    session.handle(Request::from(Command::Play {}));
    let server = Server::start(Settings { port: 0, ..Settings::default() }, session).expect("a free port");
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let (frames, latency) = runtime.block_on(async {
        let mut socket = connect_async(format!("ws://{}/ws", server.address())).await.expect("the server").0;
        say(&mut socket, Command::Hello { version: VERSION, client: None }).await;
        let triangles = loop {
            if let Answer::Surface(surface) = hear(&mut socket).await {
                break surface.triangles.0.len() / 3;
            }
        };
        (measure_frames(&mut socket, triangles).await, measure_latency(&mut socket).await)
    });
    let (enough, soon) = (frames >= LEAST_FRAMES, latency <= LONGEST_LATENCY);
    let word = |holds: bool| if holds { "holds" } else { "does NOT hold" };
    println!("bars      60 frames a second: {}   50 ms from pose to surface in 95 %: {}", word(enough), word(soon));
    let asked = std::env::args().any(|argument| argument == "--bars");
    if asked && !(enough && soon) { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Gives how many frames with new positions came in a second.
async fn measure_frames(socket: &mut Socket, triangles: usize) -> f64 {
    let start = Instant::now();
    let mut last = frame(socket).await;
    while start.elapsed() < WARM_UP {
        last = frame(socket).await;
    }
    let (start, steps) = (Instant::now(), last.steps);
    let (mut new, mut gaps, mut before) = (0, Vec::new(), Instant::now());
    while start.elapsed() < MEASURED {
        let next = frame(socket).await;
        if next.bodies[0].positions != last.bodies[0].positions {
            new += 1;
            gaps.push(before.elapsed());
            before = Instant::now();
        }
        last = next;
    }
    let seconds = start.elapsed().as_secs_f64();
    gaps.sort();
    let rate = f64::from(new) / seconds;
    println!(
        "frames    {triangles} triangles   {rate:.1} with new positions a second   longest gap {:.1} ms   {:.0} steps a second   {:.2} of real time",
        1e3 * gaps.last().map_or(0.0, Duration::as_secs_f64),
        (last.steps - steps) as f64 / seconds,
        last.pace.real_time,
    );
    rate
}

/// Gives the time from a pose to the surface that has given way to it, which 95 % of the poses do not exceed.
async fn measure_latency(socket: &mut Socket) -> Duration {
    let node = lay_the_sheet_down(socket).await;
    let height = |frame: &FrameMessage| f64::from(frame.bodies[0].positions.0[3 * node + 2]);
    let tip = |z: f64| [PLACE[0], PLACE[1], z];
    let direction = [0.0, 0.0, -1.0];
    let lead = |z: f64| Command::MoveInstrument {
        instrument: 0,
        tip: tip(z),
        direction,
        roll: 0.0,
        trigger: 0.0,
        stamp: None,
    };
    say(
        socket,
        Command::AddInstrument { kind: "probe".into(), tip: Some(tip(OFF)), direction: Some(direction), trocar: None },
    )
    .await;
    let mut times = Vec::new();
    for turn in 0..POSES {
        say(socket, lead(OFF)).await;
        // At all phases of a frame.
        let (lifted, pause) = (Instant::now(), PAUSE + Duration::from_micros(937 * (turn as u64 % 17)));
        while height(&frame(socket).await) < COME_BACK || lifted.elapsed() < pause {
            assert!(lifted.elapsed() < PATIENCE, "the surface does not come back");
        }
        // From the frame to the pose as well: frames come evenly, hands do not.
        tokio::time::sleep(Duration::from_micros(1031 * (turn as u64 % 16))).await;
        let said = Instant::now();
        say(socket, lead(INTO)).await;
        while height(&frame(socket).await) > GIVEN_WAY {
            assert!(said.elapsed() < PATIENCE, "the surface does not give way");
        }
        times.push(said.elapsed());
    }
    times.sort();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    let [median, most, largest] = [0.5, 0.95, 1.0].map(|share| 1e3 * at(share).as_secs_f64());
    println!(
        "latency   pose to surface   median {median:.1} ms   95 % {most:.1} ms   largest {largest:.1} ms   {POSES} poses"
    );
    at(0.95)
}

/// Opens the same sheet lying on a table, where nothing moves but by the probe. Gives the number of the vertex under that.
async fn lay_the_sheet_down(socket: &mut Socket) -> usize {
    let text = SHEET.replace("x-min", "z-min").replace("damping = 1", "damping = 50");
    let text = format!("gravity = [0, 0, 0]\n{text}");
    say(socket, Command::OpenText { text, name: Some("lying".into()) }).await;
    let mut epoch = None;
    loop {
        match hear(socket).await {
            Answer::Scene(scene) if scene.name == "lying" => epoch = Some(scene.epoch),
            Answer::Refusal(refusal) => panic!("{}", refusal.reason),
            Answer::Surface(surface) if Some(surface.scene) == epoch => {
                let place = [PLACE[0], PLACE[1], 0.01];
                let off =
                    |vertex: &[f32]| (0..3).map(|axis| (f64::from(vertex[axis]) - place[axis]).abs()).sum::<f64>();
                let found = surface.rest.0.chunks_exact(3).position(|vertex| off(vertex) < 1e-6);
                return found.expect("the sheet has a node there");
            }
            _ => {}
        }
    }
}

async fn say(socket: &mut Socket, command: Command) {
    let bytes = Request::from(command).encode();
    socket.send(Message::Binary(bytes.into())).await.expect("the server listens");
}

async fn hear(socket: &mut Socket) -> Answer {
    loop {
        if let Message::Binary(bytes) = socket.next().await.expect("the server stays").expect("a message") {
            return Answer::decode(&bytes).expect("an answer");
        }
    }
}

async fn frame(socket: &mut Socket) -> FrameMessage {
    loop {
        if let Answer::Frame(frame) = hear(socket).await {
            return frame;
        }
    }
}
