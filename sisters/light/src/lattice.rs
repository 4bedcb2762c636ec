//! Cells of up to three sizes: those of the grid, and finer ones in windows within each other.
//!
//! All points are in cells of the grid, so that margins mean the same everywhere; a finer cell is
//! a power of two smaller, so that scaling is exact.

use glam::{DVec3, IVec3, Vec3};

use crate::clip::{Polygon, part_of};
use crate::input::{Grid, Window};
use crate::numeric::{GRIDS, MOST_CELLS, OVER};

/// Cells along an edge of a brick, as a power of two.
const BRICK: i32 = 2;

/// A cell of one size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cell {
    /// 0 for the grid, 1 and 2 for windows.
    pub(crate) level: usize,
    /// Its place among cells of its size.
    pub(crate) at: IVec3,
}

/// The cells of one size.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Level {
    /// Cells along an edge of a cell of the grid: a power of two.
    pub(crate) fine: f64,
    /// The least cell. That of the grid is 0.
    pub(crate) low: IVec3,
    /// Cells along each axis.
    pub(crate) dims: IVec3,
    /// Cells and bricks of the levels before it.
    pub(crate) first: u32,
    pub(crate) first_brick: u32,
}

impl Level {
    fn has(&self, at: IVec3) -> bool {
        at.cmpge(self.low).all() && at.cmplt(self.low + self.dims).all()
    }

    /// Its box, in cells of the grid.
    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        (self.low.as_dvec3() / self.fine, (self.low + self.dims).as_dvec3() / self.fine)
    }

    pub(crate) fn bricks(&self) -> IVec3 {
        (self.dims + 3) >> BRICK
    }

    /// The level of a window in this one.
    fn window(&self, window: &Window, lattice: &Lattice) -> Self {
        let ratio = window.finer as i32;
        // In cells of this level.
        let middle = lattice.cells(window.middle) * self.fine;
        let edge = 2.0 * f64::from(window.half) / lattice.cell * self.fine;
        let size = self.dims.min(IVec3::splat((edge.ceil() as i32).clamp(1, MOST_CELLS as i32 / ratio)));
        // Far away, whole numbers saturate.
        let low = (middle - 0.5 * size.as_dvec3()).round().as_ivec3();
        let low = low.clamp(self.low, self.low + self.dims - size);
        Self {
            fine: self.fine * f64::from(ratio),
            low: low * ratio,
            dims: size * ratio,
            first: self.first + self.dims.element_product() as u32,
            first_brick: self.first_brick + self.bricks().element_product() as u32,
        }
    }
}

/// The lattice of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lattice {
    /// Its least corner, in metres.
    pub(crate) min: DVec3,
    /// The edge of a cell of the grid, in metres.
    pub(crate) cell: f64,
    /// Cells of the grid along each axis.
    pub(crate) dims: IVec3,
    levels: [Level; GRIDS],
    count: usize,
}

impl Lattice {
    /// The cells that cover a sound grid, and one more on each side, for surfaces in its faces; and
    /// finer ones in sound windows.
    pub(crate) fn new(grid: &Grid, windows: &[Option<Window>]) -> Self {
        let (min, max) = (grid.min.as_dvec3(), grid.max.as_dvec3());
        let cell = (max - min).max_element() / f64::from(grid.cells);
        let dims = ((max - min) / cell).round().as_ivec3();
        let more = ((max - min) / cell - dims.as_dvec3()).cmpgt(DVec3::splat(OVER));
        let more = IVec3::new(more.x.into(), more.y.into(), more.z.into());
        let dims = (dims + more).clamp(IVec3::ONE, IVec3::splat(grid.cells as i32)) + 2;
        let mut lattice = Self { min: min - cell, cell, dims, levels: [Level::default(); GRIDS], count: 1 };
        lattice.levels[0] = Level { fine: 1.0, dims, ..Level::default() };
        for window in windows.iter().flatten().take(GRIDS - 1) {
            lattice.levels[lattice.count] = lattice.levels[lattice.count - 1].window(window, &lattice);
            lattice.count += 1;
        }
        lattice
    }

    /// A point in cells.
    pub(crate) fn cells(&self, p: Vec3) -> DVec3 {
        (p.as_dvec3() - self.min) / self.cell
    }

    /// A point in metres.
    pub(crate) fn metres(&self, p: DVec3) -> Vec3 {
        (p * self.cell + self.min).as_vec3()
    }

