//! Point clouds from files, in chunks, so that a file may be larger than memory: PLY, LAS, LAZ
//! (COPC files are such) and E57; and PLY written.
//!
//! The format is found by the first bytes, not by the name. Counts in headers are checked by
//! reading, never believed by allocating.

mod chunks;
mod head;
mod layers;
mod lidar;
mod ply;
mod ply_header;
mod scans;
mod sink;
mod text;

use crate::PointCloud;
use sink::Sink;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use text::unmarked;

pub use ply::PlyWriter;
pub use sink::{Attributes, FileError, Report, Source};

/// Reads a whole file. Points whose coordinates are not finite, as scanners write them for rays
/// without an echo, are left out.
///
/// Many files are cut short, or have a detail that is wrong. What can be read of them is read, and
/// the [`Report`] says what is wrong and how many points are missing.
///
/// Colours of LAS and LAZ files have 16 bits a channel; they are taken as 8 bits if no channel of
/// the first 65,536 points that are not all black exceeds 255 (of fewer points, if their records
/// have more than 64 bytes).
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
/// places on some damaged bytes of LAZ files (`decoders.rs` 284, `las/gps.rs` 892 and 1092,
/// `las/wavepacket.rs` 170 of version 0.13), which cannot be told before. Such a panic is
/// caught, and becomes a warning or an error; the panic hook is called first. A program that is also
/// built with `panic = "abort"` ends there: the page says how to turn the checks off for `laz` alone.
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
    let name = path.display().to_string();
    let file = File::open(path).map_err(|source| FileError::Io { name: name.clone(), source })?;
    read_source(BufReader::with_capacity(1 << 18, file), name, most, each)
}

/// As [`read_chunks`], from any source. Errors call it `name`.
///
/// # Errors
/// As [`read_chunks`].
pub fn read_source<E: From<FileError>>(
    mut source: impl Source,
    name: String,
    most: usize,
    mut each: impl FnMut(PointCloud) -> Result<(), E>,
) -> Result<Report, E> {
    let mut sink = Sink::new(name, most, &mut each);
    let start = unmarked(source.fill_buf().map_err(|e| sink.io(e))?);
    let is_ply = start.get(..3).is_some_and(|word| word.eq_ignore_ascii_case(b"ply"));
    match start {
        [_, _, _, after, ..] if is_ply && after.is_ascii_whitespace() => ply::read(source, &mut sink)?,
        [b'L', b'A', b'S', b'F', ..] => lidar::read(source, &mut sink)?,
        [b'A', b'S', b'T', b'M', ..] => scans::read(source, &mut sink)?,
        _ => return Err(FileError::Unknown { name: sink.name }.into()),
    }
    sink.finish()
}
