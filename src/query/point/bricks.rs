//! The walk over bricks.

use casca_slots::Slot;
use glam::{DVec3, IVec3};

use crate::geometry::Block;
use crate::grid::bricks::Pages;
use crate::grid::side::Side;
use crate::query::point::PointWalk;
use crate::walk::{Shells, SideFrustum};

/// A brick with fewer objects yet undecided is not tested itself.
const WORTH_TESTING: usize = 3;

/// More bricks in a row than this are first tested together.
const WORTH_TESTING_ROW: i32 = 4;

/// So are bands of this many rows, if they have this many bricks.
const BAND: i32 = 8;
const WORTH_TESTING_BAND: i64 = 32;

/// Bricks of views without shells are taken in portions of this many, front to back.
const PORTION: usize = 64;

/// A page that contains bricks with a coordinate along an axis.
fn page_at(axis: usize, brick: i32) -> IVec3 {
    let mut page = IVec3::ZERO;
    page[axis] = brick >> 3;
    page
}

/// Which kinds of things that the walk looks for a page contains.
struct PageContents {
    objects: bool,
    volumes: bool,
    opaque: bool,
}

/// The part of one side of a shell of bricks that is in the grid.
struct BrickSide<'a> {
    side: &'a Side,
    /// The brick in the middle.
    brick: IVec3,
    /// Coordinate along the side's axis, relative to the middle.
    depth: i32,
    rows: (i32, i32),
    cols: (i32, i32),
}

impl BrickSide<'_> {
    /// A brick relative to the middle.
    #[inline]
    fn at(&self, row: i32, col: i32) -> IVec3 {
        self.side.cell(self.depth, row, col)
    }
}

