//! Why files are refused.

use std::path::PathBuf;

use glam::Vec3;

use crate::sets::LineError;
use crate::sets::attributes::AttributeError;

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
    /// A file was read, and what it holds was refused.
    #[error("{path}: {why}")]
    In {
        /// The file.
        path: PathBuf,
        /// The cause.
        why: Box<FileError>,
    },
    /// The file breaks its format at a line (from 1) or byte (from 0), has a part that is not read,
    /// contradicts itself, or has the ending of no format.
    #[error("{0}")]
    Refused(String),
    /// The lines were refused.
    #[error(transparent)]
    Lines(#[from] LineError),
    /// The numbers or colours were refused.
    #[error(transparent)]
    Attributes(#[from] AttributeError),
}

/// The vertices of a file, and lists of their numbers.
pub(super) type Lists = Result<(Vec<Vec3>, Vec<Vec<u32>>), FileError>;

/// The vertices of each line.
pub(super) type Lines = Result<Vec<Vec<Vec3>>, FileError>;

pub(super) fn broken(unit: &'static str, at: usize, why: impl Into<String>) -> FileError {
    refused(format!("{unit} {at}: {}", why.into()))
}

pub(super) fn refused(why: impl Into<String>) -> FileError {
    FileError::Refused(why.into())
}
