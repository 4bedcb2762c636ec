//! The reasons for which calls are refused.

use crate::id::{ClientId, EntityId};

/// Why a call was refused. The server is left as it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ServerError {
    /// A number that is not finite, or out of its range.
    #[error("{what} must be from {least} to {most}, not {value}")]
    Range {
        /// The argument.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The least value allowed.
        least: f64,
        /// The greatest value allowed.
        most: f64,
    },
    /// A box whose least corner lies beyond its greatest.
    #[error("{0} must not be inverted")]
    Inverted(&'static str),
    /// A time before one that was given already.
    #[error("{what} must not be before {last} s, but is {given} s")]
    Backwards {
        /// The argument.
        what: &'static str,
        /// The time given, in seconds.
        given: f64,
        /// The latest time given before, in seconds.
        last: f64,
    },
    /// The client left, or is another server's.
    #[error("{0} is not a client of this server: it left, or is another server's")]
    UnknownClient(ClientId),
    /// The entity was removed, or is another server's.
    #[error("{0} is not an entity of this server: it was removed, or is another server's")]
    UnknownEntity(EntityId),
    /// As many as the options allow.
    #[error("there are {most} {what} already, as many as the options allow")]
    Full {
        /// Of which there are too many.
        what: &'static str,
        /// The limit.
        most: usize,
    },
    /// The bytes are no file of baked sets.
    #[error(transparent)]
    Baked(#[from] casca_baked::ReadError),
    /// The file holds sets of objects.
    #[error("the file holds sets of objects, not from cell to cell: see casca bake --cell-to-cell")]
    NotCellToCell,
}

/// A number that must lie in a range.
pub(crate) fn within(what: &'static str, value: f32, least: f32, most: f32) -> Result<(), ServerError> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    let [value, least, most] = [value, least, most].map(f64::from);
    Err(ServerError::Range { what, value, least, most })
}

/// A time, which must not be before another.
pub(crate) fn time(what: &'static str, given: f64, last: f64) -> Result<(), ServerError> {
    if !given.is_finite() {
        return Err(ServerError::Range { what, value: given, least: f64::MIN, most: f64::MAX });
    }
    if given < last { Err(ServerError::Backwards { what, given, last }) } else { Ok(()) }
}
