//! Why there is no light.

use casca_stage::gpu::GpuError;

use crate::numeric::{MOST_TRIANGLES, RESOLUTIONS};

/// A buffer or texture, as errors name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// What it holds.
    pub name: &'static str,
    /// The things that it grows with, such as cells or pixels.
    pub by: &'static str,
}

impl Part {
    /// Something that grows with the cells of the grid.
    pub const fn of_cells(name: &'static str) -> Self {
        Self { name, by: "cells" }
    }
}

/// Why a scene cannot be lit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LightError {
    /// There is no device, or it is lost.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The adapter lacks something that the shaders need.
    #[error("the adapter lacks {0}, which the shaders need: choose another adapter or driver")]
    Lacks(&'static str),
    /// The scene has no triangles at all.
    #[error("the scene has no triangles")]
    NoTriangles,
    /// Each triangle of the scene has a flaw.
    #[error(
        "none of the scene's {triangles} triangles can be lit: {corners} have corners that do not exist or are not finite, {far} lie too far from the others, {materials} have no material"
    )]
    NoSoundTriangles {
        /// Triangles in all.
        triangles: usize,
        /// Those with a corner that does not exist, or is not finite.
        corners: usize,
        /// Those that lie too far from the others for single precision.
        far: usize,
        /// Those whose material does not exist.
        materials: usize,
    },
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
    #[error("{what} takes {needed} {unit}, but the adapter has {limit}; fewer {by} take less")]
    TooLarge {
        /// The buffer or texture.
        what: &'static str,
        /// What it takes.
        needed: u64,
        /// What there is.
        limit: u64,
        /// Of which unit.
        unit: &'static str,
        /// The things it grows with.
        by: &'static str,
    },
    /// The device has no memory left.
    #[error("the device has no memory for {}; fewer {} take less", .0.name, .0.by)]
    NoMemory(Part),
    /// An object that the scene does not have, or that does not move.
    #[error("object {0} does not exist or was not described as one that moves")]
    Object(usize),
}
