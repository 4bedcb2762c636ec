//! Why a level is not baked.

use casca_radiosity::LightError;
use casca_scenes::import::Trouble;

/// Why a level is not baked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The file is refused.
    #[error(transparent)]
    Level(#[from] Trouble),
    /// The scene cannot be lit.
    #[error(transparent)]
    Light(#[from] LightError),
    /// Nothing can have a lightmap.
    #[error("no mesh of the level stands still as the file has it, so that nothing can have a lightmap")]
    NothingStill,
    /// A setting that is out of its range.
    #[error("{what} are {value}: there must be {least} to {most}")]
    Setting {
        /// Which.
        what: &'static str,
        /// What was given.
        value: f32,
        /// The least.
        least: f32,
        /// The most.
        most: f32,
    },
    /// The surfaces need too many texels.
    #[error("{needed:.2e} texels are needed, and {most:.2e} are the most; {texels:.3} a metre would do")]
    Texels {
        /// How many.
        needed: f64,
        /// The most.
        most: f64,
        /// So many texels a metre would be few enough.
        texels: f64,
    },
    /// A mesh fits on no page, or has a form that cannot be unwrapped.
    #[error("a mesh cannot be unwrapped: {0}; fewer texels a metre, or larger pages, may help")]
    Unwrap(uvunwrap::Error),
    /// More probes than a texture of three dimensions takes.
    #[error("{counts:?} probes along x, y and z are too many: a spacing of {spacing} m would do")]
    Probes {
        /// How many.
        counts: [f32; 3],
        /// This spacing would do.
        spacing: f32,
    },
    /// The lit level does not fit into a file.
    #[error("the lit level would have more than 4 GB, which no .glb can hold")]
    TooLarge,
}
