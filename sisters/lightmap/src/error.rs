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
    /// A setting that is out of its range: its name, its value, and the least and the greatest one.
    #[error("{0} are {1}: there must be {2} to {3}")]
    Setting(&'static str, f32, f32, f32),
    /// The surfaces need too many texels: how many, the most, and so many a metre that would do.
    #[error("{0:.2e} texels are needed, and {1:.2e} are the most; {2:.3} a metre would do")]
    Texels(f64, f64, f64),
    /// A mesh fits on no page, or has a form that cannot be unwrapped.
    #[error("a mesh cannot be unwrapped: {0}; fewer texels a metre, or larger pages, may help")]
    Unwrap(uvunwrap::Error),
    /// More probes along the axes than a texture of three dimensions takes, and a spacing that would do.
    #[error("{0:?} probes along x, y and z are too many: a spacing of {1} m would do")]
    Probes([f32; 3], f32),
    /// The lit level does not fit into a file.
    #[error("the lit level would have more than 4 GB, which no .glb can hold")]
    TooLarge,
}
