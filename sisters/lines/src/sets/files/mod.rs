//! Lines from files: OBJ, PLY, the tractograms TCK and TRK, and VTK, with the numbers and colours that they have; and triangle meshes from OBJ and PLY.
//!
//! Readers take bytes and need memory in proportion to them, whatever a header promises. Lines may
//! be of any number of vertices.

mod bytes;
mod error;
mod mesh;
mod obj;
mod ply;
mod tck;
#[cfg(test)]
mod tests;
mod trk;
mod vtk;
mod words;

use std::path::Path;

pub use error::FileError;
pub use mesh::{open_mesh, read_mesh};

use crate::sets::LineSet;
use bytes::unmarked;
use error::refused;

/// The formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ: `v` and `l`.
    Obj,
    /// PLY, ASCII or binary: vertices, and elements `edge`, `line` or `polyline` with the two
    /// vertices `vertex1` and `vertex2` or a list `vertex_indices`.
    Ply,
    /// MRtrix tracks of 32-bit or 64-bit floats.
    Tck,
    /// TrackVis tracks, moved to the coordinates of the scanner if the file has their matrix.
    Trk,
    /// VTK's legacy files: the lines of POLYDATA, ASCII or binary.
    Vtk,
}

/// The lines of a file, by its ending.
///
/// # Errors
/// If the file cannot be read, has an unknown ending, or breaks its format.
pub fn open(path: &Path) -> Result<LineSet, FileError> {
    let format = match &*ending(path) {
        "obj" => Format::Obj,
        "ply" => Format::Ply,
        "tck" => Format::Tck,
        "trk" => Format::Trk,
        "vtk" => Format::Vtk,
        _ => {
            let endings = "the ending must be .obj, .ply, .tck, .trk or .vtk";
            return Err(refused(format!("{}: {endings}", path.display())));
        }
    };
    of_file(path, |bytes| read(bytes, format))
}

/// The ending of a file in small letters.
fn ending(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// What the bytes of a file hold. Errors name it.
fn of_file<T>(path: &Path, read: impl Fn(&[u8]) -> Result<T, FileError>) -> Result<T, FileError> {
    let bytes = std::fs::read(path).map_err(|why| FileError::Io { path: path.to_owned(), why })?;
    read(&bytes).map_err(|why| FileError::In { path: path.to_owned(), why: Box::new(why) })
}

/// The lines in the bytes of a file.
///
/// # Errors
/// If the bytes break the format, or a coordinate is not finite.
pub fn read(bytes: &[u8], format: Format) -> Result<LineSet, FileError> {
    // The offset that a TCK names counts from the start of the file.
    let bytes = if format == Format::Tck { bytes } else { unmarked(bytes) };
    Ok(match format {
        Format::Obj => LineSet::new(obj::read(bytes)?)?,
        Format::Ply => LineSet::new(ply::read(bytes)?)?,
        Format::Tck => tck::read(bytes)?,
        Format::Trk => trk::read(bytes)?,
        Format::Vtk => vtk::read(bytes)?,
    })
}
