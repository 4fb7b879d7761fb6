use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use axum::Router;
use axum::extract::{Request, State, WebSocketUpgrade};
use axum::http::{HeaderMap, StatusCode, Uri};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::oneshot;
use tokio::time::sleep;
use viscera_haptics::{Figures, StartError, Statistics};
use viscera_session::Session;

use crate::connection::{self, House, LONGEST_MESSAGE};
use crate::guard::Guard;
use crate::haptics::{Channel, Haptics, HapticsError, HapticsReport};
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
    /// Time from one ping to the next [> 0]; 5 s by default. A connection that leaves three in a row unanswered is lost, and its seat is
    /// free.
    pub ping: Duration,
}

impl Default for Settings {
    fn default() -> Self {
        let address = Ipv4Addr::LOCALHOST.into();
        Self { address, port: 7373, allowed_hosts: Vec::new(), ping: Duration::from_secs(5) }
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
    /// The haptic device cannot lead the instrument.
    #[error(transparent)]
    Haptics(#[from] HapticsError),
}

impl From<StartError> for ServeError {
    fn from(error: StartError) -> Self {
        Self::Haptics(error.into())
    }
}

/// How often a server asks whether it is to end.
const LOOK_UP: Duration = Duration::from_millis(50);

/// A server at work, until it is dropped.
pub struct Server {
    address: SocketAddr,
    channel: Option<Channel>,
    runtime: Runtime,
    stopped: oneshot::Receiver<()>,
}

impl Server {
    /// Serves a session.
    ///
    /// # Errors
    /// [`ServeError`].
    pub fn start(settings: Settings, session: Session) -> Result<Self, ServeError> {
        Self::start_with(settings, session, None)
    }

    /// Serves a session, an instrument of which is led by a haptic device.
    ///
    /// # Errors
    /// [`ServeError`]. The device is dropped, untouched.
    pub fn start_with(settings: Settings, session: Session, haptics: Option<Haptics>) -> Result<Self, ServeError> {
        if let Some(haptics) = &haptics {
            haptics.check(&session)?;
        }
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
        let (channel, reins) = haptics.map(Haptics::start).transpose()?.unzip();
        let stage = Stage::start(session, room.clone(), reins).map_err(ServeError::Threads)?;
        let guard = Guard { allowed: settings.allowed_hosts };
        let house = House { stage, room, number: number_of_this_run(), ping: settings.ping };
        let of_channel = channel.as_ref().map(Channel::figures);
        let app = Router::new()
            .route("/ws", get(upgrade))
            .route("/haptics", get(async move || figures(of_channel.as_ref())))
            .fallback(get(|uri: Uri| async move { page::file(&uri) }))
            .layer(middleware::from_fn_with_state(guard, check))
            .with_state(house);
        let (stop, stopped) = oneshot::channel();
        runtime.spawn(async move {
            // It ends with its listener only, and then there is nobody to tell.
            let _ = axum::serve(listener, app).await;
            drop(stop);
        });
        Ok(Self { address, channel, runtime, stopped })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Why there is no page, if there is none.
    pub fn missing_page(&self) -> Option<&'static str> {
        page::missing()
    }

    /// Figures of the haptic channel, of a moment ago; none where there is no device, and in the first quarter of a second.
    pub fn haptics(&self) -> Option<Statistics> {
        self.channel.as_ref().and_then(|channel| channel.figures().newest())
    }

    /// Whether a haptic device is at work.
    pub fn has_haptics(&self) -> bool {
        self.channel.as_ref().is_some_and(Channel::is_running)
    }

    /// Serves until `is_over` says so, which is asked twenty times a second.
    pub fn serve_until(&mut self, is_over: impl Fn() -> bool) {
        let Self { runtime, stopped, .. } = self;
        runtime.block_on(async {
            while !is_over() {
                tokio::select! {
                    _ = &mut *stopped => return,
                    () = sleep(LOOK_UP) => {}
                }
            }
        });
    }

    /// Ends: connections are closed, and the haptic device is released. Says how that fared, if there was one.
    pub fn stop(self) -> Option<HapticsReport> {
        self.channel.map(Channel::stop)
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

/// The figures of the haptic channel, for a person to read.
fn figures(of_channel: Option<&Figures>) -> Response {
    match of_channel.map(Figures::newest) {
        None => (StatusCode::NOT_FOUND, "no haptic device leads an instrument; `viscera serve --haptics` gives it one")
            .into_response(),
        Some(None) => "the haptic channel has only just begun".into_response(),
        Some(Some(statistics)) => statistics.to_string().into_response(),
    }
}

async fn upgrade(State(house): State<House>, upgrade: WebSocketUpgrade) -> Response {
    upgrade
        .max_message_size(LONGEST_MESSAGE)
        .max_frame_size(LONGEST_MESSAGE)
        .on_upgrade(move |socket| connection::serve(socket, house))
}
