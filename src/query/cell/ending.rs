//! Where a walk ends: it leaves a side of the shells where no object remains to be found.
//!
//! A direction mask only ever grows. So an object or a volume whose directions it covers is not
//! found any more, nor is one that was found, or whose cells the walk has passed: the search for
//! one that remains goes through the slots once.

use casca_slots::Slot;

use crate::grid::cell_box::CellBox;
use crate::grid::side::Side;
use crate::query::cell::CellWalk;
use crate::query::cell::shell_scale::ShellScale;

/// Reading this many words of a mask costs about as much as looking at a slot.
const WORDS_FOR_A_SLOT: i64 = 16;

impl CellWalk<'_> {
    /// Leaves the sides on which no object may be found beyond shell `m`. Returns whether a side is
    /// left to walk.
    pub(super) fn search_remaining(&mut self, m: i32) -> bool {
        self.remaining.earn();
        for side in 0..6 {
            if !self.remaining.done[side] && !self.any_remains(side, m) {
                self.remaining.done[side] = true;
            }
        }
        self.remaining.done.contains(&false)
    }

    /// Whether some object may be found on a side beyond shell `m`, as far as the search has come.
    fn any_remains(&mut self, index: usize, m: i32) -> bool {
        if !self.meets_beyond(&Side::ALL[index], m) {
            return false;
        }
        while self.remaining.slots[index].index() < self.scene.slot_count() {
            if self.remaining.budget <= 0 || self.may_find(self.remaining.slots[index], index, m) {
                return true;
            }
            self.remaining.slots[index] = self.remaining.slots[index].next();
        }
        false
    }

    /// Whether the grid and the frustum go on beyond shell `m` on a side.
    fn meets_beyond(&self, side: &Side, m: i32) -> bool {
        let (v, axis) = (self.shells.cell, side.axes.normal);
        let (mut lo, mut hi) = (-v, self.scene.grid().dims() - 1 - v);
        if side.sign > 0 {
            lo[axis] = lo[axis].max(m + 1);
        } else {
            hi[axis] = hi[axis].min(-m - 1);
        }
        lo[axis] <= hi[axis] && self.shells.frustum.meets(lo, hi)
    }

    /// Whether the object in a slot, or its volume, may be found on a side beyond shell `m`.
    fn may_find(&mut self, slot: Slot, index: usize, m: i32) -> bool {
        self.remaining.budget -= 1;
        let Some(cells) = self.cells_to_find(slot) else { return false };
        let cells = CellBox { lo: cells.lo - self.shells.cell, hi: cells.hi - self.shells.cell };
        let Some((nearest, farthest)) = shells_on_side(&cells, &Side::ALL[index], m) else { return false };
        if !self.shells.frustum.meets(cells.lo, cells.hi) {
            return false;
        }
        let scales = [nearest, farthest].map(|shell| ShellScale::new(shell, self.scratch.masks.log(), 0.0));
        let axes = Side::ALL[index].axes;
        let rows = pixels_of(&scales, cells.lo[axes.row], cells.hi[axes.row]);
        let cols = pixels_of(&scales, cells.lo[axes.col], cells.hi[axes.col]);
        let (row, col) = self.remaining.open[index];
        let masks = &self.scratch.masks;
        let within = (rows.0..=rows.1).contains(&row) && (cols.0..=cols.1).contains(&col);
        if within && masks.is_open(index, row, col) {
            return true;
        }
        let (open, words) = masks.first_open(index, rows, cols);
        self.remaining.budget -= words / WORDS_FOR_A_SLOT;
        self.remaining.open[index] = open.unwrap_or((row, col));
        open.is_some()
    }

    /// The cells by which the walk may find an object: those of its volume, or its own. `None` if
    /// it was found, or is not found by cells.
    fn cells_to_find(&self, slot: Slot) -> Option<CellBox> {
        if self.marks.is_decided(slot) {
            return None;
        }
        let object = self.scene.living_at(slot).filter(|object| object.is_shown(self.view))?;
        let (is_hidden, volumes) = (object.is_hidden(), self.scene.volumes());
        if is_hidden && !self.marks.is_revealed(slot) {
            return (!volumes.is_outer(slot)).then(|| *volumes.cells(slot));
        }
        if !is_hidden && !object.in_cells() {
            return self.remaining.with_exits(slot, None);
        }
        let (grid, block) = (self.scene.grid(), object.bounds().block());
        // Cells that shapes touch are rounded outwards, and these may be rounded inwards: by less
        // than a cell both.
        let own = grid.clip(grid.cell_of(block.min) - 1, grid.cell_of(block.max) + 1);
        self.remaining.with_exits(slot, own.map(|(lo, hi)| CellBox { lo, hi }))
    }
}

