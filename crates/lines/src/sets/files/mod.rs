//! Lines from files: the thesis' text format, OBJ, PLY, and the tractograms TCK and TRK.
//!
//! Readers take bytes and need memory in proportion to them, whatever a header promises. Lines may
//! be of any number of vertices.

mod binary;
mod bytes;
mod error;
mod ply;
#[cfg(test)]
mod tests;
mod text;
mod words;

use std::path::Path;

pub use error::FileError;

use crate::sets::LineSet;

/// The formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// The number of lines, the number of vertices of each, then all coordinates; separated by
    /// white space (Benevides 2015, section 4.1).
    Text,
    /// Wavefront OBJ: `v` and `l`.
    Obj,
    /// PLY, ASCII or binary: vertices, and elements `edge`, `line` or `polyline` with the two
    /// vertices `vertex1` and `vertex2` or a list `vertex_indices`.
    Ply,
    /// MRtrix tracks of 32-bit floats.
    Tck,
    /// TrackVis tracks.
    Trk,
}

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
    read(&bytes, format).map_err(|why| FileError::In { path: path.to_owned(), why: Box::new(why) })
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
