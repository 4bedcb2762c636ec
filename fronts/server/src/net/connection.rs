//! Connections of clients.

use std::sync::Arc;
use std::time::Duration;

use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, mpsc, oneshot, watch};
use tokio::task::JoinSet;
use tokio::time::{Instant, sleep_until, timeout};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::tungstenite::{Error, Message};

use crate::id::ClientId;
use crate::net::game::{Command, Link};
use crate::net::metrics::Metrics;
use crate::net::options::FrontOptions;
use crate::session::{Event, Refusal, Session};
use crate::wire::{MOST_FRAME, ToClient, WireError};

/// A message that takes longer to be written ends the connection.
const WRITE: Duration = Duration::from_secs(2);

/// Pause after a connection could not be accepted: there may be no file descriptors left.
const PAUSE: Duration = Duration::from_millis(50);

/// How long a last frame may take.
const FAREWELL: Duration = Duration::from_millis(200);

/// What all connections share.
#[derive(Debug, Clone)]
pub(crate) struct Door {
    pub(crate) options: FrontOptions,
    pub(crate) commands: mpsc::Sender<Command>,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) stopped: watch::Receiver<bool>,
    /// One for each connection that may be open.
    pub(crate) seats: Arc<Semaphore>,
}

impl Door {
    /// Waits until the server stops.
    async fn end(&self) {
        let _ = self.stopped.clone().wait_for(|stopped| *stopped).await;
    }

    fn note(&self, refusal: Refusal) {
        tracing::debug!(%refusal, "a connection was dropped");
        self.metrics.dropped(refusal);
    }
}

/// Takes connections until the server stops, and waits for them to end.
pub(crate) async fn listen(listener: TcpListener, door: Door) {
    let mut open = JoinSet::new();
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            Some(_) = open.join_next() => continue,
            () = door.end() => break,
        };
        let Ok((stream, _)) = accepted else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        let Ok(seat) = door.seats.clone().try_acquire_owned() else {
            door.note(Refusal::Full);
            continue;
        };
        let door = door.clone();
        open.spawn(async move {
            door.metrics.connections.inc();
            if let Err(refusal) = serve(stream, &door).await {
                door.note(refusal);
            }
            door.metrics.connections.dec();
            drop(seat);
        });
    }
    drop(listener);
    while open.join_next().await.is_some() {}
}

/// A connection, from the handshake to its end, with a goodbye.
async fn serve(stream: TcpStream, door: &Door) -> Result<(), Refusal> {
    let _ = stream.set_nodelay(true);
    let config = WebSocketConfig::default()
        .max_message_size(Some(MOST_FRAME))
        .max_frame_size(Some(MOST_FRAME))
        .write_buffer_size(0);
    let begin = Instant::now();
    let hello = Duration::from_secs_f64(door.options.limits.hello);
    let shake = tokio_tungstenite::accept_async_with_config(stream, Some(config));
    let socket = match timeout(hello, shake).await {
        Ok(Ok(socket)) => socket,
        Ok(Err(_)) => return Err(Refusal::Frame(WireError::Short(0))),
        Err(_) => return Err(Refusal::Idle),
    };
    let (mut sink, mut source) = socket.split();
    let mut client = None;
    let result = talk(&mut source, &mut sink, door, begin, &mut client).await;
    if let Some(client) = client {
        let _ = door.commands.send(Command::Leave(client)).await;
    }
    if let Err(refusal) = result
        && !matches!(refusal, Refusal::Slow | Refusal::Gone)
    {
        let bye = ToClient::Bye(refusal.code()).encode();
        let _ = timeout(FAREWELL, send_frame(&mut sink, bye)).await;
        let _ = timeout(FAREWELL, sink.close()).await;
    }
    result
}

