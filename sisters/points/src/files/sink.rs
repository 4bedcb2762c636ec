//! The points of a file on their way into chunks, and the errors of files.

use crate::{PointCloud, numeric};
use glam::{DVec3, Vec3};
use std::fmt::Display;
use std::io::{self, BufRead, Seek};
use std::panic::{self, AssertUnwindSafe};

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
    /// It begins as none of the formats does.
    #[error("{name} is neither a PLY, nor a LAS, LAZ or E57 file")]
    Unknown {
        /// The file.
        name: String,
    },
    /// What comes before the points does not follow the format.
    #[error("{name}: broken {format} header: {cause}")]
    Header {
        /// The file.
        name: String,
        /// "PLY", "LAS" or "E57".
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
}

impl Sample {
    pub const NONE: Self = Self { position: DVec3::NAN, colour: [255; 3], normal: Vec3::ZERO, radius: 0.0 };
}

/// Points whose middle decides where the origin is: a few that are wrong do no harm.
const FIRST: usize = 1024;

/// Warnings of a file, at most.
const WARNINGS: usize = 20;

/// What a reader says of a file beside its points.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Report {
    /// Points that were left out, as a coordinate is not finite or farther from the others than
    /// single precision reaches. Scanners write them for rays without an echo.
    pub skipped: u64,
    /// What was wrong with the file, and what was done, each with its name and the place in it; how
    /// many points could not be read is in the last. Empty for a sound file.
    pub warnings: Vec<String>,
}

/// Collects points and hands out full chunks.
pub(super) struct Sink<'a, E> {
    pub name: String,
    most: usize,
    chunk: PointCloud,
    origin: Option<DVec3>,
    /// Points that wait for the origin.
    first: Vec<(Sample, Attributes)>,
    /// Points that were read, and those that could not be, with the first reason.
    read: u64,
    lost: u64,
    loss: Option<FileError>,
    report: Report,
    /// The bits below the byte of a LAS colour, known from the first points that are not black.
    pub colour_shift: Option<u32>,
    each: &'a mut dyn FnMut(PointCloud) -> Result<(), E>,
}

impl<'a, E: From<FileError>> Sink<'a, E> {
    pub fn new(name: String, most: usize, each: &'a mut dyn FnMut(PointCloud) -> Result<(), E>) -> Self {
        let (most, chunk, first) = (most.max(1), PointCloud::default(), Vec::new());
        let (origin, read, lost, loss, report, colour_shift) = (None, 0, 0, None, Report::default(), None);
        Self { name, most, chunk, origin, first, read, lost, loss, report, colour_shift, each }
    }

    pub fn push(&mut self, sample: Sample, has: Attributes) -> Result<(), E> {
        self.read += 1;
        if !sample.position.is_finite() {
            self.report.skipped += 1;
            return Ok(());
        }
        if let Some(origin) = self.origin {
            return self.add(sample, has, origin);
        }
        self.first.push((sample, has));
        if self.first.len() < FIRST { Ok(()) } else { self.settle() }
    }

    /// Chooses the origin near the middle of the first points, and adds these.
    fn settle(&mut self) -> Result<(), E> {
        let first = std::mem::take(&mut self.first);
        if first.is_empty() {
            return Ok(());
        }
        let middle = |axis: usize| {
            let mut all: Vec<f64> = first.iter().map(|(sample, _)| sample.position[axis]).collect();
            let half = all.len() / 2;
            *all.select_nth_unstable_by(half, f64::total_cmp).1
        };
        let origin = numeric::origin_near(DVec3::new(middle(0), middle(1), middle(2)));
        self.origin = Some(origin);
        first.into_iter().try_for_each(|(sample, has)| self.add(sample, has, origin))
    }

    fn add(&mut self, sample: Sample, has: Attributes, origin: DVec3) -> Result<(), E> {
        let position = (sample.position - origin).as_vec3();
        if !position.is_finite() {
            self.report.skipped += 1;
            return Ok(());
        }
        self.chunk.positions.push(position);
        if has.colours {
            self.chunk.colours.push(sample.colour);
        }
        if has.normals {
            self.chunk.normals.push(numeric::unit(sample.normal));
        }
        if has.radii {
            self.chunk.radii.push(sample.radius);
        }
        if self.chunk.len() >= self.most { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), E> {
        self.chunk.origin = self.origin.unwrap_or_default();
        let chunk = std::mem::take(&mut self.chunk);
        if chunk.is_empty() { Ok(()) } else { (self.each)(chunk) }
    }

    /// Takes note that something is wrong with the file, but no point is lost.
    pub fn warn(&mut self, what: impl Display) {
        if self.report.warnings.len() < WARNINGS {
            self.report.warnings.push(format!("{}: {what}", self.name));
        }
    }

    /// Takes note that so many points cannot be read.
    pub fn lose(&mut self, why: FileError, points: u64) {
        self.lost = self.lost.saturating_add(points);
        self.loss.get_or_insert(why);
    }

    /// Hands out the last points. A file of which no point can be read is refused.
    pub fn finish(mut self) -> Result<Report, E> {
        self.settle()?;
        self.flush()?;
        if let Some(why) = self.loss {
            if self.read == 0 {
                return Err(why.into());
            }
            let (lost, all) = (self.lost, self.lost.saturating_add(self.read));
            self.report.warnings.push(format!("{why}; {lost} of {all} points could not be read"));
        }
        Ok(self.report)
    }

    pub fn io(&self, source: io::Error) -> FileError {
        FileError::Io { name: self.name.clone(), source }
    }

    pub fn header(&self, format: &'static str, cause: impl ToString) -> FileError {
        FileError::Header { name: self.name.clone(), format, cause: plain(cause) }
    }

    pub fn point(&self, place: String, cause: impl ToString) -> FileError {
        FileError::Point { name: self.name.clone(), place, cause: plain(cause) }
    }
}

/// A colour of the unit range as a byte.
pub(super) fn unit_to_byte(value: f64) -> u8 {
    (value * 255.0).round() as u8
}

/// The longest text of a library that is handed on, in characters: some repeat the file.
const LONGEST_TEXT: usize = 300;

/// The result of a library. A panic in it, as `laz` has on some broken files, becomes an error.
pub(super) fn guarded<T, E: ToString>(call: impl FnOnce() -> Result<T, E>) -> Result<T, String> {
    match panic::catch_unwind(AssertUnwindSafe(call)) {
        Ok(result) => result.map_err(plain),
        Err(_) => Err(PANICKED.into()),
    }
}

/// What is said of a panic.
pub(super) const PANICKED: &str = "the bytes make no sense to the decoder, which panicked";

/// What an error says, in plain words and not at length.
pub(super) fn plain(error: impl ToString) -> String {
    let mut text = error.to_string();
    if text.contains("failed to fill whole buffer") {
        return "the file ends here".into();
    }
    if let Some((end, _)) = text.char_indices().nth(LONGEST_TEXT) {
        text.replace_range(end.., " ...");
    }
    text
}
