//! Rectangles in one plane, put together to greater ones.

/// A rectangle: from and to along both axes.
pub(super) type Rectangle = ([f32; 2], [f32; 2]);

/// Planes with more lines than this along an axis keep their rectangles as they are: the lattice
/// would take too much memory.
const MOST_LINES: usize = 2000;

/// The lattice of all edges of some rectangles.
struct Lattice {
    lines: [Vec<f32>; 2],
    covered: Vec<bool>,
}

impl Lattice {
    fn new(rectangles: &[Rectangle]) -> Option<Self> {
        let lines = [0, 1].map(|axis| {
            let mut lines: Vec<f32> = rectangles.iter().flat_map(|r| [r.0[axis], r.1[axis]]).collect();
            lines.sort_by(f32::total_cmp);
            lines.dedup();
            lines
        });
        if lines.iter().any(|lines| lines.len() > MOST_LINES || lines.len() < 2) {
            return None;
        }
        let covered = vec![false; (lines[0].len() - 1) * (lines[1].len() - 1)];
        let mut lattice = Self { lines, covered };
        for rectangle in rectangles {
            let [[u0, v0], [u1, v1]] = lattice.cells(rectangle);
            for v in v0..v1 {
                for u in u0..u1 {
                    let at = lattice.at(u, v);
                    lattice.covered[at] = true;
                }
            }
        }
        Some(lattice)
    }

    fn at(&self, u: usize, v: usize) -> usize {
        v * (self.lines[0].len() - 1) + u
    }

    /// The lines of the edges of a rectangle.
    fn cells(&self, (min, max): &Rectangle) -> [[usize; 2]; 2] {
        let line = |axis: usize, at: f32| self.lines[axis].partition_point(|l| l.total_cmp(&at).is_lt());
        [[line(0, min[0]), line(1, min[1])], [line(0, max[0]), line(1, max[1])]]
    }

    /// Whether all cells from line to line are covered.
    fn is_full(&self, [u0, v0]: [usize; 2], [u1, v1]: [usize; 2]) -> bool {
        (v0..v1).all(|v| (u0..u1).all(|u| self.covered[self.at(u, v)]))
    }

    /// A rectangle grown as far as covered cells go, first along one axis and then along the other.
    fn grown(&self, rectangle: &Rectangle, first: usize) -> Rectangle {
        let [mut from, mut to] = self.cells(rectangle);
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
        let place = |line: [usize; 2]| [self.lines[0][line[0]], self.lines[1][line[1]]];
        (place(from), place(to))
    }
}

/// The greatest rectangles that some rectangles of one plane cover together, as far as they are
/// found by growing each. Each one given lies in one of them.
pub(super) fn greatest(rectangles: &[Rectangle]) -> Vec<Rectangle> {
    let Some(lattice) = Lattice::new(rectangles) else { return rectangles.to_vec() };
    let mut found: Vec<Rectangle> =
        rectangles.iter().flat_map(|r| [lattice.grown(r, 0), lattice.grown(r, 1)]).collect();
    let key = |r: &Rectangle| [r.0[0], r.0[1], r.1[0], r.1[1]].map(f32::to_bits);
    found.sort_by_key(key);
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_grow_over_neighbours_and_not_over_gaps() {
        // A wall of three panels with a window in the middle one: sill, lintel and sides.
        let panels = [
            ([0.0, 0.0], [1.0, 3.0]),
            ([1.0, 0.0], [2.0, 1.0]),
            ([1.0, 2.0], [2.0, 3.0]),
            ([2.0, 0.0], [3.0, 3.0]),
        ];
        let mut found = greatest(&panels);
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let expected = [
            ([0.0, 0.0], [1.0, 3.0]),
            ([0.0, 0.0], [3.0, 1.0]),
            ([0.0, 2.0], [3.0, 3.0]),
            ([2.0, 0.0], [3.0, 3.0]),
        ];
        assert_eq!(found, expected);
        let apart = [([0.0, 0.0], [1.0, 1.0]), ([1.001, 0.0], [2.0, 1.0])];
        assert_eq!(greatest(&apart), apart);
    }
}
