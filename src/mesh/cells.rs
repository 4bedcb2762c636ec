//! The cells of a mesh: those that its surface touches, and those inside.
//!
//! The cost is that of the cells that triangles touch and of the rows that come out, whatever the
//! volume: rows without surface are taken together, slice by slice.

use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

use glam::{DVec3, IVec3};

use crate::grid::bricks::Bricks;
use crate::grid::mask::BRICK;
use crate::grid::run::CellRun;
use crate::grid::{Grid, clip};
use crate::heap::in_arc;
use crate::mesh::raster::{CellRaster, box_of, margin};

/// The cells of a block that the surface of a mesh touches.
#[derive(Debug)]
pub(crate) struct SurfaceCells {
    /// The block: the mesh's box, as far as it lies in the grid.
    lo: IVec3,
    hi: IVec3,
    /// Rows in order of slice, row and x, none next to another.
    pub(crate) runs: Vec<CellRun>,
}

/// Cells that are found once for several uses, while this lives.
#[derive(Debug)]
pub(crate) struct CachedCells {
    grid: Grid,
    cells: OnceLock<Option<Arc<SurfaceCells>>>,
}

/// The cached cells of a mesh, if anybody keeps them alive.
#[derive(Debug, Default)]
pub(crate) struct CellCache(Mutex<Weak<CachedCells>>);

impl CellCache {
    /// Caches the cells in a grid until the result is dropped.
    pub(crate) fn cache(&self, grid: &Grid) -> Arc<CachedCells> {
        let held = Arc::new(CachedCells { grid: *grid, cells: OnceLock::new() });
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Arc::downgrade(&held);
        held
    }

    /// Bytes on the heap: those of the last cells that were cached, without the rows.
    pub(crate) fn bytes(&self) -> usize {
        // A `Weak` keeps the memory of a value that is gone.
        let last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if last.ptr_eq(&Weak::new()) { 0 } else { in_arc::<CachedCells>() }
    }

    /// The cells in a grid, found by `find` unless they are cached.
    pub(crate) fn get(
        &self,
        grid: &Grid,
        find: impl FnOnce() -> Option<SurfaceCells>,
    ) -> Option<Arc<SurfaceCells>> {
        let held = self.0.lock().unwrap_or_else(PoisonError::into_inner).upgrade();
        match held.filter(|held| held.grid == *grid) {
            Some(held) => held.cells.get_or_init(|| find().map(Arc::new)).clone(),
            None => find().map(Arc::new),
        }
    }
}

impl Clone for CellCache {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Where a line along x through the middle of a row crosses a mesh.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    pub(crate) y: i32,
    pub(crate) z: i32,
    pub(crate) x: f64,
    /// By how much the winding number changes.
    pub(crate) winding: i32,
}

/// Cells without surface: a stretch of one row, or all of several rows that have none.
struct Strip {
    z: i32,
    y0: i32,
    y1: i32,
    x0: i32,
    x1: i32,
    parent: u32,
    /// Whether all of it lies behind triangles, as counted along its rows.
    behind: bool,
}

/// Neighbouring rows of a slice, the last of them, and their strips.
struct RowStrips {
    y1: i32,
    strips: Range<usize>,
}

impl SurfaceCells {
    /// The cells that triangles touch, of the block that covers the box from `min` to `max`; `None`
    /// if that lies beside the grid.
    pub(crate) fn new(
        triangles: impl Iterator<Item = [DVec3; 3]>,
        grid: &Grid,
        (min, max): (DVec3, DVec3),
    ) -> Option<Self> {
        let (lo, hi) = grid.cover(min, max);
        let (lo, hi) = clip(lo, hi)?;
        let mut bricks: Bricks<[u64; 8]> = Bricks::default();
        let mut raster = CellRaster::new(grid, lo, hi);
        for t in triangles {
            raster.triangle(&t, |run| {
                let (x0, x1, y, z) = (run.x0 - lo.x, run.x1 - lo.x, run.y - lo.y, run.z - lo.z);
                for bx in x0 / BRICK..=x1 / BRICK {
                    let (first, last) = ((x0 - bx * BRICK).max(0), (x1 - bx * BRICK).min(BRICK - 1));
                    let bits = (0xff >> (BRICK - 1 - last)) & (0xff << first);
                    let brick = bricks.get_mut(IVec3::new(bx, y / BRICK, z / BRICK));
                    brick[(z % BRICK) as usize] |= bits << (y % BRICK * BRICK);
                }
            });
        }
        let mut filled: Vec<([i32; 3], &[u64; 8])> =
            bricks.iter().map(|(at, brick)| ([at.z, at.y, at.x], brick)).collect();
        filled.sort_unstable_by_key(|f| f.0);
        let mut runs: Vec<CellRun> = Vec::new();
        for slices in filled.chunk_by(|a, b| a.0[0] == b.0[0]) {
            for slice in 0..BRICK {
                for rows in slices.chunk_by(|a, b| a.0[1] == b.0[1]) {
                    for row in 0..BRICK {
                        for ([bz, by, bx], brick) in rows {
                            let bits = brick[slice as usize] >> (row * BRICK) & 0xff;
                            let corner = lo + IVec3::new(*bx, *by, *bz) * BRICK;
                            add_runs(&mut runs, bits, corner + IVec3::new(0, row, slice));
                        }
                    }
                }
            }
        }
        Some(Self { lo, hi, runs })
    }

