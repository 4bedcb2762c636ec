//! Queries: the scratch of one view, and the walk that finds its PVS.

use std::time::Instant;

use glam::IVec3;

use crate::error::Error;
use crate::mask::{DirectionMasks, ShellScale, Side, SideCells, clear_span, next_clear, next_set, set_span};
use crate::matrix::{BitMatrix, OcclusionMatrix, TbvMatrix};
use crate::pvs::{Pvs, Stats};
use crate::scene::Scene;
use crate::shape::Shape;
use crate::view::{Origin, View};
use crate::walk::{CellFrustum, shell_range};

/// Beyond this distance from the grid, in cells, nothing is taken to be hidden.
const FAR_VIEWER: i32 = 1 << 20;

/// An eye that may lie this far outside its cell, in cells, gets no occlusion.
const UNCERTAIN_EYE: f64 = 0.2;

/// How a query decides what can be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Method {
    /// Objects whose bounds may meet the frustum. Costs all objects.
    Frustum,
    /// What can be seen from anywhere in the viewer's cell, inside the frustum.
    /// Costs what is visible. Orthographic views get the cells of the frustum without occlusion.
    #[default]
    Cell,
}

/// Settings of a query.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// How visibility is decided.
    pub method: Method,
    /// Directions along each side of the view cube: the masks have this many pixels
    /// squared, six times. A power of two from 64 to 4096. Finer masks
    /// hide more and cost more.
    pub mask_resolution: u32,
    /// Sides of shells whose visible opaque cells appear smaller than this are
    /// not drawn as occluders, in steradians (Coorg & Teller 1997: area over squared
    /// distance). 0 draws all.
    pub min_solid_angle: f32,
    /// Keeps which cells were visited and which were hidden, for pictures and tests.
    pub record_cells: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { method: Method::Cell, mask_resolution: 256, min_solid_angle: 0.0, record_cells: false }
    }
}

impl Settings {
    fn check(&self) -> Result<(), Error> {
        let n = self.mask_resolution;
        if !n.is_power_of_two() || !(64..=4096).contains(&n) {
            let what = "the mask resolution (a power of two)";
            return Err(Error::Setting { what, value: f64::from(n), min: 64.0, max: 4096.0 });
        }
        let angle = f64::from(self.min_solid_angle);
        if (0.0..=1.0).contains(&angle) {
            Ok(())
        } else {
            Err(Error::Setting { what: "the least solid angle", value: angle, min: 0.0, max: 1.0 })
        }
    }
}

/// The scratch of one view, reused from frame to frame.
///
/// Any number of queries can run on one scene at the same time, each in its own thread.
#[derive(Debug)]
pub struct Query {
    settings: Settings,
    pvs: Pvs,
    scratch: Scratch,
    visited: Option<BitMatrix>,
    hidden: Option<OcclusionMatrix>,
}

#[derive(Debug)]
struct Scratch {
    masks: DirectionMasks,
    sides: [SideCells; 6],
    /// Cells of a band of eight rows that are in the frustum and not hidden.
    band: Vec<u64>,
    /// By slot: twice the query's number if the object's volume was revealed,
    /// one more if the object itself was decided.
    marks: Vec<u32>,
    epoch: u32,
    /// Tiles of bricks with objects (true) or surfaces of volumes (false) in sight.
    hits: Vec<(IVec3, u64, bool)>,
    /// Cells of revealed objects by shell.
    pending: Vec<Vec<(IVec3, u32)>>,
}

impl std::fmt::Debug for BitMatrix {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "BitMatrix({} of {} cells)", self.count(), self.dims())
    }
}

impl Default for Query {
    fn default() -> Self {
        Self::new()
    }
}

impl Query {
    /// A query with default settings.
    pub fn new() -> Self {
        let settings = Settings::default();
        Self {
            settings,
            pvs: Pvs::empty(),
            scratch: Scratch {
                masks: DirectionMasks::new(settings.mask_resolution.trailing_zeros()),
                sides: Default::default(),
                band: Vec::new(),
                marks: Vec::new(),
                epoch: 0,
                hits: Vec::new(),
                pending: Vec::new(),
            },
            visited: None,
            hidden: None,
        }
    }

    /// A query with the settings given.
    ///
    /// # Errors
    /// Refuses settings out of their range.
    pub fn with_settings(settings: Settings) -> Result<Self, Error> {
        let mut query = Self::new();
        query.set_settings(settings)?;
        Ok(query)
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the settings from the next run on.
    ///
    /// # Errors
    /// Refuses settings out of their range and keeps the old ones.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        settings.check()?;
        let log = settings.mask_resolution.trailing_zeros();
        if log != self.scratch.masks.log() {
            self.scratch.masks = DirectionMasks::new(log);
        }
        self.settings = settings;
        Ok(())
    }

