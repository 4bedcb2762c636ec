//! The walk over the cells around the viewer's cell, in chessboard shells (thesis, section 3.3.3),
//! and occlusion by the chain rule of [`crate::cell`], a row at a time.

use glam::IVec2;

use crate::cell::caps::Caps;
use crate::cell::directions::{DirectionMask, Slope, Span};
use crate::cell::map::CellMap;
use crate::cell::region::Region;
use crate::cell::words::{bits, clear_run, runs, set_run};
use crate::matrix::CrossBits;

/// The axis and the sign of each side of a shell.
pub(super) const SIDES: [(usize, i32); 4] = [(0, 1), (0, -1), (1, 1), (1, -1)];

/// How cells hide others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Hiding {
    /// Rows and columns of blocked cells in direction masks; those narrower than a slope count for
    /// nothing.
    Rows { narrowest: f64 },
    /// The thesis' extended occluders, with or without a second arm; smaller angles, in radians,
    /// count for nothing.
    Caps { l_shaped: bool, least_angle: f64 },
}

/// One side of the shell that is walked.
#[derive(Debug, Clone, Default)]
struct SideRow {
    /// The cells that may be seen, first and last, relative to V; none if the region has no cell of
    /// the side.
    row: Option<(i32, i32)>,
    /// Open cells, by place in the grid; later in the step, blocked ones.
    cells: Vec<u64>,
    /// The blocked cells of the shell before.
    before: Vec<u64>,
    mask: DirectionMask,
}

/// The work of a walk, in numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Walked {
    pub(crate) shells: u32,
    pub(crate) cells: u64,
    pub(crate) hidden: u64,
    pub(crate) occluders: u32,
    pub(crate) skipped: u32,
}

/// The memory of a walk, reused from run to run. After a run it tells which cells are in sight.
#[derive(Debug, Clone, Default)]
pub(crate) struct Walk {
    v: IVec2,
    dims: IVec2,
    /// The first and the last shell walked.
    shells: (i32, i32),
    sides: [SideRow; 4],
    /// The cells in sight. Each copy holds the sides across its axis, in the shells walked.
    seen: CrossBits,
    new: Vec<Span>,
    pub(super) caps: Caps,
    walked: Walked,
}

impl Walk {
    /// Walks from a viewer's cell outwards, until a whole shell inside the region is hidden. Calls
    /// `visit` with each cell in sight that `map.found` names, and its shell; with a cell on a
    /// diagonal of V twice.
    pub(crate) fn run(
        &mut self,
        map: &CellMap,
        v: IVec2,
        region: &Region,
        hiding: Hiding,
        mut visit: impl FnMut(IVec2, i32),
    ) -> Walked {
        let (nearest, farthest) = map.shells(v);
        self.begin(map, v, hiding);
        let inside = map.contains(v);
        if inside {
            self.walked.cells = 1;
            visit(v, 0);
        }
        self.shells = (nearest.max(1), nearest);
        for m in nearest.max(1)..=farthest {
            self.shells.1 = m;
            self.walked.shells += 1;
            for index in 0..4 {
                self.open(map, region, hiding, index, m);
            }
            let in_sight: u64 = (0..4).map(|index| self.look(map, index, m, &mut visit)).sum();
            // A way from inside the grid to a farther cell passes this shell inside the grid.
            if inside && in_sight == 0 {
                break;
            }
            if !map.opaque.is_empty() {
                self.hide(map, hiding, inside, m);
            }
        }
        self.walked
    }

    /// Whether the last run found a cell of the grid in sight: inside the region, and not hidden.
    pub(crate) fn is_seen(&self, cell: IVec2) -> bool {
        let away = (cell - self.v).abs();
        let m = away.max_element();
        let on = |axis: usize| away[axis] < m || self.seen.get_along(axis, cell.x as u32, cell.y as u32);
        m == 0 || (self.shells.0..=self.shells.1).contains(&m) && on(0) && on(1)
    }

    /// The shell of a cell.
    pub(crate) fn shell_of(&self, cell: IVec2) -> i32 {
        (cell - self.v).abs().max_element()
    }

    fn begin(&mut self, map: &CellMap, v: IVec2, hiding: Hiding) {
        self.walked = Walked::default();
        if self.dims != map.dims {
            self.dims = map.dims;
            self.seen = CrossBits::new(map.dims.as_uvec2());
        }
        self.v = v;
        for (side, (axis, _)) in self.sides.iter_mut().zip(SIDES) {
            let words = (map.dims[1 - axis] as usize).div_ceil(64);
            side.mask.clear();
            side.cells.clear();
            side.cells.resize(words, 0);
            side.before.clear();
            side.before.resize(words, 0);
        }
        if matches!(hiding, Hiding::Caps { .. }) {
            self.caps.begin(map.dims);
        }
    }

