//! The exact walk of a segment through the cells that it crosses (Amanatides and Woo 1987). Empty
//! bricks of 8x8x8 cells and empty pages of 8x8x8 bricks are crossed in one step.

use glam::{DVec3, IVec3, Vec3};

use crate::error::{Error, finite3};
use crate::grid::bricks::Pages;
use crate::grid::cell_box::CellBox;
use crate::matrix::bits::{BitMatrix, NONE};
use crate::soft::grid::SoftGrid;

/// Edge lengths of a brick and of a page, as powers of two.
const BRICK_SHIFT: i32 = 3;
const PAGE_SHIFT: i32 = 6;

/// The first occupied cell on a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellHit {
    /// The cell.
    pub cell: IVec3,
    /// Where the segment enters it: the distance from its start in world units, 0 if it starts
    /// inside.
    pub distance: f64,
}

/// A segment, and the cells on it to ignore.
#[derive(Clone, Copy)]
pub(super) struct Segment {
    pub(super) from: DVec3,
    pub(super) to: DVec3,
    /// Whether the cell that it starts in is passed over: an eye or a light may be in a cell that a
    /// surface touches.
    pub(super) skips_first: bool,
    /// The walk ends, without a hit, where it enters this block.
    pub(super) until: Option<CellBox>,
}

impl SoftGrid {
    /// The first occupied cell that the segment between two points in world units crosses. All
    /// cells count that contain a part of it longer than rounding.
    ///
    /// Costs the cells on its way through bricks with occupied cells, and one step for each other
    /// brick or page of bricks.
    ///
    /// # Errors
    /// Refuses points that are not finite.
    pub fn first_hit(&self, from: Vec3, to: Vec3) -> Result<Option<CellHit>, Error> {
        finite3("the start of the segment", from)?;
        finite3("the end of the segment", to)?;
        let (from, to) = (from.as_dvec3(), to.as_dvec3());
        Ok(self.walk(&Segment { from, to, skips_first: false, until: None }))
    }

    /// [`SoftGrid::first_hit`] for a segment of finite ends.
    pub(super) fn walk(&self, segment: &Segment) -> Option<CellHit> {
        self.walk_among(self.pyramid().any_bits(0), segment)
    }

    /// The first of the cells given on a segment of finite ends.
    pub(super) fn walk_among(&self, cells: &BitMatrix, segment: &Segment) -> Option<CellHit> {
        let Segment { from, to, .. } = *segment;
        let (way, grid) = (to - from, self.grid());
        let last = grid.dims() - 1;
        let (mut t, end) = inside(from, way, grid.min(), grid.max())?;
        let mut cell = grid.cell_of(from + way * t).clamp(IVec3::ZERO, last);
        let first = segment.skips_first.then(|| grid.cell_of(from));
        loop {
            if segment.until.is_some_and(|block| block.contains(cell)) {
                return None;
            }
            let shift = empty_around(cells, cell);
            if shift == 0 && first != Some(cell) && cells.get(cell) {
                return Some(CellHit { cell, distance: t * way.length() });
            }
            let low = (cell >> shift) << shift;
            let high = low + ((1 << shift) - 1);
            let next = |axis: usize| match way[axis] {
                d if d > 0.0 => (grid.plane(axis, high[axis] + 1) - from[axis]) / d,
                d if d < 0.0 => (grid.plane(axis, low[axis]) - from[axis]) / d,
                _ => f64::INFINITY,
            };
            let ways = DVec3::new(next(0), next(1), next(2));
            let axis = ways.min_position();
            // Infinite for a segment without length.
            if ways[axis] >= end {
                return None;
            }
            t = t.max(ways[axis]);
            if shift > 0 {
                // Where it leaves the block. Walks never turn back, whatever is rounded.
                let at = grid.cell_of(from + way * t).clamp(low, high);
                cell = IVec3::from_array([0, 1, 2].map(|axis| match way[axis] < 0.0 {
                    true => at[axis].min(cell[axis]),
                    false => at[axis].max(cell[axis]),
                }));
            }
            cell[axis] = if way[axis] > 0.0 { high[axis] + 1 } else { low[axis] - 1 };
            if cell[axis] < 0 || cell[axis] > last[axis] {
                return None;
            }
        }
    }
}

/// The edge length of an empty block around a cell, as a power of two; 0 if its brick is not empty.
fn empty_around(cells: &BitMatrix, cell: IVec3) -> i32 {
    if cells.pages().page_is_empty(cell >> PAGE_SHIFT) {
        PAGE_SHIFT
    } else if *cells.brick(cell >> BRICK_SHIFT) == NONE {
        BRICK_SHIFT
    } else {
        0
    }
}

/// The part of a segment inside a box, as shares of its way from 0 to 1.
pub(super) fn inside(from: DVec3, way: DVec3, min: DVec3, max: DVec3) -> Option<(f64, f64)> {
    let (mut start, mut end) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        if way[axis] == 0.0 {
            if from[axis] < min[axis] || from[axis] > max[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = ((min[axis] - from[axis]) / way[axis], (max[axis] - from[axis]) / way[axis]);
        (start, end) = (start.max(a.min(b)), end.min(a.max(b)));
    }
    (start <= end).then_some((start, end))
}
