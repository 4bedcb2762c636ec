//! What a run of the point method is asked for.

use crate::geometry::Block;
use crate::grid::Grid;
use crate::method::PointOptions;
use crate::numeric::query::NEAREST;
use crate::occlusion::pitch::Pitch;
use crate::scene::Scene;
use crate::view::View;
use crate::walk::{Shells, Start};

/// What a run of the point method is asked for. Nothing of it changes in the run.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub(super) scene: &'a Scene,
    pub(super) view: &'a View,
    pub(super) options: &'a PointOptions,
    /// Only the objects before these boxes are asked for.
    pub(super) receivers: Option<&'a [Block]>,
    /// Whether dynamic objects and their volumes are passed over.
    pub(super) fixed_only: bool,
    /// Whether the run uses the memory of the last one.
    pub(super) coherent: bool,
    /// Whether threads of the current pool share the work.
    #[cfg(feature = "rayon")]
    parallel: bool,
}

/// How finely the buffers of a view of the scene are divided.
pub(crate) fn pitch(scene: &Scene, options: &PointOptions) -> Pitch {
    let (min, max) = scene.extent();
    Pitch {
        pixels: 90.0 / f64::from(options.pixel_degrees),
        least: f64::from(options.min_pixels),
        nearest: NEAREST * scene.grid().cell_size(),
        radius: (max - min).length() * 0.5,
        middle: (min + max) * 0.5,
    }
}

impl PointOptions {
    /// Whether runs keep the memory of the last one. Limits choose by rules of their own among all
    /// occluders.
    pub(super) fn keeps_memory(&self) -> bool {
        self.coherent && self.max_occluders == u32::MAX && self.min_solid_angle == 0.0
    }
}

impl<'a> Run<'a> {
    pub(crate) fn new(scene: &'a Scene, view: &'a View, options: &'a PointOptions) -> Self {
        Self {
            scene,
            view,
            options,
            receivers: None,
            fixed_only: false,
            coherent: options.keeps_memory(),
            #[cfg(feature = "rayon")]
            parallel: false,
        }
    }

    /// Leaves out objects that lie before none of the receivers.
    pub(crate) fn with_receivers(mut self, receivers: Option<&'a [Block]>) -> Self {
        self.coherent &= receivers.is_none();
        self.receivers = receivers;
        self
    }

    /// Passes over dynamic objects.
    pub(crate) fn with_fixed_only(mut self, fixed_only: bool) -> Self {
        self.fixed_only = fixed_only;
        self
    }

    /// Lets threads of the current pool share the work.
    #[cfg(feature = "rayon")]
    pub(crate) fn with_parallel(mut self, parallel: bool) -> Self {
        self.parallel = parallel;
        self
    }

    /// Whether threads of the current pool share the work.
    pub(super) fn is_parallel(&self) -> bool {
        #[cfg(feature = "rayon")]
        let parallel = self.parallel && rayon::current_num_threads() > 1;
        #[cfg(not(feature = "rayon"))]
        let parallel = false;
        parallel
    }

    /// The shells of bricks around the eye's brick, if the walk goes in shells.
    pub(super) fn shells(&self, bricks: &Grid) -> Option<Shells> {
        Shells::around_eye(bricks, self.view, Start::Eye)
    }
}
