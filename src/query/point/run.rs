//! What a run of the point method is asked for.

use crate::geometry::Block;
use crate::method::PointOptions;
use crate::numeric::query::NEAREST;
use crate::occlusion::pitch::Pitch;
use crate::scene::Scene;
use crate::view::View;

/// What a run of the point method is asked for. Nothing of it changes in the run.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) view: &'a View,
    pub(crate) options: &'a PointOptions,
    /// Only the objects before these boxes are asked for.
    pub(crate) receivers: Option<&'a [Block]>,
    /// Whether dynamic objects and their volumes are passed over.
    pub(crate) fixed_only: bool,
    /// Whether the memory of the last run is kept up.
    pub(crate) keeps_memory: bool,
    /// Whether the run uses it.
    pub(crate) coherent: bool,
    /// Whether threads of the current pool share the work.
    #[cfg(feature = "rayon")]
    pub(crate) parallel: bool,
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
    /// The same options, but open pixels are not refined.
    pub(crate) fn unrefined(self) -> Self {
        Self { refine_squares: 0, refine_patches: 0, coherent: false, ..self }
    }
}

impl<'a> Run<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        view: &'a View,
        options: &'a PointOptions,
        receivers: Option<&'a [Block]>,
    ) -> Self {
        Self {
            scene,
            view,
            options,
            receivers,
            fixed_only: false,
            keeps_memory: options.coherent,
            coherent: options.coherent && receivers.is_none(),
            #[cfg(feature = "rayon")]
            parallel: false,
        }
    }

    /// Whether threads of the current pool share the work.
    pub(super) fn is_parallel(&self) -> bool {
        #[cfg(feature = "rayon")]
        let parallel = self.parallel && rayon::current_num_threads() > 1;
        #[cfg(not(feature = "rayon"))]
        let parallel = false;
        parallel
    }
}
