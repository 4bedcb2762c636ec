//! Why there is no light.

use casca_stage::gpu::GpuError;

use crate::numeric::MOST_TRIANGLES;
use crate::volume::RESOLUTIONS;

/// Why a scene cannot be lit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LightError {
    /// There is no device, or it is lost.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The scene has no triangle with finite corners and a material.
    #[error("the scene has no triangles with finite corners and a material that exists")]
    NoTriangles,
    /// The scene has more triangles than sums of 32 bits can hold.
    #[error("the scene has {0} triangles; {MOST_TRIANGLES} can be added up")]
    TooManyTriangles(usize),
    /// A number of cells that no grid has.
    #[error("a grid of {0} cells along its longest axis: from {low} to {high} are possible", low = RESOLUTIONS.start(), high = RESOLUTIONS.end())]
    Resolution(u32),
    /// A setting out of its range.
    #[error("{name} is {value}; from {low} to {high} is possible")]
    Setting {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f32,
        /// The least.
        low: f32,
        /// The greatest.
        high: f32,
    },
    /// The grid cannot be made.
    #[error("the grid: {0}")]
    Grid(#[from] casca::Error),
    /// The adapter holds no buffer or texture as large as needed.
    #[error("{what} takes {needed} {unit}, but the adapter has {limit}; fewer cells take less")]
    TooLarge {
        /// The buffer or texture.
        what: &'static str,
        /// What it takes.
        needed: u64,
        /// What there is.
        limit: u64,
        /// Of which unit.
        unit: &'static str,
    },
    /// An object that the scene does not have, or that does not move.
    #[error("object {0} does not exist or was not described as one that moves")]
    Object(usize),
}
