//! Clients by WebSocket: each binary message is a frame.

use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use tokio::net::TcpStream;
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::{Error, Message};

use crate::session::Refusal;
use crate::wire::WireError;

/// Frames from a client, and to it.
pub(crate) type Reader = SplitStream<WebSocketStream<TcpStream>>;
pub(crate) type Writer = SplitSink<WebSocketStream<TcpStream>, Message>;

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