impl PointWalk<'_> {
    /// Walks the shells around the eye outwards, until every pixel is closed.
    pub(super) fn in_shells(&mut self, shells: &Shells, eye: DVec3) {
        for m in shells.nearest..=shells.farthest {
            self.drawing.stats.shells += 1;
            self.shell(shells, m);
            if self.drawing.buffers().closed(self.distance_beyond(shells.cell, m, eye)) {
                break;
            }
        }
        if self.drawing.buffers().reach() > 0.0 {
            self.drawing.draw_all_patches(shells.farthest);
        }
    }

    /// Tests and draws the objects found in the bricks up to shell `m`, and those of their volumes.
    fn finish_bricks(&mut self, m: i32) {
        self.settle();
        self.drawing.draw_patches(m);
        self.test_volumes();
        self.settle();
        self.drawing.draw_patches(m);
    }

    /// Finds the objects of the bricks of shell `m`, tests and draws them.
    fn shell(&mut self, shells: &Shells, m: i32) {
        let mut bricks = std::mem::take(&mut self.scratch.bricks);
        bricks.clear();
        self.shell_bricks(shells, m, &mut bricks);
        for &b in &bricks {
            self.brick(b);
        }
        self.scratch.bricks = bricks;
        self.finish_bricks(m);
    }

    /// Walks all bricks in the frustum, sorted along a direction.
    pub(super) fn everywhere(&mut self, direction: DVec3) {
        let grid = self.grid;
        let shells = Shells::around_middle(&grid, self.run.view);
        let mut bricks = std::mem::take(&mut self.scratch.bricks);
        bricks.clear();
        for m in 0..=shells.farthest {
            self.shell_bricks(&shells, m, &mut bricks);
        }
        bricks.sort_unstable_by(|a, b| {
            let depth = |c: &IVec3| c.as_dvec3().dot(direction);
            depth(a).total_cmp(&depth(b)).then(a.to_array().cmp(&b.to_array()))
        });
        for portion in bricks.chunks(PORTION) {
            self.drawing.stats.shells += 1;
            for &brick in portion {
                self.brick(brick);
            }
            self.finish_bricks(0);
        }
        self.scratch.bricks = bricks;
        // Rays may start inside a volume, or enter it where no brick of the view is: all are
        // tested.
        for slot in Slot::below(self.run.scene.slot_count()) {
            if self.run.scene.is_hidden(slot) {
                self.test_volume(slot);
            }
        }
        self.settle();
        self.drawing.draw_all_patches(0);
    }

    /// The least distance along an axis from the eye to bricks beyond shell `m` around `brick`.
    fn distance_beyond(&self, brick: IVec3, m: i32, eye: DVec3) -> f64 {
        let (lo, hi) = self.grid.range_bounds(brick - m, brick + m);
        let (min, max) = (self.grid.min(), self.grid.max());
        let mut least = f64::INFINITY;
        for axis in 0..3 {
            if lo[axis] > min[axis] {
                least = least.min(eye[axis] - lo[axis]);
            }
            if hi[axis] < max[axis] {
                least = least.min(hi[axis] - eye[axis]);
            }
        }
        least
    }

    /// Whether boxes of opaque cells that the view shows start in a brick.
    #[inline]
    fn has_fused(&self, brick: IVec3) -> bool {
        self.fused.iter().any(|fused| !fused.in_brick(brick).is_empty())
    }

    /// Whether a brick contains nothing that the walk looks for.
    #[inline]
    fn brick_is_empty(&self, brick: IVec3, page: &PageContents) -> bool {
        let scene = self.run.scene;
        !(page.objects && scene.id_matrix().in_brick(brick).len() > 0
            || page.volumes && !scene.tbv_matrix().is_empty(brick)
            || page.opaque && self.has_fused(brick))
    }

    /// Whether a plane of pages contains nothing that the walk looks for.
    fn plane_is_empty(&self, axis: usize, page: IVec3) -> bool {
        let scene = self.run.scene;
        scene.id_matrix().pages().plane_is_empty(axis, page)
            && scene.tbv_matrix().pages().plane_is_empty(axis, page)
            && self.fused.iter().all(|fused| fused.pages().plane_is_empty(axis, page))
    }

    /// Whether a row of pages contains nothing that the walk looks for.
    fn row_is_empty(&self, along: usize, page: IVec3) -> bool {
        let scene = self.run.scene;
        scene.id_matrix().pages().row_is_empty(along, page)
            && scene.tbv_matrix().pages().row_is_empty(along, page)
            && self.fused.iter().all(|fused| fused.pages().row_is_empty(along, page))
    }

    /// The kinds of things in a page.
    #[inline]
    fn page(&self, page: IVec3) -> PageContents {
        let scene = self.run.scene;
        PageContents {
            objects: !scene.id_matrix().pages().page_is_empty(page),
            volumes: !scene.tbv_matrix().pages().page_is_empty(page),
            opaque: !self.fused.iter().all(|fused| fused.pages().page_is_empty(page)),
        }
    }

    /// Appends the bricks of shell `m` in the frustum that contain anything and are not hidden.
    fn shell_bricks(&self, shells: &Shells, m: i32, out: &mut Vec<IVec3>) {
        if m == 0 {
            let brick = shells.cell;
            if self.grid.contains(brick) && !self.brick_is_empty(brick, &self.page(brick >> 3i32)) {
                out.push(brick);
            }
            return;
        }
        for (index, side) in Side::ALL.iter().enumerate() {
            let Some(part) = self.side_in_grid(shells, index, side, m) else { continue };
            let on_side = shells.frustum.on_side(side, part.depth);
            let mut first = part.rows.0;
            while first <= part.rows.1 {
                let last = part.rows.1.min(first + BAND - 1);
                if !self.band_is_hidden(&part, first, last) {
                    (first..=last).for_each(|row| self.row_bricks(&part, &on_side, row, out));
                }
                first = last + 1;
            }
        }
    }

    /// The part of a side of shell `m` in the grid, if it contains anything and the frustum reaches
    /// it.
    fn side_in_grid<'s>(
        &self,
        shells: &Shells,
        index: usize,
        side: &'s Side,
        m: i32,
    ) -> Option<BrickSide<'s>> {
        let (dims, axes, brick) = (self.grid.dims(), side.axes, shells.cell);
        let depth = m * side.sign;
        let at = brick[axes.normal] + depth;
        if !(0..dims[axes.normal]).contains(&at) || self.plane_is_empty(axes.normal, page_at(axes.normal, at))
        {
            return None;
        }
        // Edges belong to the first of their sides.
        let last = |axis: usize| if axis < index / 2 { m - 1 } else { m };
        let span = |axis: usize| {
            let r = last(axis);
            ((-brick[axis]).max(-r), (dims[axis] - 1 - brick[axis]).min(r))
        };
        let part = BrickSide { side, brick, depth, rows: span(axes.row), cols: span(axes.col) };
        let ((r0, r1), (c0, c1)) = (part.rows, part.cols);
        (r0 <= r1 && c0 <= c1 && shells.frustum.meets(part.at(r0, c0), part.at(r1, c1))).then_some(part)
    }

    /// A box around the bricks of a side between two of them, relative to the middle.
    fn block(&self, brick: IVec3, lo: IVec3, hi: IVec3) -> Block {
        Block::new(self.grid.range_bounds(brick + lo.min(hi), brick + lo.max(hi)))
    }

    /// Whether a band of rows contains nothing, or is hidden as a whole.
    fn band_is_hidden(&self, part: &BrickSide, first: i32, last: i32) -> bool {
        let (along, (c0, c1)) = (part.side.axes.col, part.cols);
        // A band of rows is in at most two rows of pages.
        let empty = |&row: &i32| self.row_is_empty(along, (part.brick + part.at(row, c0)) >> 3i32);
        if [first, last].iter().all(empty) {
            return true;
        }
        let wide = i64::from(last - first + 1) * i64::from(c1 - c0 + 1) >= WORTH_TESTING_BAND;
        wide && self.drawing.hides(&self.block(part.brick, part.at(first, c0), part.at(last, c1)))
    }

    /// Appends the bricks of a row.
    fn row_bricks(&self, part: &BrickSide, on_side: &SideFrustum, row: i32, out: &mut Vec<IVec3>) {
        let Some((lo, hi)) = on_side.row(row, part.cols) else { return };
        let wide = hi - lo >= WORTH_TESTING_ROW;
        if wide && self.drawing.hides(&self.block(part.brick, part.at(row, lo), part.at(row, hi))) {
            return;
        }
        let mut col = lo;
        while col <= hi {
            let b = part.brick + part.at(row, col);
            let last = hi.min(col + 7 - (b[part.side.axes.col] & 7));
            let page = self.page(b >> 3i32);
            if page.objects || page.volumes || page.opaque {
                let mut brick = b;
                for _ in col..=last {
                    if !self.brick_is_empty(brick, &page) {
                        out.push(brick);
                    }
                    brick[part.side.axes.col] += 1;
                }
            }
            col = last + 1;
        }
    }

    /// Finds the objects of one brick, unless the brick is hidden.
    fn brick(&mut self, brick: IVec3) {
        self.drawing.stats.bricks_visited += 1;
        let scene = self.run.scene;
        let volumes = !self.run.fixed_only && !scene.tbv_matrix().is_empty(brick);
        let mut open = std::mem::take(&mut self.scratch.open);
        open.clear();
        open.extend(scene.id_matrix().in_brick(brick).filter(|&s| !self.marks.is_decided(s)));
        if !open.is_empty() || volumes || self.has_fused(brick) {
            self.open_brick(brick, &mut open, volumes);
        }
        self.scratch.open = open;
    }

    /// Finds the undecided objects of a brick, its volumes and boxes of opaque cells, unless it is
    /// hidden.
    fn open_brick(&mut self, brick: IVec3, open: &mut Vec<Slot>, volumes: bool) {
        let scene = self.run.scene;
        let has_fused = self.has_fused(brick);
        if open.len() >= WORTH_TESTING || has_fused || volumes {
            let bounds = Block::new(self.grid.cell_bounds(brick));
            if self.drawing.hides(&bounds) {
                self.drawing.stats.bricks_hidden += 1;
                return;
            }
        }
        // In a loop that does little else, the processor waits for the memory of many objects at
        // once.
        open.retain(|&slot| {
            let own = scene.boxes().of(slot);
            own.is_shown(self.run.view) || scene.object(slot).is_shown(self.run.view)
        });
        for &slot in open.iter() {
            self.find(slot);
        }
        if volumes {
            self.scratch.volumes.push(brick);
        }
        if has_fused && self.drawing.may_fuse() {
            for at in 0..self.fused.len() {
                let fused = self.fused[at];
                fused.in_brick(brick).iter().for_each(|cells| self.drawing.draw_cells(cells));
            }
        }
    }
}
