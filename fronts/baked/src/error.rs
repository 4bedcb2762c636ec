//! Why files are refused.

/// Why bytes are no file of baked visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The first bytes are others.
    #[error("this is no file of baked visibility")]
    NotBaked,
    /// It is of a version that this one cannot read.
    #[error("the file is of version {0}, not {expected}", expected = crate::VERSION)]
    Version(u32),
    /// Its sets hold something that this version does not know, or cells of another number than the
    /// grid has.
    #[error("its sets hold things of the unknown kind {0}, or not as many as the grid has cells")]
    Kind(u32),
    /// It is shorter or longer than it says.
    #[error("the file has {given} bytes where {needed} are needed: was it cut off?")]
    Length {
        /// Bytes that it must have at least.
        needed: u64,
        /// Bytes that there are.
        given: u64,
    },
    /// Bytes were changed: the checksum is another one.
    #[error("the checksum is wrong: bytes of the file were changed")]
    Checksum,
    /// The grid has no cells, too many, or numbers that are not finite.
    #[error("the grid of cells is empty, too large or not finite")]
    Cells,
    /// A cell has a set that is not there.
    #[error("cell {0} has a set that is not in the file")]
    Cell(u32),
    /// A set is none: its bytes make no list of objects that are there, or it differs from a set
    /// that does not come before it.
    #[error("set {0} is damaged")]
    Set(u32),
}

/// Why a set or a grid cannot be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The grid has no cells, more than 2^21 along an axis or 2^32 - 2 in all, or numbers that are
    /// not finite.
    #[error("the grid of cells is empty, too large or not finite")]
    Cells,
    /// There is no such cell.
    #[error("there is no cell {0}")]
    Cell(u32),
    /// The objects are not in ascending order, the same one is there twice, or there are not so
    /// many.
    #[error("entry {index} is no object, or not greater than the one before it")]
    Objects {
        /// Where in the list.
        index: usize,
    },
    /// The sets take 4 GiB or more: cut the level into several files.
    #[error("the sets take 4 GiB or more: cut the level into several files")]
    TooLarge,
}
