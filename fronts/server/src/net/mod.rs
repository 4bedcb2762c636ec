//! The front: clients by WebSocket, metrics and a map by HTTP.
//!
//! One thread plays the game, tick by tick, whatever connections do. Each connection has a task of
//! its own, which checks frames, and leaves the last place of its eye for the next tick. Answers go
//! through a short queue: a client that does not read its answers is dropped.

mod connection;
mod game;
mod http;
mod map;
mod metrics;
mod options;

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::sync::{Semaphore, mpsc, watch};
use tokio::task::JoinHandle;

use crate::bots::{Level, LevelError};
use crate::net::connection::{Door, listen};
use crate::net::game::Game;
use crate::net::metrics::Metrics;

pub use crate::net::options::FrontOptions;

/// Why a front cannot start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FrontError {
    /// The level, its options or its bots are refused.
    #[error(transparent)]
    Level(#[from] LevelError),
    /// An address cannot be used.
    #[error("cannot listen: {0}")]
    Io(#[from] io::Error),
}

/// A server that runs.
#[derive(Debug)]
pub struct Front {
    clients: SocketAddr,
    http: SocketAddr,
    stop: watch::Sender<bool>,
    tasks: Vec<JoinHandle<()>>,
    game: Option<std::thread::JoinHandle<()>>,
    metrics: Arc<Metrics>,
}

/// Commands that may wait for a tick: more wait in their tasks.
const COMMANDS: usize = 1024;

/// How long connections have to end when the server stops.
const FAREWELL: Duration = Duration::from_secs(3);

impl Front {
    /// Starts to listen and to play.
    ///
    /// # Errors
    /// Refuses addresses that cannot be listened at, and levels and options that the server refuses.
    pub async fn start(level: Level, options: FrontOptions) -> Result<Self, FrontError> {
        let metrics = Arc::new(Metrics::new());
        let listener = TcpListener::bind(options.clients).await?;
        let pages = TcpListener::bind(options.http).await?;
        let (clients, http) = (listener.local_addr()?, pages.local_addr()?);
        let (commands, orders) = mpsc::channel(COMMANDS);
        let (stop, stopped) = watch::channel(false);
        let map = Arc::new(map::Map::new(&level));
        let game = Game::new(level, &options, metrics.clone(), map.clone())
            .map_err(|error| FrontError::Level(error.into()))?;
        let game = {
            let stopped = stopped.clone();
            std::thread::Builder::new().name("game".to_owned()).spawn(move || game.play(orders, &stopped))?
        };
        let seats = Arc::new(Semaphore::new(options.connections.min(Semaphore::MAX_PERMITS)));
        let door = Door { options, commands, metrics: metrics.clone(), stopped: stopped.clone(), seats };
        let pages = tokio::spawn(http::listen(pages, metrics.clone(), map, stopped));
        let tasks = vec![pages, tokio::spawn(listen(listener, door))];
        tracing::info!(%clients, %http, "listening");
        Ok(Self { clients, http, stop, tasks, game: Some(game), metrics })
    }

    /// Where clients connect by WebSocket.
    pub fn clients(&self) -> SocketAddr {
        self.clients
    }

    /// Where metrics and the map are.
    pub fn http(&self) -> SocketAddr {
        self.http
    }

    /// The metrics as Prometheus reads them.
    pub fn metrics(&self) -> String {
        self.metrics.text()
    }

    /// Tells all clients, ends their connections, and waits for all that it started.
    pub async fn stop(mut self) {
        let _ = self.stop.send(true);
        for task in self.tasks.drain(..) {
            let _ = tokio::time::timeout(FAREWELL, task).await;
        }
        if let Some(game) = self.game.take() {
            let _ = tokio::task::spawn_blocking(move || game.join()).await;
        }
        tracing::info!("stopped");
    }
}
