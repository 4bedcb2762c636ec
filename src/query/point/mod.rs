//! The point method: the objects that can be seen from the eye, at pixel precision.
//!
//! The walk goes out from the eye in chessboard shells of bricks (8x8x8 cells), inside the frustum
//! only. A brick is tested before the objects in it ([`bricks`]), an object before it is drawn as
//! an occluder ([`objects`], [`drawing`]), and the walk ends when every pixel is closed. Small
//! moving objects that hide nothing are found then, zone by zone ([`movers`]). Objects that were
//! found visible are tested once more when all occluders are drawn, so that the order matters for
//! speed only; undecided pixels are refined ([`decide`]). Runs may build on the one before.

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
mod volumes;

use casca_slots::Slot;
use glam::IVec3;
use smallvec::SmallVec;

use crate::grid::Grid;
use crate::id::ObjectId;
use crate::matrix::fused::Fused;
use crate::pvs::Pvs;
use crate::query::marks::Marks;
use crate::query::point::decide::{Candidate, SecondTest};
use crate::query::point::drawing::{Drawing, DrawingScratch};
use crate::query::point::run::{Run, pitch};
use crate::scene::LayerOpacity;
use crate::view::Origin;
use crate::walk::{Shells, Start};

/// The walk of one run of the point method.
pub(crate) struct PointWalk<'a> {
    run: Run<'a>,
    pvs: &'a mut Pvs,
    drawing: Drawing<'a>,
    marks: &'a mut Marks,
    /// Tests what was found again.
    second: &'a mut SecondTest,
    scratch: &'a mut WalkScratch,
    /// The grid of bricks.
    grid: Grid,
    /// The boxes of opaque cells of the occluders that the view shows.
    fused: SmallVec<[&'a Fused; 2]>,
    /// The shells of bricks around the eye's brick, if the walk goes in shells.
    around: Option<Shells>,
}

/// The memory of the point method, reused from query to query.
#[derive(Debug, Clone, Default)]
pub(crate) struct PointScratch {
    pub(crate) drawing: DrawingScratch,
    second: SecondTest,
    walk: WalkScratch,
}

/// The memory of finding objects.
#[derive(Debug, Clone, Default)]
struct WalkScratch {
    bricks: Vec<IVec3>,
    /// Bricks of a shell with temporal bounding volumes that are not hidden.
    volumes: Vec<IVec3>,
    /// Undecided objects of a brick.
    open: Vec<Slot>,
    /// Objects of a shell.
    objects: Vec<Candidate>,
    /// Numbers that sort them by distance, with the place of each.
    found: Vec<u128>,
    /// Objects found visible so far.
    candidates: Vec<Candidate>,
    /// Small moving objects that need no further test.
    movers: Vec<ObjectId>,
    /// Zones of such objects in the frustum, with their distances.
    zones: Vec<(f64, u32)>,
}

impl<'a> PointWalk<'a> {
    pub(crate) fn new(
        run: Run<'a>,
        pvs: &'a mut Pvs,
        marks: &'a mut Marks,
        scratch: &'a mut PointScratch,
    ) -> Self {
        let Run { scene, view, .. } = run;
        let PointScratch { drawing, second, walk: scratch } = scratch;
        marks.begin(scene.slot_count());
        scratch.candidates.clear();
        scratch.movers.clear();
        let grid = scene.grid().bricks();
        let around = Shells::around_eye(&grid, view, Start::Eye);
        let begins = around.as_ref().map(|shells| shells.begins(&grid));
        Self {
            run,
            pvs,
            drawing: Drawing::new(run, begins, drawing),
            marks,
            second,
            scratch,
            grid,
            fused: scene.opacity(view.layers()).map(LayerOpacity::fused).collect(),
            around,
        }
    }

    /// Fills the set.
    pub(crate) fn run(mut self) {
        let Run { scene, view, options, receivers, .. } = self.run;
        let buffers = self.drawing.buffers_mut();
        buffers.begin(view, &pitch(scene, options));
        if let Some(receivers) = receivers {
            buffers.keep_before(receivers, view.is_ordered());
        }
        self.drawing.stats.pixels = self.drawing.buffers().pixels();
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
            self.drawing.remember(&self.pvs.visible, &self.second.used);
        }
        self.pvs.stats = self.drawing.stats;
    }

    /// Tests again what was found, and fills the set with those found visible and the small moving
    /// objects that need no further test.
    fn decide(&mut self) {
        self.second.decide(&mut self.drawing, &mut self.scratch.candidates);
        for candidate in self.second.seen(&self.scratch.candidates) {
            self.pvs.push(self.run.scene.id(candidate.slot));
        }
        self.drawing.stats.occlusion_tests += self.scratch.movers.len() as u32;
        self.scratch.movers.iter().for_each(|&id| self.pvs.push(id));
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
}
