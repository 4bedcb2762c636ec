//! Opacities at half the resolution again and again: six directional channels (Villegas 2016,
//! section 1.7.4.5), and beside them whether any and whether all cells below are occupied.
//!
//! A channel composes pairs of cells front to back and takes the mean of the four results. A wall
//! thus stays opaque for rays through it at every level. Seen along it, an opacity a becomes a -
//! a^2 / 2 a level: pairs count as independent, so that it falls more slowly than the share 2^-l of
//! the rays that a thin wall stops. Only bricks that are neither empty nor full hold channels.

use glam::{DVec3, IVec3};

use crate::grid::bricks::{BRICK, Bricks};
use crate::matrix::bits::{ALL, BitMatrix, Mask, NONE, block_mask, without};
use crate::numeric::soft::ONE;

/// Opacities for rays that travel along +x, -x, +y, -y, +z and -z, in units of 2^-15.
type Faces = [u16; 6];

const EMPTY: Faces = [0; 6];
const OPAQUE: Faces = [ONE as u16; 6];

/// The channels of a brick that is neither empty nor full.
#[derive(Clone, Default)]
struct Channels(Option<Box<[Faces; 512]>>);

#[derive(Clone)]
struct Level {
    dims: IVec3,
    any: BitMatrix,
    all: BitMatrix,
    channels: Bricks<Channels>,
}

/// The occupied cells of a [`crate::soft::SoftGrid`] and the levels above them. Level 0 is the
/// grid; a cell of level `l` covers 2^l cells of it along each axis, as far as these are in the
/// grid: cells beyond the border take no part.
#[derive(Clone)]
pub struct Pyramid {
    base: BitMatrix,
    levels: Vec<Level>,
}

impl Pyramid {
    pub(super) fn new(dims: IVec3) -> Self {
        let mut levels = Vec::new();
        let mut at = dims;
        while at.max_element() > 1 {
            at = (at + 1) >> 1i32;
            let (any, all) = (BitMatrix::new(at), BitMatrix::new(at));
            levels.push(Level { dims: at, any, all, channels: Bricks::new(at) });
        }
        Self { base: BitMatrix::new(dims), levels }
    }

    /// The greatest level: a single cell.
    pub fn top(&self) -> usize {
        self.levels.len()
    }

    /// Cells along each axis of a level; those of the top for greater levels.
    pub fn dims(&self, level: usize) -> IVec3 {
        match level.min(self.top()).checked_sub(1) {
            Some(i) => self.levels[i].dims,
            None => self.base.dims(),
        }
    }

    /// Whether any base cell covered by this cell of a level is occupied; none is outside the grid.
    pub fn any(&self, level: usize, cell: IVec3) -> bool {
        self.any_bits(level).get(cell)
    }

    /// Whether all base cells covered by this cell of a level are occupied; outside the grid they
    /// are not.
    pub fn all(&self, level: usize, cell: IVec3) -> bool {
        self.all_bits(level).get(cell)
    }

    /// The opacity of a cell of a level, 0 to 1, for rays that travel along an axis (0 to 2),
    /// upwards or downwards. 0 outside the grid.
    pub fn opacity(&self, level: usize, cell: IVec3, axis: usize, up: bool) -> f32 {
        let level = level.min(self.top());
        let inside = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(self.dims(level)).all();
        let face = 2 * axis.min(2) + usize::from(!up);
        if inside { f32::from(self.faces(level, cell)[face]) / ONE as f32 } else { 0.0 }
    }

    /// Bytes on the heap.
    pub fn memory_bytes(&self) -> usize {
        let of = |level: &Level| {
            let held = level.channels.iter().filter(|(_, c)| c.0.is_some()).count();
            level.any.bytes() + level.all.bytes() + level.channels.bytes() + held * size_of::<[Faces; 512]>()
        };
        self.base.bytes() + self.levels.iter().map(of).sum::<usize>()
    }

    pub(super) fn any_bits(&self, level: usize) -> &BitMatrix {
        match level.min(self.top()).checked_sub(1) {
            Some(i) => &self.levels[i].any,
            None => &self.base,
        }
    }

    fn all_bits(&self, level: usize) -> &BitMatrix {
        match level.min(self.top()).checked_sub(1) {
            Some(i) => &self.levels[i].all,
            None => &self.base,
        }
    }

    /// Replaces the occupied cells of a brick. Says whether any changed.
    pub(super) fn set_base(&mut self, brick: IVec3, mask: &Mask) -> bool {
        let changed = self.base.brick(brick) != mask;
        if changed {
            replace(&mut self.base, brick, &ALL, mask);
        }
        changed
    }

    /// Makes anew all that lies above bricks of the base. Costs 64 cells for each of them and of
    /// the levels.
    pub(super) fn rebuild(&mut self, mut stale: Vec<IVec3>) {
        for level in 1..=self.top() {
            stale.iter().for_each(|&brick| self.lift(level, brick));
            stale = stale.into_iter().map(|brick| brick >> 1i32).collect();
            // In order, so that equal ones are next to each other.
            stale.sort_unstable_by_key(|b| b.to_array());
            stale.dedup();
        }
    }

