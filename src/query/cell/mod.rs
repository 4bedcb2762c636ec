//! The cell method: the objects that can be seen from anywhere in the viewer's cell.

mod bands;
mod cell_ids;
mod ending;
mod everything;
pub(crate) mod lists;
pub(crate) mod masks;
mod objects;
mod overhang;
mod remaining;
pub(crate) mod scratch;
mod shell_scale;
mod side;
mod side_cells;
mod spans;

use casca_slots::Slot;
use glam::IVec3;
use smallvec::SmallVec;

use crate::matrix::bits::BitMatrix;
use crate::method::CellOptions;
use crate::numeric::query::UNCERTAIN_EYE;
use crate::pvs::{Pvs, Stats};
use crate::query::cell::lists::CellLists;
use crate::query::cell::remaining::Remaining;
use crate::query::cell::scratch::CellScratch;
use crate::query::cell::shell_scale::ShellScale;
use crate::query::cell::side_cells::SideCells;
use crate::query::cell::spans::{next_clear, next_set};
use crate::query::marks::Marks;
use crate::query::start::{Starts, rays_start_in_occluder};
use crate::scene::Scene;
use crate::view::View;
use crate::walk::{Shells, Start};

/// The matrices of visited and of hidden cells, if they are recorded.
pub(crate) type Recorded<'a> = Option<(&'a mut BitMatrix, &'a mut BitMatrix)>;

/// One run of the cell method.
pub(crate) struct CellWalk<'a> {
    scene: &'a Scene,
    view: &'a View,
    options: &'a CellOptions,
    pvs: &'a mut Pvs,
    marks: &'a mut Marks,
    /// The objects by cell.
    lists: &'a CellLists,
    scratch: &'a mut CellScratch,
    record: Recorded<'a>,
    /// The shells around the viewer's cell; around the middle of the grid without one.
    shells: Shells,
    /// Whether the walk starts at the viewer's cell: the frustum is then widened to contain the eye
    /// and all of that cell.
    from_eye: bool,
    /// The cells that count as opaque.
    opaque: SmallVec<[&'a BitMatrix; 4]>,
    /// For each side, about where cells were last in sight: a share of its rows.
    seen_at: [f64; 6],
    remaining: Remaining,
    stats: Stats,
}

