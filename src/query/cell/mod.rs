//! The cell method: the objects that can be seen from anywhere in the viewer's cell.

mod cell_ids;
mod everything;
mod finder;
pub(crate) mod lists;
mod mask;
mod matrices;
mod remaining;
mod shell_scale;
mod side;
mod side_cells;
mod sides;
mod spans;

use casca_slots::Slot;
use glam::IVec3;

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::grid::mask::BRICK;
use crate::grid::side::Side;
use crate::numeric::query::UNCERTAIN_EYE;
use crate::pvs::{Pvs, Stats};
use crate::query::cell::everything::find_everything;
use crate::query::cell::finder::Finder;
use crate::query::cell::lists::CellLists;
use crate::query::cell::mask::DirectionMask;
use crate::query::cell::matrices::CellMatrices;
use crate::query::cell::remaining::Remaining;
use crate::query::cell::shell_scale::ShellScale;
use crate::query::cell::side::{CellCounts, Hit, Recorded, SidePass};
use crate::query::cell::side_cells::SideCells;
use crate::query::cell::sides::ShellSide;
use crate::query::marks::Marks;
use crate::query::start::{Starts, rays_start_in_occluder};
use crate::scene::Scene;
use crate::view::View;
use crate::walk::{Shells, Start};

/// The walk goes no farther from the eye's cell than this, in cells.
const FARTHEST: i32 = 2048;

/// The memory of the cell method, reused from query to query.
#[derive(Debug, Clone)]
pub(crate) struct CellScratch {
    sides: [ShellSide; 6],
    hits: Vec<Hit>,
    pending: Vec<Vec<(IVec3, Slot)>>,
}

impl CellScratch {
    /// Memory for masks of `resolution` pixels along each side, a power of two.
    pub(crate) fn new(resolution: u32) -> Self {
        let mask = DirectionMask::new(resolution.trailing_zeros());
        let side = |side| ShellSide { side, mask: mask.clone(), cells: SideCells::default() };
        Self { sides: Side::ALL.map(side), hits: Vec::new(), pending: Vec::new() }
    }

    /// Changes the resolution of the masks.
    pub(crate) fn set_resolution(&mut self, resolution: u32) {
        let log = resolution.trailing_zeros();
        for side in self.sides.iter_mut().filter(|side| side.mask.log() != log) {
            side.mask = DirectionMask::new(log);
        }
    }
}

/// One run of the cell method.
pub(crate) struct CellWalk<'a> {
    shells: &'a Shells,
    matrices: CellMatrices<'a>,
    sides: &'a mut [ShellSide; 6],
    /// What the walk came upon on the side that it is on.
    hits: &'a mut Vec<Hit>,
    finder: Finder<'a>,
    remaining: Remaining,
    record: Recorded<'a>,
}

