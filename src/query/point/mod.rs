//! The point method: the objects that can be seen from the eye, at pixel precision.
//!
//! The walk goes out from the eye in chessboard shells of bricks (8x8x8 cells), inside the frustum
//! only. A brick is tested before the objects in it ([`bricks`]), an object before it is drawn as
//! an occluder ([`finder`], [`drawing`]), and the walk ends when every pixel is closed. Small
//! moving objects that hide nothing are found then, zone by zone ([`movers`]). Objects that were
//! found visible are tested once more when all occluders are drawn, so that the order matters for
//! speed only; undecided pixels are refined ([`decide`]). Runs may build on the one before.

#[cfg(feature = "rayon")]
mod ahead;
mod bricks;
mod decide;
pub(crate) mod drawing;
mod finder;
mod movers;
pub(crate) mod run;

use casca_slots::Slot;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::pvs::Pvs;
use crate::query::marks::Marks;
use crate::query::point::bricks::{BrickLists, find_all};
use crate::query::point::decide::SecondTest;
use crate::query::point::drawing::{Drawing, DrawingScratch, Offered};
use crate::query::point::finder::{FoundObjects, ObjectFinder};
use crate::query::point::movers::find_movers;
use crate::query::point::run::{Run, pitch};

/// The memory of the point method, reused from query to query.
#[derive(Debug, Clone, Default)]
pub(crate) struct PointScratch {
    pub(crate) drawing: DrawingScratch,
    second: SecondTest,
    found: FoundObjects,
    bricks: BrickLists,
    /// Zones of small moving objects in the frustum, with their distances.
    zones: Vec<(f64, u32)>,
}

/// What a run must be told of the changes since the one before.
#[derive(Debug, Default)]
pub(crate) struct StaticChanges {
    /// The slots of static objects that came or changed.
    pub(crate) fresh: Vec<Slot>,
    /// The slots of the objects in the set that stayed as they are.
    pub(crate) known: Vec<Slot>,
    /// Around the occluders that are gone, those that changed among them.
    pub(crate) gone: SmallVec<[Block; 4]>,
}

impl PointScratch {
    /// Fills a set.
    pub(crate) fn run(&mut self, run: Run, pvs: &mut Pvs, marks: &mut Marks) {
        let Run { scene, view, options, receivers, coherent, .. } = run;
        let Self { drawing, second, found, bricks, zones } = self;
        let mut finder = ObjectFinder::new(Drawing::new(run, drawing), pvs, marks, found);
        let buffers = finder.drawing.buffers_mut();
        buffers.begin(view, &pitch(scene, options));
        if let Some(receivers) = receivers {
            buffers.keep_before(receivers, view.is_ordered());
        }
        finder.drawing.stats.pixels = buffers.pixels();
        if coherent {
            finder.drawing.draw_useful();
        }
        find_all(&mut finder, bricks);
        find_movers(&mut finder, zones);
        decide(finder, second);
    }

    /// Goes on with the buffers of the last run, which was of the same view, after static objects
    /// came, went or changed. `offered` are the objects that they rest on and that stayed. Fills
    /// the set with the objects that are not known. Returns the share of the pixels that were
    /// opened.
    ///
    /// Where an occluder is gone, the tiles around its box are opened, that box grown by the reach;
    /// the occluders of other objects that reach into them are drawn again, and the walk finds the
    /// objects that come into sight. Objects that are new are tested, and their occluders drawn,
    /// like any others.
    ///
    /// Nothing visible is lost: let a pixel be covered that was not opened. Every ray that it
    /// hides, from any eye within reach, met a solid or a patch. A ray that ends in a pixel that was
    /// not opened passes no point of an occluder that is gone: otherwise the ray from the middle to
    /// the same end would pass within the reach of that point. So the ray met others, which are
    /// there. Occluders that were never offered need no hole: no free ray reached them.
    ///
    /// Open pixels must not be [refined](crate::PointOptions::unrefined), since the lists of
    /// occluders in the buffers name some that are gone.
    pub(crate) fn follow(
        &mut self,
        run: Run,
        pvs: &mut Pvs,
        marks: &mut Marks,
        changes: &StaticChanges,
        offered: &Offered,
    ) -> f64 {
        let Self { drawing, second, found, bricks, .. } = self;
        let mut finder = ObjectFinder::new(Drawing::new(run, drawing), pvs, marks, found);
        changes.known.iter().for_each(|&slot| {
            finder.marks.decide(slot);
        });
        let drawing = &mut finder.drawing;
        let pixels = drawing.buffers().pixels().max(1) as f64;
        let holes = drawing.buffers_mut().reopen(&changes.gone);
        if !holes.is_empty() {
            for slot in offered.slots() {
                let block = run.scene.living_at(slot).and_then(|o| o.occluder()).map(|o| o.block());
                if block.is_some_and(|block| drawing.buffers().reaches_into(&block, &holes)) {
                    drawing.draw(slot);
                }
            }
        }
        changes.fresh.iter().for_each(|&slot| finder.find(slot));
        finder.settle();
        finder.drawing.draw_patches();
        if !holes.is_empty() {
            find_all(&mut finder, bricks);
        }
        decide(finder, second);
        holes.iter().map(|hole| hole.pixels() as f64).sum::<f64>() / pixels
    }
}

/// Tests the objects that were found again. The set gets the visible ones.
fn decide(finder: ObjectFinder, second: &mut SecondTest) {
    let ObjectFinder { mut drawing, pvs, found, .. } = finder;
    let Run { scene, coherent, .. } = drawing.run;
    second.decide(&mut drawing, &found.candidates);
    second.seen(&found.candidates).for_each(|candidate| pvs.push(scene.id(candidate.slot)));
    found.in_the_open.iter().for_each(|&id| pvs.push(id));
    if coherent {
        drawing.remember(&pvs.visible, &second.used);
    }
    pvs.stats = drawing.stats;
}
