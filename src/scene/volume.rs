//! One temporal bounding volume: a box of cells that contains a hidden dynamic object for a while
//! (Sudarsky & Gotsman 1996; thesis, sections 3.3.2 and 3.4.1).
//!
//! A volume is the object's bounds widened by the distance that it can go while the volume is
//! valid. These limit the widening: the radius of the thesis, the cost of writing a volume into the
//! matrices, and the rule that a hollow volume must not contain a viewer.

use glam::IVec3;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::cell_box::CellBox;

/// Volumes are widened by at most this many cells: the cost of writing one grows with the square of
/// the widening, the time that it lasts only with the widening.
const MOST_CELLS: f64 = 8.0;

/// A volume is no larger than a rectangle whose sides are those of the grid, divided by this
/// (thesis, section 3.4.1).
const GRID_PARTS: f64 = 5.0;

/// A volume reaches beyond the grid where the border would leave it less than this share of the
/// distance asked for.
const CRAMPED: f64 = 0.5;

/// No volume reaches more cells than this beyond the grid: its cells could not be counted.
const FARTHEST: i32 = 1 << 20;

/// One object's volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tbv {
    pub(super) cells: CellBox,
    /// Its cells as a box in world units; where it leaves the grid, no larger than needed.
    pub(super) block: Block,
    /// How far the object can move and stay inside, in world units.
    pub(super) slack: f64,
}

/// How the border of the grid bounds a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Border {
    /// It is cut off there: the object is reported when it leaves.
    Cut,
    /// It ends there, and the object does not get there while it is valid.
    Inside,
    /// It goes on beyond it where it would be cramped inside.
    Beyond,
}

impl Tbv {
    /// A volume around an object that may move by up to `distance` world units; none if the object
    /// leaves the grid, is too large or too close to a viewer.
    pub(super) fn around(
        grid: &Grid,
        bounds: &Block,
        distance: f64,
        viewers: &[IVec3],
        border: Border,
    ) -> Option<Self> {
        let (lo, hi) = grid.cover(bounds.min, bounds.max);
        let inside = grid.contains(lo) && grid.contains(hi);
        if !inside && border != Border::Beyond {
            return None;
        }
        let slack = slack_between_viewers(grid, bounds, &CellBox { lo, hi }, distance, viewers)?;
        let room = (bounds.min - grid.min()).min(grid.max() - bounds.max).min_element();
        let beyond = border == Border::Beyond && room < CRAMPED * slack;
        let slack = if border == Border::Cut || beyond { slack } else { slack.min(room) };
        if slack < 0.0 {
            return None;
        }
        let (a, b) = grid.cover(bounds.min - slack, bounds.max + slack);
        let (lo, hi) = if beyond { (a, b) } else { grid.clip(a, b)? };
        if lo.cmplt(IVec3::splat(-FARTHEST)).any() || hi.cmpgt(grid.dims() + FARTHEST).any() {
            return None;
        }
        let cells = CellBox { lo, hi };
        if viewers.iter().any(|&v| cells.contains(v)) {
            return None;
        }
        let block = if beyond { grown(bounds, slack) } else { Block::new(grid.range_bounds(lo, hi)) };
        Some(Self { cells, block, slack })
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

/// By how much a volume may be widened for all that the grid's size, its cost and the viewers say;
/// none if a viewer is too close or the object, in these cells, too large.
fn slack_between_viewers(
    grid: &Grid,
    bounds: &Block,
    cells: &CellBox,
    distance: f64,
    viewers: &[IVec3],
) -> Option<f64> {
    let cell = grid.cell_size();
    let dims = grid.dims().as_dvec3();
    let limit = (dims.x / GRID_PARTS).hypot(dims.y / GRID_PARTS) * cell;
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

/// A box with all sides moved out by a distance.
fn grown(block: &Block, by: f64) -> Block {
    Block { min: block.min - by, max: block.max + by }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, UVec3, Vec3};

    use super::*;
    use crate::grid::GridSpec;

    fn grid() -> Grid {
        Grid::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::new(100, 60, 100) }).unwrap()
    }

    fn bounds(center: [f64; 3], half: f64) -> Block {
        let c = DVec3::from_array(center);
        Block { min: c - half, max: c + half }
    }

    #[test]
    fn a_volume_contains_every_reachable_place_and_no_viewer() {
        let g = grid();
        let b = bounds([50.5, 30.5, 50.5], 1.0);
        let v = Tbv::around(&g, &b, 4.0, &[], Border::Cut).unwrap();
        assert!(v.block.contains(&grown(&b, 4.0)));
        let viewer = IVec3::new(55, 30, 50);
        let near = Tbv::around(&g, &b, 4.0, &[viewer], Border::Cut).unwrap();
        assert!(!near.cells.contains(viewer) && near.block.contains(&grown(&b, near.slack)));
        assert!(Tbv::around(&g, &b, 4.0, &[IVec3::new(50, 30, 50)], Border::Cut).is_none());
        let far = Tbv::around(&g, &b, 1e9, &[], Border::Cut).unwrap();
        assert!(far.slack < 24.0 && (far.cells.hi - far.cells.lo).max_element() < 50);
        assert!(Tbv::around(&g, &bounds([50.0; 3], 30.0), 1.0, &[], Border::Cut).is_none());
        assert!(Tbv::around(&g, &bounds([0.5, 30.0, 30.0], 1.0), 1.0, &[], Border::Cut).is_none());
        let edge = Tbv::around(&g, &bounds([3.5, 30.0, 30.0], 1.0), 9.0, &[], Border::Inside).unwrap();
        assert!(edge.slack <= 2.5 && edge.slack > 2.0);
        let beyond = Tbv::around(&g, &bounds([3.5, 30.0, 30.0], 1.0), 8.0, &[], Border::Beyond).unwrap();
        assert!(beyond.slack == 8.0 && beyond.cells.lo.x == -6 && beyond.block.min.x == -5.5);
        let roomy = Tbv::around(&g, &bounds([6.5, 30.0, 30.0], 1.0), 8.0, &[], Border::Beyond).unwrap();
        assert!(roomy.slack == 5.5 && roomy.cells.lo.x == 0);
        assert!(Tbv::around(&g, &bounds([1e7, 30.0, 30.0], 1.0), 8.0, &[], Border::Beyond).is_none());
    }
}
