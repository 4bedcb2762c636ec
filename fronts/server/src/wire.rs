//! The frames of the protocol, version 1: see `PROTOCOL.md`. All numbers are little endian.

use casca::Aabb;
use casca::glam::Vec3;

use crate::id::EntityId;
use crate::numeric::FARTHEST;
use crate::server::{Answer, VisibilityServer};

/// The version of the protocol.
pub const VERSION: u16 = 1;

/// The first bytes of a hello.
pub const MAGIC: [u8; 4] = *b"CASC";

/// Tokens are at most so long, in bytes.
pub const MOST_TOKEN: usize = 64;

/// The most bytes of a frame from a client.
pub const MOST_FRAME: usize = 128;

const HELLO: u8 = 0x01;
const EYE: u8 = 0x02;
const PING: u8 = 0x03;
const WELCOME: u8 = 0x81;
const ANSWER: u8 = 0x82;
const PONG: u8 = 0x83;
const BYE: u8 = 0x8f;

/// Why a frame is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WireError {
    /// It ends too early.
    #[error("the frame ends after {0} bytes")]
    Short(usize),
    /// Bytes follow after its end.
    #[error("{0} bytes follow after the end of the frame")]
    Trailing(usize),
    /// It is too long.
    #[error("the frame has {0} bytes, more than {MOST_FRAME}")]
    Long(usize),
    /// Its first byte is none of the kinds.
    #[error("frames of the kind {0:#04x} are not known")]
    Kind(u8),
    /// A hello of something else.
    #[error("the hello does not begin with the letters CASC")]
    Magic,
    /// A hello of another version.
    #[error("the client speaks version {0}, the server {VERSION}")]
    Version(u16),
    /// A token that is too long.
    #[error("the token has {0} bytes, more than {MOST_TOKEN}")]
    Token(usize),
    /// A place that is not finite or too far.
    #[error("the eye is not finite, or farther than {FARTHEST} m from the origin")]
    Place,
}

/// A frame from a client.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ToServer<'a> {
    /// The first frame.
    Hello {
        /// Proves that the client may come in.
        token: &'a [u8],
        /// The latency that it claims, in milliseconds.
        latency: u16,
    },
    /// Where its eye is.
    Eye {
        /// Grows from report to report.
        sequence: u32,
        /// The place, in metres.
        eye: Vec3,
    },
    /// Asks for a pong with the same number.
    Ping(u64),
}

/// A frame to a client.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ToClient {
    /// Answers a hello.
    Welcome {
        /// The key of the client.
        client: u64,
        /// The key of its entity.
        entity: u64,
        /// The time from tick to tick, in microseconds.
        tick: u32,
        /// The greatest speed of its eye, in metres a second.
        speed: f32,
        /// Where its eye is.
        eye: Vec3,
    },
    /// What it is told in a tick.
    Answer(AnswerFrame),
    /// Answers a ping.
    Pong(u64),
    /// The connection ends, for the reason of this number.
    Bye(u8),
}

/// What a client is told in a tick.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AnswerFrame {
    /// The number of the tick.
    pub tick: u64,
    /// Whether all that it knew is to be forgotten.
    pub fresh: bool,
    /// Keys of entities to be forgotten.
    pub forgotten: Vec<u64>,
    /// Keys and boxes of entities that it was not told of before.
    pub new: Vec<(u64, Aabb)>,
    /// Keys and least corners of the boxes of all others.
    pub moved: Vec<(u64, Vec3)>,
}

impl AnswerFrame {
    /// An answer of a server in a tick, with where it knows the entities to be.
    pub fn of(server: &VisibilityServer, answer: &Answer, tick: u64) -> Self {
        let bounds = |id: &EntityId| server.entity(*id).ok().map(|entity| (id.key(), entity.bounds));
        let (new, forgotten): (_, &[EntityId]) = match answer.is_fresh {
            true => (&answer.told, &[]),
            false => (&answer.new, &answer.forgotten),
        };
        let old = answer.told.iter().filter(|id| new.binary_search(id).is_err());
        Self {
            tick,
            fresh: answer.is_fresh,
            forgotten: forgotten.iter().map(|id| id.key()).collect(),
            new: new.iter().filter_map(bounds).collect(),
            moved: old.filter_map(bounds).map(|(key, b)| (key, b.min)).collect(),
        }
    }
}

/// Bytes that are read.
struct Input<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Input<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], WireError> {
        let end = self.at.saturating_add(count);
        let taken = self.bytes.get(self.at..end).ok_or(WireError::Short(self.bytes.len()))?;
        self.at = end;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], WireError> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(N)?);
        Ok(out)
    }

    fn float(&mut self) -> Result<f32, WireError> {
        self.array().map(f32::from_le_bytes)
    }

    fn vector(&mut self) -> Result<Vec3, WireError> {
        Ok(Vec3::new(self.float()?, self.float()?, self.float()?))
    }

    fn key(&mut self) -> Result<u64, WireError> {
        self.array().map(u64::from_le_bytes)
    }

    /// As many values as a number of 16 bits says. Memory is taken for those that are there only.
    fn list<T>(&mut self, item: impl Fn(&mut Self) -> Result<T, WireError>) -> Result<Vec<T>, WireError> {
        let count = u16::from_le_bytes(self.array()?);
        (0..count).map(|_| item(self)).collect()
    }

    fn end(self) -> Result<(), WireError> {
        match self.bytes.len() - self.at {
            0 => Ok(()),
            rest => Err(WireError::Trailing(rest)),
        }
    }
}

