//! The cell method: what can be seen from anywhere in the viewer's cell.

pub(crate) mod bands;
pub(crate) mod masks;

use glam::IVec3;

use crate::grid::cell_box::volume;
use crate::grid::side::Side;
use crate::matrix::bits::BitMatrix;
use crate::matrix::tbv::TbvMatrix;
use crate::method::Settings;
use crate::pvs::{Pvs, Stats};
use crate::query::cell::masks::{ShellScale, SideCells, clear_span, next_clear, next_set, set_span};
use crate::query::{FAR_VIEWER, Scratch};
use crate::scene::Scene;
use crate::shape::Shape;
use crate::view::{Origin, View};
use crate::walk::{CellFrustum, shell_range};

/// An eye that may lie this far outside its cell, in cells, gets no occlusion.
const UNCERTAIN_EYE: f64 = 0.2;

/// A revealed object that spans more cells than this is decided without asking which of them are in sight.
const MAX_PENDING: u64 = 1 << 18;

/// One run of the cell method.
pub(crate) struct Walk<'a> {
    scene: &'a Scene,
    view: &'a View,
    settings: &'a Settings,
    pvs: &'a mut Pvs,
    scratch: &'a mut Scratch,
    record: Option<(&'a mut BitMatrix, &'a mut BitMatrix)>,
    /// The viewer's cell.
    cell: IVec3,
    frustum: CellFrustum,
    /// Whether the frustum is widened to hold the eye and all of the viewer's cell.
    holds_eye: bool,
    /// The opaque cells of visible dynamic objects, if they are known.
    dynamic: Option<&'a BitMatrix>,
    /// Cells that count as opaque beside those that are.
    more: Option<&'a BitMatrix>,
    /// By side, about where in it cells were last in sight: a share of its rows.
    seen_at: [f64; 6],
    stats: Stats,
}