    /// The cells of each size, the coarsest first.
    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels[..self.count]
    }

    /// Cells of a cell's size along an edge of a cell of the grid.
    pub(crate) fn fine(&self, cell: Cell) -> f64 {
        self.levels[cell.level].fine
    }

    /// The cell of a point: the finest one. Outside, there are cells like those of the grid.
    pub(crate) fn at(&self, p: DVec3) -> Cell {
        let inside = (1..self.count).rev().map(|level| self.of_level(level, p)).find(|c| self.has(*c));
        inside.unwrap_or_else(|| self.of_level(0, p))
    }

    /// The cell of a size that a point would be in, if there is one.
    fn of_level(&self, level: usize, p: DVec3) -> Cell {
        Cell { level, at: (p * self.levels[level].fine).floor().as_ivec3() }
    }

    /// The cell of a point, and then the cells of other sizes there, which may be none of their
    /// window: what lies in the face of a window belongs to one side of it.
    pub(crate) fn all_at(&self, p: DVec3) -> impl Iterator<Item = Cell> + '_ {
        let own = self.at(p);
        let others = (0..self.count).filter(move |level| *level != own.level);
        std::iter::once(own).chain(others.map(move |level| self.of_level(level, p)))
    }

    /// How fine the coarsest cells are that lie in or next to the cell of a point.
    pub(crate) fn coarsest_around(&self, p: DVec3) -> f64 {
        let own = self.at(p);
        let is_there = |c: Cell| self.has(c) && !self.is_finer(c);
        let coarser = (0..own.level).find(|level| self.around(self.of_level(*level, p)).any(is_there));
        self.levels[coarser.unwrap_or(own.level)].fine
    }

    /// The number of a cell. A grid of 514³ cells has less than 2^28, and so has a window. A cell
    /// keeps its number when its window moves, as long as it stays inside.
    pub(crate) fn number(&self, cell: Cell) -> u32 {
        let level = &self.levels[cell.level];
        let (c, d) = (cell.at.rem_euclid(level.dims), level.dims);
        level.first + ((c.z * d.y + c.y) * d.x + c.x) as u32
    }

    /// The cell of a number.
    pub(crate) fn place(&self, number: u32) -> Cell {
        let level = self.levels().iter().rposition(|l| l.first <= number).unwrap_or(0);
        let Level { low, dims: d, first, .. } = self.levels[level];
        let n = (number - first) as i32;
        let c = IVec3::new(n % d.x, n / d.x % d.y, n / d.x / d.y);
        Cell { level, at: low + (c - low).rem_euclid(d) }
    }

    /// Whether there is such a cell.
    pub(crate) fn has(&self, cell: Cell) -> bool {
        self.levels[cell.level].has(cell.at)
    }

    /// Whether a window has finer cells instead of a cell.
    pub(crate) fn is_finer(&self, cell: Cell) -> bool {
        let Some(next) = self.levels().get(cell.level + 1) else { return false };
        let ratio = (next.fine / self.levels[cell.level].fine) as i32;
        next.has(cell.at * ratio)
    }

    /// The brick of a cell, and its bit in it.
    pub(crate) fn slot(&self, cell: Cell) -> (usize, i32) {
        let level = &self.levels[cell.level];
        let c = cell.at - level.low;
        let (b, bricks) = (c >> BRICK, level.bricks());
        let brick = level.first_brick as i32 + (b.z * bricks.y + b.y) * bricks.x + b.x;
        (brick as usize, ((c.z & 3) << 4) | ((c.y & 3) << 2) | (c.x & 3))
    }

    /// The brick and the bit of a cell by its number.
    pub(crate) fn slot_of(&self, number: u32) -> (usize, i32) {
        self.slot(self.place(number))
    }

    /// The cell of a brick and a bit.
    pub(crate) fn of_slot(&self, (brick, bit): (usize, i32)) -> Cell {
        let brick = brick as u32;
        let level = self.levels().iter().rposition(|l| l.first_brick <= brick).unwrap_or(0);
        let (of, n) = (&self.levels[level], (brick - self.levels[level].first_brick) as i32);
        let d = of.bricks();
        let b = IVec3::new(n % d.x, n / d.x % d.y, n / d.x / d.y) << BRICK;
        Cell { level, at: of.low + b + IVec3::new(bit & 3, bit >> 2 & 3, bit >> 4) }
    }

    /// The number of bricks of all levels.
    pub(crate) fn bricks(&self) -> usize {
        self.levels().iter().map(|l| l.bricks().element_product() as usize).sum()
    }

    /// The part of a polygon that belongs to a cell.
    pub(crate) fn part(&self, polygon: &Polygon, cell: Cell) -> Polygon {
        let fine = self.fine(cell);
        let part = part_of(&polygon.iter().map(|p| *p * fine).collect(), cell.at);
        part.into_iter().map(|p| p / fine).collect()
    }

    /// The cells of one size that are at most so many cells from one along each axis.
    pub(crate) fn block(&self, cell: Cell, reach: i32) -> impl Iterator<Item = Cell> + use<> {
        let n = 2 * reach + 1;
        (0..n * n * n)
            .map(move |i| Cell { at: cell.at + IVec3::new(i % n, i / n % n, i / n / n) - reach, ..cell })
    }

    /// The 27 cells around one, itself among them.
    pub(crate) fn around(&self, cell: Cell) -> impl Iterator<Item = Cell> + use<> {
        self.block(cell, 1)
    }
}