impl<'a> ToServer<'a> {
    /// Reads a frame.
    ///
    /// # Errors
    /// Refuses all that is no whole frame, and places that are not finite.
    pub fn decode(bytes: &'a [u8]) -> Result<Self, WireError> {
        if bytes.len() > MOST_FRAME {
            return Err(WireError::Long(bytes.len()));
        }
        let mut input = Input { bytes, at: 0 };
        let frame = match input.array()? {
            [HELLO] => {
                if input.array()? != MAGIC {
                    return Err(WireError::Magic);
                }
                let version = u16::from_le_bytes(input.array()?);
                if version != VERSION {
                    return Err(WireError::Version(version));
                }
                let latency = u16::from_le_bytes(input.array()?);
                let [length] = input.array()?;
                if usize::from(length) > MOST_TOKEN {
                    return Err(WireError::Token(length.into()));
                }
                Self::Hello { token: input.take(length.into())?, latency }
            }
            [EYE] => {
                let sequence = u32::from_le_bytes(input.array()?);
                let eye = input.vector()?;
                // NaN is no number of the range.
                if !eye.to_array().iter().all(|c| c.abs() <= FARTHEST) {
                    return Err(WireError::Place);
                }
                Self::Eye { sequence, eye }
            }
            [PING] => Self::Ping(input.key()?),
            [kind] => return Err(WireError::Kind(kind)),
        };
        input.end()?;
        Ok(frame)
    }

    /// The bytes of the frame. A token is cut off after [`MOST_TOKEN`] bytes.
    pub fn encode(&self) -> Vec<u8> {
        match self {
            Self::Hello { token, latency } => {
                let token = &token[..token.len().min(MOST_TOKEN)];
                let head = [MAGIC.as_slice(), &VERSION.to_le_bytes(), &latency.to_le_bytes()].concat();
                [&[HELLO], head.as_slice(), &[token.len() as u8], token].concat()
            }
            Self::Eye { sequence, eye } => {
                let mut out = vec![EYE];
                out.extend(sequence.to_le_bytes());
                put(&mut out, *eye);
                out
            }
            Self::Ping(number) => [[PING].as_slice(), &number.to_le_bytes()].concat(),
        }
    }
}

fn put(out: &mut Vec<u8>, v: Vec3) {
    out.extend(v.to_array().into_iter().flat_map(f32::to_le_bytes));
}

/// The most entries of a list in an answer.
const MOST_LISTED: usize = u16::MAX as usize;

fn put_list<T>(out: &mut Vec<u8>, list: &[T], item: impl Fn(&mut Vec<u8>, &T)) {
    let list = &list[..list.len().min(MOST_LISTED)];
    out.extend((list.len() as u16).to_le_bytes());
    list.iter().for_each(|entry| item(out, entry));
}

impl ToClient {
    /// The bytes of the frame. Lists are cut off after 65,535 entries.
    pub fn encode(&self) -> Vec<u8> {
        match self {
            Self::Welcome { client, entity, tick, speed, eye } => {
                let mut out = vec![WELCOME];
                out.extend(VERSION.to_le_bytes());
                out.extend(client.to_le_bytes());
                out.extend(entity.to_le_bytes());
                out.extend(tick.to_le_bytes());
                out.extend(speed.to_le_bytes());
                put(&mut out, *eye);
                out
            }
            Self::Answer(AnswerFrame { tick, fresh, forgotten, new, moved }) => {
                let mut out = vec![ANSWER];
                out.extend(tick.to_le_bytes());
                out.push(u8::from(*fresh));
                put_list(&mut out, forgotten, |out, key| out.extend(key.to_le_bytes()));
                put_list(&mut out, new, |out, (key, b)| {
                    out.extend(key.to_le_bytes());
                    put(out, b.min);
                    put(out, b.max);
                });
                put_list(&mut out, moved, |out, (key, corner)| {
                    out.extend(key.to_le_bytes());
                    put(out, *corner);
                });
                out
            }
            Self::Pong(number) => [[PONG].as_slice(), &number.to_le_bytes()].concat(),
            Self::Bye(reason) => vec![BYE, *reason],
        }
    }

    /// Reads a frame, as a client does.
    ///
    /// # Errors
    /// Refuses all that is no whole frame.
    pub fn decode(bytes: &[u8]) -> Result<Self, WireError> {
        let mut input = Input { bytes, at: 0 };
        let frame = match input.array()? {
            [WELCOME] => {
                let version = u16::from_le_bytes(input.array()?);
                if version != VERSION {
                    return Err(WireError::Version(version));
                }
                let (client, entity) = (input.key()?, input.key()?);
                let tick = u32::from_le_bytes(input.array()?);
                Self::Welcome { client, entity, tick, speed: input.float()?, eye: input.vector()? }
            }
            [ANSWER] => {
                let tick = input.key()?;
                let [flags] = input.array()?;
                let forgotten = input.list(Input::key)?;
                let new = input.list(|i| Ok((i.key()?, Aabb::new(i.vector()?, i.vector()?))))?;
                let moved = input.list(|i| Ok((i.key()?, i.vector()?)))?;
                Self::Answer(AnswerFrame { tick, fresh: flags & 1 == 1, forgotten, new, moved })
            }
            [PONG] => Self::Pong(input.key()?),
            [BYE] => Self::Bye(u8::from_le_bytes(input.array()?)),
            [kind] => return Err(WireError::Kind(kind)),
        };
        input.end()?;
        Ok(frame)
    }
}
