//! The points of a file on their way into chunks, and the errors of files.

use std::io::{self, BufRead, Seek};

use glam::{DVec3, Vec3};

use super::levels::Selection;
use crate::{PointCloud, UNKNOWN_SCANNER, numeric};

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
        /// "PLY", "LAS", "COPC", "EPT", "E57" or "surfel".
        format: &'static str,
        /// What is wrong.
        cause: String,
    },
    /// Levels were wanted of a file that has none.
    #[error("{name}: {format} files have no levels, only COPC and EPT files do")]
    NoLevels {
        /// The file.
        name: String,
        /// "PLY", "LAS", "E57" or "surfel".
        format: &'static str,
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
pub(super) struct Sample {
    pub position: DVec3,
    pub colour: [u8; 3],
    pub normal: Vec3,
    pub radius: f32,
    /// Where the scanner stood.
    pub scanner: Option<DVec3>,
}

impl Sample {
    pub const NONE: Self =
        Self { position: DVec3::NAN, colour: [255; 3], normal: Vec3::ZERO, radius: 0.0, scanner: None };
}

/// Collects points and hands out full chunks.
pub(super) struct Sink<'a, E> {
    pub name: String,
    /// The part of the file that is wanted.
    pub wanted: Selection,
    pub most: usize,
    pub chunk: PointCloud,
    pub origin: Option<DVec3>,
    pub skipped: u64,
    /// The bits below the byte of a LAS colour, known from the first points that are not black.
    pub colour_shift: Option<u32>,
    pub each: &'a mut dyn FnMut(PointCloud) -> Result<(), E>,
}

impl<E: From<FileError>> Sink<'_, E> {
    pub fn push(&mut self, sample: Sample, has: Attributes) -> Result<(), E> {
        let place = sample.position;
        let position = (place - self.origin.unwrap_or_else(|| numeric::origin_near(place))).as_vec3();
        if !position.is_finite() {
            self.skipped += 1;
            return Ok(());
        }
        if !self.wanted.has(place) {
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
        self.push_scanner(sample.scanner);
        if self.chunk.len() >= self.most { self.flush() } else { Ok(()) }
    }

    /// Adds the scanner of the last point. Each chunk has the scanners of its own points.
    fn push_scanner(&mut self, scanner: Option<DVec3>) {
        let PointCloud { scanners, seen_by, positions, .. } = &mut self.chunk;
        if let Some(place) = scanner {
            if scanners.last() != Some(&place) {
                scanners.push(place);
            }
            seen_by.resize(positions.len() - 1, UNKNOWN_SCANNER);
            seen_by.push(scanners.len() as u32 - 1);
        } else if !seen_by.is_empty() {
            seen_by.push(UNKNOWN_SCANNER);
        }
    }

    pub fn flush(&mut self) -> Result<(), E> {
        if self.chunk.is_empty() {
            return Ok(());
        }
        self.chunk.origin = self.origin.unwrap_or_default();
        (self.each)(std::mem::take(&mut self.chunk))
    }

    pub fn io(&self, source: io::Error) -> FileError {
        FileError::Io { name: self.name.clone(), source }
    }

    pub fn no_levels(&self, format: &'static str) -> FileError {
        FileError::NoLevels { name: self.name.clone(), format }
    }

    pub fn header(&self, format: &'static str, cause: impl ToString) -> FileError {
        FileError::Header { name: self.name.clone(), format, cause: cause.to_string() }
    }

    pub fn point(&self, place: String, cause: impl ToString) -> FileError {
        FileError::Point { name: self.name.clone(), place, cause: cause.to_string() }
    }
}

/// A colour of the unit range as a byte.
pub(super) fn unit_to_byte(value: f64) -> u8 {
    (value * 255.0).round() as u8
}
