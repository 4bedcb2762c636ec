//! The cells of a chessboard shell that lie in some arcs (thesis, section 3.3.3).

use glam::{DVec2, IVec2};

use crate::grid::Grid;
use crate::numeric::SHELL;
use crate::point::arcs::Arc;

/// Eyes farther from the grid's corner than this many cells along an axis get no walk.
const FAR: i32 = 1 << 24;

/// The shells of cells around an eye.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shells<'a> {
    grid: &'a Grid,
    eye: DVec2,
    /// The eye's cell.
    cell: IVec2,
    /// The place of the eye in its cell, 0 to 1.
    place: DVec2,
}

/// Cells in a column or a row: from the first to the last.
pub(crate) type Run = (IVec2, IVec2);

impl<'a> Shells<'a> {
    /// The shells around an eye; `None` if it is too far away from the grid.
    pub(crate) fn new(grid: &'a Grid, eye: DVec2) -> Option<Self> {
        let cell = grid.cell_of(eye);
        let near = cell.abs().max_element() < FAR;
        let place = ((eye - grid.cell_bounds(cell).0) / grid.cell_size()).clamp(DVec2::ZERO, DVec2::ONE);
        near.then_some(Self { grid, eye, cell, place })
    }

    /// The first and the last shell with cells of the grid.
    pub(crate) fn numbers(&self) -> (i32, i32) {
        let last = self.grid.dims() - 1;
        let near = self.cell.clamp(IVec2::ZERO, last);
        let far = (self.cell - last).abs().max(self.cell.abs());
        ((self.cell - near).abs().max_element(), far.max_element())
    }

    /// The corners of the square of the shells up to one.
    pub(crate) fn square(&self, shell: i32) -> (DVec2, DVec2) {
        (self.grid.cell_bounds(self.cell - shell).0, self.grid.cell_bounds(self.cell + shell).1)
    }

    /// Calls `run` with the cells of a shell of the grid that have points in some arcs, rounded outwards; each cell comes once if
    /// the arcs are sorted and disjoint, but those on the axes may come twice.
    pub(crate) fn runs(&self, shell: i32, arcs: &[Arc], run: &mut impl FnMut(Run)) {
        let mut before: [Option<(i32, i32)>; 8] = [None; 8];
        for arc in arcs {
            let signs =
                [IVec2::ONE, IVec2::new(-1, 1), IVec2::NEG_ONE, IVec2::new(1, -1)][usize::from(arc.quarter)];
            let mut ends = [arc.from, arc.to].map(|p| (p - self.eye).abs());
            if signs.x != signs.y {
                ends.swap(0, 1);
            }
            // Where lines through the cell's sides begin, in the first quarter.
            let place = DVec2::select(signs.cmpgt(IVec2::ZERO), self.place, 1.0 - self.place);
            for axis in 0..2 {
                let other = 1 - axis;
                // How fast the other coordinate grows, at least and at most.
                let (slow, fast) =
                    (ends[axis][other] / ends[axis][axis], ends[other][other] / ends[other][axis]);
                let near = f64::from(shell) - place[axis];
                let low = (slow * near.max(0.0) - SHELL + place[other]).floor().max(0.0);
                // The corner belongs to the column.
                let most = f64::from(shell - axis as i32);
                let high = (fast * (near + 1.0) + SHELL + place[other]).floor().min(most);
                let (mut low, mut high) = (low as i32, if high.is_nan() { most as i32 } else { high as i32 });
                if low > high {
                    continue;
                }
                let before = &mut before[usize::from(arc.quarter) * 2 + axis];
                if let Some((first, last)) = *before {
                    let whole = (low.min(first), high.max(last));
                    if low >= first {
                        low = low.max(last + 1)
                    } else {
                        high = high.min(first - 1)
                    }
                    *before = Some(whole);
                } else {
                    *before = Some((low, high));
                }
                if low <= high {
                    self.clip(shell, axis, signs, (low, high), run);
                }
            }
        }
    }

    /// Calls `run` with the part inside the grid of the cells that are `shell` away along an axis, and between two distances
    /// along the other.
    fn clip(
        &self,
        shell: i32,
        axis: usize,
        signs: IVec2,
        (low, high): (i32, i32),
        run: &mut impl FnMut(Run),
    ) {
        let other = 1 - axis;
        let at = self.cell[axis] + signs[axis] * shell;
        let ends = [low, high].map(|distance| self.cell[other] + signs[other] * distance);
        let (first, last) =
            (ends[0].min(ends[1]).max(0), ends[0].max(ends[1]).min(self.grid.dims()[other] - 1));
        if at >= 0 && at < self.grid.dims()[axis] && first <= last {
            let cell = |along: i32| if axis == 0 { IVec2::new(at, along) } else { IVec2::new(along, at) };
            run((cell(first), cell(last)));
        }
    }
}
