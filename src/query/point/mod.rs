//! The point method: the objects that can be seen from the eye, at pixel precision.
//!
//! The walk goes out from the eye in chessboard shells of bricks (8x8x8 cells), inside the frustum
//! only. A brick is tested before the objects in it ([`bricks`]), an object before it is drawn as
//! an occluder ([`objects`], [`occluders`], [`surfaces`]), and the walk ends when every pixel is
//! closed. Small moving objects that hide nothing are found then, zone by zone ([`movers`]).
//! Objects that were found visible are tested once more when all occluders are drawn, so that the
//! order matters for speed only; undecided pixels are refined ([`decide`]). Runs may build
//! on the one before ([`coherence`]).

#[cfg(feature = "rayon")]
mod ahead;
mod bricks;
mod coherence;
mod decide;
mod drawables;
pub(crate) mod follow;
mod movers;
mod objects;
mod occluders;
pub(crate) mod offered;
pub(crate) mod overlay;
mod planes;
mod recall;
pub(crate) mod scratch;
mod surfaces;
mod volumes;

use crate::geometry::Block;
use smallvec::SmallVec;

use crate::grid::Grid;
use crate::matrix::fused::Fused;
use crate::method::PointOptions;
use crate::numeric::query::NEAREST;
use crate::occlusion::pitch::Pitch;
use crate::pvs::{Pvs, Stats};
use crate::query::marks::Marks;
use crate::query::point::scratch::PointScratch;
use crate::query::start::Starts;
use crate::scene::{LayerOpacity, Scene};
use crate::view::{Origin, View};
use crate::walk::{ShellBegins, Shells, Start};

/// One run of the point method.
pub(crate) struct PointWalk<'a> {
    scene: &'a Scene,
    view: &'a View,
    options: &'a PointOptions,
    pvs: &'a mut Pvs,
    marks: &'a mut Marks,
    scratch: &'a mut PointScratch,
    /// Where rays start beside the eye.
    starts: Starts,
    /// A box around the eye and those regions; `None` for parallel rays.
    around_starts: Option<Block>,
    /// How finely the buffers are divided.
    pitch: Pitch,
    /// The grid of bricks.
    grid: Grid,
    /// The boxes of opaque cells of the occluders that the view shows.
    fused: SmallVec<[&'a Fused; 2]>,
    /// Whether boxes of opaque cells may be drawn, once that was found out.
    fuses: Option<bool>,
    /// The shells of bricks around the eye's brick, if the walk goes in shells.
    around: Option<Shells>,
    /// The shell that a box begins in, if the walk goes in shells.
    begins: Option<ShellBegins>,
    /// Only the objects before these boxes are asked for.
    receivers: Option<&'a [Block]>,
    /// Whether dynamic objects and their volumes are passed over.
    fixed_only: bool,
    /// Whether the run uses the memory of the last one.
    coherent: bool,
    /// Whether threads of the current pool share the work.
    #[cfg(feature = "rayon")]
    parallel: bool,
    stats: Stats,
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

impl<'a> PointWalk<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        view: &'a View,
        options: &'a PointOptions,
        pvs: &'a mut Pvs,
        marks: &'a mut Marks,
        scratch: &'a mut PointScratch,
    ) -> Self {
        marks.begin(scene.slot_count());
        scratch.begin(scene.slot_count(), scene.seams().patches(), marks.epoch());
        // Limits choose by rules of their own among all occluders.
        let coherent =
            options.coherent && options.max_occluders == u32::MAX && options.min_solid_angle == 0.0;
        if coherent {
            scratch.coherence.begin(scene.tag(), scene.slot_count(), scene.seams().patches());
        }
        let grid = scene.grid().bricks();
        let starts = Starts::of(scene, view);
        let around = Shells::around_eye(&grid, view, Start::Eye);
        Self {
            scene,
            view,
            options,
            pvs,
            marks,
            scratch,
            around_starts: view.eye().map(|eye| starts.around(eye)),
            starts,
            pitch: pitch(scene, options),
            grid,
            fused: scene.opacity(view.layers()).map(LayerOpacity::fused).collect(),
            fuses: None,
            begins: around.as_ref().map(|shells| shells.begins(&grid)),
            around,
            receivers: None,
            fixed_only: false,
            coherent,
            #[cfg(feature = "rayon")]
            parallel: false,
            stats: Stats::default(),
        }
    }

    /// Leaves out objects that lie before none of the receivers.
    pub(crate) fn with_receivers(mut self, receivers: Option<&'a [Block]>) -> Self {
        self.coherent &= receivers.is_none();
        self.receivers = receivers;
        self
    }

    /// Lets threads of the current pool share the work.
    #[cfg(feature = "rayon")]
    pub(crate) fn with_parallel(mut self, parallel: bool) -> Self {
        self.parallel = parallel;
        self
    }

    /// Whether threads of the current pool share the work.
    fn is_parallel(&self) -> bool {
        #[cfg(feature = "rayon")]
        let parallel = self.parallel && rayon::current_num_threads() > 1;
        #[cfg(not(feature = "rayon"))]
        let parallel = false;
        parallel
    }

    /// Passes over dynamic objects.
    pub(crate) fn with_fixed_only(mut self, fixed_only: bool) -> Self {
        self.fixed_only = fixed_only;
        self
    }

    /// Fills the set.
    pub(crate) fn run(mut self) {
        self.scratch.buffers.begin(self.view, &self.pitch);
        if let Some(receivers) = self.receivers {
            self.scratch.buffers.keep_before(receivers, self.view.is_ordered());
        }
        self.stats.pixels = self.scratch.buffers.pixels();
        if self.coherent {
            self.draw_useful();
        }
        self.find_all();
        if !self.fixed_only {
            self.test_outer_volumes();
        }
        self.find_movers();
        self.decide();
        if self.coherent {
            self.remember();
        }
        self.pvs.stats = self.stats;
    }

    /// Finds the objects of the whole scene that the buffers do not hide.
    fn find_all(&mut self) {
        for slot in self.scene.always().iter().copied().chain(self.scene.overdue()) {
            self.find(slot);
        }
        self.settle();
        match (self.view.origin, self.around.clone()) {
            (Origin::Eye { at, .. }, Some(shells)) => {
                self.reveal_around(at);
                self.in_shells(&shells, at);
            }
            (Origin::Eye { at, .. }, None) => {
                self.reveal_around(at);
                self.everywhere(self.pitch.middle - at);
            }
            (Origin::Direction(d), _) => self.everywhere(d),
        }
        self.find_overhanging();
    }

    /// Whether a box in world units is hidden by the occluders drawn so far.
    fn hides(&self, bounds: &Block) -> bool {
        self.scratch.hides(bounds)
    }
}
