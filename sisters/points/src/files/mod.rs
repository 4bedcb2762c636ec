//! Point clouds from files, in chunks, so that a file may be larger than memory: PLY, LAS and LAZ,
//! COPC, EPT, E57, surfels; and PLY written.
//!
//! The format is found by the first bytes, not by the name. Counts in headers are checked by
//! reading, never believed by allocating. Of COPC and EPT files only some levels and a box can
//! be read ([`Selection`]).

mod chunks;
mod copc;
mod ept;
mod guarded;
mod head;
mod layers;
mod levels;
mod lidar;
mod ply;
mod ply_header;
mod records;
mod scans;
mod sink;
mod surfel;
#[cfg(test)]
mod tests;
mod text;

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use crate::PointCloud;
use sink::Sink;
use text::unmarked;

pub use levels::{Levels, Selection};
pub use ply::PlyWriter;
pub use sink::{Attributes, FileError, Report, Source};

/// Reads a whole file; of EPT its `ept.json`, or the folder that this lies in. Points whose
/// coordinates are not finite, as scanners write them for rays without an echo, are left out.
///
/// Many files are cut short, or have a detail that is wrong. What can be read of them is read, and
/// the [`Report`] says what is wrong and how many points are missing.
///
/// Colours of LAS and LAZ files have 16 bits a channel; they are taken as 8 bits if no channel of
/// the first 65,536 points that are not all black exceeds 255 (of fewer points, if their records
/// have more than 64 bytes).
///
/// Points of E57 files have the places of their scanners, by the poses of scans.
///
/// The origin is a multiple of 1,024 units in each coordinate, near the middle of the first 1,024
/// points; bounds in headers are not believed.
///
/// Normals come with length 1; those that have no direction are zero.
///
/// # Errors
/// If the file cannot be opened or is of none of the formats; if its header is broken, or no point
/// can be read.
///
/// # Panics
/// None. But in builds with overflow checks or debug assertions, the crate `laz` panics at four
/// places on some damaged bytes of LAZ, COPC and EPT files (`decoders.rs` 284, `las/gps.rs` 892 and
/// 1092, `las/wavepacket.rs` 170 of version 0.13), which cannot be told before. Such a panic is
/// caught, and becomes a warning or an error; the panic hook is called first, which by default
/// prints a line. A program that is built with these checks and with `panic = "abort"` ends there:
/// turn them off for `laz` alone (`[profile.dev.package.laz]`, `overflow-checks = false`,
/// `debug-assertions = false`), or read files that you do not trust in another process.
pub fn read(path: &Path) -> Result<(PointCloud, Report), FileError> {
    let mut all = PointCloud::default();
    let report = read_chunks(path, usize::MAX, |chunk| {
        all = chunk;
        Ok::<_, FileError>(())
    })?;
    Ok((all, report))
}

/// Reads a file and hands out its points in chunks of `most` (at least 1), in their order, all with
/// one origin; and what [`read`] reports.
///
/// # Errors
/// As [`read`]; and the first error of `each`, which ends the reading.
pub fn read_chunks<E: From<FileError>>(
    path: &Path,
    most: usize,
    each: impl FnMut(PointCloud) -> Result<(), E>,
) -> Result<Report, E> {
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
) -> Result<Report, E> {
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
) -> Result<Report, E> {
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
) -> Result<Report, E> {
    read_part(source, (name, None), wanted, most, each)
}

/// As [`read_selected_source`], of a file with a name, in a folder if that is known.
fn read_part<E: From<FileError>>(
    mut source: impl Source,
    (name, folder): (String, Option<&Path>),
    wanted: &Selection,
    most: usize,
    mut each: impl FnMut(PointCloud) -> Result<(), E>,
) -> Result<Report, E> {
    let mut sink = Sink::new(name, *wanted, most, &mut each);
    let start = unmarked(source.fill_buf().map_err(|e| sink.io(e))?);
    let is_ply = start.get(..3).is_some_and(|word| word.eq_ignore_ascii_case(b"ply"));
    let format = match start {
        [_, _, _, after, ..] if is_ply && after.is_ascii_whitespace() => "PLY",
        [b'L', b'A', b'S', b'F', ..] => "LAS",
        [b'A', b'S', b'T', b'M', ..] => "E57",
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
    sink.finish()
}
