//! Files and folders that cannot be had.

use std::io;
use std::path::{Path, PathBuf};

/// A file or folder that cannot be had.
#[derive(Debug, thiserror::Error)]
#[error("cannot {act} {}: {why}", path.display())]
pub struct PathError {
    act: &'static str,
    path: PathBuf,
    why: io::Error,
}

impl PathError {
    /// A file that cannot be written.
    pub fn write(path: &Path) -> impl FnOnce(io::Error) -> Self {
        Self::to("write", path)
    }

    /// A file that cannot be read.
    pub fn read(path: &Path) -> impl FnOnce(io::Error) -> Self {
        Self::to("read", path)
    }

    /// A file or folder with which something else cannot be done.
    pub fn to(act: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |why| Self { act, path: path.to_owned(), why }
    }
}
