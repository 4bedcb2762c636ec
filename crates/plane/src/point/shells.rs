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

    /// Edge length of a cell.
    pub(crate) fn cell_size(&self) -> f64 {
        self.grid.cell_size()
    }

    /// The first shell whose square contains a point.
    pub(crate) fn shell_of(&self, p: DVec2) -> i32 {
        let off = (self.grid.cell_of(p) - self.cell).abs().max_element();
        // A point on the upper border of a square belongs to the cell beyond.
        let contains = |shell: i32| {
            let (min, max) = self.square(shell);
            p.cmpge(min).all() && p.cmple(max).all()
        };
        if off > 0 && contains(off - 1) { off - 1 } else { off }
    }

    /// Calls `run` with the cells of a shell of the grid that have points in some arcs, rounded
    /// outwards. The arcs are sorted by quarter and direction, and disjoint. Each cell comes once,
    /// but those on the axes may come twice. Costs the logarithm of the number of arcs for each of
    /// the runs.
    pub(crate) fn runs(&self, shell: i32, arcs: &[Arc], run: &mut impl FnMut(Run)) {
        let mut rest = arcs;
        for quarter in 0..4u8 {
            let (own, others) = rest.split_at(rest.partition_point(|arc| arc.quarter == quarter));
            rest = others;
            Quarter::new(self, quarter, shell).runs(own, run);
        }
    }
}

/// The cells of a shell in a quarter of the circle, counted from the axis of x to that of y: up the
/// column, then along the row.
struct Quarter<'a> {
    shells: &'a Shells<'a>,
    shell: i32,
    /// Where the axes point.
    signs: IVec2,
    /// Where the eye is in its cell, along these axes.
    place: DVec2,
}

impl<'a> Quarter<'a> {
    fn new(shells: &'a Shells<'a>, quarter: u8, shell: i32) -> Self {
        let signs =
            [IVec2::ONE, IVec2::new(-1, 1), IVec2::NEG_ONE, IVec2::new(1, -1)][usize::from(quarter % 4)];
        let place = DVec2::select(signs.cmpgt(IVec2::ZERO), shells.place, 1.0 - shells.place);
        Self { shells, shell, signs, place }
    }

    fn runs(&self, arcs: &[Arc], run: &mut impl FnMut(Run)) {
        let turned = self.signs.x != self.signs.y;
        // In the order from the axis of x to that of y.
        let arc = |i: usize| {
            let Arc { from, to, .. } = arcs[if turned { arcs.len() - 1 - i } else { i }];
            if turned { [to, from] } else { [from, to] }
        };
        let (mut i, mut next) = (0, 0);
        while i < arcs.len() {
            let [from, to] = arc(i);
            let (first, last) = (self.first(from).max(next), self.last(to));
            if first <= last {
                self.emit(first, last, run);
                next = last + 1;
            }
            i += 1;
            // Many arcs may lie in the last cell: passed over in strides that double, then halve.
            let passed = |i: usize| i < arcs.len() && !self.reaches(next, arc(i)[1]);
            let mut stride = 1;
            while passed(i + stride - 1) {
                i += stride;
                stride *= 2;
            }
            while stride > 1 {
                stride /= 2;
                if passed(i + stride - 1) {
                    i += stride;
                }
            }
        }
    }

    /// The vector from the eye to a point along the axes, and where the column and the row of the
    /// shell begin.
    fn place(&self, p: DVec2) -> (DVec2, DVec2) {
        ((p - self.shells.eye).abs(), (f64::from(self.shell) - self.place).max(DVec2::ZERO))
    }

    /// The number of the first cell that has points in directions from that to a point on.
    fn first(&self, p: DVec2) -> i32 {
        let (d, near) = self.place(p);
        // Casts round towards zero, and numbers that are not known to zero.
        let up = (d.y / d.x * near.x - SHELL + self.place.y).max(0.0);
        if up < f64::from(self.shell + 1) {
            return up as i32;
        }
        let along = d.x / d.y * (near.y + 1.0) + SHELL + self.place.x;
        2 * self.shell - (along as i32).clamp(0, self.shell)
    }

    /// The number of the last cell that has points in directions up to that to a point.
    fn last(&self, p: DVec2) -> i32 {
        let (d, near) = self.place(p);
        let along = (d.x / d.y * near.y - SHELL + self.place.x).max(0.0);
        if along < f64::from(self.shell) {
            return 2 * self.shell - along as i32;
        }
        let up = d.y / d.x * (near.x + 1.0) + SHELL + self.place.y;
        (up as i32).clamp(0, self.shell)
    }

    /// Whether [`Quarter::last`] of a point is at least a number: without a division.
    fn reaches(&self, number: i32, p: DVec2) -> bool {
        let (d, near) = self.place(p);
        let beyond = 2 * self.shell - number + 1;
        // In the row, or else in the column, of which the corner is the last cell.
        let in_row = d.x * near.y < d.y * (f64::from(beyond.min(self.shell)) + SHELL - self.place.x);
        let up = f64::from(number) - SHELL - self.place.y;
        in_row || number <= self.shell && d.y * (near.x + 1.0) >= d.x * up
    }

    /// Calls `run` with the cells of some numbers.
    fn emit(&self, first: i32, last: i32, run: &mut impl FnMut(Run)) {
        let shell = self.shell;
        if first <= shell {
            self.clip(0, (first, last.min(shell)), run);
        }
        if last > shell {
            self.clip(1, (2 * shell - last, 2 * shell - first.max(shell + 1)), run);
        }
    }

    /// Calls `run` with the part inside the grid of the cells that are a shell away along an axis,
    /// and between two distances along the other.
    fn clip(&self, axis: usize, (low, high): (i32, i32), run: &mut impl FnMut(Run)) {
        let (other, Shells { cell: eye, grid, .. }) = (1 - axis, self.shells);
        let at = eye[axis] + self.signs[axis] * self.shell;
        let ends = [low, high].map(|distance| eye[other] + self.signs[other] * distance);
        let (first, last) = (ends[0].min(ends[1]).max(0), ends[0].max(ends[1]).min(grid.dims()[other] - 1));
        if at >= 0 && at < grid.dims()[axis] && first <= last {
            let cell = |along: i32| if axis == 0 { IVec2::new(at, along) } else { IVec2::new(along, at) };
            run((cell(first), cell(last)));
        }
    }
}
