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
    /// The ending is that of no format that is read.
    #[error("{0}: the ending must be .txt, .obj, .ply, .tck, .trk, .vtk or .hair")]
    Unknown(PathBuf),
    /// The ending is that of no format whose meshes are read.
    #[error("{0}: the ending of a mesh must be .obj or .ply")]
    NoMesh(PathBuf),
    /// A file was read, and what it holds was refused.
    #[error("{path}: {why}")]
    In {
        /// The file.
        path: PathBuf,
        /// The cause: [`Self::Broken`] or [`Self::Lines`].
        why: Box<FileError>,
    },
    /// The bytes break the format.
    #[error("{unit} {at}: {why}")]
    Broken {
        /// How places are counted: "line" or "byte".
        unit: &'static str,
        /// The place: lines from 1, bytes from 0.
        at: usize,
        /// The cause.
        why: String,
    },
    /// The file has a part that is not read, or contradicts itself.
    #[error("{0}")]
    Refused(String),
    /// The lines were refused.
    #[error(transparent)]
    Lines(#[from] LineError),
    /// The numbers, colours or groups were refused.
    #[error(transparent)]
    Attributes(#[from] AttributeError),
}

/// The vertices of a file, and lists of their numbers.
pub(super) type Lists = Result<(Vec<Vec3>, Vec<Vec<u32>>), FileError>;

/// The vertices of each line.
pub(super) type Lines = Result<Vec<Vec<Vec3>>, FileError>;

pub(super) fn broken(unit: &'static str, at: usize, why: impl Into<String>) -> FileError {
    FileError::Broken { unit, at, why: why.into() }
}

pub(super) fn refused(why: impl Into<String>) -> FileError {
    FileError::Refused(why.into())
}
