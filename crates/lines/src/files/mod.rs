//! Lines from files: the thesis' text format, OBJ, PLY, and the tractograms TCK and TRK.
//!
//! Readers take bytes and need memory in proportion to them, whatever a header promises. Lines may be of any number of vertices.

mod binary;
mod ply;
#[cfg(test)]
mod tests;
mod text;

use std::path::{Path, PathBuf};

use glam::Vec3;

use crate::lines::{LineError, LineSet};

/// The formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// The number of lines, the number of vertices of each, then all coordinates; separated by white space.
    Text,
    /// Wavefront OBJ: `v` and `l`.
    Obj,
    /// PLY, ASCII or binary: vertices, and `edge` elements with two vertices or lists of vertex indices.
    Ply,
    /// MRtrix tracks of 32-bit floats.
    Tck,
    /// TrackVis tracks.
    Trk,
}

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file could not be opened or read.
    #[error("cannot read {path}: {why}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The cause.
        why: std::io::Error,
    },
    /// The ending is none of .txt, .obj, .ply, .tck and .trk.
    #[error("{0}: the ending must be .txt, .obj, .ply, .tck or .trk")]
    Unknown(PathBuf),
    /// The file breaks its format.
    #[error("{unit} {at}: {why}")]
    Broken {
        /// How places are counted: "line" or "byte".
        unit: &'static str,
        /// The place: lines from 1, bytes from 0.
        at: usize,
        /// The cause.
        why: String,
    },
    /// The lines were refused.
    #[error(transparent)]
    Lines(#[from] LineError),
}

type Lines = Result<Vec<Vec<Vec3>>, FileError>;

/// The lines of a file, by its ending.
///
/// # Errors
/// If the file cannot be read, has an unknown ending, or breaks its format.
pub fn open(path: &Path) -> Result<LineSet, FileError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let format = match ending.as_str() {
        "txt" => Format::Text,
        "obj" => Format::Obj,
        "ply" => Format::Ply,
        "tck" => Format::Tck,
        "trk" => Format::Trk,
        _ => return Err(FileError::Unknown(path.to_owned())),
    };
    let bytes = std::fs::read(path).map_err(|why| FileError::Io { path: path.to_owned(), why })?;
    read(&bytes, format)
}

/// The lines in the bytes of a file.
///
/// # Errors
/// If the bytes break the format, or a coordinate is not finite.
pub fn read(bytes: &[u8], format: Format) -> Result<LineSet, FileError> {
    let lines = match format {
        Format::Text => text::thesis(bytes),
        Format::Obj => text::obj(bytes),
        Format::Ply => ply::read(bytes),
        Format::Tck => binary::tck(bytes),
        Format::Trk => binary::trk(bytes),
    };
    Ok(LineSet::new(lines?)?)
}

fn broken(unit: &'static str, at: usize, why: impl Into<String>) -> FileError {
    FileError::Broken { unit, at, why: why.into() }
}

/// The words of a text with their line numbers; white space separates.
struct Words<'a> {
    words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    line: usize,
}

impl<'a> Words<'a> {
    /// Words of lines that are counted from `first`.
    fn new(bytes: &'a [u8], first: usize) -> Self {
        let lines = bytes.split(|b| *b == b'\n').zip(first..);
        Self {
            words: Box::new(lines.flat_map(|(l, i)| words(l).into_iter().map(move |w| (i, w)))),
            line: first,
        }
    }

    fn next(&mut self) -> Option<&'a str> {
        let (line, word) = self.words.next()?;
        self.line = line;
        Some(word)
    }

    /// The next word as a number.
    fn number<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, FileError> {
        let Some(word) = self.next() else {
            return Err(broken("line", self.line, format!("the file ends before {what}")));
        };
        parse(word, what, self.line)
    }

    fn point(&mut self) -> Result<Vec3, FileError> {
        let mut next = || self.number("a coordinate");
        Ok(Vec3::new(next()?, next()?, next()?))
    }
}

fn words(line: &[u8]) -> Vec<&str> {
    line.split(u8::is_ascii_whitespace)
        .filter(|w| !w.is_empty())
        .map(|w| str::from_utf8(w).unwrap_or("\u{fffd}"))
        .collect()
}

fn parse<T: std::str::FromStr>(word: &str, what: &str, line: usize) -> Result<T, FileError> {
    let short: String = word.chars().take(20).collect();
    word.parse().map_err(|_| broken("line", line, format!("\"{short}\" is not {what}")))
}

/// Numbers from bytes.
struct Bytes<'a> {
    bytes: &'a [u8],
    at: usize,
    big: bool,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], FileError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let Some(taken) = rest.get(..count) else {
            return Err(broken("byte", self.at, format!("the file ends within the next {count} bytes")));
        };
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], FileError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        if self.big {
            array.reverse();
        }
        Ok(array)
    }

    fn f32(&mut self) -> Result<f32, FileError> {
        self.array().map(f32::from_le_bytes)
    }

    fn i32(&mut self) -> Result<i32, FileError> {
        self.array().map(i32::from_le_bytes)
    }

    fn point(&mut self) -> Result<Vec3, FileError> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }
}