/// The nearest and the farthest shell beyond `m` in which cells, relative to V, may lie on a side.
fn shells_on_side(cells: &CellBox, side: &Side, m: i32) -> Option<(i32, i32)> {
    let CellBox { lo, hi } = *cells;
    let axes = &side.axes;
    let (near, far) =
        if side.sign > 0 { (lo[axes.normal], hi[axes.normal]) } else { (-hi[axes.normal], -lo[axes.normal]) };
    // Across, a cell of a side is no farther than its shell.
    let beside = |axis: usize| lo[axis].max(-hi[axis]);
    let nearest = (m + 1).max(near).max(beside(axes.row)).max(beside(axes.col));
    (nearest <= far).then_some((nearest, far))
}

/// The pixels of the directions of lattice lines, of those on a side in the shells between two.
///
/// The direction of a line c in shell m, c / m, only rises or only falls from shell to shell, also
/// where it is cut off at the end of the side: so the nearest and the farthest shell have the first
/// and the last pixel.
fn pixels_of(scales: &[ShellScale; 2], lo: i32, hi: i32) -> (i64, i64) {
    let pixel = |scale: &ShellScale, line: i32| {
        let end = scale.shell() as i32;
        scale.pixel(line.clamp(-end, end))
    };
    let [a, b] = scales;
    (pixel(a, lo).min(pixel(b, lo)), pixel(a, hi).max(pixel(b, hi)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn the_pixels_of_a_box_hold_those_of_its_cells() {
        let mut random = Random::new(7);
        let mut found = [0; 2];
        for _ in 0..400 {
            let lo = (random.point(30.0)).as_ivec3();
            let cells = CellBox { lo, hi: lo + (random.point(9.0).abs()).as_ivec3() };
            let m = (random.next() * 20.0) as i32;
            for side in &Side::ALL {
                let around = shells_on_side(&cells, side, m);
                let mut any = false;
                for c in cells.cells() {
                    let depth = c[side.axes.normal] * side.sign;
                    let (row, col) = (c[side.axes.row], c[side.axes.col]);
                    if depth <= m || row.abs().max(col.abs()) > depth {
                        continue;
                    }
                    any = true;
                    let (nearest, farthest) = around.unwrap();
                    assert!((nearest..=farthest).contains(&depth));
                    let scales = [nearest, farthest].map(|shell| ShellScale::new(shell, 8, 0.0));
                    let scale = ShellScale::new(depth, 8, 0.0);
                    for (axis, line) in [(side.axes.row, row), (side.axes.col, col)] {
                        let (first, last) = pixels_of(&scales, cells.lo[axis], cells.hi[axis]);
                        assert!((first..=last).contains(&scale.pixel(line)), "{cells:?} {c} {side:?}");
                    }
                }
                found[usize::from(any)] += 1;
                let ends = cells.lo[side.axes.normal] == cells.hi[side.axes.normal];
                assert!(any || around.is_none() || !ends, "{cells:?} {side:?}: none is found");
            }
        }
        assert!(found[0] > 200 && found[1] > 200, "{found:?}");
    }
}
