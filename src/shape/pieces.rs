//! The cells of a shape brick by brick. Pages and bricks that lie wholly inside or outside are
//! reported as a whole, so that large shapes cost their surface.

use crate::geometry::Block;
use crate::grid::cell_box::{CellBox, volume};
use crate::grid::mask::{ALL, BRICK, Mask, NONE, block_mask, span8};
use crate::grid::run::CellRun;
use crate::grid::{Grid, clip};
use crate::matrix::bits::BitMatrix;
use crate::shape::Shape;
use crate::shape::traits::{Rows, Which};
use glam::{DVec3, IVec3};

use smallvec::SmallVec;

/// Shapes that touch no more bricks are written row by row, without looking for full bricks.
const FEW_BRICKS: u64 = 216;

/// A shape whose box has more bricks than this on its surface makes no cell opaque: they would take
/// a brick of memory each. It hides as itself.
const MOST_OPAQUE: f64 = (1u64 << 18) as f64;

/// Edge length of a page in cells.
const PAGE: i32 = BRICK * BRICK;

/// Cells of a shape.
pub(crate) enum Piece {
    /// All cells of a page.
    Page(IVec3),
    /// Cells of a brick.
    Brick(IVec3, Mask),
}

impl Piece {
    /// Calls `out` with the cells brick by brick.
    pub(crate) fn bricks(self, mut out: impl FnMut(IVec3, &Mask)) {
        match self {
            Self::Page(page) => bricks_of_page(page).for_each(|b| out(b, &ALL)),
            Self::Brick(brick, mask) => out(brick, &mask),
        }
    }
}

/// The bricks of a page.
pub(crate) fn bricks_of_page(page: IVec3) -> impl Iterator<Item = IVec3> {
    CellBox { lo: page * BRICK, hi: page * BRICK + (BRICK - 1) }.cells()
}

/// A shape, and its rows if it can be asked for them.
pub(crate) trait Parts: Shape {
    fn rows(&self) -> Option<&dyn Rows>;
}

/// Calls `out` with the cells that a shape touches.
pub(crate) fn touched(shape: &impl Parts, grid: &Grid, out: &mut dyn FnMut(Piece)) {
    pieces(shape, grid, Which::Touched, out);
}

/// Calls `out` with the cells that a shape touches in pages and bricks that are asked for.
pub(crate) fn touched_where(
    shape: &impl Parts,
    grid: &Grid,
    asked: Asked,
    out: &mut dyn FnMut(IVec3, &Mask),
) {
    let (min, max) = shape.bounds();
    let (lo, hi) = grid.cover(min, max);
    let Some((lo, hi)) = clip(lo, hi) else { return };
    let mut out = |piece: Piece| {
        piece.bricks(|b, mask| {
            if (asked.brick)(b) {
                out(b, mask);
            }
        });
    };
    match shape.rows() {
        Some(rows) if volume(lo >> 3i32, hi >> 3i32) > FEW_BRICKS => {
            let asked = Some(asked);
            PieceWalk { rows, grid, which: Which::Touched, lo, hi, asked, out: &mut out }.pages();
        }
        _ => pieces(shape, grid, Which::Touched, &mut out),
    }
}

/// Calls `out` with the cells that a shape makes opaque.
pub(crate) fn opaque(shape: &impl Parts, grid: &Grid, out: &mut dyn FnMut(Piece)) {
    pieces(shape, grid, Which::Opaque, out);
}

/// Whether a box contains no point of a shape; in doubt, no.
pub(crate) fn misses(shape: &impl Parts, min: DVec3, max: DVec3) -> bool {
    match shape.rows() {
        Some(rows) => rows.misses(min, max),
        None => !Block::new(shape.bounds()).meets(&Block { min, max }),
    }
}

