//! Point clouds from files, in chunks, so that a file may be larger than memory: PLY, LAS and LAZ,
//! COPC, EPT, E57, surfels; and PLY written.
//!
//! The format is found by the first bytes, not by the name. Counts in headers are checked by
//! reading, never believed by allocating. Of COPC and EPT files only some levels and a box can
//! be read ([`Selection`]).

mod copc;
mod ept;
mod guarded;
mod layers;
mod levels;
mod lidar;
mod ply;
mod records;
mod scans;
mod sink;
mod surfel;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use crate::PointCloud;
use sink::Sink;

pub use levels::{Levels, Selection};
pub use ply::PlyWriter;
pub use sink::{Attributes, FileError, Source};

/// Reads a whole file; of EPT its `ept.json`, or the folder that this lies in. Points whose
/// coordinates are not finite, as scanners write them for rays without an echo, are left out.
///
/// Colours of LAS and LAZ files have 16 bits a channel; they are taken as 8 bits if no channel of
/// the first 65,536 points that are not all black exceeds 255 (of fewer points, if their records
/// have more than 64 bytes).
///
/// Points of E57 files have the places of their scanners, by the poses of scans.
///
/// The origin is a multiple of 1,024 units in each coordinate, near the first point or the middle
/// of the bounds in the header.
///
/// # Errors
/// If the file cannot be opened, is of none of the formats, is broken or ends too early.
pub fn read(path: &Path) -> Result<PointCloud, FileError> {
    let mut all = PointCloud::default();
    read_chunks(path, usize::MAX, |chunk| {
        all = chunk;
        Ok(())
    })?;
    Ok(all)
}

/// Reads a file and hands out its points in chunks of `most` (at least 1), in their order, all with
/// one origin; and the number of points that were left out, as [`read`] does it.
///
/// # Errors
/// As [`read`]; and the first error of `each`, which ends the reading.
pub fn read_chunks<E: From<FileError>>(
    path: &Path,
    most: usize,
    each: impl FnMut(PointCloud) -> Result<(), E>,
) -> Result<u64, E> {
    read_selected(path, &Selection::default(), most, each)
}

/// As [`read_chunks`], only the part that is wanted. Of COPC files with levels or a box, only nodes
/// that are wanted are read from the file, and their points come in the order of the file; of EPT,
/// always, and level by level.
///
/// # Errors
/// As [`read_chunks`]; [`FileError::NoLevels`] if [`Selection::levels`] is given and the file has
/// none.
pub fn read_selected<E: From<FileError>>(
    path: &Path,
    wanted: &Selection,
    most: usize,
    each: impl FnMut(PointCloud) -> Result<(), E>,
) -> Result<u64, E> {
    let path = if path.is_dir() { &path.join("ept.json") } else { path };
    let name = path.display().to_string();
    let file = File::open(path).map_err(|source| FileError::Io { name: name.clone(), source })?;
    read_part(BufReader::with_capacity(1 << 18, file), (name, path.parent()), wanted, most, each)
}

/// As [`read_chunks`], from any source. Errors call it `name`.
///
/// # Errors
/// As [`read_chunks`].
pub fn read_source<E: From<FileError>>(
    source: impl Source,
    name: String,
    most: usize,
    each: impl FnMut(PointCloud) -> Result<(), E>,
) -> Result<u64, E> {
    read_selected_source(source, name, &Selection::default(), most, each)
}

/// As [`read_selected`], from any source. Errors call it `name`.
///
/// # Errors
/// As [`read_selected`]; if it is an `ept.json`, whose points lie in files beside it.
pub fn read_selected_source<E: From<FileError>>(
    source: impl Source,
    name: String,
    wanted: &Selection,
    most: usize,
    each: impl FnMut(PointCloud) -> Result<(), E>,
) -> Result<u64, E> {
    read_part(source, (name, None), wanted, most, each)
}

/// As [`read_selected_source`], of a file with a name, in a folder if that is known.
fn read_part<E: From<FileError>>(
    mut source: impl Source,
    (name, folder): (String, Option<&Path>),
    wanted: &Selection,
    most: usize,
    mut each: impl FnMut(PointCloud) -> Result<(), E>,
) -> Result<u64, E> {
    let mut sink = Sink {
        name,
        wanted: *wanted,
        most: most.max(1),
        chunk: PointCloud::default(),
        origin: None,
        skipped: 0,
        colour_shift: None,
        each: &mut each,
    };
    let start = source.fill_buf().map_err(|e| sink.io(e))?;
    let format = match start.get(..4) {
        Some(b"ply\n" | b"ply\r") => "PLY",
        Some(b"LASF") => "LAS",
        Some(b"ASTM") => "E57",
        _ if start.trim_ascii_start().starts_with(b"{") => "EPT",
        _ => "surfel",
    };
    if !["LAS", "EPT"].contains(&format) && wanted.levels != Levels::All {
        return Err(sink.no_levels(format).into());
    }
    match format {
        "PLY" => ply::read(source, &mut sink)?,
        "LAS" => lidar::read(source, &mut sink)?,
        "E57" => scans::read(source, &mut sink)?,
        "EPT" => match folder {
            Some(folder) => ept::read(source, folder, &mut sink)?,
            None => return Err(sink.header("EPT", "its points lie in files beside it").into()),
        },
        _ => surfel::read(source, &mut sink)?,
    }
    sink.flush()?;
    Ok(sink.skipped)
}
