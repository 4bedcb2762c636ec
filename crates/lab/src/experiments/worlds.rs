//! The worlds that experiments over all scenes walk through.

use std::path::Path;

use super::{Lab, LabError};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::import;
use casca_scenes::world::World;

/// A scene to walk through, by name or file.
#[derive(Debug, Clone)]
pub(super) enum Place<'a> {
    Built(SceneKind),
    File(&'a Path),
}

/// The procedural scenes of solids, then the files of the lab.
pub(super) fn places<'a>(lab: &'a Lab) -> Vec<Place<'a>> {
    let built = SceneKind::SOLIDS.iter().copied().map(Place::Built);
    built.chain(lab.files.iter().map(|f| Place::File(f))).collect()
}

impl Place<'_> {
    /// Builds or loads it.
    ///
    /// # Errors
    /// As [`import::load`].
    pub(super) fn open(&self, lab: &Lab) -> Result<World, LabError> {
        Ok(match self {
            Self::Built(kind) => build(*kind, &SceneOptions { seed: lab.seed, ..SceneOptions::default() }),
            Self::File(path) => import::load(path)?,
        })
    }
}
