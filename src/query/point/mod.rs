//! The point method: the objects that can be seen from the eye, at pixel precision.
//!
//! The walk goes out from the eye in chessboard shells of bricks (8x8x8 cells), inside the frustum
//! only. A brick is tested before the objects in it ([`bricks`]), an object before it is drawn as
//! an occluder ([`objects`], [`drawing`]), and the walk ends when every pixel is closed. Small moving objects that hide nothing are found then, zone by zone ([`movers`]).
//! Objects that were found visible are tested once more when all occluders are drawn, so that the
//! order matters for speed only; undecided pixels are refined ([`decide`]). Runs may build
//! on the one before (`drawing::coherence`).

#[cfg(feature = "rayon")]
mod ahead;
mod bricks;
mod decide;
pub(crate) mod drawing;
pub(crate) mod follow;
mod movers;
mod objects;
pub(crate) mod offered;
pub(crate) mod overlay;
mod planes;
pub(crate) mod run;
pub(crate) mod scratch;
mod volumes;

use smallvec::SmallVec;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::matrix::fused::Fused;
use crate::pvs::{Pvs, Stats};
use crate::query::marks::Marks;
use crate::query::point::drawing::Drawing;
use crate::query::point::run::{Run, pitch};
use crate::query::point::scratch::{PointScratch, WalkScratch};
use crate::scene::LayerOpacity;
use crate::view::Origin;
use crate::walk::Shells;

/// The walk of one run of the point method.
pub(crate) struct PointWalk<'a> {
    run: Run<'a>,
    pvs: &'a mut Pvs,
    drawing: Drawing<'a>,
    marks: &'a mut Marks,
    scratch: &'a mut WalkScratch,
    /// The grid of bricks.
    grid: Grid,
    /// The boxes of opaque cells of the occluders that the view shows.
    fused: SmallVec<[&'a Fused; 2]>,
    /// The shells of bricks around the eye's brick, if the walk goes in shells.
    around: Option<Shells>,
    stats: Stats,
}

impl<'a> PointWalk<'a> {
    pub(crate) fn new(
        run: Run<'a>,
        pvs: &'a mut Pvs,
        marks: &'a mut Marks,
        scratch: &'a mut PointScratch,
    ) -> Self {
        let Run { scene, view, .. } = run;
        let PointScratch { drawing, walk: scratch } = scratch;
        marks.begin(scene.slot_count());
        scratch.begin();
        let grid = scene.grid().bricks();
        let around = run.shells(&grid);
        let begins = around.as_ref().map(|shells| shells.begins(&grid));
        Self {
            run,
            pvs,
            drawing: Drawing::new(run, begins, drawing),
            marks,
            scratch,
            grid,
            fused: scene.opacity(view.layers()).map(LayerOpacity::fused).collect(),
            around,
            stats: Stats::default(),
        }
    }

    /// Fills the set.
    pub(crate) fn run(mut self) {
        self.stats.pixels = self.drawing.begin_buffers();
        if self.run.coherent {
            self.drawing.draw_useful();
        }
        self.find_all();
        if !self.run.fixed_only {
            self.test_outer_volumes();
        }
        self.find_movers();
        self.decide();
        if self.run.coherent {
            self.drawing.remember(&self.pvs.visible, &self.scratch.used);
        }
        self.pvs.stats = self.drawing.add_to(self.stats);
    }

    /// Finds the objects of the whole scene that the buffers do not hide.
    fn find_all(&mut self) {
        for slot in self.run.scene.always().iter().copied().chain(self.run.scene.overdue()) {
            self.find(slot);
        }
        self.settle();
        match (self.run.view.origin, self.around.clone()) {
            (Origin::Eye { at, .. }, Some(shells)) => {
                self.reveal_around(at);
                self.in_shells(&shells, at);
            }
            (Origin::Eye { at, .. }, None) => {
                self.reveal_around(at);
                self.everywhere(pitch(self.run.scene, self.run.options).middle - at);
            }
            (Origin::Direction(d), _) => self.everywhere(d),
        }
        self.find_overhanging();
    }

    /// Whether a box in world units is hidden by the occluders drawn so far.
    fn hides(&self, bounds: &Block) -> bool {
        self.drawing.hides(bounds)
    }
}
