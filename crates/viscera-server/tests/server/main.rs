//! The server as a browser has it: over a real socket on this machine.

mod haptics;
mod limits;
mod visitor;

use std::net::SocketAddr;

use futures_util::SinkExt;
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_tungstenite::connect_async;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use viscera_server::Settings;
use viscera_session::message::{Answer, Command, Request, Role, RunState, VERSION};

use visitor::{BAR, PATIENCE, Visitor, start, start_with};

#[test]
fn a_page_hears_welcome_catalogue_scene_surface_and_frames_that_move() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let (mut visitor, welcome) = Visitor::enter(server.address()).await;
        assert_eq!((welcome.role, welcome.engine.as_str()), (Role::Controller, "native"));
        let Some(Answer::Catalogue(catalogue)) = visitor.hear().await else { panic!("the catalogue comes next") };
        assert!(catalogue.scenes.iter().any(|scene| scene.name == "liver"));
        let mut kinds = Vec::new();
        while kinds.len() < 3 {
            kinds.push(match visitor.hear().await.unwrap() {
                Answer::Scene(_) => "scene",
                Answer::Surface(_) => "surface",
                Answer::Frame(_) => "frame",
                _ => continue,
            });
        }
        assert_eq!(kinds, ["scene", "surface", "frame"]);
        let before = visitor.frame().await;
        let after = visitor.frame().await;
        assert!(after.sequence > before.sequence);
        visitor
            .until(|answer| match answer {
                Answer::Frame(frame) if frame.steps > before.steps => {
                    assert_ne!(frame.bodies[0].positions, before.bodies[0].positions);
                    Some(())
                }
                _ => None,
            })
            .await;
    });
}

#[test]
fn one_controls_and_the_next_takes_over_when_it_leaves() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let (mut first, _) = Visitor::enter(server.address()).await;
        let (mut second, welcome) = Visitor::enter(server.address()).await;
        assert_eq!(welcome.role, Role::Watcher);
        second.send(Request { command: Command::Pause {}, request: Some(5) }.encode()).await;
        let refusal =
            second.until(|answer| if let Answer::Refusal(refusal) = answer { Some(refusal) } else { None }).await;
        assert!(refusal.reason.contains("another page controls") && refusal.request == Some(5));
        first.frame().await;
        assert_eq!(first.frame().await.state, RunState::Running, "a watcher changes nothing");
        drop(first);
        let role = second.until(|answer| if let Answer::Role(role) = answer { Some(role) } else { None }).await;
        assert_eq!((role.role, role.clients), (Role::Controller, 1));
        second.say(Command::Pause {}).await;
        second
            .until(|answer| matches!(answer, Answer::Frame(frame) if frame.state == RunState::Paused).then_some(()))
            .await;
    });
}

/// What is malformed is refused with its reason, and the next frame comes all the same.
#[test]
fn malformed_messages_are_refused_and_the_simulation_goes_on() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let (mut visitor, _) = Visitor::enter(server.address()).await;
        let before = visitor.frame().await.steps;
        for bytes in [vec![], vec![0xc1; 100], b"GET / HTTP/1.1".to_vec(), vec![0xdf, 0xff, 0xff, 0xff, 0xff]] {
            visitor.send(bytes).await;
            visitor.until(|answer| matches!(answer, Answer::Refusal(_)).then_some(())).await;
        }
        visitor.socket.send(Message::Text("pause".into())).await.unwrap();
        let refusal =
            visitor.until(|answer| if let Answer::Refusal(refusal) = answer { Some(refusal) } else { None }).await;
        assert!(refusal.reason.contains("binary"));
        visitor.until(|answer| matches!(answer, Answer::Frame(frame) if frame.steps > before).then_some(())).await;
    });
}

#[test]
fn other_versions_and_those_who_do_not_greet_are_shown_the_door_with_a_reason() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let mut visitor = Visitor::connect(server.address()).await;
        visitor.say(Command::Hello { version: VERSION + 1, client: None }).await;
        let closed = visitor.closed().await;
        assert!(u16::from(closed.code) == 1008 && closed.reason.contains("version 2"), "{closed:?}");
        let mut visitor = Visitor::connect(server.address()).await;
        visitor.say(Command::Pause {}).await;
        assert!(visitor.closed().await.reason.contains("hello"));
    });
}

