//! Clients by QUIC: frames lie on one stream, each after its length.

use std::sync::Arc;
use std::time::Duration;

use quinn::crypto::rustls::QuicServerConfig;
use quinn::{Connection, Endpoint, RecvStream, SendStream, ServerConfig, TransportConfig, VarInt};
use tokio::task::JoinSet;
use tokio::time::{Instant, timeout};

use crate::net::connection::{Door, FAREWELL, Incoming, Outlet, Source, converse};
use crate::net::identity::{Identity, IdentityError};
use crate::session::{Limits, Refusal};
use crate::wire::{MOST_FRAME, WireError};

/// The name of the protocol in the handshake (ALPN).
pub const PROTOCOL: &[u8] = b"casca/1";

/// Bytes of the length before a frame from a client.
const LENGTH: usize = 2;

/// A client may send so many bytes before they are read: some frames.
const UNREAD: u32 = 4096;

/// So many bytes wait for a client that does not confirm them; the queue of answers fills then.
const UNCONFIRMED: u64 = 256 * 1024;

/// What an endpoint goes by.
pub(crate) fn config(identity: &Identity, limits: &Limits) -> Result<ServerConfig, IdentityError> {
    let tls = identity.tls(PROTOCOL)?;
    let no_suite = |_| IdentityError::Tls(rustls::Error::General("no cipher suite for QUIC".to_owned()));
    let crypto = QuicServerConfig::try_from(tls).map_err(no_suite)?;
    let mut config = ServerConfig::with_crypto(Arc::new(crypto));
    let mut transport = TransportConfig::default();
    // One stream, and nothing beside it: all else that a client sends would wait unread.
    transport
        .max_concurrent_bidi_streams(VarInt::from_u32(1))
        .max_concurrent_uni_streams(VarInt::from_u32(0))
        .datagram_receive_buffer_size(None)
        .stream_receive_window(VarInt::from_u32(UNREAD))
        .receive_window(VarInt::from_u32(UNREAD))
        .send_window(UNCONFIRMED);
    // The session is stricter: this ends connections that never came so far.
    let idle = Duration::from_secs_f64(limits.idle.max(limits.hello));
    transport.max_idle_timeout(idle.try_into().ok());
    config.transport_config(Arc::new(transport)).migration(false);
    Ok(config)
}

/// Takes connections until the server stops, and waits for them to end.
pub(crate) async fn listen(endpoint: Endpoint, door: Door) {
    let mut open = JoinSet::new();
    loop {
        let incoming = tokio::select! {
            Some(incoming) = endpoint.accept() => incoming,
            Some(_) = open.join_next() => continue,
            () = door.end() => break,
        };
        // A forged address never takes a seat: its owner does not answer.
        if !incoming.remote_address_validated() {
            let _ = incoming.retry();
            continue;
        }
        match door.seat() {
            Some(seat) => drop(open.spawn(async move { seat.hold(serve(incoming, seat.door())).await })),
            None => incoming.refuse(),
        }
    }
    while open.join_next().await.is_some() {}
    endpoint.close(VarInt::from_u32(Refusal::Stop.code().into()), &[]);
    let _ = timeout(FAREWELL, endpoint.wait_idle()).await;
}

/// A connection, from the handshake to its end.
async fn serve(incoming: quinn::Incoming, door: &Door) -> Result<(), Refusal> {
    let begin = Instant::now();
    let hello = Duration::from_secs_f64(door.options.limits.hello);
    let opened = async {
        let connection = incoming.await.map_err(|_| Refusal::Frame(WireError::Short(0)))?;
        let streams = connection.accept_bi().await.map_err(|_| Refusal::Gone)?;
        Ok((connection, streams))
    };
    let opened = tokio::select! {
        opened = timeout(hello, opened) => opened.unwrap_or(Err(Refusal::Idle)),
        () = door.end() => Err(Refusal::Stop),
    };
    let (connection, (mut outlet, stream)) = opened?;
    let mut frames = Frames { stream, buffer: Vec::new() };
    let result = converse(&mut frames, &mut outlet, door, begin).await;
    leave(&connection, &mut outlet, result).await;
    result
}

/// Ends a connection, when the last frame arrived or took too long.
async fn leave(connection: &Connection, outlet: &mut SendStream, result: Result<(), Refusal>) {
    if !matches!(result, Err(Refusal::Slow | Refusal::Gone)) && outlet.finish().is_ok() {
        let _ = timeout(FAREWELL, outlet.stopped()).await;
    }
    let code = result.err().map_or(0, Refusal::code);
    connection.close(VarInt::from_u32(code.into()), &[]);
}

/// Frames as they lie on a stream.
struct Frames {
    stream: RecvStream,
    /// What was read and not taken: less than a frame, or a few of them.
    buffer: Vec<u8>,
}

impl Frames {
    /// The first frame in the buffer, if all of it is there.
    fn take(&mut self) -> Option<Incoming> {
        let (length, rest) = self.buffer.split_first_chunk::<LENGTH>()?;
        let length = usize::from(u16::from_le_bytes(*length));
        if length > MOST_FRAME {
            return Some(Incoming::Malformed(WireError::Long(length)));
        }
        let frame = rest.get(..length)?.to_vec();
        self.buffer.drain(..LENGTH + length);
        Some(Incoming::Frame(frame))
    }
}

impl Source for Frames {
    /// Bytes are in the buffer as soon as they are read, so that a call may be given up.
    async fn next_frame(&mut self) -> Incoming {
        loop {
            if let Some(incoming) = self.take() {
                return incoming;
            }
            let mut bytes = [0; LENGTH + MOST_FRAME];
            match self.stream.read(&mut bytes).await {
                Ok(Some(count)) => self.buffer.extend_from_slice(&bytes[..count]),
                Ok(None) if !self.buffer.is_empty() => {
                    return Incoming::Malformed(WireError::Short(self.buffer.len()));
                }
                Ok(None) | Err(_) => return Incoming::End,
            }
        }
    }
}

impl Outlet for SendStream {
    async fn send_frame(&mut self, frame: Vec<u8>) -> Result<(), Refusal> {
        let length = u32::try_from(frame.len()).unwrap_or(u32::MAX).to_le_bytes();
        self.write_all(&[&length, frame.as_slice()].concat()).await.map_err(|_| Refusal::Gone)
    }
}
