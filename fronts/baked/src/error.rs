//! Why files are refused.

use core::fmt;

/// Why bytes are no file of baked visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReadError {
    /// The first bytes are others.
    NotBaked,
    /// It is of a version that this one cannot read.
    Version(u32),
    /// Its sets hold something that this version does not know, or cells of another number than the
    /// grid has.
    Kind(u32),
    /// It is shorter or longer than it says.
    Length {
        /// Bytes that it must have at least.
        needed: u64,
        /// Bytes that there are.
        given: u64,
    },
    /// Bytes were changed: the checksum is another one.
    Checksum,
    /// The grid has no cells, too many, or numbers that are not finite.
    Cells,
    /// A cell has a set that is not there.
    Cell(u32),
    /// A set is none: its bytes make no list of objects that are there, or it differs from a set
    /// that does not come before it.
    Set(u32),
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotBaked => write!(f, "this is no file of baked visibility"),
            Self::Version(version) => write!(f, "the file is of version {version}, not {}", crate::VERSION),
            Self::Kind(kind) => write!(
                f,
                "its sets hold things of the unknown kind {kind}, or not as many as the grid has cells"
            ),
            Self::Length { needed, given } => {
                write!(f, "the file has {given} bytes where {needed} are needed: was it cut off?")
            }
            Self::Checksum => write!(f, "the checksum is wrong: bytes of the file were changed"),
            Self::Cells => write!(f, "the grid of cells is empty, too large or not finite"),
            Self::Cell(cell) => write!(f, "cell {cell} has a set that is not in the file"),
            Self::Set(set) => write!(f, "set {set} is damaged"),
        }
    }
}

impl core::error::Error for ReadError {}

/// Why a set or a grid cannot be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum WriteError {
    /// The grid has no cells, more than 2^21 along an axis or 2^32 - 2 in all, or numbers that are
    /// not finite.
    Cells,
    /// There is no such cell.
    Cell(u32),
    /// The objects are not in ascending order, the same one is there twice, or there are not so
    /// many.
    Objects {
        /// Where in the list.
        index: usize,
    },
    /// The sets take 4 GiB or more: cut the level into several files.
    TooLarge,
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cells => write!(f, "the grid of cells is empty, too large or not finite"),
            Self::Cell(cell) => write!(f, "there is no cell {cell}"),
            Self::Objects { index } => {
                write!(f, "entry {index} is no object, or not greater than the one before it")
            }
            Self::TooLarge => write!(f, "the sets take 4 GiB or more: cut the level into several files"),
        }
    }
}

impl core::error::Error for WriteError {}
