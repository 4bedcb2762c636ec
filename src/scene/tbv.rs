//! Temporal bounding volumes: boxes of cells that hold hidden dynamic objects
//! for a while (Sudarsky & Gotsman 1996; thesis, sections 3.3.2 and 3.4.1).
//!
//! A volume is the object's bounds widened by the way it can go while the
//! volume is valid. Validity adapts: longer after the object left or
//! outlived its volume unseen, half as long after the volume was revealed.
//! Limits on the widening: the radius of the thesis, what laying costs, and the rule that a hollow
//! volume must not contain a viewer.

use std::collections::HashMap;

use glam::IVec3;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::cell_box::CellBox;
use crate::matrix::tbv::TbvMatrix;
use crate::scene::outer::{Bucket, Outer};

/// Validity of the first volume of an object, in seconds.
pub(crate) const FIRST_VALIDITY: f64 = 0.5;
/// Bounds of what adaptation can make of it.
pub(crate) const VALIDITY_RANGE: (f64, f64) = (1.0 / 64.0, 64.0);

/// What validity is multiplied by when a volume is outlived, and when it is revealed. A slow rise keeps
/// most volumes from being revealed at all: each reveal costs a query a test, and the object a new volume.
pub(crate) const LONGER: f64 = 1.25;
pub(crate) const SHORTER: f64 = 0.5;
/// Volumes are widened by at most this many cells: the cost of laying one grows with the square of
/// the widening, the time that it lasts only with the widening.
const MOST_CELLS: f64 = 8.0;

/// One object's volume.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tbv {
    pub(crate) cells: CellBox,
    /// Its cells as a box in world units; no more than is needed where it leaves the grid.
    pub(crate) block: Block,
    /// How far the object can move and stay inside.
    pub(crate) slack: f64,
}

impl Tbv {
    /// Whether the volume holds something with all cells that it touches: what is flat on a wall of a cell may touch
    /// the one beyond.
    pub(crate) fn holds(&self, grid: &Grid, bounds: &Block) -> bool {
        let (lo, hi) = grid.cover(bounds.min, bounds.max);
        self.block.contains(bounds) && self.cells.contains(lo) && self.cells.contains(hi)
    }

    /// How far something inside is from the nearest wall.
    pub(crate) fn room(&self, inside: &Block) -> f64 {
        (inside.min - self.block.min).min(self.block.max - inside.max).min_element()
    }
}

/// A volume that the border of the grid leaves less than this share of the way asked for leaves the grid instead.
const CRAMPED: f64 = 0.5;

/// Volumes beyond this many cells from the grid are not laid: their cells could not be counted.
const FARTHEST: i32 = 1 << 20;

/// How a volume meets the border of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Border {
    /// It is cut off there: the object is reported when it leaves.
    Cut,
    /// It ends there, and the object does not get there while it is valid.
    Inside,
    /// It goes on beyond it where it would be cramped inside.
    Beyond,
}

