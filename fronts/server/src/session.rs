//! What a connection may do, frame by frame, without a network.

use casca::glam::Vec3;
use subtle::ConstantTimeEq;

use crate::wire::{ToServer, WireError};

/// The secret that lets clients in. It is compared in constant time, and not printed.
#[derive(Clone)]
pub struct Token(Vec<u8>);

impl Token {
    /// A token of 1 to [`MOST_TOKEN`](crate::wire::MOST_TOKEN) bytes.
    pub fn new(bytes: impl Into<Vec<u8>>) -> Option<Self> {
        let bytes = bytes.into();
        (1..=crate::wire::MOST_TOKEN).contains(&bytes.len()).then_some(Self(bytes))
    }

    /// Whether some bytes are the token. The time does not tell how many of them are right; it does
    /// tell the length.
    pub fn is(&self, bytes: &[u8]) -> bool {
        self.0.ct_eq(bytes).into()
    }
}

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Token")
    }
}

/// What a connection may cost.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// The most frames a second in the long run. Default: 120.
    pub frames: f64,
    /// The most frames at once. Default: 60.
    pub burst: f64,
    /// A client that sends no frame for so long is dropped, in seconds. Default: 10.
    pub idle: f64,
    /// A connection without a hello is dropped after so long, in seconds. Default: 5.
    pub hello: f64,
    /// The greatest latency that is believed, in milliseconds: who claims more is told of more.
    /// Default: 250.
    pub latency: u16,
}

impl Default for Limits {
    fn default() -> Self {
        Self { frames: 120.0, burst: 60.0, idle: 10.0, hello: 5.0, latency: 250 }
    }
}

/// Why a connection ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// A frame is malformed.
    #[error(transparent)]
    Frame(#[from] WireError),
    /// The token is wrong.
    #[error("the token is wrong")]
    Token,
    /// A second hello, or another frame before the first.
    #[error("a frame came out of order")]
    Order,
    /// Too many frames.
    #[error("too many frames came")]
    Flood,
    /// No frame for too long.
    #[error("no frame came for too long")]
    Idle,
    /// It reads its answers too slowly.
    #[error("answers are not read")]
    Slow,
    /// The server has as many clients as it may.
    #[error("the server is full")]
    Full,
    /// The server stops.
    #[error("the server stops")]
    Stop,
    /// The other side is gone: nobody is told.
    #[error("the client is gone")]
    Gone,
}

impl Refusal {
    /// The number that says it in a last frame.
    pub fn code(self) -> u8 {
        match self {
            Self::Frame(_) => 1,
            Self::Token => 2,
            Self::Order => 3,
            Self::Flood => 4,
            Self::Idle => 5,
            Self::Slow => 6,
            Self::Full => 7,
            Self::Stop => 8,
            Self::Gone => 9,
        }
    }
}

/// What a frame asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// The client comes in, with a latency in seconds.
    Join {
        /// What it claims, as far as it is believed.
        latency: f32,
    },
    /// Its eye is there.
    Eye(Vec3),
    /// It wants a pong.
    Ping(u64),
    /// An old report, which is passed over.
    Old,
}

/// The state of a connection.
#[derive(Debug, Clone)]
pub struct Session {
    token: Token,
    limits: Limits,
    joined: bool,
    /// The sequence of the last report.
    sequence: Option<u32>,
    /// How many frames may come now.
    credit: f64,
    /// When the last frame came, or the connection began.
    last: f64,
}

impl Session {
    /// A connection that begins at the time `now`, in seconds.
    pub fn new(token: Token, limits: Limits, now: f64) -> Self {
        Self { token, limits, joined: false, sequence: None, credit: limits.burst, last: now }
    }

    /// Takes a frame that came at the time `now`, in seconds.
    ///
    /// # Errors
    /// Refuses malformed frames, wrong tokens, frames out of order, and too many of them: the
    /// connection is to be closed then.
    pub fn take(&mut self, frame: &[u8], now: f64) -> Result<Event, Refusal> {
        self.count(now)?;
        match (ToServer::decode(frame)?, self.joined) {
            (ToServer::Hello { token, latency }, false) => {
                if !self.token.is(token) {
                    return Err(Refusal::Token);
                }
                self.joined = true;
                Ok(Event::Join { latency: f32::from(latency.min(self.limits.latency)) / 1000.0 })
            }
            (ToServer::Hello { .. }, true) | (_, false) => Err(Refusal::Order),
            (ToServer::Eye { sequence, eye }, true) => {
                if self.sequence.is_some_and(|last| sequence <= last) {
                    return Ok(Event::Old);
                }
                self.sequence = Some(sequence);
                Ok(Event::Eye(eye))
            }
            (ToServer::Ping(number), true) => Ok(Event::Ping(number)),
        }
    }

    /// Counts a frame that says nothing, such as a ping of the transport.
    ///
    /// # Errors
    /// Refuses too many frames.
    pub fn count(&mut self, now: f64) -> Result<(), Refusal> {
        let passed = (now - self.last).max(0.0);
        self.credit = (self.credit + passed * self.limits.frames).min(self.limits.burst) - 1.0;
        self.last = self.last.max(now);
        if self.credit < 0.0 { Err(Refusal::Flood) } else { Ok(()) }
    }

    /// When the connection is to be closed if no frame comes, in seconds.
    pub fn deadline(&self) -> f64 {
        self.last + if self.joined { self.limits.idle } else { self.limits.hello }
    }

    /// Whether it said hello with the right token.
    pub fn has_joined(&self) -> bool {
        self.joined
    }
}