impl CellWalk<'_> {
    /// Fills the set. Records the cells visited and hidden, if asked to.
    pub(crate) fn run(
        (scene, view): (&Scene, &View),
        pvs: &mut Pvs,
        marks: &mut Marks,
        lists: &CellLists,
        scratch: &mut CellScratch,
        record: Recorded,
    ) {
        let (extent, all) = walked(scene, view);
        // Around the middle without a viewer's cell. From the eye, the frustum is widened to
        // contain it and all of its cell.
        let around_eye = Shells::around_eye(scene.grid(), extent, view, Start::Cell);
        let from_eye = around_eye.is_some();
        let shells = &around_eye.unwrap_or_else(|| Shells::around_middle(scene.grid(), extent, view));
        let CellScratch { sides, hits, pending } = scratch;
        let matrices = CellMatrices::new(scene, view, lists, extent);
        marks.begin(scene.slot_count());
        pending.iter_mut().for_each(Vec::clear);
        let finder = Finder { scene, view, shells, pvs, marks, pending };
        let remaining = Remaining::default();
        let slack = occlusion_slack(scene, view, &mut finder.pvs.stats).filter(|_| from_eye);
        let mut walk = CellWalk { shells, matrices, sides, hits, finder, remaining, record };
        if slack.is_some() {
            walk.finder.pvs.cell = Some(shells.cell);
            walk.walk_shells(slack, from_eye);
        } else {
            find_everything(&mut walk.finder);
            if walk.record.is_some() {
                // Everything was found without cells: they are walked for the record alone.
                Slot::below(scene.slot_count()).for_each(|slot| _ = walk.finder.marks.decide(slot));
                walk.walk_shells(None, from_eye);
            }
        }
        let mut finder = walk.finder;
        if !all {
            find_beyond(&mut finder);
        }
        for slot in scene.always().iter().copied().chain(scene.overdue()) {
            finder.decide(slot);
        }
    }

    /// Walks the shells outwards. Without a slack nothing is taken to be hidden.
    fn walk_shells(&mut self, slack: Option<f64>, from_eye: bool) {
        let (cell, CellBox { lo, hi }) = (self.shells.cell, self.shells.extent);
        let inside = self.shells.extent.contains(cell);
        let interior = cell.cmpgt(lo).all() && cell.cmplt(hi).all();
        // An eye outside its cell sees past the edge of a side, through cells of the next one.
        let closed = inside && slack == Some(0.0);
        // A segment from inside the block that is walked to a farther cell passes each shell inside
        // it, on the same side.
        let ends = inside && from_eye && slack.is_none_or(|s| s == 0.0 || interior);
        self.sides.iter_mut().for_each(ShellSide::clear);
        if inside {
            self.finder.pvs.stats.cells_visited += 1;
            if let Some((visited, _)) = &mut self.record {
                visited.set(cell);
            }
            self.finder.first_cell(self.matrices.lists);
        }
        for m in self.shells.nearest.max(1)..=self.shells.farthest {
            // All cells are recorded, also those without objects.
            if self.record.is_none() && !self.remaining.search(m - 1, &self.finder, self.sides) {
                break;
            }
            let scale = ShellScale::new(m, self.sides[0].mask.log(), slack.unwrap_or(0.0));
            let (mut cells, mut in_sight) = (0, 0);
            for side in 0..6 {
                let counts = self.side(side, &scale);
                cells += counts.total;
                in_sight += counts.in_sight;
            }
            self.finder.settle_pending(&scale, self.sides);
            let stats = &mut self.finder.pvs.stats;
            stats.shells += 1;
            stats.cells_visited += cells;
            stats.cells_hidden += cells - in_sight;
            let sees_passed_over = |side: &mut ShellSide| side.sees_passed_over(&scale, self.shells);
            if ends && in_sight == 0 && !self.sides.iter_mut().any(sees_passed_over) {
                break;
            }
            if slack.is_some() {
                self.stamp(&scale, closed);
            }
        }
    }

    /// Walks one side of a shell. Counts its cells without the parts that contain
    /// nothing or the masks hide all: those are passed over.
    fn side(&mut self, index: usize, scale: &ShellScale) -> CellCounts {
        let ShellSide { side, mask, cells } = &mut self.sides[index];
        let (side, mask, matrices) = (*side, &*mask, &self.matrices);
        let (v, record) = (self.shells.cell, self.record.is_some());
        let (axes, depth) = (side.axes, scale.shell() * side.sign);
        let mut counts = CellCounts::default();
        if self.remaining.is_done(index) {
            cells.clear();
            return counts;
        }
        let Some(frustum) = cells.begin(&side, depth, self.shells) else {
            return counts;
        };
        if !record && matrices.plane_is_empty(axes.normal, (v + side.cell(depth, 0, 0)) >> 6i32) {
            return counts;
        }
        let (c0, c1) = cells.columns();
        let pass = SidePass {
            side,
            scale,
            frustum,
            mask,
            cell: v,
            at: v[axes.normal] + depth,
            words: cells.words,
            first_word: (v[axes.col] + c0) >> 6,
            base: cells.base(),
        };
        for number in 0..cells.bands() {
            let (first, last) = cells.rows_of_band(number);
            let page = (v + side.cell(depth, first, c0)) >> 6i32;
            if !record && matrices.row_is_empty(axes.col, page) {
                continue;
            }
            let part = if record { Some((c0, c1)) } else { mask.open_part(scale, (first, last), (c0, c1)) };
            let Some(part) = part else {
                cells.hide_band(number);
                continue;
            };
            let brick = (v + side.cell(depth, first, part.0)) >> 3i32;
            let columns = (v[axes.col] + part.0, v[axes.col] + part.1);
            if !record && part != (c0, c1) && matrices.pages_are_empty(axes.col, brick, columns) {
                continue;
            }
            let band = cells.make_band(number);
            if !self.shells.frustum.meets(side.cell(depth, first, c0), side.cell(depth, last, c1)) {
                continue;
            }
            self.remaining.add_rows(i64::from(last - first + 1));
            let open = pass.open_rows((first, last), part, band, &mut counts, &mut self.record);
            let Some(open) = open else { continue };
            let fresh = pass.block_tiles(matrices, first, open, band, self.hits);
            if fresh != 0 {
                cells.set_fresh(number, fresh);
            }
        }
        let at = pass.at;
        self.finder.look_up(self.hits, matrices.lists, &side, at, scale, self.sides);
        counts
    }

    /// Draws the blocked cells of the sides into their masks.
    fn stamp(&mut self, scale: &ShellScale, closed: bool) {
        for side in &mut *self.sides {
            if !side.complete(scale, self.shells) {
                continue;
            }
            self.finder.pvs.stats.caps_drawn += 1;
            side.mask.stamp(scale, &side.cells, closed);
        }
    }
}

