//! The region of one plane that rectangles and triangles cover, and rectangles in it.
//!
//! The coordinates of all corners make a lattice. A cell of it is covered by a rectangle as a whole
//! or not at all. It is covered by triangles if a triangle holds its middle, and no edge that has
//! triangles on one side only passes through its inside: on the way from the middle to any point of
//! the cell, whoever leaves a triangle enters the next one.

use std::collections::BTreeMap;

use robust::{Coord, orient2d};

/// A rectangle: from and to along both axes.
pub(crate) type Rectangle = ([f32; 2], [f32; 2]);

/// A triangle: its corners along both axes.
pub(crate) type Triangle = [[f32; 2]; 3];

/// Planes with more lines than this along an axis are left out: the lattice would take too much
/// memory.
const MOST_LINES: usize = 1500;

/// A plane has up to so many rectangles.
const MOST_RECTANGLES: usize = 1024;

/// Places on edges count as wider by this share of their coordinates, against rounding in double
/// precision.
const ROUNDING: f64 = 1e-12;

/// What lies in one plane.
#[derive(Debug, Default)]
pub(crate) struct Region {
    pub(crate) rectangles: Vec<Rectangle>,
    pub(crate) triangles: Vec<Triangle>,
}

/// The lattice of all corners.
struct Lattice {
    lines: [Vec<f32>; 2],
    /// How many cells before each corner of the lattice are covered, along both axes.
    before: Vec<u32>,
}

/// Numbers, row by row.
struct Table<T> {
    columns: usize,
    cells: Vec<T>,
}

impl<T: Copy + Default> Table<T> {
    fn new(columns: usize, rows: usize) -> Self {
        Self { columns, cells: vec![T::default(); columns * rows] }
    }

    fn row(&mut self, v: usize) -> &mut [T] {
        &mut self.cells[v * self.columns..(v + 1) * self.columns]
    }
}

impl Region {
    /// The greatest rectangles that it covers, as far as they are found by growing its cells, the
    /// largest first.
    pub(crate) fn rectangles(&self) -> Vec<Rectangle> {
        let Some(lattice) = Lattice::new(self) else { return Vec::new() };
        let [columns, rows] = lattice.size();
        let all = (0..rows).flat_map(|v| (0..columns).map(move |u| [u, v]));
        let mut cells: Vec<[usize; 2]> = all.filter(|&at| lattice.is_full(at, at.map(|i| i + 1))).collect();
        let area = |&[u, v]: &[usize; 2]| lattice.length(0, u, u + 1) * lattice.length(1, v, v + 1);
        cells.sort_by(|a, b| area(b).total_cmp(&area(a)));
        let mut taken = Table::<bool>::new(columns, rows);
        let mut found: Vec<Rectangle> = Vec::new();
        for at in cells {
            if found.len() >= MOST_RECTANGLES {
                break;
            }
            if taken.row(at[1])[at[0]] {
                continue;
            }
            for first in [0, 1] {
                let (from, to) = lattice.grown(at, first);
                (from[1]..to[1]).for_each(|v| taken.row(v)[from[0]..to[0]].fill(true));
                let rectangle = (lattice.place(from), lattice.place(to));
                if found.last() != Some(&rectangle) {
                    found.push(rectangle);
                }
            }
        }
        found
    }

    /// The edges that do not have triangles on both sides.
    fn border(&self) -> impl Iterator<Item = [[f32; 2]; 2]> {
        // A bit for each side on which an edge has a triangle.
        let mut edges: BTreeMap<[[u32; 2]; 2], u8> = BTreeMap::new();
        for t in &self.triangles {
            for i in 0..3 {
                let (a, b, c) = (t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
                let key = [a, b].map(|p| p.map(f32::to_bits));
                let (key, turned) = if key[0] <= key[1] { (key, false) } else { ([key[1], key[0]], true) };
                let side = side_of(a, b, c);
                if side != 0.0 {
                    *edges.entry(key).or_default() |= if (side > 0.0) == turned { 1 } else { 2 };
                }
            }
        }
        edges.into_iter().filter(|(_, sides)| *sides != 3).map(|(key, _)| key.map(|p| p.map(f32::from_bits)))
    }
}

/// A number with the sign of the side of an edge that a point is on; exactly 0 on its line.
fn side_of(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: f64::from(p[0]), y: f64::from(p[1]) });
    orient2d(a, b, c)
}

