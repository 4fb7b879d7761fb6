//! What a page gets over a socket of this machine: frames with new positions in a second, for a surface of ten thousand triangles,
//! and the time from a pose that is sent to the frame that has it.
//!
//!     cargo bench -p viscera-server --bench loopback

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
/// How many poses are timed, one every 50 ms.
const POSES: usize = 200;

type Socket = WebSocketStream<MaybeTlsStream<TcpStream>>;

fn main() {
    let mut session = Session::new(Executor::serial());
    session.handle(Request::from(Command::OpenText { text: SHEET.into(), name: None }));
    session.handle(Request::from(Command::Play {}));
    let server = Server::start(Settings { port: 0, ..Settings::default() }, session).expect("a free port");
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(async {
        let mut socket = connect_async(format!("ws://{}/ws", server.address())).await.expect("the server").0;
        say(&mut socket, Command::Hello { version: VERSION, client: None }).await;
        let triangles = loop {
            if let Answer::Surface(surface) = hear(&mut socket).await {
                break surface.triangles.0.len() / 3;
            }
        };
        measure_frames(&mut socket, triangles).await;
        measure_latency(&mut socket).await;
    });
}

async fn measure_frames(socket: &mut Socket, triangles: usize) {
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
    println!(
        "frames    {triangles} triangles   {:.1} with new positions a second   longest gap {:.1} ms   {:.0} steps a second   {:.2} of real time",
        f64::from(new) / seconds,
        1e3 * gaps.last().map_or(0.0, Duration::as_secs_f64),
        (last.steps - steps) as f64 / seconds,
        last.pace.real_time,
    );
}

async fn measure_latency(socket: &mut Socket) {
    let tip = |turn: usize| [0.175, 0.09, 0.05 - 0.0005 * (turn % 2) as f64];
    let direction = [0.0, 0.0, -1.0];
    say(socket, Command::AddInstrument { kind: "probe".into(), tip: Some(tip(0)), direction: Some(direction) }).await;
    let mut times = Vec::new();
    for turn in 1..=POSES {
        // At all phases of a frame.
        let until = Instant::now() + Duration::from_micros(50_000 + 937 * (turn as u64 % 17));
        while Instant::now() < until {
            frame(socket).await;
        }
        let stamp = Some(turn as f64);
        let sent = Instant::now();
        say(
            socket,
            Command::MoveInstrument { instrument: 0, tip: tip(turn), direction, roll: 0.0, trigger: 0.0, stamp },
        )
        .await;
        loop {
            let seen = frame(socket).await;
            let there = seen.instruments.first().is_some_and(|tool| (tool.tip[2] - tip(turn)[2]).abs() < 1e-9);
            if there {
                break;
            }
        }
        times.push(sent.elapsed());
    }
    times.sort();
    let at = |share: f64| 1e3 * times[((times.len() - 1) as f64 * share) as usize].as_secs_f64();
    println!(
        "latency   pose to frame   median {:.1} ms   95 % {:.1} ms   largest {:.1} ms   {POSES} poses",
        at(0.5),
        at(0.95),
        at(1.0)
    );
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
