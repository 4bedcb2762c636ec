//! Connections of clients.

use std::sync::Arc;
use std::time::Duration;

use futures_util::{Sink, SinkExt, StreamExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, mpsc, oneshot, watch};
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

/// What all connections share.
#[derive(Debug, Clone)]
pub(crate) struct Door {
    pub(crate) options: FrontOptions,
    pub(crate) commands: mpsc::Sender<Command>,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) stopped: watch::Receiver<bool>,
}

/// Takes connections until the server stops, and waits for them to end.
pub(crate) async fn listen(listener: TcpListener, door: Door) {
    let seats = Arc::new(Semaphore::new(door.options.connections));
    let mut stopped = door.stopped.clone();
    let mut open = tokio::task::JoinSet::new();
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            Some(_) = open.join_next() => continue,
            () = end(&mut stopped) => break,
        };
        let Ok((stream, _)) = accepted else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        let Ok(seat) = seats.clone().try_acquire_owned() else {
            drop_for(&door.metrics, Refusal::Full);
            continue;
        };
        let door = door.clone();
        open.spawn(async move {
            door.metrics.connections.inc();
            if let Err(refusal) = serve(stream, &door).await {
                drop_for(&door.metrics, refusal);
            }
            door.metrics.connections.dec();
            drop(seat);
        });
    }
    drop(listener);
    while open.join_next().await.is_some() {}
}

fn drop_for(metrics: &Metrics, refusal: Refusal) {
    tracing::debug!(%refusal, "a connection was dropped");
    metrics.dropped(refusal);
}

/// A connection, from the handshake to its end.
async fn serve(stream: TcpStream, door: &Door) -> Result<(), Refusal> {
    let _ = stream.set_nodelay(true);
    let config = WebSocketConfig::default()
        .max_message_size(Some(MOST_FRAME))
        .max_frame_size(Some(MOST_FRAME))
        .write_buffer_size(0);
    let begin = Instant::now();
    let hello = Duration::from_secs_f64(door.options.limits.hello);
    let shake = tokio_tungstenite::accept_async_with_config(stream, Some(config));
    let mut socket = match timeout(hello, shake).await {
        Ok(Ok(socket)) => socket,
        Ok(Err(_)) => return Err(Refusal::Frame(WireError::Short(0))),
        Err(_) => return Err(Refusal::Idle),
    };
    let mut client = None;
    let result = talk(&mut socket, door, begin, &mut client).await;
    if let Some(client) = client {
        let _ = door.commands.send(Command::Leave(client)).await;
    }
    if let Err(refusal) = result
        && !matches!(refusal, Refusal::Slow | Refusal::Gone)
    {
        let bye = ToClient::Bye(refusal.code()).encode();
        let farewell = async {
            let _ = socket.send(Message::binary(bye)).await;
            let _ = socket.close(None).await;
        };
        let _ = timeout(Duration::from_millis(200), farewell).await;
    }
    result
}

/// Reads and writes until one side ends it.
async fn talk(
    socket: &mut WebSocketStream<TcpStream>,
    door: &Door,
    begin: Instant,
    client: &mut Option<ClientId>,
) -> Result<(), Refusal> {
    let (answers, mut queue) = mpsc::channel(door.options.queue.max(1));
    let link = Arc::new(Link { eye: Default::default(), answers });
    // The game holds the other one: when it lets go, the queue ends.
    let (link, shared) = (Arc::downgrade(&link), link);
    let mut shared = Some(shared);
    let mut stopped = door.stopped.clone();
    let (mut sink, mut source) = socket.split();
    let mut session = Session::new(door.options.token.clone(), door.options.limits, 0.0);
    loop {
        let deadline = begin + Duration::from_secs_f64(session.deadline());
        let next = tokio::select! {
            message = source.next() => Next::Message(message),
            answer = queue.recv(), if client.is_some() => Next::Answer(answer),
            () = sleep_until(deadline) => return Err(Refusal::Idle),
            () = end(&mut stopped) => return Err(Refusal::Stop),
        };
        let message = match next {
            Next::Message(message) => message,
            Next::Answer(Some(answer)) => {
                write(&mut sink, answer).await?;
                continue;
            }
            // The game let go.
            Next::Answer(None) if *door.stopped.borrow() => return Err(Refusal::Stop),
            Next::Answer(None) => return Err(Refusal::Slow),
        };
        let now = begin.elapsed().as_secs_f64();
        let frame = match message {
            Some(Ok(Message::Binary(frame))) => frame,
            Some(Ok(Message::Ping(_) | Message::Pong(_))) => {
                session.count(now)?;
                continue;
            }
            Some(Ok(Message::Close(_))) | None | Some(Err(Error::Io(_) | Error::ConnectionClosed)) => {
                return Ok(());
            }
            Some(Ok(_) | Err(_)) => return Err(Refusal::Frame(WireError::Short(0))),
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
                write(&mut sink, welcome).await?;
            }
            Event::Eye(eye) => {
                if let Some(link) = link.upgrade() {
                    *link.eye.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(eye);
                }
            }
            Event::Ping(number) => write(&mut sink, ToClient::Pong(number).encode()).await?,
            Event::Old => {}
        }
    }
}

/// What comes next in a connection.
enum Next {
    Message(Option<Result<Message, Error>>),
    Answer(Option<Vec<u8>>),
}

/// Waits until the server stops.
async fn end(stopped: &mut watch::Receiver<bool>) {
    let _ = stopped.wait_for(|stopped| *stopped).await;
}

async fn write(
    sink: &mut (impl Sink<Message, Error = Error> + Unpin),
    frame: Vec<u8>,
) -> Result<(), Refusal> {
    match timeout(WRITE, sink.send(Message::binary(frame))).await {
        Ok(Ok(())) => Ok(()),
        Ok(Err(_)) => Err(Refusal::Gone),
        Err(_) => Err(Refusal::Slow),
    }
}