/// Whoever reads nothing for a while gets the newest frame then, not all that it missed: 60 frames of 200 kB. Sockets of some machines hold
/// 30 MB that nobody has read, so its own is small; and a slow machine is not to lose it meanwhile, for it answers no pings.
#[test]
fn a_slow_page_gets_fewer_frames_and_none_that_is_old() {
    const FRAMES: u64 = 60;
    let (server, runtime) = start_with(Settings { ping: PATIENCE, ..Settings::default() });
    runtime.block_on(async {
        let (mut quick, _) = Visitor::enter(server.address()).await;
        let sheet = BAR
            .replace("size = [0.04, 0.04, 0.12], cells = [2, 2, 6]", "size = [0.2, 0.2, 0.005], cells = [80, 80, 1]");
        quick.say(Command::Pause {}).await;
        quick.say(Command::OpenText { text: sheet, name: None }).await;
        quick.say(Command::Colour { by: "displacement".into() }).await;
        let large = |answer| match answer {
            Answer::Frame(frame) if frame.bodies[0].positions.0.len() > 9000 => Some(frame),
            _ => None,
        };
        let first = quick.until(large).await.sequence;
        let (mut slow, _) = Visitor::connect_holding_little(server.address()).await.introduced().await;
        slow.until(large).await;
        let mut newest = first;
        while newest < first + FRAMES {
            // Something that makes a new frame and takes no time.
            quick.say(Command::Colour { by: "displacement".into() }).await;
            newest = quick.frame().await.sequence;
        }
        let (mut received, mut last) = (0, 0);
        while last < newest {
            last = slow.frame().await.sequence;
            received += 1;
        }
        assert!(received < FRAMES / 2, "{received} of {FRAMES} frames waited for the slow page");
    });
}

/// A connection that is lost and comes back finds the session as it was, time included: it waited.
#[test]
fn a_page_that_comes_back_finds_the_session_where_it_was() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let (mut visitor, welcome) = Visitor::enter(server.address()).await;
        visitor.say(Command::Pause {}).await;
        let paused = visitor
            .until(|answer| match answer {
                Answer::Frame(frame) if frame.state == RunState::Paused => Some(frame),
                _ => None,
            })
            .await;
        drop(visitor);
        let (mut visitor, again) = Visitor::enter(server.address()).await;
        assert_eq!(again.session, welcome.session);
        let frame = visitor.frame().await;
        assert_eq!((frame.steps, &frame.bodies[0].positions), (paused.steps, &paused.bodies[0].positions));
    });
}

/// Asks over plain HTTP; gives the status and all that was answered.
async fn ask(address: SocketAddr, head: &str) -> (u16, String) {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    let mut stream = TcpStream::connect(address).await.unwrap();
    stream.write_all(format!("{head}Connection: close\r\n\r\n").as_bytes()).await.unwrap();
    let mut answer = Vec::new();
    timeout(PATIENCE, stream.read_to_end(&mut answer)).await.unwrap().unwrap();
    let text = String::from_utf8_lossy(&answer).into_owned();
    let status = text.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
    (status, text)
}

#[test]
fn other_sites_get_neither_the_page_nor_the_session() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let address = server.address();
        let own = address.to_string();
        let upgrade =
            "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
        for (path, host, origin, wanted) in [
            ("/", own.as_str(), None, [200, 503]),
            ("/", "rebound.example:8472", None, [403, 403]),
            ("/ws", own.as_str(), Some("http://evil.example"), [403, 403]),
            ("/ws", "rebound.example", Some("http://rebound.example"), [403, 403]),
            ("/nothing", own.as_str(), None, [404, 404]),
            ("/haptics", own.as_str(), None, [404, 404]),
            ("/haptics", "rebound.example", None, [403, 403]),
        ] {
            let origin = origin.map_or(String::new(), |origin| format!("Origin: {origin}\r\n"));
            let (status, text) =
                ask(address, &format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n{origin}{upgrade}")).await;
            assert!(wanted.contains(&status), "{path} of {host}: {text}");
        }
        let mut request = format!("ws://{address}/ws").into_client_request().unwrap();
        request.headers_mut().insert("Origin", format!("http://{address}").parse().unwrap());
        assert!(connect_async(request).await.is_ok(), "the page itself may");
    });
}