impl<'a> CellWalk<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        view: &'a View,
        options: &'a CellOptions,
        pvs: &'a mut Pvs,
        marks: &'a mut Marks,
        lists: &'a CellLists,
        scratch: &'a mut CellScratch,
    ) -> Self {
        marks.begin(scene.slot_count());
        let around_eye = Shells::around_eye(scene.grid(), view, Start::Cell);
        let from_eye = around_eye.is_some();
        let shells = around_eye.unwrap_or_else(|| Shells::around_middle(scene.grid(), view));
        Self {
            scene,
            view,
            options,
            pvs,
            marks,
            lists,
            scratch,
            record: None,
            shells,
            from_eye,
            opaque: scene
                .opacity(view.layers())
                .flat_map(|part| std::iter::once(part.fixed()).chain(part.known_moving()))
                .collect(),
            seen_at: [0.5; 6],
            remaining: Remaining::default(),
            stats: Stats::default(),
        }
    }

    /// Records the cells visited and hidden.
    pub(crate) fn with_record(self, record: Recorded<'a>) -> Self {
        Self { record, ..self }
    }

    /// Fills the set.
    pub(crate) fn run(mut self) {
        match self.occlusion_slack() {
            Some(slack) => {
                self.pvs.cell = Some(self.shells.cell);
                self.walk_shells(Some(slack));
            }
            None => {
                self.find_everything();
                self.record_frustum();
            }
        }
        // Nothing is known to hide objects beyond the grid.
        for &slot in self.scene.volumes().outer().buckets().flat_map(|bucket| bucket.slots()) {
            if self.view.may_see_volume(&self.scene.volume_block(slot)) {
                self.reveal(slot, 0);
                self.decide(slot);
            }
        }
        for slot in self.scene.always().iter().copied().chain(self.scene.overdue()) {
            self.decide(slot);
        }
        self.pvs.stats = self.stats;
    }

    /// Records the cells of the frustum, if cells are recorded, where everything was found without
    /// them.
    fn record_frustum(&mut self) {
        if self.record.is_some() {
            Slot::below(self.scene.slot_count()).for_each(|slot| _ = self.marks.decide(slot));
            self.walk_shells(None);
        }
    }

    /// How far the eye may be outside its cell, in cells, doubled; `None` if nothing may be taken
    /// to be hidden.
    fn occlusion_slack(&mut self) -> Option<f64> {
        let (at, error) = (self.view.eye()?, self.view.eye_box());
        let grid = self.scene.grid();
        self.stats.eye_in_occluder =
            rays_start_in_occluder(self.scene, self.view, &Starts::of(self.scene, self.view));
        let sure = grid.cell_of(at - error) == grid.cell_of(at + error);
        let slack = if sure { 0.0 } else { error.max_element() / grid.cell_size() };
        (!self.stats.eye_in_occluder && self.from_eye && slack <= UNCERTAIN_EYE).then_some(2.0 * slack)
    }

    /// Walks the shells outwards. Without a slack nothing is taken to be hidden.
    fn walk_shells(&mut self, slack: Option<f64>) {
        let grid = self.scene.grid();
        let inside = grid.contains(self.shells.cell);
        let interior =
            self.shells.cell.cmpgt(IVec3::ZERO).all() && self.shells.cell.cmplt(grid.dims() - 1).all();
        let closed = inside && (slack == Some(0.0) || interior);
        self.scratch.masks.clear();
        self.scratch.pending.iter_mut().for_each(Vec::clear);
        self.list_overhanging(slack.is_some());
        if inside {
            self.first_cell();
        }
        // A segment from inside the grid to a farther cell passes each shell inside the grid, on
        // the same side.
        let ends = inside && self.from_eye && slack.is_none_or(|s| s == 0.0 || interior);
        for m in self.shells.nearest.max(1)..=self.shells.farthest {
            // All cells are recorded, also those without objects.
            if self.record.is_none() && !self.search_remaining(m - 1) {
                break;
            }
            self.stats.shells += 1;
            let scale = ShellScale::new(m, self.scratch.masks.log(), slack.unwrap_or(0.0));
            let (mut cells, mut in_sight) = (0, 0);
            for side in 0..6 {
                let (c, v) = self.side(side, m, &scale);
                cells += c;
                in_sight += v;
            }
            self.settle_pending(m, &scale);
            self.stats.cells_visited += cells;
            self.stats.cells_hidden += cells - in_sight;
            if ends && in_sight == 0 && !(0..6).any(|side| self.sees_passed_over(side, m, &scale)) {
                break;
            }
            if slack.is_some() {
                for side in 0..6 {
                    self.stamp(side, m, &scale, closed);
                }
            }
        }
    }

    /// Draws the blocked cells of a side into its mask, unless they appear too small.
    fn stamp(&mut self, index: usize, m: i32, scale: &ShellScale, closed: bool) {
        if !self.scratch.sides[index].fresh.contains(&true) {
            return;
        }
        self.complete(index, m, scale);
        let cells = &self.scratch.sides[index];
        if self.options.min_solid_angle > 0.0 {
            let angle = blocked_cells(cells) as f64 / (scale.shell() as f64).powi(2);
            if angle < f64::from(self.options.min_solid_angle) {
                self.stats.caps_skipped += 1;
                return;
            }
        }
        self.stats.caps_drawn += 1;
        self.scratch.masks.stamp(index, scale, cells, closed);
    }
}

/// Number of cells of the rows with fresh occluders that block.
fn blocked_cells(cells: &SideCells) -> usize {
    let end = cells.offset + cells.cols as usize;
    let fresh = cells.fresh.iter().enumerate().filter(|(_, fresh)| **fresh);
    fresh
        .filter_map(|(r, _)| cells.line(r))
        .map(|open| {
            let (mut sum, mut x) = (0, cells.offset);
            while x < end {
                let stop = next_set(open, x, end);
                sum += stop - x;
                x = next_clear(open, stop, end);
            }
            sum
        })
        .sum()
}
