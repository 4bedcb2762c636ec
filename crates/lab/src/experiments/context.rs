//! What experiments are told.

use std::path::PathBuf;

/// Why an experiment failed.
pub type LabError = Box<dyn std::error::Error + Send + Sync>;

/// Pictures are this many times as wide as high.
pub(crate) const ASPECT: f32 = 16.0 / 9.0;

/// What experiments are told.
pub struct Lab<'a> {
    /// Takes less of everything, for a smoke run; the figures are of no use then.
    pub quick: bool,
    /// Seed of all that is random.
    pub seed: u64,
    /// glTF files that join the procedural scenes.
    pub files: Vec<PathBuf>,
    /// The folder that charts and tables are written into.
    pub folder: PathBuf,
    /// Gets a message at each step.
    pub progress: &'a dyn Fn(&str),
}

impl Lab<'_> {
    /// The first value in a full run, the second in a quick one.
    pub fn pick<T>(&self, full: T, quick: T) -> T {
        if self.quick { quick } else { full }
    }
}