impl Lattice {
    fn new(region: &Region) -> Option<Self> {
        let lines = [0, 1].map(|axis| {
            let of_rectangles = region.rectangles.iter().flat_map(|r| [r.0[axis], r.1[axis]]);
            let of_triangles = region.triangles.iter().flatten().map(|p| p[axis]);
            let mut lines: Vec<f32> = of_rectangles.chain(of_triangles).collect();
            lines.sort_by(f32::total_cmp);
            lines.dedup();
            lines
        });
        if lines.iter().any(|lines| lines.len() > MOST_LINES || lines.len() < 2) {
            return None;
        }
        let mut lattice = Self { lines, before: Vec::new() };
        let covered = lattice.covered(region);
        let [columns, rows] = lattice.size();
        let mut before = Table::<u32>::new(columns + 1, rows + 1);
        for v in 0..rows {
            let mut row = 0;
            for u in 0..columns {
                row += u32::from(covered.cells[v * columns + u]);
                let below = before.row(v)[u + 1];
                before.row(v + 1)[u + 1] = below + row;
            }
        }
        lattice.before = before.cells;
        Some(lattice)
    }

    /// The number of cells along both axes.
    fn size(&self) -> [usize; 2] {
        [0, 1].map(|axis| self.lines[axis].len() - 1)
    }

    /// The cells that are covered.
    fn covered(&self, region: &Region) -> Table<bool> {
        let [columns, rows] = self.size();
        // Where the triangles of each row start and end.
        let mut starts = Table::<i32>::new(columns + 1, rows);
        // Triangles without an inside cover nothing.
        for t in region.triangles.iter().filter(|t| side_of(t[0], t[1], t[2]) != 0.0) {
            for v in self.rows_of(t) {
                let middle = (self.at(1, v) + self.at(1, v + 1)) * 0.5;
                let (from, to) = span_at(t, middle);
                let (first, last) = (self.first_middle(from), self.first_middle(to));
                if first < last {
                    starts.row(v)[first] += 1;
                    starts.row(v)[last] -= 1;
                }
            }
        }
        let mut covered = Table::<bool>::new(columns, rows);
        for v in 0..rows {
            let mut count = 0;
            for u in 0..columns {
                count += starts.row(v)[u];
                covered.row(v)[u] = count > 0;
            }
        }
        for edge in region.border() {
            self.cut(&edge, &mut covered);
        }
        for (min, max) in &region.rectangles {
            let ([u0, v0], [u1, v1]) = (self.corner(min), self.corner(max));
            (v0..v1).for_each(|v| covered.row(v)[u0..u1].fill(true));
        }
        covered
    }

    /// Takes away the cells through whose inside an edge passes.
    fn cut(&self, edge: &[[f32; 2]; 2], covered: &mut Table<bool>) {
        // Edges along an axis lie on a line of the lattice.
        if (0..2).any(|axis| edge[0][axis] == edge[1][axis]) {
            return;
        }
        for v in self.rows_of(edge) {
            let ends = [v, v + 1].map(|line| span_at(edge, self.at(1, line)).0);
            let (from, to) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            let doubt = ROUNDING * from.abs().max(to.abs());
            let lines = &self.lines[0];
            let first = lines.partition_point(|&l| f64::from(l) <= from - doubt).saturating_sub(1);
            let last = lines.partition_point(|&l| f64::from(l) < to + doubt).min(lines.len() - 1);
            if first < last {
                covered.row(v)[first..last].fill(false);
            }
        }
    }

    fn at(&self, axis: usize, line: usize) -> f64 {
        f64::from(self.lines[axis][line])
    }

    fn length(&self, axis: usize, from: usize, to: usize) -> f64 {
        self.at(axis, to) - self.at(axis, from)
    }

    /// The rows that some points reach across.
    fn rows_of(&self, points: &[[f32; 2]]) -> std::ops::Range<usize> {
        let line = |v: f32| self.lines[1].partition_point(|&l| l < v);
        let lines = || points.iter().map(|p| line(p[1]));
        lines().min().unwrap_or(0)..lines().max().unwrap_or(0)
    }

    /// The first column whose middle is not before a place.
    fn first_middle(&self, place: f64) -> usize {
        let columns = self.lines[0].len() - 1;
        let after = self.lines[0].partition_point(|&l| f64::from(l) < place);
        // The column before that line may have its middle after the place.
        let before = after.saturating_sub(1);
        if before < columns && (self.at(0, before) + self.at(0, before + 1)) * 0.5 >= place {
            before
        } else {
            after.min(columns)
        }
    }

    /// The lines that meet at a corner of a rectangle.
    fn corner(&self, p: &[f32; 2]) -> [usize; 2] {
        [0, 1].map(|axis| self.lines[axis].partition_point(|l| *l < p[axis]))
    }

    fn place(&self, corner: [usize; 2]) -> [f32; 2] {
        [0, 1].map(|axis| self.lines[axis][corner[axis]])
    }

    /// Whether all cells from line to line are covered.
    fn is_full(&self, [u0, v0]: [usize; 2], [u1, v1]: [usize; 2]) -> bool {
        let before = |u: usize, v: usize| self.before[v * self.lines[0].len() + u];
        let count = before(u1, v1) + before(u0, v0) - before(u0, v1) - before(u1, v0);
        count as usize == (u1 - u0) * (v1 - v0)
    }

