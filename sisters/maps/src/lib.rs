#![doc = include_str!("../README.md")]

mod drawing;
mod rooms;
mod tmx;

use std::io;
use std::path::Path;

pub use drawing::{Drawing, HARBOUR};
pub use tmx::{Role, TmxImport, TmxMap, TmxObject};

/// Why a map was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The file, or one that it names, cannot be read.
    #[error("{file} cannot be read: {why}")]
    File {
        /// Its path; that of a tileset as the map has it.
        file: String,
        /// The reason.
        why: io::Error,
    },
    /// A file is no map, lacks something, is of a kind that is not read, or its contents do not fit
    /// together; a layer has fewer tiles than its dimensions say, for example.
    #[error("{file}, line {line}: {why}")]
    Damaged {
        /// The path of the map or "the map", or the path of a tileset as the map has it.
        file: String,
        /// The line, from 1.
        line: u32,
        /// What is wrong, or what to do.
        why: String,
    },
}

impl MapError {
    fn damaged(file: &str, line: u32, why: impl ToString) -> Self {
        Self::Damaged { file: file.to_owned(), line, why: why.to_string() }
    }
}

/// Tiles that are never too many: 2 MiB of bits.
const SMALL: u64 = 1 << 24;

/// The bytes of a file. Pipes and devices are not opened: they may have no end.
fn file(path: &Path) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::other("is no file"));
    }
    std::fs::read(path)
}

/// The text of a file, without a byte-order mark.
fn utf8<'a>(bytes: &'a [u8], file: &str) -> Result<&'a str, MapError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    str::from_utf8(bytes).map_err(|_| MapError::damaged(file, 1, "it is no text in UTF-8"))
}
