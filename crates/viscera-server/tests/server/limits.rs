//! What one connection may take from the others: memory, the seat, time.

use std::time::Duration;

use futures_util::{SinkExt, StreamExt};
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::Message;
use viscera_server::Settings;
use viscera_session::message::{Answer, Bytes, Command, Request, Role};

use crate::visitor::{PATIENCE, Visitor, start, start_with};

/// More than 64 MiB is not even read.
#[test]
fn a_message_beyond_all_limits_ends_its_connection_with_code_1009_and_no_other() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let (visitor, _) = Visitor::enter(server.address()).await;
        let (mut watcher, _) = Visitor::enter(server.address()).await;
        let (mut sink, mut stream) = visitor.socket.split();
        let sending = async {
            // The server closes before all is sent.
            let _ = sink.send(Message::Binary(vec![0; (64 << 20) + 2048].into())).await;
        };
        let closing = async {
            loop {
                match timeout(PATIENCE, stream.next()).await.expect("the server closes") {
                    Some(Ok(Message::Close(Some(frame)))) => return frame,
                    Some(Ok(_)) => {}
                    other => panic!("closed without a reason: {other:?}"),
                }
            }
        };
        let ((), closed) = tokio::join!(sending, closing);
        assert!(u16::from(closed.code) == 1009 && closed.reason.contains("64 MiB"), "{closed:?}");
        let role = watcher.until(|answer| if let Answer::Role(role) = answer { Some(role) } else { None }).await;
        assert_eq!(role.role, Role::Controller);
        watcher.frame().await;
    });
}

/// A message that is too long before anything was said is no hello, and its reason is told all the same.
#[test]
fn a_first_message_beyond_all_limits_is_told_so() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let visitor = Visitor::connect(server.address()).await;
        let (mut sink, mut stream) = visitor.socket.split();
        let sending = async {
            let _ = sink.send(Message::Binary(vec![0; (64 << 20) + 2048].into())).await;
        };
        let (_, closed) = tokio::join!(sending, timeout(PATIENCE, stream.next()));
        let Ok(Some(Ok(Message::Close(Some(closed))))) = closed else { panic!("no reason: {closed:?}") };
        assert_eq!(u16::from(closed.code), 1009);
    });
}

/// What has not said hello yet may not have megabytes decoded.
#[test]
fn a_hello_of_more_than_64_kib_is_shown_the_door() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let mut visitor = Visitor::connect(server.address()).await;
        visitor.send(vec![0xc0; (64 << 10) + 1]).await;
        let closed = visitor.closed().await;
        assert!(u16::from(closed.code) == 1009 && closed.reason.contains("hello"), "{closed:?}");
    });
}

/// The refusal carries the number of the command, however much else there is in it.
#[test]
fn a_watcher_with_a_mesh_is_refused_by_its_number() {
    let (server, runtime) = start();
    runtime.block_on(async {
        let (_first, _) = Visitor::enter(server.address()).await;
        let (mut watcher, _) = Visitor::enter(server.address()).await;
        let bytes = Bytes(vec![7; 1 << 20]);
        let command = Command::OpenMesh { name: "organ.stl".into(), bytes, unit: None, edge: None };
        watcher.send(Request { command, request: Some(9) }.encode()).await;
        let refusal =
            watcher.until(|answer| if let Answer::Refusal(refusal) = answer { Some(refusal) } else { None }).await;
        assert!(refusal.reason.contains("another page controls") && refusal.request == Some(9), "{refusal:?}");
    });
}

/// A page whose machine fell asleep: its connection stands, and nothing on it is read, so that no ping is answered.
#[test]
fn a_controller_that_answers_no_pings_loses_its_seat_to_the_next() {
    let (server, runtime) = start_with(Settings { ping: Duration::from_millis(300), ..Settings::default() });
    runtime.block_on(async {
        let (silent, welcome) = Visitor::enter(server.address()).await;
        assert_eq!(welcome.role, Role::Controller);
        let (mut next, welcome) = Visitor::enter(server.address()).await;
        assert_eq!(welcome.role, Role::Watcher);
        let role = next.until(|answer| if let Answer::Role(role) = answer { Some(role) } else { None }).await;
        assert_eq!((role.role, role.clients), (Role::Controller, 1));
        drop(silent);
    });
}
