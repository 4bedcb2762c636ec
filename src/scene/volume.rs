//! One temporal bounding volume: a box of cells that contains a hidden dynamic object for a while
//! (Sudarsky & Gotsman 1996; thesis, sections 3.3.2 and 3.4.1).
//!
//! A volume is the object's bounds widened by the distance that it can go while the volume is
//! valid. These limit the widening: the radius of the thesis, the cost of writing a volume into the
//! matrices, and the rule that a hollow volume must not contain a viewer.

use glam::IVec3;

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::grid::{Grid, reaches};

/// Volumes are widened by at most this many cells: the cost of writing one grows with the square of
/// the widening, the time that it lasts only with the widening.
pub(super) const MOST_CELLS: f64 = 8.0;

/// A volume is no larger than a rectangle whose sides are those of all that is there, divided by
/// this (thesis, section 3.4.1, where it is the grid).
const PARTS: f64 = 5.0;

/// One object's volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tbv {
    pub(super) cells: CellBox,
    /// The box in which the object stays, inside of its cells.
    pub(super) block: Block,
    /// How far the object can move and stay inside, in world units.
    pub(super) slack: f64,
}

impl Tbv {
    /// A volume around an object that may move by up to `distance` world units, in a scene of
    /// `extent` cells; none if the object is too large, too close to a viewer or beyond the reach of
    /// coordinates. It is as large as its cells, unless it is `tight`.
    pub(super) fn around(
        grid: &Grid,
        extent: IVec3,
        (bounds, tight): (&Block, bool),
        distance: f64,
        viewers: &[IVec3],
    ) -> Option<Self> {
        let (lo, hi) = grid.cover(bounds.min, bounds.max);
        let slack = slack_between_viewers(grid, extent, (bounds, &CellBox { lo, hi }), distance, viewers)?;
        let (lo, hi) = grid.cover(bounds.min - slack, bounds.max + slack);
        let cells = CellBox { lo, hi };
        if !(reaches(lo) && reaches(hi)) || viewers.iter().any(|&v| cells.contains(v)) {
            return None;
        }
        let block = Block::new(grid.range_bounds(lo, hi));
        let reached = Block { min: bounds.min - slack, max: bounds.max + slack };
        Some(Self { cells, block: if tight { block.intersection(&reached) } else { block }, slack })
    }

    /// Whether the volume contains a box and every cell that the box touches: something flat on a
    /// wall of a cell may touch the cell beyond.
    pub(super) fn contains(&self, grid: &Grid, bounds: &Block) -> bool {
        let Block { min, max } = self.block;
        if min.cmple(bounds.min).all() && max.cmpgt(bounds.max).all() {
            // Its cells are those that the block covers.
            return true;
        }
        let (lo, hi) = grid.cover(bounds.min, bounds.max);
        self.block.contains(bounds) && self.cells.contains(lo) && self.cells.contains(hi)
    }

    /// How far a box inside is from the nearest wall, in world units.
    pub(super) fn room(&self, inside: &Block) -> f64 {
        (inside.min - self.block.min).min(self.block.max - inside.max).min_element()
    }
}

/// By how much a volume may be widened for all that the size of the scene, its cost and the viewers say;
/// none if a viewer is too close or the object, in these cells, too large.
fn slack_between_viewers(
    grid: &Grid,
    extent: IVec3,
    (bounds, cells): (&Block, &CellBox),
    distance: f64,
    viewers: &[IVec3],
) -> Option<f64> {
    let cell = grid.cell_size();
    let sides = extent.as_dvec3() / PARTS;
    let limit = sides.x.hypot(sides.y) * cell;
    let half = (bounds.max - bounds.min).max_element() * 0.5;
    let mut slack = distance.min(limit.max(cell) - half).min(MOST_CELLS * cell);
    if slack.is_nan() || slack < 0.0 {
        return None;
    }
    for &viewer in viewers {
        let gap = (cells.lo - viewer).max(viewer - cells.hi).max_element();
        if gap <= 0 {
            return None;
        }
        slack = slack.min(f64::from(gap - 1) * cell);
    }
    Some(slack)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn grid() -> Grid {
        Grid::new(1.0).unwrap()
    }

    fn grown(block: &Block, by: f64) -> Block {
        Block { min: block.min - by, max: block.max + by }
    }

    fn bounds(center: [f64; 3], half: f64) -> Block {
        let c = DVec3::from_array(center);
        Block { min: c - half, max: c + half }
    }

    #[test]
    fn a_volume_contains_every_reachable_place_and_no_viewer() {
        let g = grid();
        let b = bounds([50.5, 30.5, 50.5], 1.0);
        let volume = |b: &Block, tight, distance, viewers: &[IVec3]| {
            Tbv::around(&g, IVec3::new(100, 60, 100), (b, tight), distance, viewers)
        };
        let around = |b: &Block, distance, viewers: &[IVec3]| volume(b, false, distance, viewers);
        let v = around(&b, 4.0, &[]).unwrap();
        assert!(v.block.contains(&grown(&b, 4.0)));
        assert_eq!(v.block, Block::new(g.range_bounds(v.cells.lo, v.cells.hi)));
        let tight = volume(&b, true, 4.25, &[]).unwrap();
        assert_eq!(tight.block, grown(&b, 4.25), "farther it does not get");
        let viewer = IVec3::new(55, 30, 50);
        let near = around(&b, 4.0, &[viewer]).unwrap();
        assert!(!near.cells.contains(viewer) && near.block.contains(&grown(&b, near.slack)));
        assert!(around(&b, 4.0, &[IVec3::new(50, 30, 50)]).is_none());
        let far = around(&b, 1e9, &[]).unwrap();
        assert!(far.slack < 24.0 && (far.cells.hi - far.cells.lo).max_element() < 50);
        assert!(around(&bounds([50.0; 3], 30.0), 1.0, &[]).is_none(), "it is too large");
        let below = around(&bounds([-3.5, 30.0, 30.0], 1.0), 8.0, &[]).unwrap();
        assert!(below.slack == 8.0 && below.cells.lo.x == -13);
        assert!(around(&bounds([1e7, 30.0, 30.0], 1.0), 8.0, &[]).is_none(), "it is too far away");
    }
}
