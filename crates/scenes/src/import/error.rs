//! Why files are refused.

use std::path::PathBuf;

/// Why a file was refused.
#[derive(Debug, thiserror::Error)]
#[error("{}: {why}", path.display())]
pub struct ImportError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub why: Trouble,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Trouble {
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// It is no glTF 2.0, or breaks its rules: at which place, and how.
    #[error("is not a valid glTF 2.0 file: {0}")]
    Format(String),
    /// It is of another version of glTF.
    #[error("is glTF, but version {0} is not read; export it as glTF 2.0")]
    Version(String),
    /// A part of it breaks the rules, or is of a kind that is not read: which one, and how.
    #[error("{0}")]
    Part(String),
    /// It requires extensions that are not read.
    #[error("requires extensions that are not read: {0}")]
    Extensions(String),
    /// A coordinate or transform is not finite.
    #[error("{0} is not finite")]
    NotFinite(String),
    /// Nodes are their own ancestors, or have two parents.
    #[error("node {0} is reached twice: nodes must form trees")]
    NotATree(usize),
    /// There is nothing to show.
    #[error("holds no triangles in any node")]
    NoTriangles,
}

pub(super) fn unread(buffer: usize, why: &str) -> Trouble {
    Trouble::Part(format!("buffer {buffer} cannot be read: {why}"))
}

pub(super) fn short(buffer: usize, held: usize, needed: usize) -> Trouble {
    Trouble::Part(format!("buffer {buffer} has {held} bytes, but {needed} are needed"))
}
