//! Objects that reach beyond the grid, where no cell can be hidden.
//!
//! Let the viewer's cell V lie in the grid, v be a point of it and p a point of an object beyond
//! the grid. The segment from v to p leaves the grid at a point x of a cell on the border. If v
//! sees p, it sees x. So if all cells in which such points x may lie are hidden, no point of the
//! object beyond the grid is seen from V; its points in the grid are in its own cells, as those of
//! other objects.
//!
//! Where are the points x? Let V be by h or more inside of a face of the grid, and the object by e
//! or less beyond it. A segment passes that face at the share h / (h + e) of its way or later. Let
//! t be the least of these shares, over the faces that the object passes: x = v + s (p - v) with a
//! share s from t to 1. Along each axis that is between the least and the greatest coordinate of
//! V + t (B - V) and of B, the object's box.

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::cell_box::{CellBox, volume};
use crate::numeric::query::EXIT;
use crate::query::cell::finder::Finder;

/// Objects whose points x may lie in more cells than this are decided at once.
const MOST_EXITS: u64 = 1 << 12;

/// The cells on the border in which segments from one box to the parts of another beyond the grid
/// may leave the grid, face by face; `None` if that may be anywhere.
fn exits(grid: &Grid, from: &Block, to: &Block) -> Option<impl Iterator<Item = CellBox> + use<>> {
    let (min, max) = (grid.min(), grid.max());
    let (below, above) = (min - to.min, to.max - max);
    let (room_below, room_above) = (from.min - min, max - from.max);
    let mut share = 1.0f64;
    for axis in 0..3 {
        for (beyond, room) in [(below[axis], room_below[axis]), (above[axis], room_above[axis])] {
            if beyond > 0.0 {
                share = share.min(room / (room + beyond));
            }
        }
    }
    let room = EXIT * (from.min.abs().max(from.max.abs()) + to.min.abs().max(to.max.abs())).max_element();
    share -= EXIT;
    // Not a number for boxes that are none.
    if share.is_nan() || share <= 0.0 {
        return None;
    }
    let way = |v: DVec3, p: DVec3| v + (p - v) * share;
    let (lo, hi) = (way(from.min, to.min).min(to.min) - room, way(from.max, to.max).max(to.max) + room);
    let (lo, hi) = grid.cover(lo, hi);
    let last = grid.dims() - 1;
    let (lo, hi) = grid.clip(lo, hi)?;
    let faces = (0..3).flat_map(move |axis| {
        let layer = move |passed: bool, at: i32| {
            let mut cells = CellBox { lo, hi };
            (cells.lo[axis], cells.hi[axis]) = (at, at);
            passed.then_some(cells)
        };
        [layer(below[axis] > 0.0, 0), layer(above[axis] > 0.0, last[axis])].into_iter().flatten()
    });
    Some(faces)
}

/// Lists the objects that reach beyond the grid by the cells on the border that decide about those
/// parts, and returns them with a box around these cells. Objects for which no such cells are known
/// are decided. Without `known` cells, that is all of them.
pub(super) fn list_overhanging(finder: &mut Finder, known: bool) -> Vec<(Slot, CellBox)> {
    let (scene, view, cell) = (finder.scene, finder.view, finder.shells.cell);
    let grid = scene.grid();
    let from = Block::new(grid.cell_bounds(cell)).grown(view.eye_box().max_element());
    let (mut slots, mut listed) = (Vec::new(), Vec::new());
    scene.overhang().slots_where(|block| view.may_see_volume(block), |slot| slots.push(slot));
    for slot in slots {
        let object = scene.object(slot);
        if finder.marks.is_decided(slot) || !object.is_shown(view) {
            continue;
        }
        let block = object.bounds().block();
        let faces = if known && grid.contains(cell) { exits(grid, &from, &block) } else { None };
        let few = |faces: &Vec<CellBox>| faces.iter().map(|f| volume(f.lo, f.hi)).sum::<u64>() <= MOST_EXITS;
        match faces.map(Iterator::collect).filter(few) {
            Some(_) if !view.may_see(object.bounds()) => {}
            Some(faces) => {
                listed.extend(faces.iter().copied().reduce(CellBox::join).map(|around| (slot, around)));
                faces.into_iter().flat_map(CellBox::cells).for_each(|c| finder.pend(c, slot));
            }
            None => finder.decide(slot),
        }
    }
    listed
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;
    use crate::grid::GridSpec;
    use crate::random::Random;

    #[test]
    fn segments_leave_the_grid_in_the_cells_found() {
        let spec = GridSpec { min: Vec3::new(-4.0, 1.0, 0.0), cell: 0.5, dims: UVec3::new(24, 12, 16) };
        let grid = Grid::new(&spec).unwrap();
        let (min, max) = (grid.min(), grid.max());
        let mut random = Random::new(11);
        let mut point =
            |lo: DVec3, hi: DVec3| lo + DVec3::new(random.next(), random.next(), random.next()) * (hi - lo);
        let (mut left, mut unknown, mut cells) = (0, 0, 0);
        for _ in 0..3000 {
            let v = grid.cell_of(point(min, max));
            let from = Block::new(grid.cell_bounds(v));
            let (a, b) = (point(min - 1.0, max + 1.0), point(DVec3::ZERO, DVec3::splat(1.5)));
            let to = Block { min: a, max: a + b };
            let Some(faces) = exits(&grid, &from, &to) else {
                unknown += 1;
                continue;
            };
            let faces: Vec<CellBox> = faces.collect();
            cells += faces.iter().map(|f| volume(f.lo, f.hi)).sum::<u64>();
            for _ in 0..20 {
                let (eye, p) = (point(from.min, from.max), point(to.min, to.max));
                let way = p - eye;
                let end = DVec3::select(way.cmplt(DVec3::ZERO), min, max);
                // The share of the way at which it leaves the grid; more than 1 if it does not.
                let leaves = ((end - eye) / way).min_element();
                if leaves < 1.0 {
                    left += 1;
                    let x = (eye + way * leaves).clamp(min, max);
                    let c = grid.cell_of(x).clamp(glam::IVec3::ZERO, grid.dims() - 1);
                    assert!(faces.iter().any(|f| f.contains(c)), "{eye} to {p} leaves at {x}");
                }
            }
        }
        assert!(left > 5000 && unknown < 2000 && cells < 200_000, "{left} {unknown} {cells}");
    }
}
