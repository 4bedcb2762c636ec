//! The cell method: what can be seen from anywhere in the viewer's cell.

use glam::IVec3;

use super::{FAR_VIEWER, Scratch, Settings};
use crate::mask::{ShellScale, Side, SideCells, clear_span, next_clear, next_set, set_span};
use crate::matrix::{BitMatrix, TbvMatrix};
use crate::pvs::{Pvs, Stats};
use crate::scene::{Object, Scene};
use crate::shape::Shape;
use crate::view::{Origin, View};
use crate::walk::{CellFrustum, shell_range};

/// An eye that may lie this far outside its cell, in cells, gets no occlusion.
const UNCERTAIN_EYE: f64 = 0.2;

/// One run of the cell method.
pub(super) struct Walk<'a> {
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
    stats: Stats,
}

impl<'a> Walk<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        view: &'a View,
        settings: &'a Settings,
        pvs: &'a mut Pvs,
        scratch: &'a mut Scratch,
        record: Option<(&'a mut BitMatrix, &'a mut BitMatrix)>,
    ) -> Self {
        let grid = &scene.grid;
        // Parallel rays come from no cell: the walk starts where they enter the grid.
        let eye = view.eye().unwrap_or((grid.min() + grid.max()) * 0.5);
        let cell = grid.cell_of(eye);
        scratch.begin(scene.slots.len());
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
            stats: Stats::default(),
        }
    }

    /// Counts more cells as opaque.
    pub(super) fn with_more(self, more: Option<&'a BitMatrix>) -> Self {
        Self { more, ..self }
    }

    pub(super) fn run(mut self) {
        let grid = self.scene.grid;
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
                for slot in 0..scene.slots.len() as u32 {
                    if scene.slots[slot as usize].object.as_ref().is_some_and(Object::is_hidden)
                        && self.view.may_see_block(&scene.volumes.block(&grid, slot))
                    {
                        self.reveal(slot, 0);
                    }
                }
            }
        }
        // Nothing is known to hide what is beyond the grid.
        for &slot in self.scene.volumes.outer().flat_map(|bucket| &bucket.slots) {
            if self.view.may_see_volume(&self.scene.volumes.block(&self.scene.grid, slot)) {
                self.reveal(slot, 0);
            }
        }
        for &slot in &self.scene.always {
            let object = self.scene.object(slot);
            if object.is_unlocated() {
                if self.scratch.mark_decided(slot) {
                    self.pvs.push(self.scene.id(slot));
                }
            } else {
                self.decide(slot);
            }
        }
        self.pvs.stats = self.stats;
    }

    /// How far the eye may lie outside its cell, in cells, doubled; `None` if
    /// nothing may be taken to be hidden.
    fn occlusion_slack(&mut self, nearest: i32) -> Option<f64> {
        let Origin::Eye { at, error } = self.view.origin else { return None };
        let grid = &self.scene.grid;
        self.stats.eye_in_occluder = self.scene.inside_occluder(at) || self.scene.near_plane_cuts(self.view);
        let sure = grid.cell_of(at - error) == grid.cell_of(at + error);
        let slack = if sure { 0.0 } else { error / grid.cell_size() };
        (!self.stats.eye_in_occluder && nearest <= FAR_VIEWER && slack <= UNCERTAIN_EYE)
            .then_some(2.0 * slack)
    }

    /// Walks the shells outwards. Without a slack nothing is taken to be hidden.
    fn shells(&mut self, nearest: i32, farthest: i32, slack: Option<f64>) {
        let grid = self.scene.grid;
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
            if inside && self.holds_eye && in_sight == 0 && slack.is_none_or(|s| s == 0.0 || interior) {
                break;
            }
            if slack.is_some() {
                for side in 0..6 {
                    self.stamp(side, &scale, closed);
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
        for &slot in self.scene.ids.get(self.cell) {
            self.decide(slot);
        }
        let mut around = Vec::new();
        self.scene.volumes.holding(self.cell, |slot| around.push(slot));
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
        if self.view.may_see(&self.scene.object(slot).bounds) {
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
        let bounds = &object.bounds;
        if !self.view.may_see(bounds) {
            return;
        }
        let (cell, pending) = (self.cell, &mut self.scratch.pending);
        bounds.touched(&self.scene.grid, &mut |run| {
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

    /// Walks one side of shell `m`. Returns its cells in the frustum, and how many are not hidden.
    fn side(&mut self, index: usize, m: i32, scale: &ShellScale) -> (u64, u64) {
        let side = Side::ALL[index];
        let axes = side.axes;
        let dims = self.scene.grid.dims();
        let v = self.cell;
        let cells = &mut self.scratch.sides[index];
        cells.rows = 0;
        cells.fresh.clear();
        let depth = m * side.sign;
        let at = v[axes.normal] + depth;
        if !(0..dims[axes.normal]).contains(&at) {
            return (0, 0);
        }
        let span = |axis: usize| ((-v[axis]).max(-m), (dims[axis] - 1 - v[axis]).min(m));
        let ((r0, r1), (c0, c1)) = (span(axes.row), span(axes.col));
        if r0 > r1 || c0 > c1 {
            return (0, 0);
        }
        let corner = |row, col| {
            let mut c = IVec3::ZERO;
            (c[axes.normal], c[axes.row], c[axes.col]) = (depth, row, col);
            c
        };
        if !self.frustum.meets(corner(r0, c0), corner(r1, c1)) {
            return (0, 0);
        }
        // Columns are addressed by their place in the grid, so that tiles fall on bytes.
        let first_word = ((v[axes.col] + c0) >> 6) as usize;
        let words = ((v[axes.col] + c1) >> 6) as usize + 1 - first_word;
        let base = v[axes.col] - (first_word as i32) * 64;
        cells.row0 = r0;
        cells.col0 = c0;
        cells.rows = r1 - r0 + 1;
        cells.cols = c1 - c0 + 1;
        cells.words = words;
        cells.offset = (base + c0) as usize;
        cells.open.clear();
        cells.open.resize(words * cells.rows as usize, 0);
        cells.fresh.resize(cells.rows as usize, false);

        let band = &mut self.scratch.band;
        band.clear();
        band.resize(words * 8, 0);
        let on_side = self.frustum.on_side(&side, depth);
        let mut hits = std::mem::take(&mut self.scratch.hits);
        let (mut total, mut in_sight) = (0u64, 0u64);
        let mut top = (v[axes.row] + r0) & !7;
        while top <= v[axes.row] + r1 {
            let (first, last) = ((top - v[axes.row]).max(r0), (top + 7 - v[axes.row]).min(r1));
            let (mut left, mut right) = (i32::MAX, i32::MIN);
            if self.frustum.meets(corner(first, c0), corner(last, c1)) {
                for row in first..=last {
                    let Some((lo, hi)) = on_side.row(row, (c0, c1)) else { continue };
                    let i = (v[axes.row] + row - top) as usize;
                    let line = &mut band[i * words..(i + 1) * words];
                    set_span(line, (base + lo) as usize, (base + hi) as usize + 1);
                    total += (hi - lo + 1) as u64;
                    let mut seen = hi - lo + 1;
                    self.scratch.masks.hidden_runs(index, scale, row, (lo, hi), |a, b| {
                        clear_span(line, (base + a) as usize, (base + b) as usize + 1);
                        seen -= b - a + 1;
                    });
                    if let Some((visited, hidden)) = &mut self.record {
                        for col in lo..=hi {
                            let c = v + corner(row, col);
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
            }
            if left <= right {
                let bricks = (v[axes.col] + left) >> 3..=(v[axes.col] + right) >> 3;
                for b in bricks {
                    let shift = ((b & 7) * 8) as u32;
                    let word = (b >> 3) as usize - first_word;
                    let mut tile = 0;
                    for i in 0..8 {
                        tile |= (band[i * words + word] >> shift & 0xff) << (8 * i);
                    }
                    if tile == 0 {
                        continue;
                    }
                    let mut brick = IVec3::ZERO;
                    (brick[axes.normal], brick[axes.row], brick[axes.col]) = (at >> 3, top >> 3, b);
                    let opaque = self.scene.opacity_static.tile(brick, &axes, at)
                        | self.dynamic.map_or(0, |o| o.tile(brick, &axes, at))
                        | self.more.map_or(0, |m| m.tile(brick, &axes, at));
                    let objects = self.scene.ids.tile(brick, &axes, at) & tile;
                    if objects != 0 {
                        hits.push((brick, objects, true));
                    }
                    let volumes = self.scene.volumes.matrix.tile(brick, &axes, at) & tile;
                    if volumes != 0 {
                        hits.push((brick, volumes, false));
                    }
                    let blocked = opaque & tile;
                    if blocked != 0 {
                        for i in 0..8 {
                            let byte = blocked >> (8 * i) & 0xff;
                            if byte != 0 {
                                band[i * words + word] &= !(byte << shift);
                                cells.fresh[(top + i as i32 - v[axes.row] - r0) as usize] = true;
                            }
                        }
                    }
                }
                for row in first..=last {
                    let i = (v[axes.row] + row - top) as usize;
                    let r = (row - r0) as usize;
                    cells.open[r * words..(r + 1) * words].copy_from_slice(&band[i * words..(i + 1) * words]);
                }
                band.fill(0);
            } else {
                band.fill(0);
            }
            top += 8;
        }
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
        scene.ids.for_tile(brick, &axes, at, tile, |bit, objects| {
            if objects.iter().all(|&slot| self.scratch.is_decided(slot)) {
                return;
            }
            let mut c = corner;
            c[axes.row] += bit >> 3;
            c[axes.col] += bit & 7;
            let on_edge = c[axes.row].abs() == m || c[axes.col].abs() == m;
            if !(on_edge && self.is_hidden(c, m, scale)) {
                objects.iter().for_each(|&slot| self.decide(slot));
            }
        });
    }

    fn meet_volumes(&mut self, side: &Side, brick: IVec3, at: i32, tile: u64, m: i32) {
        let scene = self.scene;
        for slot in scene.volumes.matrix.ids(brick) {
            if !self.scratch.is_revealed(slot)
                && TbvMatrix::surface_tile(scene.volumes.cells(slot), brick, &side.axes, at) & tile != 0
            {
                self.reveal(slot, m);
            }
        }
    }

    fn stamp(&mut self, index: usize, scale: &ShellScale, closed: bool) {
        let cells = &self.scratch.sides[index];
        let fresh = cells.fresh.iter().filter(|&&f| f).count();
        if fresh == 0 {
            return;
        }
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
    let rows = cells.open.chunks(cells.words).zip(&cells.fresh).filter(|(_, fresh)| **fresh);
    rows.map(|(open, _)| {
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