    /// A cell grown as far as covered cells go, first along one axis and then along the other.
    fn grown(&self, cell: [usize; 2], first: usize) -> ([usize; 2], [usize; 2]) {
        let (mut from, mut to) = (cell, cell.map(|i| i + 1));
        for axis in [first, 1 - first] {
            while to[axis] + 1 < self.lines[axis].len() {
                let (mut a, mut b) = (from, to);
                (a[axis], b[axis]) = (to[axis], to[axis] + 1);
                if !self.is_full(a, b) {
                    break;
                }
                to[axis] += 1;
            }
            while from[axis] > 0 {
                let (mut a, mut b) = (from, to);
                (a[axis], b[axis]) = (from[axis] - 1, from[axis]);
                if !self.is_full(a, b) {
                    break;
                }
                from[axis] -= 1;
            }
        }
        (from, to)
    }
}

/// Where a line across the second axis passes through a triangle or an edge, from and to.
fn span_at(points: &[[f32; 2]], v: f64) -> (f64, f64) {
    let mut span = (f64::INFINITY, f64::NEG_INFINITY);
    let mut add = |u: f64| span = (span.0.min(u), span.1.max(u));
    for i in 0..points.len() {
        let [a, b] = [points[i], points[(i + 1) % points.len()]].map(|p| p.map(f64::from));
        if (a[1] - v) * (b[1] - v) <= 0.0 && a[1] != b[1] {
            add(a[0] + (b[0] - a[0]) * ((v - a[1]) / (b[1] - a[1])));
        }
    }
    span
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn of(rectangles: &[Rectangle]) -> Vec<Rectangle> {
        let mut found = Region { rectangles: rectangles.to_vec(), triangles: Vec::new() }.rectangles();
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        found
    }

    #[test]
    fn rectangles_grow_over_neighbours_and_not_over_gaps() {
        // A wall of three panels with a window in the middle one: sill, lintel and sides.
        let panels = [
            ([0.0, 0.0], [1.0, 3.0]),
            ([1.0, 0.0], [2.0, 1.0]),
            ([1.0, 2.0], [2.0, 3.0]),
            ([2.0, 0.0], [3.0, 3.0]),
        ];
        let expected = [
            ([0.0, 0.0], [1.0, 3.0]),
            ([0.0, 0.0], [3.0, 1.0]),
            ([0.0, 2.0], [3.0, 3.0]),
            ([2.0, 0.0], [3.0, 3.0]),
        ];
        assert_eq!(of(&panels), expected);
        let apart = [([0.0, 0.0], [1.0, 1.0]), ([1.001, 0.0], [2.0, 1.0])];
        assert_eq!(of(&apart), apart);
    }

    #[test]
    fn triangles_make_the_rectangles_that_they_cover() {
        let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0], [2.0, 1.0]];
        let of = |all: &[[usize; 3]]| {
            let triangles = all.iter().map(|t| t.map(|i| corners[i])).collect();
            Region { rectangles: Vec::new(), triangles }.rectangles()
        };
        let whole = ([0.0, 0.0], [4.0, 2.0]);
        // Two halves, whichever way they are wound, and a fan around the middle.
        assert_eq!(of(&[[0, 1, 2], [0, 2, 3]]), [whole]);
        assert_eq!(of(&[[0, 1, 2], [3, 2, 0]]), [whole]);
        assert_eq!(of(&[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]), [whole]);
        // Halves that overlap, one twice, and a fan with a part missing.
        assert_eq!(of(&[[0, 1, 2], [0, 1, 3]]), []);
        assert_eq!(of(&[[0, 1, 2], [0, 2, 1]]), []);
        assert_eq!(of(&[[0, 1, 4], [1, 2, 4], [2, 3, 4]]), []);
    }

    fn holds(t: &Triangle, p: [f32; 2]) -> bool {
        let sides = [0, 1, 2].map(|i| side_of(t[i], t[(i + 1) % 3], p));
        sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
    }

    proptest! {
        #![proptest_config(casca_truth::cases(300))]
        #[test]
        fn all_of_a_rectangle_is_covered(
            corners in prop::collection::vec(prop::array::uniform2(0u8..7), 3..12),
            numbers in prop::collection::vec(prop::array::uniform3(0usize..12), 1..24),
            shares in prop::collection::vec(prop::array::uniform2(0.0f32..1.0), 40),
        ) {
            let corner = |i: usize| corners[i % corners.len()].map(f32::from);
            let triangles: Vec<Triangle> = numbers.iter().map(|t| t.map(corner)).collect();
            let region = Region { rectangles: Vec::new(), triangles };
            for (min, max) in region.rectangles() {
                for share in &shares {
                    let p = [0, 1].map(|i| min[i] + share[i] * (max[i] - min[i]));
                    prop_assert!(region.triangles.iter().any(|t| holds(t, p)), "{p:?} {min:?} {max:?}");
                }
            }
        }
    }
}
