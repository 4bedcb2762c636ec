//! Clients by WebSocket: each binary message is a frame.

use std::time::Duration;

use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinSet;
use tokio::time::timeout;
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::tungstenite::{Error, Message};

use crate::net::connection::{Door, FAREWELL, PAUSE, converse};
use crate::session::Refusal;
use crate::wire::{MOST_FRAME, WireError};

/// Frames from a client, and to it.
pub(crate) type Reader = SplitStream<WebSocketStream<TcpStream>>;
pub(crate) type Writer = SplitSink<WebSocketStream<TcpStream>, Message>;

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
        if let Some(seat) = door.seat() {
            open.spawn(async move { seat.hold(serve(stream, seat.door())).await });
        }
    }
    drop(listener);
    while open.join_next().await.is_some() {}
}

/// A connection, from the handshake to its end.
async fn serve(stream: TcpStream, door: &Door) -> Result<(), Refusal> {
    let _ = stream.set_nodelay(true);
    let config = WebSocketConfig::default()
        .max_message_size(Some(MOST_FRAME))
        .max_frame_size(Some(MOST_FRAME))
        .write_buffer_size(0);
    let begin = tokio::time::Instant::now();
    let hello = Duration::from_secs_f64(door.options.limits.hello);
    let shake = tokio_tungstenite::accept_async_with_config(stream, Some(config));
    let socket = match timeout(hello, shake).await {
        Ok(Ok(socket)) => socket,
        Ok(Err(_)) => return Err(Refusal::Frame(WireError::Short(0))),
        Err(_) => return Err(Refusal::Idle),
    };
    let (mut sink, mut source) = socket.split();
    let result = converse(&mut source, &mut sink, door, begin).await;
    if result.is_err_and(|refusal| !matches!(refusal, Refusal::Slow | Refusal::Gone)) {
        let _ = timeout(FAREWELL, sink.close()).await;
    }
    result
}

/// What comes from a client.
pub(crate) enum Incoming {
    Frame(Vec<u8>),
    /// A message of the transport, which counts as a frame.
    Nothing,
    End,
    Malformed(WireError),
}

/// The next frame. A call that is given up loses nothing.
pub(crate) async fn next_frame(source: &mut Reader) -> Incoming {
    match source.next().await {
        Some(Ok(Message::Binary(frame))) => Incoming::Frame(frame.into()),
        Some(Ok(Message::Ping(_) | Message::Pong(_))) => Incoming::Nothing,
        Some(Ok(Message::Close(_))) | None | Some(Err(Error::Io(_) | Error::ConnectionClosed)) => {
            Incoming::End
        }
        Some(Ok(_) | Err(_)) => Incoming::Malformed(WireError::Short(0)),
    }
}

pub(crate) async fn send_frame(outlet: &mut Writer, frame: Vec<u8>) -> Result<(), Refusal> {
    outlet.send(Message::binary(frame)).await.map_err(|_| Refusal::Gone)
}