    /// Where lines along x through the middles of the block's rows cross triangles, in order of
    /// slice, row and x; not beyond the block.
    pub(crate) fn crossings(
        &self,
        triangles: impl Iterator<Item = [DVec3; 3]>,
        grid: &Grid,
        crossing: impl Fn(&[DVec3; 3], DVec3) -> Option<(f64, i32)>,
    ) -> Vec<Crossing> {
        let mut all = Vec::new();
        let end = grid.plane(0, self.hi.x + 1);
        for t in triangles {
            let (min, max) = box_of(&t);
            let (a, b) = grid.cover(min, max);
            let (a, b) = (a.max(self.lo), b.min(self.hi));
            let room = margin(&t);
            for z in a.z..=b.z {
                let middle = |y: i32| {
                    let (min, max) = grid.cell_bounds(IVec3::new(self.lo.x, y, z));
                    (min + max) * 0.5
                };
                // The triangle's section at this height.
                let height = middle(a.y).z;
                let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
                for (p, q) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                    if (p.z > height) != (q.z > height) {
                        let y = p.y + (height - p.z) / (q.z - p.z) * (q.y - p.y);
                        (low, high) = (low.min(y), high.max(y));
                    }
                }
                if low > high {
                    continue;
                }
                let first = grid.cell_along(1, low - room).max(a.y);
                let last = grid.cell_along(1, high + room).min(b.y);
                for y in first..=last {
                    if let Some((x, winding)) = crossing(&t, middle(y)).filter(|c| c.0 < end) {
                        all.push(Crossing { y, z, x, winding });
                    }
                }
            }
        }
        all.sort_unstable_by(|a, b| (a.z, a.y).cmp(&(b.z, b.y)).then(a.x.total_cmp(&b.x)));
        all
    }

    /// Calls `out` with the rows of all components without surface that lie behind triangles in
    /// each of their rows. `is_behind` says that of a number of crossings and the winding number
    /// beyond them.
    pub(crate) fn inside(
        &self,
        grid: &Grid,
        crossings: &[Crossing],
        is_behind: impl Fn(u32, i32) -> bool,
        out: &mut dyn FnMut(CellRun),
    ) {
        let mut strips = self.strips(grid, crossings, is_behind);
        for i in 0..strips.len() {
            let r = root(&mut strips, i as u32) as usize;
            strips[r].behind &= strips[i].behind;
        }
        for i in 0..strips.len() {
            let r = root(&mut strips, i as u32) as usize;
            if strips[r].behind {
                let Strip { z, y0, y1, x0, x1, .. } = strips[i];
                (y0..=y1).for_each(|y| out(CellRun { x0, x1, y, z }));
            }
        }
    }

    /// The strips of the block in order of slice and row; neighbours are joined.
    fn strips(
        &self,
        grid: &Grid,
        mut crossings: &[Crossing],
        is_behind: impl Fn(u32, i32) -> bool,
    ) -> Vec<Strip> {
        let Self { lo, hi, .. } = *self;
        let mut strips: Vec<Strip> = Vec::new();
        let mut runs = self.runs.as_slice();
        let mut below: Vec<RowStrips> = Vec::new();
        for z in lo.z..=hi.z {
            let mut slice: Vec<RowStrips> = Vec::new();
            let mut y = lo.y;
            while y <= hi.y {
                let surface = runs.iter().take_while(|r| (r.z, r.y) == (z, y)).count();
                let first = strips.len();
                let y0 = y;
                if surface == 0 {
                    y = runs.first().filter(|r| r.z == z).map_or(hi.y + 1, |r| r.y);
                    let counted = crossings.partition_point(|c| (c.z, c.y) < (z, y));
                    let start = grid.plane(0, lo.x);
                    let mut rows = 0;
                    for row in crossings[..counted].chunk_by(|a, b| (a.z, a.y) == (b.z, b.y)) {
                        let (count, winding) = count(row.iter().take_while(|c| c.x < start));
                        rows += i32::from(row[0].z == z && row[0].y >= y0 && is_behind(count, winding));
                    }
                    crossings = &crossings[counted..];
                    let behind = rows == y - y0;
                    let parent = first as u32;
                    strips.push(Strip { z, y0, y1: y - 1, x0: lo.x, x1: hi.x, parent, behind });
                } else {
                    y += 1;
                    let skipped = crossings.partition_point(|c| (c.z, c.y) < (z, y0));
                    let here = crossings.partition_point(|c| (c.z, c.y) < (z, y));
                    let mut row = &crossings[skipped..here];
                    crossings = &crossings[here..];
                    let (mut counted, mut winding) = (0, 0);
                    let mut x = lo.x;
                    let ends = runs[..surface].iter().map(|r| (r.x0, r.x1)).chain([(hi.x + 1, hi.x + 1)]);
                    for (x0, x1) in ends {
                        if x < x0 {
                            let start = grid.plane(0, x);
                            let before = row.partition_point(|c| c.x < start);
                            let more = count(row[..before].iter());
                            (counted, winding) = (counted + more.0, winding + more.1);
                            row = &row[before..];
                            let (behind, parent) = (is_behind(counted, winding), strips.len() as u32);
                            strips.push(Strip { z, y0, y1: y0, x0: x, x1: x0 - 1, parent, behind });
                        }
                        x = x1 + 1;
                    }
                    runs = &runs[surface..];
                }
                let rows = RowStrips { y1: y - 1, strips: first..strips.len() };
                if let Some(last) = slice.last() {
                    join(&mut strips, last, &rows);
                }
                slice.push(rows);
            }
            let (mut i, mut j) = (0, 0);
            while i < below.len() && j < slice.len() {
                join(&mut strips, &below[i], &slice[j]);
                // Both lists cover all rows.
                let (end, other) = (below[i].y1, slice[j].y1);
                i += usize::from(end <= other);
                j += usize::from(other <= end);
            }
            below = slice;
        }
        strips
    }
}