    /// Finds what the view can see.
    pub fn run(&mut self, scene: &Scene, view: &View) -> &Pvs {
        let start = Instant::now();
        let pvs = &mut self.pvs;
        pvs.reset(scene.slots.len());
        pvs.scene = scene.tag();
        pvs.method = self.settings.method;
        pvs.cell = None;
        match self.settings.method {
            Method::Frustum => {
                pvs.revision = scene.moves();
                for slot in 0..scene.slots.len() as u32 {
                    let Some(object) = &scene.slots[slot as usize].object else { continue };
                    pvs.stats.objects_tested += 1;
                    if object.is_unlocated() || view.may_see(&object.bounds) {
                        pvs.push(scene.id(slot));
                    }
                }
            }
            Method::Cell => {
                pvs.revision = scene.revision();
                let dims = scene.grid.dims();
                let record = self.settings.record_cells.then(|| (BitMatrix::new(dims), BitMatrix::new(dims)));
                (self.visited, self.hidden) = record.unzip();
                let record = self.visited.as_mut().zip(self.hidden.as_mut());
                Walk::new(scene, view, &self.settings, pvs, &mut self.scratch, record).run();
            }
        }
        match &mut pvs.view {
            Some(own) => own.clone_from(view),
            None => pvs.view = Some(view.clone()),
        }
        pvs.stats.elapsed = start.elapsed();
        pvs
    }

    /// The result of the last run; empty before the first.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }

    /// The cells that the last run found hidden (H), if it was told to record them.
    /// Cells behind the last shell walked are hidden too, and not in it.
    pub fn hidden_cells(&self) -> Option<&OcclusionMatrix> {
        self.hidden.as_ref()
    }

    /// The cells inside the frustum that the last run visited, if it was told to
    /// record them.
    pub fn visited_cells(&self) -> Option<&BitMatrix> {
        self.visited.as_ref()
    }
}

/// One run of the cell method.
struct Walk<'a> {
    scene: &'a Scene,
    view: &'a View,
    settings: &'a Settings,
    pvs: &'a mut Pvs,
    scratch: &'a mut Scratch,
    record: Option<(&'a mut BitMatrix, &'a mut BitMatrix)>,
    /// The viewer's cell.
    cell: IVec3,
    frustum: CellFrustum,
    stats: Stats,
}

impl<'a> Walk<'a> {
    fn new(
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
        scratch.marks.resize(scene.slots.len().max(scratch.marks.len()), 0);
        scratch.epoch += 1;
        if scratch.epoch >= u32::MAX / 2 {
            scratch.marks.fill(0);
            scratch.epoch = 1;
        }
        let frustum = CellFrustum::new(grid, view, cell);
        Self { scene, view, settings, pvs, scratch, record, cell, frustum, stats: Stats::default() }
    }

    fn run(mut self) {
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
                let (nearest, farthest) = shell_range(&grid, self.cell);
                self.shells(nearest, farthest, None);
            }
        }
        for &slot in &self.scene.always {
            let object = self.scene.object(slot);
            if object.is_unlocated() {
                let mark = &mut self.scratch.marks[slot as usize];
                if *mark != self.scratch.epoch * 2 + 1 {
                    *mark = self.scratch.epoch * 2 + 1;
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
            if inside && in_sight == 0 && slack.is_none_or(|s| s == 0.0 || interior) {
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
        let decided = self.scratch.epoch * 2 + 1;
        if self.scratch.marks[slot as usize] == decided {
            return;
        }
        self.scratch.marks[slot as usize] = decided;
        self.stats.objects_tested += 1;
        if self.view.may_see(&self.scene.object(slot).bounds) {
            self.pvs.push(self.scene.id(slot));
        }
    }

    /// A volume came into sight at shell `m`: the cells of its object from
    /// there on decide. Nearer ones are hidden, or the surface around them would have
    /// been seen before.
    fn reveal(&mut self, slot: u32, m: i32) {
        let mark = &mut self.scratch.marks[slot as usize];
        if *mark >= self.scratch.epoch * 2 {
            return;
        }
        *mark = self.scratch.epoch * 2;
        self.stats.tbvs_revealed += 1;
        self.pvs.revealed.push(self.scene.id(slot));
        let object = self.scene.object(slot);
        if object.on_expiry() {
            // Its bounds are old: it may be anywhere in the volume.
            self.scratch.marks[slot as usize] += 1;
            self.pvs.push(self.scene.id(slot));
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
            if self.scratch.marks[slot as usize] == self.scratch.epoch * 2
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
                        | self.scene.opacity_dynamic.tile(brick, &axes, at);
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
        let decided = self.scratch.epoch * 2 + 1;
        let scene = self.scene;
        scene.ids.for_tile(brick, &axes, at, tile, |bit, objects| {
            if objects.iter().all(|&slot| self.scratch.marks[slot as usize] == decided) {
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
        for &slot in scene.volumes.matrix.ids(brick) {
            if self.scratch.marks[slot as usize] < self.scratch.epoch * 2
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