    /// Finds the open cells of a side: those inside the region that are not hidden.
    fn open(&mut self, map: &CellMap, region: &Region, hiding: Hiding, index: usize, m: i32) {
        let (axis, sign) = SIDES[index];
        let (v, across) = (self.v[1 - axis], map.dims[1 - axis]);
        let side = &mut self.sides[index];
        side.cells.fill(0);
        let at = self.v[axis] + sign * m;
        let (lo, hi) = ((-m).max(-v), m.min(across - 1 - v));
        side.row = Some((lo, hi)).filter(|_| lo <= hi && (0..map.dims[axis]).contains(&at));
        side.row = side.row.and_then(|row| region.row(axis, sign * m, row));
        let Some((lo, hi)) = side.row else { return };
        let place = |line: i32| (line + v) as usize;
        set_run(&mut side.cells, place(lo), place(hi) + 1);
        self.walked.cells += (hi - lo + 1) as u64;
        match hiding {
            Hiding::Rows { narrowest } => side.mask.hidden(m, narrowest, |a, b| {
                let (a, b) = (a.max(lo), b.min(hi));
                if a <= b {
                    clear_run(&mut side.cells, place(a), place(b) + 1);
                }
            }),
            Hiding::Caps { .. } => {
                for line in lo..=hi {
                    let mut cell = IVec2::splat(line + v);
                    cell[axis] = at;
                    if self.caps.is_hidden(cell) {
                        clear_run(&mut side.cells, place(line), place(line) + 1);
                    }
                }
            }
        }
    }

    /// Notes the open cells of a side and visits those that are asked for. Returns the number of
    /// open cells.
    fn look(&mut self, map: &CellMap, index: usize, m: i32, visit: &mut impl FnMut(IVec2, i32)) -> u64 {
        let (axis, sign) = SIDES[index];
        let side = &self.sides[index];
        let at = self.v[axis] + sign * m;
        if !(0..map.dims[axis]).contains(&at) {
            return 0;
        }
        self.seen.line_mut(axis, at as u32).copy_from_slice(&side.cells);
        let Some((lo, hi)) = side.row else { return 0 };
        let open: u64 = side.cells.iter().map(|word| u64::from(word.count_ones())).sum();
        self.walked.hidden += (hi - lo + 1) as u64 - open;
        let [ids, volumes] = map.found.map(|bits| bits.line(axis, at as u32));
        let found = side.cells.iter().zip(ids).zip(volumes).map(|((open, i), t)| open & (i | t));
        for place in bits(found) {
            let mut cell = IVec2::splat(place as i32);
            cell[axis] = at;
            visit(cell, m);
        }
        open
    }

    /// Lets the blocked cells of the shell hide cells of later shells.
    fn hide(&mut self, map: &CellMap, hiding: Hiding, inside: bool, m: i32) {
        match hiding {
            Hiding::Rows { .. } => (0..4).for_each(|index| self.block(map, index, inside, m)),
            Hiding::Caps { l_shaped, least_angle } => {
                (0..4).for_each(|index| self.extend(map, index, (l_shaped, least_angle), m));
            }
        }
    }

    /// Hides the cells behind the extended occluders that the opaque cells in sight of a side
    /// begin.
    fn extend(&mut self, map: &CellMap, index: usize, (l_shaped, least_angle): (bool, f64), m: i32) {
        let (axis, sign) = SIDES[index];
        for place in bits(self.sides[index].cells.iter().copied()) {
            let mut cell = IVec2::splat(place as i32);
            cell[axis] = self.v[axis] + sign * m;
            if map.is_opaque(cell) {
                let drawn = self.caps.hide_behind(map, self.v, cell, l_shaped, least_angle);
                self.walked.occluders += u32::from(drawn);
                self.walked.skipped += u32::from(!drawn);
            }
        }
    }

    /// Adds the runs of blocked cells of a side to its mask: those along the side, and those in
    /// line with blocked cells of the shell before.
    ///
    /// Where the walk starts inside of the grid, cells outside of the grid or of the region count
    /// as blocked, since no way between cells of the convex region passes through them.
    fn block(&mut self, map: &CellMap, index: usize, closed: bool, m: i32) {
        let (axis, sign) = SIDES[index];
        let v = self.v[1 - axis];
        let SideRow { row, cells, before, mask } = &mut self.sides[index];
        let Some((lo, hi)) = *row else {
            before.fill(0);
            return;
        };
        let at = (self.v[axis] + sign * m) as u32;
        cells.iter_mut().for_each(|word| *word = !*word);
        for opaque in map.opaque {
            cells.iter_mut().zip(opaque.line(axis, at)).for_each(|(word, o)| *word |= o);
        }
        let (from, end) = ((lo + v) as usize, (hi + v) as usize + 1);
        clear_run(cells, 0, from);
        clear_run(cells, end, usize::MAX);
        self.new.clear();
        for (a, b) in runs(cells, from, end) {
            let lo = if closed && a == from { -m } else { a as i32 - v };
            let hi = if closed && b == end { m } else { b as i32 - 1 - v };
            self.new.push(Span { lo: Slope::new(lo, m), hi: Slope::new(hi, m) });
        }
        before.iter_mut().zip(cells.iter()).for_each(|(word, now)| *word &= now);
        for (a, b) in runs(before, from, end) {
            let (a, b) = (a as i32 - v, b as i32 - 1 - v);
            if b > 0 {
                self.new.push(Span { lo: Slope::new(a.max(1), m), hi: Slope::new(b, m - 1) });
            }
            if a < 0 {
                self.new.push(Span { lo: Slope::new(a, m - 1), hi: Slope::new(b.min(-1), m) });
            }
        }
        self.walked.occluders += self.new.len() as u32;
        mask.add(&mut self.new, m);
        std::mem::swap(cells, before);
    }
}