impl<'a> Walk<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        view: &'a View,
        settings: &'a Settings,
        pvs: &'a mut Pvs,
        scratch: &'a mut Scratch,
        record: Option<(&'a mut BitMatrix, &'a mut BitMatrix)>,
    ) -> Self {
        let grid = scene.grid();
        // Parallel rays come from no cell: the walk starts where they enter the grid.
        let eye = view.eye().unwrap_or((grid.min() + grid.max()) * 0.5);
        let cell = grid.cell_of(eye);
        scratch.begin(scene.slot_count());
        let frustum = CellFrustum::with_cell(grid, view, cell);
        Self {
            scene,
            view,
            settings,
            pvs,
            scratch,
            record,
            cell,
            frustum,
            holds_eye: true,
            dynamic: scene.known_dynamic_opacity(),
            more: None,
            seen_at: [0.5; 6],
            stats: Stats::default(),
        }
    }

    /// Counts more cells as opaque.
    pub(crate) fn with_more(self, more: Option<&'a BitMatrix>) -> Self {
        Self { more, ..self }
    }

    pub(crate) fn run(mut self) {
        let grid = *self.scene.grid();
        let (nearest, farthest) = shell_range(&grid, self.cell);
        match self.occlusion_slack(nearest) {
            Some(slack) => {
                self.pvs.cell = Some(self.cell);
                self.shells(nearest, farthest, Some(slack));
            }
            None if nearest <= FAR_VIEWER && self.view.eye().is_some() => {
                self.shells(nearest, farthest, None);
            }
            // Without a viewer's cell near the grid, the walk starts in its middle.
            None => {
                self.cell = grid.dims() / 2;
                self.frustum = CellFrustum::without_eye(&grid, self.view, self.cell);
                self.holds_eye = false;
                let (nearest, farthest) = shell_range(&grid, self.cell);
                self.shells(nearest, farthest, None);
                // Rays may start and end inside a hollow volume.
                let scene = self.scene;
                for slot in 0..scene.slot_count() as u32 {
                    if scene.is_hidden(slot) && self.view.may_see_block(&scene.volume_block(slot)) {
                        self.reveal(slot, 0);
                    }
                }
            }
        }
        // Nothing is known to hide what is beyond the grid.
        for &slot in self.scene.volumes().outer().flat_map(|bucket| &bucket.slots) {
            if self.view.may_see_volume(&self.scene.volume_block(slot)) {
                self.reveal(slot, 0);
            }
        }
        for &slot in self.scene.always() {
            self.decide(slot);
        }
        self.pvs.stats = self.stats;
    }

    /// How far the eye may lie outside its cell, in cells, doubled; `None` if
    /// nothing may be taken to be hidden.
    fn occlusion_slack(&mut self, nearest: i32) -> Option<f64> {
        let Origin::Eye { at, error } = self.view.origin else { return None };
        let grid = self.scene.grid();
        self.stats.eye_in_occluder = self.scene.inside_occluder(at) || self.scene.near_plane_cuts(self.view);
        let sure = grid.cell_of(at - error) == grid.cell_of(at + error);
        let slack = if sure { 0.0 } else { error / grid.cell_size() };
        (!self.stats.eye_in_occluder && nearest <= FAR_VIEWER && slack <= UNCERTAIN_EYE)
            .then_some(2.0 * slack)
    }

    /// Walks the shells outwards. Without a slack nothing is taken to be hidden.
    fn shells(&mut self, nearest: i32, farthest: i32, slack: Option<f64>) {
        let grid = *self.scene.grid();
        let inside = grid.contains(self.cell);
        let interior = self.cell.cmpgt(IVec3::ZERO).all() && self.cell.cmplt(grid.dims() - 1).all();
        let closed = inside && (slack == Some(0.0) || interior);
        self.scratch.masks.clear();
        self.scratch.pending.iter_mut().for_each(Vec::clear);
        if inside {
            self.first_cell();
        }
        for m in nearest.max(1)..=farthest {
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
            // A segment from inside the grid to a farther cell passes this shell inside the grid.
            let ends = inside && self.holds_eye && slack.is_none_or(|s| s == 0.0 || interior);
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

    /// The viewer's own cell, and the volumes around it.
    fn first_cell(&mut self) {
        self.stats.cells_visited += 1;
        if let Some((visited, _)) = &mut self.record {
            visited.set(self.cell);
        }
        let scene = self.scene;
        scene.id_matrix().get(self.cell).for_each(|slot| self.decide(slot));
        let mut around = Vec::new();
        self.scene.volumes().holding(self.cell, |slot| around.push(slot));
        around.sort_unstable();
        around.into_iter().for_each(|slot| self.reveal(slot, 0));
        if let Some(first) = self.scratch.pending.first_mut() {
            for (_, slot) in std::mem::take(first) {
                self.decide(slot);
            }
        }
    }

    /// Decides an object one of whose cells is in sight.
    fn decide(&mut self, slot: u32) {
        if !self.scratch.mark_decided(slot) {
            return;
        }
        self.stats.objects_tested += 1;
        let object = self.scene.object(slot);
        // It may be anywhere, whatever its old bounds say.
        if object.is_unlocated() || self.view.may_see(object.bounds()) {
            self.pvs.push(self.scene.id(slot));
        }
    }

    /// A volume came into sight at shell `m`: the cells of its object from
    /// there on decide. Nearer ones are hidden, or the surface around them would have
    /// been seen before.
    fn reveal(&mut self, slot: u32, m: i32) {
        if !self.scratch.reveal(slot) {
            return;
        }
        self.stats.tbvs_revealed += 1;
        self.pvs.revealed.push(self.scene.id(slot));
        let object = self.scene.object(slot);
        if object.on_expiry() {
            // Its bounds are old: it may be anywhere in the volume.
            self.scratch.mark_decided(slot);
            self.pvs.push(self.scene.id(slot));
            return;
        }
        if !self.holds_eye {
            // Rays do not start where the walk does, which may have passed the object's cells.
            self.decide(slot);
            return;
        }
        let bounds = object.bounds();
        if !self.view.may_see(bounds) {
            return;
        }
        let block = bounds.block();
        let (lo, hi) = self.scene.grid().cover(block.min, block.max);
        if volume(lo, hi) > MAX_PENDING {
            // So many cells cost more than a test could spare.
            self.decide(slot);
            return;
        }
        let (cell, pending) = (self.cell, &mut self.scratch.pending);
        bounds.touched(self.scene.grid(), &mut |run| {
            for c in run.cells() {
                let shell = (c - cell).abs().max_element();
                if shell >= m {
                    if pending.len() <= shell as usize {
                        pending.resize_with(shell as usize + 1, Vec::new);
                    }
                    pending[shell as usize].push((c, slot));
                }
            }
        });
    }

    /// Decides the revealed objects with cells in shell `m`.
    fn settle_pending(&mut self, m: i32, scale: &ShellScale) {
        let Some(list) = self.scratch.pending.get_mut(m as usize) else { return };
        let mut list = std::mem::take(list);
        for (c, slot) in list.drain(..) {
            let relative = c - self.cell;
            if !self.scratch.is_decided(slot)
                && self.frustum.meets(relative, relative)
                && !self.is_hidden(relative, m, scale)
            {
                self.decide(slot);
            }
        }
        self.scratch.pending[m as usize] = list;
    }

    /// Whether a cell, relative to V, is hidden by the mask of a side that it belongs to.
    fn is_hidden(&self, c: IVec3, m: i32, scale: &ShellScale) -> bool {
        Side::ALL.iter().enumerate().any(|(i, side)| {
            c[side.axes.normal] * side.sign == m
                && self.scratch.masks.is_hidden(i, scale, c[side.axes.row], c[side.axes.col])
        })
    }

    /// Walks one side of shell `m`. Returns its cells in the frustum, and how many are not hidden, both
    /// without the parts of the grid that hold nothing: those are passed over.
    fn side(&mut self, index: usize, m: i32, scale: &ShellScale) -> (u64, u64) {
        let side = Side::ALL[index];
        let axes = side.axes;
        let v = self.cell;
        let Some(on_side) = self.lay_side(index, m) else { return (0, 0) };
        let depth = m * side.sign;
        let at = v[axes.normal] + depth;
        let (first_page, all) =
            ((v + side.cell(depth, 0, 0)).max(IVec3::ZERO) >> 6i32, self.record.is_some());
        if !all && self.plane_is_empty(axes.normal, first_page) {
            return (0, 0);
        }
        let mut cells = std::mem::take(&mut self.scratch.sides[index]);
        let (c0, c1) = (cells.col0, cells.col0 + cells.cols - 1);
        let (words, base) = (cells.words, cells.offset as i32 - cells.col0);
        let first_word = ((v[axes.col] + c0) >> 6) as usize;
        let mut hits = std::mem::take(&mut self.scratch.hits);
        let (mut total, mut in_sight) = (0u64, 0u64);
        for number in 0..cells.bands.len() {
            let (first, last) = Self::rows_of_band(&cells, number);
            let top = (v[axes.row] + first) & !7;
            let page = (v + side.cell(depth, first, c0)) >> 6i32;
            if !all && self.row_is_empty(axes.col, page) {
                continue;
            }
            let skip = (v[axes.row] + first - top) as usize;
            let band = cells.make_band(number);
            if !self.frustum.meets(side.cell(depth, first, c0), side.cell(depth, last, c1)) {
                continue;
            }
            let (mut left, mut right) = (i32::MAX, i32::MIN);
            for (row, line) in (first..=last).zip(band[skip * words..].chunks_mut(words)) {
                let Some((lo, hi)) = on_side.row(row, (c0, c1)) else { continue };
                set_span(line, (base + lo) as usize, (base + hi) as usize + 1);
                total += (hi - lo + 1) as u64;
                let mut seen = hi - lo + 1;
                self.scratch.masks.hidden_runs(index, scale, row, (lo, hi), |a, b| {
                    clear_span(line, (base + a) as usize, (base + b) as usize + 1);
                    seen -= b - a + 1;
                });
                if let Some((visited, hidden)) = &mut self.record {
                    for col in lo..=hi {
                        let c = v + side.cell(depth, row, col);
                        visited.set(c);
                        let bit = (base + col) as usize;
                        if line[bit / 64] >> (bit % 64) & 1 == 0 {
                            hidden.set(c);
                        }
                    }
                }
                in_sight += seen as u64;
                if seen > 0 {
                    (left, right) = (left.min(lo), right.max(hi));
                }
            }
            if left > right {
                continue;
            }
            let mut fresh = 0u8;
            let (mut b, end) = ((v[axes.col] + left) >> 3, (v[axes.col] + right) >> 3);
            while b <= end {
                let mut brick = IVec3::ZERO;
                (brick[axes.normal], brick[axes.row], brick[axes.col]) = (at >> 3, top >> 3, b);
                let stop = end.min(b | 7);
                if self.page_is_empty(brick >> 3i32) {
                    b = stop + 1;
                    continue;
                }
                while b <= stop {
                    brick[axes.col] = b;
                    let shift = ((b & 7) * 8) as u32;
                    let word = (b >> 3) as usize - first_word;
                    b += 1;
                    let mut tile = 0;
                    for i in 0..8 {
                        tile |= (band[i * words + word] >> shift & 0xff) << (8 * i);
                    }
                    if tile == 0 {
                        continue;
                    }
                    let opaque = self.scene.static_opacity().tile(brick, &axes, at)
                        | self.dynamic.map_or(0, |o| o.tile(brick, &axes, at))
                        | self.more.map_or(0, |m| m.tile(brick, &axes, at));
                    let objects = self.scene.id_matrix().tile(brick, &axes, at) & tile;
                    if objects != 0 {
                        hits.push((brick, objects, true));
                    }
                    let volumes = self.scene.tbv_matrix().tile(brick, &axes, at) & tile;
                    if volumes != 0 {
                        hits.push((brick, volumes, false));
                    }
                    let blocked = opaque & tile;
                    if blocked != 0 {
                        for i in 0..8 {
                            let byte = blocked >> (8 * i) & 0xff;
                            if byte != 0 {
                                band[i * words + word] &= !(byte << shift);
                                fresh |= 1 << i;
                            }
                        }
                    }
                }
            }
            if fresh != 0 {
                cells.fresh.resize(cells.rows as usize, false);
                let rows =
                    cells.fresh[(first - cells.row0) as usize..=(last - cells.row0) as usize].iter_mut();
                rows.enumerate().for_each(|(i, row)| *row = fresh >> (i + skip) & 1 != 0);
            }
        }
        self.scratch.sides[index] = cells;
        for (brick, tile, objects) in hits.drain(..) {
            if objects {
                self.meet_objects(&side, brick, at, tile, m, scale);
            } else {
                self.meet_volumes(&side, brick, at, tile, m);
            }
        }
        self.scratch.hits = hits;
        (total, in_sight)
    }

    fn meet_objects(&mut self, side: &Side, brick: IVec3, at: i32, tile: u64, m: i32, scale: &ShellScale) {
        let axes = side.axes;
        let mut corner = (brick << 3i32) - self.cell;
        corner[axes.normal] = at - self.cell[axes.normal];
        let scene = self.scene;
        scene.id_matrix().for_tile(brick, &axes, at, tile, |bit, whole, own| {
            let decided = |&slot: &u32| self.scratch.is_decided(slot);
            if own.iter().all(decided) && whole.iter().all(decided) {
                return;
            }
            let mut c = corner;
            c[axes.row] += bit >> 3;
            c[axes.col] += bit & 7;
            let on_edge = c[axes.row].abs() == m || c[axes.col].abs() == m;
            if !(on_edge && self.is_hidden(c, m, scale)) {
                whole.iter().chain(own).for_each(|&slot| self.decide(slot));
            }
        });
    }

    fn meet_volumes(&mut self, side: &Side, brick: IVec3, at: i32, tile: u64, m: i32) {
        let scene = self.scene;
        for slot in scene.tbv_matrix().ids(brick) {
            if !self.scratch.is_revealed(slot)
                && TbvMatrix::surface_tile(scene.volumes().cells(slot), brick, &side.axes, at) & tile != 0
            {
                self.reveal(slot, m);
            }
        }
    }

    fn stamp(&mut self, index: usize, m: i32, scale: &ShellScale, closed: bool) {
        if !self.scratch.sides[index].fresh.contains(&true) {
            return;
        }
        self.complete(index, m, scale);
        let cells = &self.scratch.sides[index];
        if self.settings.min_solid_angle > 0.0 {
            let angle = blocked_cells(cells) as f64 / (scale.shell() as f64).powi(2);
            if angle < f64::from(self.settings.min_solid_angle) {
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