/// The block of cells that is walked, and whether it contains all that there is: a walk goes no
/// farther than [`FARTHEST`] from the eye.
fn walked(scene: &Scene, view: &View) -> (CellBox, bool) {
    // What is in no cells may make some opaque.
    let layers = scene.opacity(view.layers());
    let opaque = layers.flat_map(|part| [part.fixed().pages().extent(), part.moving().pages().extent()]);
    let CellBox { lo, hi } = opaque.flatten().fold(scene.extent_in_bricks(), CellBox::join);
    let all = CellBox { lo: lo * BRICK, hi: hi * BRICK + (BRICK - 1) };
    let middle = view.eye().map_or(all.middle(), |eye| scene.grid().cell_of(eye)).clamp(all.lo, all.hi);
    let walked = CellBox { lo: all.lo.max(middle - FARTHEST), hi: all.hi.min(middle + FARTHEST) };
    (walked, walked == all)
}

/// Finds what lies, in part or wholly, beyond the block that is walked: nothing is known to hide it.
fn find_beyond(finder: &mut Finder) {
    let (scene, view, extent) = (finder.scene, finder.view, finder.shells.extent);
    for (slot, object) in scene.living() {
        let cells = |block: Block| scene.grid().cover(block.min, block.max);
        let is_hidden = object.is_hidden();
        let block = if is_hidden { scene.volume_block(slot) } else { object.bounds().block() };
        let (lo, hi) = cells(block);
        if extent.contains(lo - 1) && extent.contains(hi + 1) {
            continue;
        }
        if !is_hidden {
            finder.decide(slot);
        } else if view.may_see_volume(&block) {
            finder.reveal(slot, 0);
            finder.decide(slot);
        }
    }
}

/// How far the eye may be outside its cell, in cells, doubled; `None` if nothing may be taken to be
/// hidden.
fn occlusion_slack(scene: &Scene, view: &View, stats: &mut Stats) -> Option<f64> {
    let (at, error, grid) = (view.eye()?, view.eye_box(), scene.grid());
    stats.eye_in_occluder = rays_start_in_occluder(scene, view, &Starts::of(scene, view));
    let sure = grid.cell_of(at - error) == grid.cell_of(at + error);
    let slack = if sure { 0.0 } else { error.max_element() / grid.cell_size() };
    (!stats.eye_in_occluder && slack <= UNCERTAIN_EYE).then_some(2.0 * slack)
}
