//! The cells of a chessboard shell that lie in some arcs (thesis, section 3.3.3).

use glam::{DVec2, IVec2};

use crate::bits::{CrossBits, first_set, last_set};
use crate::grid::Grid;
use crate::numeric::SHELL;
use crate::point::arcs::Arc;

/// Eyes farther from the grid's corner than this many cells along an axis get no walk.
const FAR: i32 = 1 << 24;

/// The shells of cells around an eye.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shells<'a> {
    pub(crate) grid: &'a Grid,
    eye: DVec2,
    /// The eye's cell.
    cell: IVec2,
    /// The place of the eye in its cell, 0 to 1.
    place: DVec2,
    /// The least corner of that cell.
    corner: DVec2,
}

impl<'a> Shells<'a> {
    /// The shells around an eye; `None` if it is too far away from the grid.
    pub(crate) fn new(grid: &'a Grid, eye: DVec2) -> Option<Self> {
        let cell = grid.cell_of(eye);
        let near = cell.abs().max_element() < FAR;
        let corner = grid.cell_bounds(cell).0;
        let place = ((eye - corner) / grid.cell).clamp(DVec2::ZERO, DVec2::ONE);
        near.then_some(Self { grid, eye, cell, place, corner })
    }

    /// The first and the last shell with cells of the grid.
    pub(crate) fn numbers(&self) -> (i32, i32) {
        let last = self.grid.dims - 1;
        let near = self.cell.clamp(IVec2::ZERO, last);
        let far = (self.cell - last).abs().max(self.cell.abs());
        ((self.cell - near).abs().max_element(), far.max_element())
    }

    /// The corners of the square of the shells up to one.
    pub(crate) fn square(&self, shell: i32) -> (DVec2, DVec2) {
        (self.grid.cell_bounds(self.cell - shell).0, self.grid.cell_bounds(self.cell + shell).1)
    }

    /// A shell whose square contains a point: the first, or the one after it. A point on the upper
    /// border of a square belongs to it.
    #[inline]
    pub(crate) fn shell_of(&self, p: DVec2) -> i32 {
        let off = (p - self.corner) / self.grid.cell;
        // The square of a shell goes from `-shell` to `shell + 1`.
        let shell = (off - 1.0).max(-off).max_element();
        // Casts saturate.
        ((shell + SHELL).max(0.0).ceil()) as i32
    }

    /// Calls `visit` with the marked cells of a shell of the grid that have points in some arcs,
    /// rounded outwards. The arcs are sorted by quarter and direction, and disjoint. Each cell
    /// comes once, but those on the axes may come twice. Costs the lesser of the numbers of cells
    /// and arcs, times its logarithm, and a word for each 64 cells.
    pub(crate) fn cells(&self, shell: i32, arcs: &[Arc], marks: &CrossBits, visit: &mut impl FnMut(IVec2)) {
        let mut rest = arcs;
        for quarter in 0..4u8 {
            let (own, others) = rest.split_at(rest.partition_point(|arc| arc.quarter == quarter));
            rest = others;
            Quarter::new(self, quarter, shell).cells(own, marks, visit);
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

    fn cells(&self, arcs: &[Arc], marks: &CrossBits, visit: &mut impl FnMut(IVec2)) {
        let turned = self.signs.x != self.signs.y;
        // In the order from the axis of x to that of y.
        let arc = |i: usize| {
            let Arc { from, to, .. } = arcs[if turned { arcs.len() - 1 - i } else { i }];
            if turned { [to.p, from.p] } else { [from.p, to.p] }
        };
        let (mut i, mut number, mut first) = (0, 0, None);
        while i < arcs.len()
            && let Some(found) = self.next(marks, number)
        {
            let before = i;
            // Many arcs may end before: passed over in strides that double, then halve.
            let passed = |i: usize| i < arcs.len() && !self.reaches(found, arc(i)[1]);
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
            if i == arcs.len() {
                return;
            }
            let known = first.filter(|_| i == before);
            let begins = known.unwrap_or_else(|| self.first(arc(i)[0]));
            first = Some(begins);
            if begins <= found {
                visit(self.cell(found));
            }
            number = begins.max(found + 1);
        }
    }

    /// The cell of a number.
    fn cell(&self, number: i32) -> IVec2 {
        let off = IVec2::new((2 * self.shell - number).min(self.shell), number.min(self.shell));
        self.shells.cell + self.signs * off
    }

    /// The first marked cell of the grid from a number on, up to the last of the quarter.
    fn next(&self, marks: &CrossBits, number: i32) -> Option<i32> {
        let (shell, end) = (self.shell, 2 * self.shell);
        let up = || self.next_along(marks, 0, [number, shell]);
        let back = || self.next_along(marks, 1, [end - number.max(shell + 1), 0]).map(|along| end - along);
        (number <= shell).then(up).flatten().or_else(back)
    }

    /// The first marked cell of the grid that is a shell away along an axis, and from one distance
    /// to another along the other, as its distance.
    fn next_along(&self, marks: &CrossBits, axis: usize, [from, to]: [i32; 2]) -> Option<i32> {
        let (other, Shells { cell: eye, grid, .. }) = (1 - axis, self.shells);
        let at = eye[axis] + self.signs[axis] * self.shell;
        if at < 0 || at >= grid.dims[axis] || from < 0 {
            return None;
        }
        let place = |distance: i32| eye[other] + self.signs[other] * distance;
        let line = marks.line(axis, at as u32);
        let last = grid.dims[other] - 1;
        let (first, end) = (place(from), place(to));
        let up = first <= end;
        let (least, most) = if up { (first.max(0), end.min(last)) } else { (end.max(0), first.min(last)) };
        if least > most {
            return None;
        }
        let (least, most) = (least as usize, most as usize + 1);
        let found = match up {
            true => Some(first_set(least, most, |at| line[at])).filter(|&found| found < most),
            false => last_set(least, most, |at| line[at]),
        };
        found.map(|found| (found as i32 - eye[other]) * self.signs[other])
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

    /// Whether the last cell that has points in directions up to that to a point has at least a
    /// number.
    fn reaches(&self, number: i32, p: DVec2) -> bool {
        let (d, near) = self.place(p);
        let beyond = 2 * self.shell - number + 1;
        // In the row, or else in the column, of which the corner is the last cell.
        let in_row = d.x * near.y < d.y * (f64::from(beyond.min(self.shell)) + SHELL - self.place.x);
        let up = f64::from(number) - SHELL - self.place.y;
        in_row || number <= self.shell && d.y * (near.x + 1.0) >= d.x * up
    }
}