/// The number of crossings, and the winding number beyond them.
fn count<'a>(crossings: impl Iterator<Item = &'a Crossing>) -> (u32, i32) {
    crossings.fold((0, 0), |(n, sum), c| (n + 1, sum + c.winding))
}

/// Adds the runs of set bits from a cell on, in order. Bits that continue the last run lengthen it.
fn add_runs(runs: &mut Vec<CellRun>, mut bits: u64, at: IVec3) {
    while bits != 0 {
        let first = bits.trailing_zeros() as i32;
        let length = (bits >> first).trailing_ones() as i32;
        bits &= !(((1 << length) - 1) << first);
        let (x0, x1) = (at.x + first, at.x + first + length - 1);
        match runs.last_mut() {
            Some(last) if (last.z, last.y, last.x1 + 1) == (at.z, at.y, x0) => last.x1 = x1,
            _ => runs.push(CellRun { x0, x1, y: at.y, z: at.z }),
        }
    }
}

fn root(strips: &mut [Strip], mut i: u32) -> u32 {
    while strips[i as usize].parent != i {
        let up = strips[strips[i as usize].parent as usize].parent;
        strips[i as usize].parent = up;
        i = up;
    }
    i
}

/// Joins the strips of neighbouring rows that overlap.
fn join(strips: &mut [Strip], a: &RowStrips, b: &RowStrips) {
    let (mut i, mut j) = (a.strips.start, b.strips.start);
    while i < a.strips.end && j < b.strips.end {
        if strips[i].x0 <= strips[j].x1 && strips[j].x0 <= strips[i].x1 {
            let (ri, rj) = (root(strips, i as u32), root(strips, j as u32));
            strips[ri.max(rj) as usize].parent = ri.min(rj);
        }
        if strips[i].x1 < strips[j].x1 { i += 1 } else { j += 1 }
    }
}