fn pieces(shape: &impl Parts, grid: &Grid, which: Which, out: &mut dyn FnMut(Piece)) {
    let corners = shape.rows().and_then(|rows| rows.corners(grid, which));
    let (lo, hi) = corners.unwrap_or_else(|| {
        let (min, max) = shape.bounds();
        grid.cover(min, max)
    });
    let Some((lo, hi)) = clip(lo, hi) else { return };
    if which == Which::Opaque && is_too_large(lo, hi) {
        return;
    }
    let bricks = CellBox { lo, hi }.bricks();
    if volume(bricks.lo, bricks.hi) <= FEW_BRICKS {
        if corners.is_some() {
            bricks.cells().for_each(|b| out(Piece::Brick(b, block_mask(b, lo, hi))));
            return;
        }
        let mut masks = Masks::default();
        masks.begin(&bricks);
        masks.write(shape, grid, which);
        masks.iter().filter(|(_, m)| **m != NONE).for_each(|(b, m)| out(Piece::Brick(b, *m)));
    } else if let Some(rows) = shape.rows() {
        PieceWalk { rows, grid, which, lo, hi, asked: None, out }.pages();
    } else {
        let mut bits = BitMatrix::default();
        runs(shape, grid, which, &mut |r| bits.set_run(r.x0, r.x1, r.y, r.z));
        bits.masks().for_each(|(b, m)| out(Piece::Brick(b, *m)));
    }
}

/// Whether a shape in a block of cells makes none of them opaque, because they are too many.
pub(crate) fn is_too_large(lo: IVec3, hi: IVec3) -> bool {
    let (lo, hi) = (lo >> 3i32, hi >> 3i32);
    let all = (hi - lo + 1).as_dvec3();
    all.element_product() - (all - 2.0).max(DVec3::ZERO).element_product() > MOST_OPAQUE
}

fn runs(shape: &dyn Shape, grid: &Grid, which: Which, out: &mut dyn FnMut(CellRun)) {
    match which {
        Which::Touched => shape.touched(grid, out),
        Which::Opaque => shape.opaque(grid, out),
    }
}

/// The cells of a small shape, or of two that lie close together.
#[derive(Clone, Default)]
pub(crate) struct Masks {
    lo: IVec3,
    per: IVec3,
    masks: SmallVec<[Mask; 8]>,
}

impl Masks {
    fn begin(&mut self, bricks: &CellBox) {
        (self.lo, self.per) = (bricks.lo, bricks.hi - bricks.lo + 1);
        self.masks.clear();
        self.masks.resize(volume(bricks.lo, bricks.hi) as usize, NONE);
    }

    fn write(&mut self, shape: &impl Parts, grid: &Grid, which: Which) {
        if let Some((lo, hi)) = shape.rows().and_then(|rows| rows.corners(grid, which)) {
            let bricks = CellBox { lo: self.lo, hi: self.lo + self.per - 1 }.cells();
            bricks.zip(&mut self.masks).for_each(|(brick, mask)| *mask = block_mask(brick, lo, hi));
            return;
        }
        runs(shape, grid, which, &mut |r| {
            let at = IVec3::new(r.x0 >> 3, r.y >> 3, r.z >> 3) - self.lo;
            let row = (at.z * self.per.y + at.y) * self.per.x;
            for bx in r.x0 >> 3..=r.x1 >> 3 {
                let bits = span8(r.x0 - bx * BRICK, r.x1 - bx * BRICK);
                self.masks[(row + bx - self.lo.x) as usize][(r.z & 7) as usize] |= bits << ((r.y & 7) << 3);
            }
        });
    }

    fn iter(&self) -> impl Iterator<Item = (IVec3, &Mask)> {
        CellBox { lo: self.lo, hi: self.lo + self.per - 1 }.cells().zip(&self.masks)
    }
}

/// The cells that a shape made opaque before and after it moved, where both are small and close
/// together.
#[derive(Clone, Default)]
pub(crate) struct Moved {
    old: Masks,
    new: Masks,
}

