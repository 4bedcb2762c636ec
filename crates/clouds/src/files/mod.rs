//! Point clouds from files, in chunks, so that a file may be larger than memory: PLY, LAS and LAZ, E57, surfels; and PLY written.
//!
//! The format is found by the first bytes, not by the name. Counts in headers are checked by reading, never believed by allocating.

mod ply;
mod scans;
mod surfel;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek};
use std::path::Path;

use glam::{DVec3, Vec3};

use crate::{PointCloud, numeric};
pub use ply::PlyWriter;

/// Why a file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The operating system says why.
    #[error("{name}: {source}")]
    Io {
        /// The file.
        name: String,
        /// The reason.
        source: io::Error,
    },
    /// What comes before the points does not follow the format.
    #[error("{name}: broken {format} header: {cause}")]
    Header {
        /// The file.
        name: String,
        /// "PLY", "LAS", "E57" or "surfel".
        format: &'static str,
        /// What is wrong.
        cause: String,
    },
    /// A point that does not follow the format, or is missing.
    #[error("{name}, {place}: {cause}")]
    Point {
        /// The file.
        name: String,
        /// The line, byte or number of the point.
        place: String,
        /// What is wrong.
        cause: String,
    },
}

/// A file, or bytes in memory.
pub trait Source: BufRead + Seek + Send + Sync + 'static {}

impl<T: BufRead + Seek + Send + Sync + 'static> Source for T {}

/// Reads a whole file. Points whose coordinates are not finite, as scanners write them for rays without an echo, are left out.
///
/// The origin is a multiple of 1,024 units in each coordinate, near the first point or the middle of the bounds in the header.
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

/// Reads a file and hands out its points in chunks of `most` (at least 1), in their order, all with one origin; and the number of
/// points that were left out, as [`read`] does it.
///
/// # Errors
/// As [`read`]; and the first error of `each`, which ends the reading.
pub fn read_chunks<E: From<FileError>>(
    path: &Path,
    most: usize,
    each: impl FnMut(PointCloud) -> Result<(), E>,
) -> Result<u64, E> {
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
) -> Result<u64, E> {
    let mut sink = Sink {
        name,
        most: most.max(1),
        chunk: PointCloud::default(),
        origin: None,
        skipped: 0,
        each: &mut each,
    };
    let start = source.fill_buf().map_err(|e| sink.io(e))?;
    match start.get(..4) {
        Some(b"ply\n" | b"ply\r") => ply::read(source, &mut sink)?,
        Some(b"LASF") => scans::read_las(source, &mut sink)?,
        Some(b"ASTM") => scans::read_e57(source, &mut sink)?,
        _ => surfel::read(source, &mut sink)?,
    }
    sink.flush()?;
    Ok(sink.skipped)
}

/// The attributes that a file has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Attributes {
    /// Points have colours.
    pub colours: bool,
    /// Points have normals.
    pub normals: bool,
    /// Points have radii.
    pub radii: bool,
}

/// One point, with defaults for the attributes that it lacks.
#[derive(Debug, Clone, Copy)]
struct Sample {
    position: DVec3,
    colour: [u8; 3],
    normal: Vec3,
    radius: f32,
}

impl Sample {
    const NONE: Self = Self { position: DVec3::NAN, colour: [255; 3], normal: Vec3::ZERO, radius: 0.0 };
}

/// Collects points and hands out full chunks.
struct Sink<'a, E> {
    name: String,
    most: usize,
    chunk: PointCloud,
    origin: Option<DVec3>,
    skipped: u64,
    each: &'a mut dyn FnMut(PointCloud) -> Result<(), E>,
}

impl<E: From<FileError>> Sink<'_, E> {
    fn push(&mut self, sample: Sample, has: Attributes) -> Result<(), E> {
        let place = sample.position;
        let position = (place - self.origin.unwrap_or_else(|| numeric::origin_near(place))).as_vec3();
        if !position.is_finite() {
            self.skipped += 1;
            return Ok(());
        }
        self.origin.get_or_insert_with(|| numeric::origin_near(place));
        self.chunk.positions.push(position);
        if has.colours {
            self.chunk.colours.push(sample.colour);
        }
        if has.normals {
            let normal = sample.normal;
            self.chunk.normals.push(if normal.is_normalized() { normal } else { normal.normalize_or_zero() });
        }
        if has.radii {
            self.chunk.radii.push(sample.radius);
        }
        if self.chunk.len() >= self.most { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), E> {
        if self.chunk.is_empty() {
            return Ok(());
        }
        self.chunk.origin = self.origin.unwrap_or_default();
        (self.each)(std::mem::take(&mut self.chunk))
    }

    fn io(&self, source: io::Error) -> FileError {
        FileError::Io { name: self.name.clone(), source }
    }

    fn header(&self, format: &'static str, cause: impl ToString) -> FileError {
        FileError::Header { name: self.name.clone(), format, cause: cause.to_string() }
    }

    fn point(&self, place: String, cause: impl ToString) -> FileError {
        FileError::Point { name: self.name.clone(), place, cause: cause.to_string() }
    }
}

/// A colour of the unit range as a byte.
fn unit_to_byte(value: f64) -> u8 {
    (value * 255.0).round() as u8
}
