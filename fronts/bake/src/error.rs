//! Why a bake ends early.

use std::path::PathBuf;

use casca_scenes::import::ImportError;

/// Why a bake ends early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The edge of cells or the heights are not positive and finite, or make too many cells.
    #[error(
        "cells must have edges that are greater than 0, the greatest height must exceed the least, and there can be 2^28 cells at most"
    )]
    Places,
    /// The level cannot be loaded.
    #[error(transparent)]
    Level(#[from] ImportError),
    /// The level is none that casca takes.
    #[error("the level cannot be used: {0}")]
    Scene(#[from] casca::Error),
    /// The level was made for sets from cell to cell of another grid, or of fewer cells.
    #[error("the level was made for sets from cell to cell of another grid, or of fewer cells")]
    OtherCells,
    /// A part of several is none of them.
    #[error("part {part} of {parts}: parts are counted from 1")]
    Shard {
        /// The number of the part.
        part: u32,
        /// How many there are.
        parts: u32,
    },
    /// A file cannot be had.
    #[error("cannot {act} {}: {why}", path.display())]
    File {
        /// As in "write" or "read".
        act: &'static str,
        /// The file.
        path: PathBuf,
        /// Why not.
        why: std::io::Error,
    },
    /// A journal was begun with another level or other options.
    #[error(
        "{} was begun with another level or other options: delete it to begin anew", .0.display()
    )]
    OtherJournal(PathBuf),
    /// A file cannot be used.
    #[error("{}: {why}", path.display())]
    Of {
        /// The file.
        path: PathBuf,
        /// Why not.
        why: Box<BakeError>,
    },
    /// The bytes of a file of sets are damaged or of another version.
    #[error(transparent)]
    Read(#[from] casca_baked::ReadError),
    /// A part is of another bake than those before it.
    #[error("the part has other cells, objects or kinds of sets than those before it")]
    OtherBake,
    /// A cell has two sets.
    #[error("the part has another set for cell {0} than one before it")]
    Differs(u32),
    /// The sets make no file.
    #[error("the sets cannot be stored: {0}")]
    Write(#[from] casca_baked::WriteError),
    /// There is nothing to merge.
    #[error("no files were given")]
    NoFiles,
    /// The progress was told to stop.
    #[error("stopped; the journal keeps what is done")]
    Stopped,
}

impl BakeError {
    pub(crate) fn file<'a>(
        act: &'static str,
        path: &'a std::path::Path,
    ) -> impl FnOnce(std::io::Error) -> Self + use<'a> {
        move |why| Self::File { act, path: path.to_owned(), why }
    }

    pub(crate) fn of(self, path: &std::path::Path) -> Self {
        Self::Of { path: path.to_owned(), why: Box::new(self) }
    }
}