impl Moved {
    /// Finds the cells that a shape made and makes opaque; false if they are too many.
    pub(crate) fn opaque<T: Parts>(&mut self, old: Option<&T>, new: Option<&T>, grid: &Grid) -> bool {
        let shapes = [old, new];
        let blocks = shapes.map(|shape| {
            let (min, max) = shape?.bounds();
            let (lo, hi) = grid.cover(min, max);
            let (lo, hi) = clip(lo, hi)?;
            Some(CellBox { lo, hi }.bricks())
        });
        let all = blocks.into_iter().flatten().reduce(CellBox::join);
        // Each alone must be few, so that it is written as if it were inserted.
        let few = |b: &CellBox, most: u64| volume(b.lo, b.hi) <= most;
        if !blocks.iter().flatten().all(|b| few(b, FEW_BRICKS)) || !all.iter().all(|b| few(b, 2 * FEW_BRICKS))
        {
            return false;
        }
        for ((masks, block), shape) in [&mut self.old, &mut self.new].into_iter().zip(blocks).zip(shapes) {
            masks.begin(&all.unwrap_or(CellBox { lo: IVec3::ONE, hi: IVec3::ZERO }));
            if let (Some(shape), Some(_)) = (shape, block) {
                masks.write(shape, grid, Which::Opaque);
            }
        }
        true
    }

    /// The bricks with cells of either: brick, cells before, cells after.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (IVec3, &Mask, &Mask)> {
        self.old.iter().zip(&self.new.masks).map(|((b, old), new)| (b, old, new)).filter(|(_, o, n)| o != n)
    }

    pub(crate) fn bytes(&self) -> usize {
        let heap = |m: &Masks| if m.masks.spilled() { m.masks.capacity() * size_of::<Mask>() } else { 0 };
        heap(&self.old) + heap(&self.new)
    }
}

/// Which pages and bricks are asked for.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) page: &'a dyn Fn(IVec3) -> bool,
    pub(crate) brick: &'a dyn Fn(IVec3) -> bool,
}

/// The way through the pages and bricks of a shape's box.
struct PieceWalk<'a> {
    rows: &'a dyn Rows,
    grid: &'a Grid,
    which: Which,
    lo: IVec3,
    hi: IVec3,
    /// Others are left out.
    asked: Option<Asked<'a>>,
    out: &'a mut dyn FnMut(Piece),
}

impl PieceWalk<'_> {
    /// Whether a block of cells contains none of the shape's cells (`false`), or only those
    /// (`true`).
    fn verdict(&self, lo: IVec3, hi: IVec3) -> Option<bool> {
        let (min, max) = self.grid.range_bounds(lo, hi);
        let all = match self.which {
            Which::Touched => self.rows.fills(min, max),
            Which::Opaque => self.rows.contains_box(min, max),
        };
        if all { Some(true) } else { self.rows.misses(min, max).then_some(false) }
    }

    fn pages(&mut self) {
        for page in (CellBox { lo: self.lo >> 6i32, hi: self.hi >> 6i32 }).cells() {
            if self.asked.is_some_and(|a| !(a.page)(page)) {
                continue;
            }
            let (first, last) = (page * PAGE, page * PAGE + (PAGE - 1));
            match self.verdict(first, last) {
                Some(true) => (self.out)(Piece::Page(page)),
                Some(false) => {}
                _ => self.bricks(first.max(self.lo) >> 3i32, last.min(self.hi) >> 3i32),
            }
        }
    }

    fn bricks(&mut self, lo: IVec3, hi: IVec3) {
        for brick in (CellBox { lo, hi }).cells() {
            let (first, last) = (brick * BRICK, brick * BRICK + (BRICK - 1));
            match self.verdict(first, last) {
                Some(true) => (self.out)(Piece::Brick(brick, ALL)),
                Some(false) => {}
                _ if self.asked.is_some_and(|a| !(a.brick)(brick)) => {}
                _ => {
                    let mut mask = NONE;
                    let (lo, hi) = (first.max(self.lo), last.min(self.hi));
                    let mut add = |r: CellRun| {
                        mask[(r.z & 7) as usize] |= span8(r.x0 & 7, r.x1 & 7) << ((r.y & 7) << 3);
                    };
                    match self.which {
                        Which::Touched => self.rows.touched_rows(self.grid, lo, hi, &mut add),
                        Which::Opaque => self.rows.opaque_rows(self.grid, lo, hi, &mut add),
                    }
                    if mask != NONE {
                        (self.out)(Piece::Brick(brick, mask));
                    }
                }
            }
        }
    }
}
