//! The cells of a shape brick by brick. Pages and bricks that lie wholly inside or outside are
//! reported as a whole, so that large shapes cost their surface.

use crate::grid::cell_box::{CellBox, volume};
use crate::grid::mask::{ALL, BRICK, Mask, NONE, block_mask, span8};
use crate::grid::run::CellRun;
use crate::grid::{Grid, clip};
use crate::matrix::bits::BitMatrix;
use crate::shape::{Shape, Which};
use glam::{DVec3, IVec3};

use smallvec::{SmallVec, smallvec};

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

/// Calls `out` with the cells that a shape touches.
pub(crate) fn touched(shape: &dyn Shape, grid: &Grid, out: &mut dyn FnMut(Piece)) {
    pieces(shape, grid, Which::Touched, out);
}

/// Calls `out` with the cells that a shape touches in pages and bricks that are asked for.
pub(crate) fn touched_where(shape: &dyn Shape, grid: &Grid, asked: Asked, out: &mut dyn FnMut(IVec3, &Mask)) {
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
    if shape.has_rows() && volume(lo >> 3i32, hi >> 3i32) > FEW_BRICKS {
        let asked = Some(asked);
        PieceWalk { shape, grid, which: Which::Touched, lo, hi, asked, out: &mut out }.pages();
    } else {
        pieces(shape, grid, Which::Touched, &mut out);
    }
}

/// Calls `out` with the cells that a shape makes opaque.
pub(crate) fn opaque(shape: &dyn Shape, grid: &Grid, out: &mut dyn FnMut(Piece)) {
    pieces(shape, grid, Which::Opaque, out);
}

fn pieces(shape: &dyn Shape, grid: &Grid, which: Which, out: &mut dyn FnMut(Piece)) {
    let corners = shape.corners(grid, which);
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
        let per = bricks.hi - bricks.lo + 1;
        let mut masks: SmallVec<[Mask; 8]> = smallvec![NONE; volume(bricks.lo, bricks.hi) as usize];
        shape.rows(grid, which, &mut |r| {
            let at = IVec3::new(r.x0 >> 3, r.y >> 3, r.z >> 3) - bricks.lo;
            let row = (at.z * per.y + at.y) * per.x;
            for bx in r.x0 >> 3..=r.x1 >> 3 {
                let bits = span8(r.x0 - bx * BRICK, r.x1 - bx * BRICK);
                masks[(row + bx - bricks.lo.x) as usize][(r.z & 7) as usize] |= bits << ((r.y & 7) << 3);
            }
        });
        bricks.cells().zip(masks).filter(|(_, m)| *m != NONE).for_each(|(b, m)| out(Piece::Brick(b, m)));
    } else if shape.has_rows() {
        PieceWalk { shape, grid, which, lo, hi, asked: None, out }.pages();
    } else {
        let mut bits = BitMatrix::default();
        shape.rows(grid, which, &mut |r| bits.set_run(r.x0, r.x1, r.y, r.z));
        bits.masks().for_each(|(b, m)| out(Piece::Brick(b, *m)));
    }
}

/// Whether a shape in a block of cells makes none of them opaque, because they are too many.
pub(crate) fn is_too_large(lo: IVec3, hi: IVec3) -> bool {
    let (lo, hi) = (lo >> 3i32, hi >> 3i32);
    let all = (hi - lo + 1).as_dvec3();
    all.element_product() - (all - 2.0).max(DVec3::ZERO).element_product() > MOST_OPAQUE
}

/// Which pages and bricks are asked for.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) page: &'a dyn Fn(IVec3) -> bool,
    pub(crate) brick: &'a dyn Fn(IVec3) -> bool,
}

/// The way through the pages and bricks of a shape's box.
struct PieceWalk<'a> {
    shape: &'a dyn Shape,
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
            Which::Touched => self.shape.fills(min, max),
            Which::Opaque => self.shape.contains_box(min, max),
        };
        if all { Some(true) } else { self.shape.misses(min, max).then_some(false) }
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
                        Which::Touched => self.shape.touched_rows(self.grid, lo, hi, &mut add),
                        Which::Opaque => self.shape.opaque_rows(self.grid, lo, hi, &mut add),
                    }
                    if mask != NONE {
                        (self.out)(Piece::Brick(brick, mask));
                    }
                }
            }
        }
    }
}