/// Lays the volume of an object with the given bounds, or none: the object
/// leaves the grid, is too large or too close to a viewer.
pub(crate) fn lay(grid: &Grid, bounds: &Block, way: f64, viewers: &[IVec3], border: Border) -> Option<Tbv> {
    let (lo, hi) = grid.cover(bounds.min, bounds.max);
    let inside = grid.contains(lo) && grid.contains(hi);
    if !inside && border != Border::Beyond {
        return None;
    }
    let cell = grid.cell_size();
    let dims = grid.dims().as_dvec3();
    let limit = (dims.x / 5.0).hypot(dims.y / 5.0) * cell;
    let half = (bounds.max - bounds.min).max_element() * 0.5;
    let mut slack = way.min(limit.max(cell) - half).min(MOST_CELLS * cell);
    if slack.is_nan() || slack < 0.0 {
        return None;
    }
    for &viewer in viewers {
        let gap = (lo - viewer).max(viewer - hi).max_element();
        if gap <= 0 {
            return None;
        }
        slack = slack.min(f64::from(gap - 1) * cell);
    }
    let room = (bounds.min - grid.min()).min(grid.max() - bounds.max).min_element();
    let beyond = border == Border::Beyond && room < CRAMPED * slack;
    if border != Border::Cut && !beyond {
        slack = slack.min(room);
        if slack < 0.0 {
            return None;
        }
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
    let block = if beyond {
        Block { min: bounds.min - slack, max: bounds.max + slack }
    } else {
        Block::new(grid.range_bounds(lo, hi))
    };
    Some(Tbv { cells, block, slack })
}

/// Finds the volumes that hold a cell, to keep the rule that a hollow volume
/// must not contain the viewer: a volume of up to 2^level cells is filed by its
/// centre in a hash grid of that pitch, so that 8 places a level are looked up.
#[derive(Clone, Default)]
pub(crate) struct Containing {
    levels: Vec<HashMap<[i32; 3], Vec<u32>>>,
    /// By slot: its place in its list, so that it leaves it at once.
    places: Vec<u32>,
}

fn level_and_key(volume: &CellBox) -> (usize, [i32; 3]) {
    let size = (volume.hi - volume.lo).max_element() as u32 + 1;
    let level = size.next_power_of_two().trailing_zeros() as usize;
    (level, (((volume.lo + volume.hi) >> 1i32) >> level as i32).to_array())
}

impl Containing {
    fn insert(&mut self, volume: &CellBox, slot: u32) {
        let (level, key) = level_and_key(volume);
        if self.levels.len() <= level {
            self.levels.resize_with(level + 1, HashMap::new);
        }
        if self.places.len() <= slot as usize {
            self.places.resize(slot as usize + 1, 0);
        }
        let list = self.levels[level].entry(key).or_default();
        self.places[slot as usize] = list.len() as u32;
        list.push(slot);
    }

    fn remove(&mut self, volume: &CellBox, slot: u32) {
        let (level, key) = level_and_key(volume);
        let Some(map) = self.levels.get_mut(level) else { return };
        let Some(list) = map.get_mut(&key) else { return };
        let place = self.places[slot as usize];
        list.swap_remove(place as usize);
        if let Some(&moved) = list.get(place as usize) {
            self.places[moved as usize] = place;
        }
        if list.is_empty() {
            map.remove(&key);
        }
    }

    /// Calls `found` for a superset of the volumes that hold a cell.
    fn find(&self, cell: IVec3, mut found: impl FnMut(u32)) {
        for (level, map) in self.levels.iter().enumerate() {
            if map.is_empty() {
                continue;
            }
            // A volume reaches at most 2^(level-1) cells from its centre, rounded up.
            let reach = (1 << level >> 1i32) + 1;
            let (a, b) = ((cell - reach) >> level as i32, (cell + reach) >> level as i32);
            for z in a.z..=b.z {
                for y in a.y..=b.y {
                    for x in a.x..=b.x {
                        if let Some(list) = map.get(&[x, y, z]) {
                            list.iter().for_each(|&s| found(s));
                        }
                    }
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        let entry = size_of::<([i32; 3], Vec<u32>)>() + 1;
        self.levels
            .iter()
            .map(|m| m.capacity() * entry + m.values().map(|l| l.capacity() * 4).sum::<usize>())
            .sum::<usize>()
            + self.places.capacity() * 4
    }
}

/// All volumes of a scene.
#[derive(Clone)]
pub(crate) struct Volumes {
    pub(crate) matrix: TbvMatrix,
    /// By slot; only read for slots in the matrix.
    cells: Vec<CellBox>,
    containing: Containing,
    /// Those that leave the grid are not in the matrix.
    outer: Outer,
    /// All cells of the grid.
    whole: CellBox,
}

impl Volumes {
    pub(crate) fn new(grid: &Grid) -> Self {
        Self {
            matrix: TbvMatrix::new(grid.dims()),
            cells: Vec::new(),
            containing: Containing::default(),
            outer: Outer::default(),
            whole: CellBox { lo: IVec3::ZERO, hi: grid.dims() - 1 },
        }
    }

    pub(crate) fn insert(&mut self, slot: u32, tbv: &Tbv) {
        let volume = &tbv.cells;
        if self.cells.len() <= slot as usize {
            self.cells.resize(slot as usize + 1, CellBox::default());
        }
        self.cells[slot as usize] = *volume;
        if self.leaves(volume) {
            self.outer.insert(&tbv.block, volume, slot);
        } else {
            self.matrix.insert(volume, slot);
        }
        self.containing.insert(volume, slot);
    }

    /// Whether a volume reaches beyond the grid.
    fn leaves(&self, volume: &CellBox) -> bool {
        !(self.whole.contains(volume.lo) && self.whole.contains(volume.hi))
    }

    /// Whether the volume of an object reaches beyond the grid.
    pub(crate) fn is_outer(&self, slot: u32) -> bool {
        self.leaves(self.cells(slot))
    }

    /// The box of an object's volume.
    pub(crate) fn block(&self, grid: &Grid, slot: u32) -> Block {
        let CellBox { lo, hi } = *self.cells(slot);
        if self.is_outer(slot) { self.outer.block(slot) } else { Block::new(grid.range_bounds(lo, hi)) }
    }

    /// The volumes that reach beyond the grid.
    pub(crate) fn outer(&self) -> impl Iterator<Item = &Bucket> {
        self.outer.buckets()
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        let volume = self.cells[slot as usize];
        if self.leaves(&volume) {
            self.outer.remove(&volume, slot);
        } else {
            self.matrix.remove(&volume, slot);
        }
        self.containing.remove(&volume, slot);
    }

    #[inline]
    pub(crate) fn cells(&self, slot: u32) -> &CellBox {
        &self.cells[slot as usize]
    }

    /// The volumes that hold a cell, on their surface or inside.
    pub(crate) fn holding(&self, cell: IVec3, mut found: impl FnMut(u32)) {
        self.containing.find(cell, |slot| {
            if self.cells[slot as usize].contains(cell) {
                found(slot);
            }
        });
    }

    pub(crate) fn bytes(&self) -> usize {
        self.matrix.bytes()
            + self.cells.capacity() * size_of::<CellBox>()
            + self.containing.bytes()
            + self.outer.bytes()
    }
}

/// An object whose volume expires, ordered by time and then by slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expiry {
    pub(crate) at: f64,
    pub(crate) slot: u32,
    pub(crate) generation: u32,
}

impl Eq for Expiry {}

impl PartialOrd for Expiry {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Expiry {
    /// Earliest is greatest: for a heap that gives the earliest first.
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other
            .at
            .total_cmp(&self.at)
            .then(other.slot.cmp(&self.slot))
            .then(other.generation.cmp(&self.generation))
    }
}

/// How far an object may go in `validity` seconds.
pub(crate) fn way(speed: f64, validity: f64) -> f64 {
    let way = speed * validity;
    if way.is_finite() { way } else { f64::MAX }
}

/// Grows a box by a distance on all sides.
#[cfg(test)]
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
    fn a_volume_holds_the_way_and_no_viewer() {
        let g = grid();
        let b = bounds([50.5, 30.5, 50.5], 1.0);
        let v = lay(&g, &b, 4.0, &[], Border::Cut).unwrap();
        assert!(v.block.contains(&grown(&b, 4.0)));
        let viewer = IVec3::new(55, 30, 50);
        let near = lay(&g, &b, 4.0, &[viewer], Border::Cut).unwrap();
        assert!(!near.cells.contains(viewer) && near.block.contains(&grown(&b, near.slack)));
        assert!(lay(&g, &b, 4.0, &[IVec3::new(50, 30, 50)], Border::Cut).is_none());
        let far = lay(&g, &b, 1e9, &[], Border::Cut).unwrap();
        assert!(far.slack < 24.0 && (far.cells.hi - far.cells.lo).max_element() < 50);
        assert!(lay(&g, &bounds([50.0; 3], 30.0), 1.0, &[], Border::Cut).is_none());
        assert!(lay(&g, &bounds([0.5, 30.0, 30.0], 1.0), 1.0, &[], Border::Cut).is_none());
        let edge = lay(&g, &bounds([3.5, 30.0, 30.0], 1.0), 9.0, &[], Border::Inside).unwrap();
        assert!(edge.slack <= 2.5 && edge.slack > 2.0);
        let beyond = lay(&g, &bounds([3.5, 30.0, 30.0], 1.0), 8.0, &[], Border::Beyond).unwrap();
        assert!(beyond.slack == 8.0 && beyond.cells.lo.x == -6 && beyond.block.min.x == -5.5);
        let roomy = lay(&g, &bounds([6.5, 30.0, 30.0], 1.0), 8.0, &[], Border::Beyond).unwrap();
        assert!(roomy.slack == 5.5 && roomy.cells.lo.x == 0);
        assert!(lay(&g, &bounds([1e7, 30.0, 30.0], 1.0), 8.0, &[], Border::Beyond).is_none());
    }

    #[test]
    fn finds_every_volume_around_a_cell() {
        let mut volumes = Volumes::new(&grid());
        let mut boxes = Vec::new();
        let mut state = 9u32;
        let mut next = |n: i32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as i32 % n
        };
        for slot in 0..400 {
            let lo = IVec3::new(next(90), next(50), next(90));
            let hi = (lo + IVec3::new(next(30), next(9), next(20))).min(IVec3::new(99, 59, 99));
            boxes.push(CellBox { lo, hi });
            let block = Block::new(grid().range_bounds(lo, hi));
            volumes.insert(slot, &Tbv { cells: CellBox { lo, hi }, block, slack: 0.0 });
        }
        for slot in (0..400).step_by(3) {
            volumes.remove(slot);
        }
        for _ in 0..500 {
            let c = IVec3::new(next(100), next(60), next(100));
            let mut found = Vec::new();
            volumes.holding(c, |s| found.push(s));
            found.sort_unstable();
            let expect: Vec<u32> =
                (0..400).filter(|s| s % 3 != 0 && boxes[*s as usize].contains(c)).collect();
            assert_eq!(found, expect, "{c}");
        }
    }
}
