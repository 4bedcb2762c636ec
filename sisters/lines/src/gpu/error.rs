//! Why nothing is drawn.

use casca_stage::gpu::GpuError;

use crate::gpu::numeric::MOST_THICK;
use crate::occlusion::OptionsError;
use crate::samples::SampleError;
use crate::sets::LineError;
use crate::view::ViewError;

/// Why lines were refused or not drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinesGpuError {
    /// There is no adapter, no room, the device is lost or refuses commands.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The depths of a view are too near to each other.
    #[error(
        "depths from {near} to {far}: single precision needs a range of at least 1/32 of the greatest depth: \
         move the eye nearer, or one of the depths outwards"
    )]
    Depths {
        /// The nearest depth.
        near: f64,
        /// The farthest depth.
        far: f64,
    },
    /// The thickness of smooth lines.
    #[error("lines of {0} pixels: smooth lines are 1 to {MOST_THICK} pixels thick")]
    Thickness(f32),
    /// Lines on the device without places, for an estimator that needs them.
    #[error("the lines have no places: they were put on the device for another estimator")]
    Places,
    /// A view was refused.
    #[error(transparent)]
    View(#[from] ViewError),
    /// An option of the occlusion is out of its range.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// Sets of samples were refused.
    #[error(transparent)]
    Samples(#[from] SampleError),
    /// Lines were refused.
    #[error(transparent)]
    Lines(#[from] LineError),
    /// The scene refused bounds or a view.
    #[error("the scene for culling: {0}")]
    Scene(#[from] casca::Error),
    /// Not as many colours as vertices.
    #[error("{colours} colours for {vertices} vertices")]
    Colours {
        /// The number of colours.
        colours: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// The bundles are those of another set of lines.
    #[error("a bundle with number {number}, but the set has {bundles}")]
    Bundle {
        /// The number asked for.
        number: u32,
        /// The number of bundles.
        bundles: usize,
    },
}
