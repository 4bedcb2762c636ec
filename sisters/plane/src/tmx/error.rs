//! Why a map was not read, and how names from files are told.

use std::io;

/// Coordinates in tiles, at most.
pub(super) const FARTHEST: i64 = 1 << 30;

/// Why a map was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TmxError {
    /// The file, or one that it names, cannot be read.
    #[error("{file} cannot be read: {why}")]
    File {
        /// Its path; that of a tileset as the map has it.
        file: String,
        /// The reason.
        why: io::Error,
    },
    /// A file is no XML, lacks something, is of a kind that is not read, or its contents do not fit
    /// together; a layer has fewer tiles than its dimensions say, for example.
    #[error("{file}, line {line}: {why}")]
    Damaged {
        /// The path of the map or "the map", or the path of a tileset as the map has it.
        file: String,
        /// The line up to which the file was read, from 1.
        line: usize,
        /// What is wrong.
        why: String,
    },
}

/// A name from a file as warnings show it.
pub(super) fn shortened(text: &str) -> String {
    const MOST_LETTERS: usize = 40;
    text.chars().take(MOST_LETTERS).collect()
}
