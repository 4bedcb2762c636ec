//! Why there are no bricks.

use std::io;

/// Why there are no bricks.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BrickError {
    /// The operating system says why.
    #[error("{name}: {source}")]
    Io {
        /// The file.
        name: String,
        /// The reason.
        source: io::Error,
    },
    /// A file of something else, of another version, cut short or damaged.
    #[error("{name} is not a valid brick file: {cause}")]
    Broken {
        /// The file.
        name: String,
        /// What is wrong.
        cause: String,
    },
    /// A point to build bricks from is infinite, not a number, or too far from the first ones for
    /// single precision.
    #[error("the position of point {index} is not finite")]
    NotFinite {
        /// Its number among all points.
        index: u64,
    },
    /// Points to build bricks from have colours only for some.
    #[error(transparent)]
    Length(#[from] crate::LengthError),
}
