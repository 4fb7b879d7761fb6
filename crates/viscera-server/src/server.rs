use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::{SystemTime, UNIX_EPOCH};

use axum::Router;
use axum::extract::{Request, State, WebSocketUpgrade};
use axum::http::{HeaderMap, Uri};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::oneshot;
use viscera_session::Session;

use crate::connection::{self, House, LONGEST_MESSAGE};
use crate::guard::Guard;
use crate::page;
use crate::room::Room;
use crate::simulation::Stage;

/// Where to serve.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The address to bind to; 127.0.0.1 by default, which only this machine reaches.
    pub address: IpAddr,
    /// The port; 0 for any that is free.
    pub port: u16,
    /// Names besides `localhost` and addresses by which pages may reach the server, with or without a port.
    pub allowed_hosts: Vec<String>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { address: Ipv4Addr::LOCALHOST.into(), port: 7373, allowed_hosts: Vec::new() }
    }
}

/// Why nothing is served.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The address cannot be bound to.
    #[error("cannot listen on {address}: {source}; is another program there already? --port 0 takes any that is free")]
    Bind {
        /// The address.
        address: SocketAddr,
        /// What the system says.
        source: std::io::Error,
    },
    /// The system refuses threads.
    #[error("the system refuses threads to serve with: {0}")]
    Threads(std::io::Error),
}

/// A server at work, until it is dropped.
pub struct Server {
    address: SocketAddr,
    runtime: Runtime,
    stopped: Option<oneshot::Receiver<()>>,
}

impl Server {
    /// Serves a session.
    ///
    /// # Errors
    /// [`ServeError`].
    pub fn start(settings: Settings, session: Session) -> Result<Self, ServeError> {
        // Connections are few, and the simulation wants the cores.
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("connection")
            .enable_all()
            .build()
            .map_err(ServeError::Threads)?;
        let wanted = SocketAddr::new(settings.address, settings.port);
        let bind = |source| ServeError::Bind { address: wanted, source };
        let listener = runtime.block_on(TcpListener::bind(wanted)).map_err(bind)?;
        let address = listener.local_addr().map_err(bind)?;
        let room = Room::new();
        let stage = Stage::start(session, room.clone()).map_err(ServeError::Threads)?;
        let guard = Guard { allowed: settings.allowed_hosts };
        let house = House { stage, room, number: number_of_this_run() };
        let app = Router::new()
            .route("/ws", get(upgrade))
            .fallback(get(|uri: Uri| async move { page::file(&uri) }))
            .layer(middleware::from_fn_with_state(guard, check))
            .with_state(house);
        let (stop, stopped) = oneshot::channel();
        runtime.spawn(async move {
            // It ends with its listener only, and then there is nobody to tell.
            let _ = axum::serve(listener, app).await;
            drop(stop);
        });
        Ok(Self { address, runtime, stopped: Some(stopped) })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Why there is no page, if there is none.
    pub fn missing_page(&self) -> Option<&'static str> {
        page::missing()
    }

    /// Serves until the program is ended.
    pub fn wait(mut self) {
        if let Some(stopped) = self.stopped.take() {
            let _ = self.runtime.block_on(stopped);
        }
    }
}

/// A number that JavaScript can hold, another one each time.
fn number_of_this_run() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (since.as_micros() as u64) & ((1 << 53) - 1)
}

async fn check(State(guard): State<Guard>, headers: HeaderMap, request: Request, next: Next) -> Response {
    match guard.check(&headers) {
        Ok(()) => next.run(request).await,
        Err(refused) => refused.into_response(),
    }
}

async fn upgrade(State(house): State<House>, upgrade: WebSocketUpgrade) -> Response {
    upgrade
        .max_message_size(LONGEST_MESSAGE)
        .max_frame_size(LONGEST_MESSAGE)
        .on_upgrade(move |socket| connection::serve(socket, house))
}