/// Reads and writes until one side ends it.
async fn talk(
    source: &mut Reader,
    outlet: &mut Writer,
    door: &Door,
    begin: Instant,
    client: &mut Option<ClientId>,
) -> Result<(), Refusal> {
    let (answers, mut queue) = mpsc::channel(door.options.queue.max(1));
    let link = Arc::new(Link { eye: Default::default(), answers });
    // The game holds the other one: when it lets go, the queue ends.
    let (link, shared) = (Arc::downgrade(&link), link);
    let mut shared = Some(shared);
    let mut session = Session::new(door.options.token.clone(), door.options.limits, 0.0);
    loop {
        let deadline = begin + Duration::from_secs_f64(session.deadline());
        let next = tokio::select! {
            incoming = next_frame(source) => Next::Incoming(incoming),
            answer = queue.recv(), if client.is_some() => Next::Answer(answer),
            () = sleep_until(deadline) => return Err(Refusal::Idle),
            () = door.end() => return Err(Refusal::Stop),
        };
        let incoming = match next {
            Next::Incoming(incoming) => incoming,
            Next::Answer(Some(answer)) => {
                write(outlet, answer).await?;
                continue;
            }
            // The game let go.
            Next::Answer(None) if *door.stopped.borrow() => return Err(Refusal::Stop),
            Next::Answer(None) => return Err(Refusal::Slow),
        };
        let now = begin.elapsed().as_secs_f64();
        let frame = match incoming {
            Incoming::Frame(frame) => frame,
            Incoming::Nothing => {
                session.count(now)?;
                continue;
            }
            Incoming::End => return Ok(()),
            Incoming::Malformed(error) => return Err(error.into()),
        };
        door.metrics.frames.inc();
        match session.take(&frame, now)? {
            Event::Join { latency } => {
                let (reply, joined) = oneshot::channel();
                let link = shared.take().ok_or(Refusal::Order)?;
                let join = Command::Join { latency, link, reply };
                door.commands.send(join).await.map_err(|_| Refusal::Stop)?;
                let (id, welcome) = joined.await.map_err(|_| Refusal::Stop)?.ok_or(Refusal::Full)?;
                *client = Some(id);
                write(outlet, welcome).await?;
            }
            Event::Eye(eye) => {
                if let Some(link) = link.upgrade() {
                    *link.eye.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(eye);
                }
            }
            Event::Ping(number) => write(outlet, ToClient::Pong(number).encode()).await?,
            Event::Old => {}
        }
    }
}

/// What comes next in a connection.
enum Next {
    Incoming(Incoming),
    Answer(Option<Vec<u8>>),
}

async fn write(outlet: &mut Writer, frame: Vec<u8>) -> Result<(), Refusal> {
    timeout(WRITE, send_frame(outlet, frame)).await.unwrap_or(Err(Refusal::Slow))
}

/// Frames from a client, and to it.
type Reader = SplitStream<WebSocketStream<TcpStream>>;
type Writer = SplitSink<WebSocketStream<TcpStream>, Message>;

/// What comes from a client: each binary message is a frame.
enum Incoming {
    Frame(Vec<u8>),
    /// A message of the transport, which counts as a frame.
    Nothing,
    End,
    Malformed(WireError),
}

/// The next frame. A call that is given up loses nothing.
async fn next_frame(source: &mut Reader) -> Incoming {
    match source.next().await {
        Some(Ok(Message::Binary(frame))) => Incoming::Frame(frame.into()),
        Some(Ok(Message::Ping(_) | Message::Pong(_))) => Incoming::Nothing,
        Some(Ok(Message::Close(_))) | None | Some(Err(Error::Io(_) | Error::ConnectionClosed)) => {
            Incoming::End
        }
        Some(Ok(_) | Err(_)) => Incoming::Malformed(WireError::Short(0)),
    }
}

async fn send_frame(outlet: &mut Writer, frame: Vec<u8>) -> Result<(), Refusal> {
    outlet.send(Message::binary(frame)).await.map_err(|_| Refusal::Gone)
}
