//! Somebody who comes to look.

use std::net::SocketAddr;
use std::time::Duration;

use futures_util::{SinkExt, StreamExt};
use tokio::net::{TcpSocket, TcpStream};
use tokio::runtime::Runtime;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::protocol::CloseFrame;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, client_async};
use viscera::executor::Executor;
use viscera_server::{Server, Settings};
use viscera_session::Session;
use viscera_session::message::{Answer, Command, FrameMessage, Request, VERSION, Welcome};

pub(crate) const BAR: &str = r#"
duration = "1 s"
step = "10 ms"
integrator = { kind = "backward-euler" }

[body.bar]
mesh = { generate = "box", size = [0.04, 0.04, 0.12], cells = [2, 2, 6] }
density = 1000
law = { kind = "stable-neo-hookean", young = 20e3, poisson = 0.4 }
model = { kind = "total-lagrangian" }
fix = "z-min"
"#;

/// Longer than any answer takes on a machine that is busy; nothing is measured with it.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// A scene at play.
pub(crate) fn session(text: &str) -> Session {
    let mut session = Session::new(Executor::serial());
    session.handle(Request::from(Command::OpenText { text: text.into(), name: None }));
    session.handle(Request::from(Command::Play {}));
    session
}

/// A server with a bar that moves.
pub(crate) fn start() -> (Server, Runtime) {
    start_with(Settings::default())
}

/// The same with other settings.
pub(crate) fn start_with(settings: Settings) -> (Server, Runtime) {
    (Server::start(Settings { port: 0, ..settings }, session(BAR)).unwrap(), runtime())
}

pub(crate) fn runtime() -> Runtime {
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap()
}

/// Somebody with a browser.
pub(crate) struct Visitor {
    pub(crate) socket: WebSocketStream<MaybeTlsStream<TcpStream>>,
}

impl Visitor {
    pub(crate) async fn connect(address: SocketAddr) -> Self {
        Self::over(TcpStream::connect(address).await.unwrap()).await
    }

    /// Connects with a socket that holds no more than some kB of what is not read, however much those of the machine may hold.
    pub(crate) async fn connect_holding_little(address: SocketAddr) -> Self {
        let socket = TcpSocket::new_v4().unwrap();
        socket.set_recv_buffer_size(64 << 10).unwrap();
        Self::over(socket.connect(address).await.unwrap()).await
    }

    async fn over(stream: TcpStream) -> Self {
        let address = format!("ws://{}/ws", stream.peer_addr().unwrap());
        Self { socket: client_async(address, MaybeTlsStream::Plain(stream)).await.unwrap().0 }
    }

    /// Connects and says hello.
    pub(crate) async fn enter(address: SocketAddr) -> (Self, Welcome) {
        Self::connect(address).await.introduced().await
    }

    /// Says hello.
    pub(crate) async fn introduced(mut self) -> (Self, Welcome) {
        self.say(Command::Hello { version: VERSION, client: None }).await;
        match self.hear().await {
            Some(Answer::Welcome(welcome)) => (self, welcome),
            other => panic!("no welcome: {other:?}"),
        }
    }

    pub(crate) async fn say(&mut self, command: Command) {
        self.send(Request::from(command).encode()).await;
    }

    pub(crate) async fn send(&mut self, bytes: Vec<u8>) {
        self.socket.send(Message::Binary(bytes.into())).await.unwrap();
    }

    /// The next answer; none when the connection is closed.
    pub(crate) async fn hear(&mut self) -> Option<Answer> {
        loop {
            match timeout(PATIENCE, self.socket.next()).await.expect("an answer comes") {
                Some(Ok(Message::Binary(bytes))) => return Some(Answer::decode(&bytes).unwrap()),
                Some(Ok(Message::Close(_)) | Err(_)) | None => return None,
                Some(Ok(_)) => {}
            }
        }
    }

    /// Hears until something is what is waited for.
    pub(crate) async fn until<T>(&mut self, mut wanted: impl FnMut(Answer) -> Option<T>) -> T {
        loop {
            if let Some(found) = wanted(self.hear().await.expect("the connection stays")) {
                return found;
            }
        }
    }

    /// Hears until the scene no longer leads its first tool.
    pub(crate) async fn until_a_hand_has_the_tool(&mut self) {
        let led = |answer| match answer {
            Answer::Scene(scene) if !scene.instruments[0].scripted => Some(()),
            _ => None,
        };
        self.until(led).await;
    }

    pub(crate) async fn frame(&mut self) -> FrameMessage {
        self.until(|answer| if let Answer::Frame(frame) = answer { Some(frame) } else { None }).await
    }

    /// Why the server closed.
    pub(crate) async fn closed(&mut self) -> CloseFrame {
        loop {
            match timeout(PATIENCE, self.socket.next()).await.expect("the server closes") {
                Some(Ok(Message::Close(Some(frame)))) => return frame,
                Some(Ok(_)) => {}
                other => panic!("closed without a reason: {other:?}"),
            }
        }
    }
}
