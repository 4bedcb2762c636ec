//! Where a walk ends: it leaves a side of the shells where no object remains to be found.
//!
//! A direction mask only ever grows. So an object or a volume whose directions it covers is not
//! found any more, nor is one that was found, or whose cells the walk has passed: the search for
//! one that remains goes through the slots once.

use casca_slots::Slot;

use crate::grid::cell_box::CellBox;
use crate::grid::side::Side;
use crate::query::cell::finder::Finder;
use crate::query::cell::shell_scale::ShellScale;
use crate::query::cell::sides::ShellSide;

/// How many slots are looked at after each shell, and how many rows walked in it pay for one more:
/// the search costs a small part of the walk.
const SLOTS: i64 = 64;
const ROWS_FOR_A_SLOT: i64 = 8;

/// Reading this many words of a mask costs about as much as looking at a slot.
const WORDS_FOR_A_SLOT: i64 = 16;

/// How far the search for objects that a walk may still find has come.
#[derive(Debug, Default)]
pub(super) struct Remaining {
    /// For each side, the first slot with an object that may still be found there.
    slots: [Slot; 6],
    /// For each side, a pixel through which it may be.
    open: [(i64, i64); 6],
    /// Sides on which no object may be found.
    done: [bool; 6],
    /// Slots that may be looked at. Below zero after a large object.
    budget: i64,
    /// Rows walked since the last search.
    rows: i64,
}

impl Remaining {
    /// Counts rows walked: they pay for the next search.
    pub(super) fn add_rows(&mut self, rows: i64) {
        self.rows += rows;
    }

    /// Whether the walk has left a side.
    pub(super) fn is_done(&self, side: usize) -> bool {
        self.done[side]
    }

    /// Leaves the sides on which no object may be found beyond shell `m`. Returns whether a side is
    /// left to walk.
    pub(super) fn search(&mut self, m: i32, finder: &Finder, sides: &[ShellSide; 6]) -> bool {
        let rows = std::mem::take(&mut self.rows);
        self.budget = SLOTS.min(self.budget + SLOTS) + rows / ROWS_FOR_A_SLOT;
        for side in 0..6 {
            self.done[side] = self.done[side] || !self.any_remains(side, m, finder, sides);
        }
        self.done.contains(&false)
    }

    /// Whether some object may be found on a side beyond shell `m`, as far as the search has come.
    fn any_remains(&mut self, index: usize, m: i32, finder: &Finder, sides: &[ShellSide; 6]) -> bool {
        // Where all that there is or the frustum ends at the shell, none does.
        let (side, v, extent) = (&Side::ALL[index], finder.shells.cell, finder.shells.extent);
        let (mut lo, mut hi, axis) = (extent.lo - v, extent.hi - v, side.axes.normal);
        if side.sign > 0 {
            lo[axis] = lo[axis].max(m + 1);
        } else {
            hi[axis] = hi[axis].min(-m - 1);
        }
        if lo[axis] > hi[axis] || !finder.shells.frustum.meets(lo, hi) {
            return false;
        }
        while self.slots[index].index() < finder.scene.slot_count() {
            if self.budget <= 0 || self.may_find(index, m, finder, sides) {
                return true;
            }
            self.slots[index] = self.slots[index].next();
        }
        false
    }

    /// Whether the object in the slot that the search has come to on a side, or its volume, may be
    /// found there beyond shell `m`.
    fn may_find(&mut self, index: usize, m: i32, finder: &Finder, sides: &[ShellSide; 6]) -> bool {
        self.budget -= 1;
        let Some(cells) = Self::cells_to_find(self.slots[index], finder) else { return false };
        let cells = CellBox { lo: cells.lo - finder.shells.cell, hi: cells.hi - finder.shells.cell };
        let Some((nearest, farthest)) = shells_on_side(&cells, &Side::ALL[index], m) else { return false };
        if !finder.shells.frustum.meets(cells.lo, cells.hi) {
            return false;
        }
        let ShellSide { mask, .. } = &sides[index];
        let scales = [nearest, farthest].map(|shell| ShellScale::new(shell, mask.log(), 0.0));
        let axes = Side::ALL[index].axes;
        let rows = pixels_of(&scales, cells.lo[axes.row], cells.hi[axes.row]);
        let cols = pixels_of(&scales, cells.lo[axes.col], cells.hi[axes.col]);
        let (row, col) = self.open[index];
        let within = (rows.0..=rows.1).contains(&row) && (cols.0..=cols.1).contains(&col);
        if within && mask.is_open(row, col) {
            return true;
        }
        let (open, words) = mask.first_open(rows, cols);
        self.budget -= words / WORDS_FOR_A_SLOT;
        self.open[index] = open.unwrap_or((row, col));
        open.is_some()
    }

    /// The cells by which the walk may find an object: those of its volume, or its own. `None` if
    /// it was found, or is not found by cells.
    fn cells_to_find(slot: Slot, finder: &Finder) -> Option<CellBox> {
        let scene = finder.scene;
        if finder.marks.is_decided(slot) {
            return None;
        }
        let object = scene.living_at(slot).filter(|object| object.is_shown(finder.view))?;
        if object.is_hidden() && !finder.marks.is_revealed(slot) {
            return scene.volume_cells(slot).copied();
        }
        if !object.is_hidden() && !object.in_cells() {
            return None;
        }
        let (grid, block) = (scene.grid(), object.bounds().block());
        // Cells that shapes touch are rounded outwards, and these may be rounded inwards: by less
        // than a cell both.
        Some(CellBox { lo: grid.cell_of(block.min) - 1, hi: grid.cell_of(block.max) + 1 })
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
        let end = scale.shell();
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