    /// Makes anew the 4x4x4 cells of a level above a brick of the one below.
    fn lift(&mut self, level: usize, child: IVec3) {
        let (brick, lo) = (child >> 1i32, child * (BRICK / 2));
        let hi = (lo + (BRICK / 2 - 1)).min(self.dims(level) - 1);
        let region = block_mask(brick, lo, hi);
        let uniform = self.uniform(level - 1, child);
        let (mut any, mut all) = (NONE, NONE);
        let mut new: Vec<(usize, Faces)> = Vec::with_capacity(64);
        for z in lo.z..=hi.z {
            for y in lo.y..=hi.y {
                for x in lo.x..=hi.x {
                    let (faces, some, full) =
                        uniform.unwrap_or_else(|| self.composed(level - 1, IVec3::new(x, y, z) * 2));
                    let place = ((z & 7) << 6 | (y & 7) << 3 | (x & 7)) as usize;
                    let bit = 1 << (place & 63);
                    any[place >> 6] |= if some { bit } else { 0 };
                    all[place >> 6] |= if full { bit } else { 0 };
                    new.push((place, faces));
                }
            }
        }
        let level = &mut self.levels[level - 1];
        let was_full = *level.all.brick(brick) == ALL;
        replace(&mut level.any, brick, &region, &any);
        replace(&mut level.all, brick, &region, &all);
        if *level.any.brick(brick) == NONE || *level.all.brick(brick) == ALL {
            level.channels.release(brick);
            return;
        }
        let before = if was_full { OPAQUE } else { EMPTY };
        let cells = level.channels.get_mut(brick).0.get_or_insert_with(|| Box::new([before; 512]));
        new.into_iter().for_each(|(place, faces)| cells[place] = faces);
    }

    /// What lies above each part of a brick that is empty or full: the channels, and whether any
    /// and all cells are occupied.
    fn uniform(&self, level: usize, brick: IVec3) -> Option<(Faces, bool, bool)> {
        let empty = *self.any_bits(level).brick(brick) == NONE;
        match (empty, *self.all_bits(level).brick(brick) == ALL) {
            (true, _) => Some((EMPTY, false, false)),
            (_, true) => Some((OPAQUE, true, true)),
            _ => None,
        }
    }

    /// The channels of a cell from the eight of the level below that start at `corner`, and whether
    /// any and all of those are occupied.
    fn composed(&self, below: usize, corner: IVec3) -> (Faces, bool, bool) {
        let (dims, mut some, mut full) = (self.dims(below), false, true);
        let mut children = [None; 8];
        for (i, child) in (0..).zip(&mut children) {
            let at = corner + IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            if at.cmplt(dims).all() {
                some |= self.any(below, at);
                full &= self.all(below, at);
                *child = Some(self.faces(below, at));
            }
        }
        let faces = std::array::from_fn(|face| {
            let along = 1 << (face / 2);
            let (mut sum, mut columns) = (0, 0);
            for i in (0..8).filter(|i| i & along == 0) {
                let Some(near) = children[i] else { continue };
                let near = u64::from(near[face]);
                let far = children[i | along].map_or(0, |c| u64::from(c[face]));
                // The same from both ends: front + back (1 - front).
                sum += near * u64::from(ONE) + far * (u64::from(ONE) - near);
                columns += u64::from(ONE);
            }
            ((sum + columns / 2) / columns.max(1)) as u16
        });
        (faces, some, full)
    }

    fn faces(&self, level: usize, cell: IVec3) -> Faces {
        if !self.any_bits(level).get(cell) {
            return EMPTY;
        }
        let Some(above) = level.checked_sub(1) else { return OPAQUE };
        match &self.levels[above].channels.get(cell >> 3i32).0 {
            Some(cells) => cells[((cell.z & 7) << 6 | (cell.y & 7) << 3 | (cell.x & 7)) as usize],
            None => OPAQUE,
        }
    }

    /// Opacities for the three faces at a point in cells of the grid, interpolated between the
    /// eight nearest cells of a level. Cells beyond the border are those of the border.
    pub(super) fn smooth(&self, level: usize, point: DVec3, faces: [usize; 3]) -> DVec3 {
        let at = point / (1u64 << level) as f64 - 0.5;
        let last = self.dims(level) - 1;
        let low = at.floor();
        let part = at - low;
        let mut sum = DVec3::ZERO;
        for i in 0..8 {
            let high = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let share = DVec3::select(high.cmpeq(IVec3::ONE), part, 1.0 - part).element_product();
            if share > 0.0 {
                let f = self.faces(level, (low.as_ivec3() + high).clamp(IVec3::ZERO, last));
                sum += share * DVec3::from_array(faces.map(|face| f64::from(f[face])));
            }
        }
        sum / f64::from(ONE)
    }

    /// As [`Pyramid::smooth`] for one face, but not interpolated along its axis: a slab of cells
    /// keeps its opacity.
    pub(super) fn smooth_across(&self, level: usize, slab: i32, point: DVec3, face: usize) -> f64 {
        let mut at = point / (1u64 << level) as f64 - 0.5;
        at[face / 2] = f64::from(slab);
        let last = self.dims(level) - 1;
        let low = at.floor();
        let part = at - low;
        let (u, v) = ((face / 2 + 1) % 3, (face / 2 + 2) % 3);
        let mut sum = 0.0;
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let share = |part: f64, high: i32| if high == 1 { part } else { 1.0 - part };
            let share = share(part[u], i) * share(part[v], j);
            if share > 0.0 {
                let mut cell = low.as_ivec3();
                (cell[u], cell[v]) = (cell[u] + i, cell[v] + j);
                sum += share * f64::from(self.faces(level, cell.clamp(IVec3::ZERO, last))[face]);
            }
        }
        sum / f64::from(ONE)
    }
}

/// Sets those cells of a region of a brick that are in `new`, and clears its others.
fn replace(bits: &mut BitMatrix, brick: IVec3, region: &Mask, new: &Mask) {
    bits.clear_mask(brick, &without(region, new));
    bits.set_mask(brick, new);
}

impl std::fmt::Debug for Pyramid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Pyramid({} levels over {:?})", self.top(), self.base)
    }
}
