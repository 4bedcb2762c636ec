//! The occlusion procedure of the thesis, kept as it is written: for tests
//! against the masks, and for drawing caps.
//!
//! *Occluder extension* (section 3.4.3): the blocked cells (opaque or already
//! hidden) of one side of one chessboard shell, of any shape, also disconnected.
//! *Cap*: their outline as polygons with holes, through the centres of the
//! outermost cells (Schaufler et al. 2000; vertices as indices retract the
//! occluder so that its shadow is valid for the whole viewer's cell, section 3.3.5).
//! *Volume*: the cap pushed outwards along rays from the viewer's cell, and
//! rasterised slab by slab into H, sampled at cell centres.
//!
//! Cells one wide have no area: their outline is a segment or a point, kept
//! beside the polygons. Cost: O(n^4) for n^3 cells. Use [`crate::Query`] for work.

use glam::{IVec2, IVec3};

use crate::grid::side::Side;
use crate::matrix::bits::{BitMatrix, OcclusionMatrix};

/// The outline of the blocked cells of one side of a shell, in the side's two
/// coordinates (columns, rows), relative to the viewer's cell.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Cap {
    /// Axis that the side is perpendicular to (0, 1, 2) and its sign.
    pub side: (usize, i32),
    /// Chessboard distance of the shell.
    pub shell: i32,
    /// Areas.
    pub polygons: Vec<CapPolygon>,
    /// Runs of blocked cells one wide, as their two end cells.
    pub segments: Vec<[IVec2; 2]>,
    /// Single blocked cells.
    pub points: Vec<IVec2>,
}

/// A polygon with holes, along lattice lines. The area is to the left of each ring's direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CapPolygon {
    /// The outer ring, counter-clockwise, without its first vertex repeated.
    pub outer: Vec<IVec2>,
    /// Rings of holes, clockwise.
    pub holes: Vec<Vec<IVec2>>,
}

impl Cap {
    /// The outline of the blocked cells of one side of a shell; `blocked` is asked
    /// for cells (column, row) with both coordinates from `-shell` to `shell`.
    fn vectorise(side: &Side, shell: i32, blocked: &dyn Fn(i32, i32) -> bool) -> Self {
        let mut cap = Self { side: (side.axes.normal, side.sign), shell, ..Self::default() };
        // A unit square of the lattice is full if all its corners are blocked cells.
        let full = |x: i32, y: i32| {
            x >= -shell
                && y >= -shell
                && x < shell
                && y < shell
                && blocked(x, y)
                && blocked(x + 1, y)
                && blocked(x, y + 1)
                && blocked(x + 1, y + 1)
        };
        cap.polygons = polygons(shell, &full);
        for y in -shell..=shell {
            for x in -shell..=shell {
                if !blocked(x, y) {
                    continue;
                }
                let right = x < shell && blocked(x + 1, y);
                let up = y < shell && blocked(x, y + 1);
                if right && !full(x, y) && !full(x, y - 1) {
                    cap.segments.push([IVec2::new(x, y), IVec2::new(x + 1, y)]);
                }
                if up && !full(x, y) && !full(x - 1, y) {
                    cap.segments.push([IVec2::new(x, y), IVec2::new(x, y + 1)]);
                }
                let left = x > -shell && blocked(x - 1, y);
                let down = y > -shell && blocked(x, y - 1);
                if !(right || up || left || down) {
                    cap.points.push(IVec2::new(x, y));
                }
            }
        }
        cap
    }

    /// Rasterises the volume behind the cap into the slab at shell `m`: calls
    /// `out` with the cells (column, row) whose centres are in it, borders included.
    fn slab(&self, m: i32, out: &mut dyn FnMut(i32, i32)) {
        let (k, m) = (i64::from(self.shell), i64::from(m));
        // Cell c is in the volume if c * k / m is in the cap: all in integers, times m.
        for polygon in &self.polygons {
            for row in -m..=m {
                let y = row * k;
                // An area touches the closed scan line from above or below: both count.
                let rings = || std::iter::once(&polygon.outer).chain(&polygon.holes);
                for above in [true, false] {
                    let mut cuts: Vec<i64> = Vec::new();
                    for ring in rings() {
                        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                            let (lo, hi) = (i64::from(a.y.min(b.y)) * m, i64::from(a.y.max(b.y)) * m);
                            let meets = if above { lo <= y && y < hi } else { lo < y && y <= hi };
                            if a.x == b.x && meets {
                                cuts.push(i64::from(a.x));
                            }
                        }
                    }
                    cuts.sort_unstable();
                    for pair in cuts.chunks_exact(2) {
                        // Columns c with pair[0] * m <= c * k <= pair[1] * m.
                        let first = (pair[0] * m).div_euclid(k) + i64::from((pair[0] * m).rem_euclid(k) != 0);
                        let last = (pair[1] * m).div_euclid(k);
                        (first..=last).for_each(|c| out(c as i32, row as i32));
                    }
                }
            }
        }
        for [a, b] in &self.segments {
            let along_x = a.y == b.y;
            let (fixed, from, to) = if along_x { (a.y, a.x, b.x) } else { (a.x, a.y, b.y) };
            let fixed = i64::from(fixed) * m;
            if fixed % k != 0 {
                continue;
            }
            let (from, to) = (i64::from(from) * m, i64::from(to) * m);
            for c in from.div_euclid(k)..=to.div_euclid(k) {
                if c * k >= from {
                    if along_x {
                        out(c as i32, (fixed / k) as i32)
                    } else {
                        out((fixed / k) as i32, c as i32)
                    }
                }
            }
        }
        for p in &self.points {
            let (x, y) = (i64::from(p.x) * m, i64::from(p.y) * m);
            if x % k == 0 && y % k == 0 {
                out((x / k) as i32, (y / k) as i32);
            }
        }
    }
}

/// Traces the border of a set of unit squares as rings with the area to the
/// left, and puts each hole into the polygon around it.
fn polygons(shell: i32, full: &dyn Fn(i32, i32) -> bool) -> Vec<CapPolygon> {
    let n = (2 * shell + 1) as usize;
    let at = |p: IVec2| ((p.y + shell) as usize) * n + (p.x + shell) as usize;
    const STEPS: [IVec2; 4] = [IVec2::new(1, 0), IVec2::new(0, 1), IVec2::new(-1, 0), IVec2::new(0, -1)];
    // Directed border edges from each lattice point, one bit a direction.
    let mut edges = vec![0u8; n * n];
    for y in -shell..shell {
        for x in -shell..shell {
            if full(x, y) {
                let sides = [
                    (full(x, y - 1), IVec2::new(x, y), 0),
                    (full(x + 1, y), IVec2::new(x + 1, y), 1),
                    (full(x, y + 1), IVec2::new(x + 1, y + 1), 2),
                    (full(x - 1, y), IVec2::new(x, y + 1), 3),
                ];
                for (neighbour, from, direction) in sides {
                    if !neighbour {
                        edges[at(from)] |= 1 << direction;
                    }
                }
            }
        }
    }
    let mut rings: Vec<Vec<IVec2>> = Vec::new();
    for y in -shell..=shell {
        for x in -shell..=shell {
            let start = IVec2::new(x, y);
            while edges[at(start)] != 0 {
                let mut ring = Vec::new();
                let first = edges[at(start)].trailing_zeros() as usize;
                let (mut p, mut direction) = (start, first);
                loop {
                    ring.push(p);
                    p += STEPS[direction];
                    // Turning left first keeps squares that touch at a corner apart.
                    let turns = [1, 0, 3].map(|turn| (direction + turn) % 4);
                    match turns.into_iter().find(|d| edges[at(p)] >> d & 1 != 0) {
                        Some(d) if (p, d) != (start, first) => direction = d,
                        _ => break,
                    }
                    edges[at(p)] &= !(1 << direction);
                }
                edges[at(start)] &= !(1 << first);
                tidy(&mut ring);
                rings.push(ring);
            }
        }
    }
    let (outer, holes): (Vec<_>, Vec<_>) = rings.into_iter().partition(|r| doubled_area(r) > 0);
    let mut polygons: Vec<CapPolygon> =
        outer.into_iter().map(|outer| CapPolygon { outer, holes: Vec::new() }).collect();
    for hole in holes {
        // A point just outside the area, inside the hole: next to its first edge.
        let around =
            polygons.iter_mut().filter(|p| holds(&p.outer, &hole)).min_by_key(|p| doubled_area(&p.outer));
        if let Some(polygon) = around {
            polygon.holes.push(hole);
        }
    }
    polygons
}

fn direction_of(a: IVec2, b: IVec2) -> IVec2 {
    (b - a).signum()
}

/// Drops vertices on straight runs.
fn tidy(ring: &mut Vec<IVec2>) {
    let n = ring.len();
    let keep: Vec<bool> = (0..n)
        .map(|i| direction_of(ring[(i + n - 1) % n], ring[i]) != direction_of(ring[i], ring[(i + 1) % n]))
        .collect();
    let mut i = 0;
    ring.retain(|_| {
        i += 1;
        keep[i - 1]
    });
}

fn doubled_area(ring: &[IVec2]) -> i64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter()
        .zip(next)
        .map(|(a, b)| i64::from(a.x) * i64::from(b.y) - i64::from(b.x) * i64::from(a.y))
        .sum()
}

/// Whether a ring contains a square that borders on the hole from inside.
fn holds(outer: &[IVec2], hole: &[IVec2]) -> bool {
    // The area is to the left of the hole's first edge: its square's centre, doubled.
    let (a, b) = (hole[0], hole[1]);
    let d = direction_of(a, b);
    let center = a * 2 + d + IVec2::new(-d.y, d.x);
    let mut inside = false;
    for (a, b) in outer.iter().zip(outer.iter().cycle().skip(1)) {
        let (lo, hi) = (a.y.min(b.y) * 2, a.y.max(b.y) * 2);
        if a.x == b.x && lo < center.y && center.y < hi && a.x * 2 > center.x {
            inside = !inside;
        }
    }
    inside
}

/// The cells that the viewer's cell cannot see, and the caps that hide them, by
/// the thesis' procedure in all directions.
///
/// `opaque` is O, of which the cells from 0 to `dims` are looked at; `viewer` is one of these.
pub fn occlusion_by_caps(opaque: &BitMatrix, dims: IVec3, viewer: IVec3) -> (OcclusionMatrix, Vec<Cap>) {
    let mut hidden = BitMatrix::default();
    let mut caps = Vec::new();
    let farthest = viewer.abs().max((dims - 1 - viewer).abs()).max_element();
    for k in 1..farthest {
        let shell: Vec<Cap> = Side::ALL
            .iter()
            .map(|side| {
                let blocked = |col, row| {
                    let c = viewer + cell_of(side, k, col, row);
                    opaque.get(c) || hidden.get(c)
                };
                Cap::vectorise(side, k, &blocked)
            })
            .collect();
        for (cap, side) in shell.into_iter().zip(&Side::ALL) {
            if cap.polygons.is_empty() && cap.segments.is_empty() && cap.points.is_empty() {
                continue;
            }
            for m in k + 1..=farthest {
                cap.slab(m, &mut |col, row| {
                    let c = viewer + cell_of(side, m, col, row);
                    if c.cmpge(IVec3::ZERO).all() && c.cmplt(dims).all() {
                        hidden.set(c);
                    }
                });
            }
            caps.push(cap);
        }
    }
    (hidden, caps)
}

/// The cells that the viewer's cell cannot see, by the lattice rule over all
/// pairs of shells: the most that the rule finds.
///
/// `opaque` is O, of which the cells from 0 to `dims` are looked at; `viewer` is one of these.
pub fn occlusion_by_lattice(opaque: &BitMatrix, dims: IVec3, viewer: IVec3) -> OcclusionMatrix {
    let mut hidden = BitMatrix::default();
    let farthest = viewer.abs().max((dims - 1 - viewer).abs()).max_element();
    for m in 2..=farthest {
        let mut found = Vec::new();
        for side in &Side::ALL {
            for row in -m..=m {
                for col in -m..=m {
                    let c = viewer + cell_of(side, m, col, row);
                    if c.cmplt(IVec3::ZERO).any() || c.cmpge(dims).any() {
                        continue;
                    }
                    let blocked_at = |k: i32| {
                        let around = |v: i32| {
                            let lo = (i64::from(v) * i64::from(k)).div_euclid(i64::from(m));
                            let exact = (i64::from(v) * i64::from(k)).rem_euclid(i64::from(m)) == 0;
                            (lo as i32, lo as i32 + i32::from(!exact))
                        };
                        let ((r0, r1), (c0, c1)) = (around(row), around(col));
                        (r0..=r1).all(|r| {
                            (c0..=c1).all(|c| {
                                let cell = viewer + cell_of(side, k, c, r);
                                opaque.get(cell) || hidden.get(cell)
                            })
                        })
                    };
                    if (1..m).any(blocked_at) {
                        found.push(c);
                    }
                }
            }
        }
        found.into_iter().for_each(|c| hidden.set(c));
    }
    hidden
}

fn cell_of(side: &Side, shell: i32, col: i32, row: i32) -> IVec3 {
    let mut c = IVec3::ZERO;
    c[side.axes.normal] = shell * side.sign;
    c[side.axes.col] = col;
    c[side.axes.row] = row;
    c
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn cap_of(shell: i32, rows: &[&str]) -> Cap {
        let blocked = |x: i32, y: i32| rows[(y + shell) as usize].as_bytes()[(x + shell) as usize] == b'#';
        Cap::vectorise(&Side::ALL[0], shell, &blocked)
    }

    #[test]
    fn outlines_have_holes_segments_and_points() {
        let cap = cap_of(3, &["####..#", "#..#...", "#..#...", "####...", ".......", "##.....", "##..##."]);
        assert_eq!(cap.polygons.len(), 1);
        assert_eq!(cap.segments.len(), 3 + 3 + 3 + 3 + 1);
        assert_eq!(cap.points, vec![IVec2::new(3, -3)]);
        let ring = cap_of(2, &["#####", "#####", "##.##", "#####", "#####"]);
        assert_eq!(ring.polygons.len(), 1);
        assert_eq!(ring.polygons[0].holes.len(), 1);
        assert_eq!((ring.polygons[0].outer.len(), ring.polygons[0].holes[0].len()), (4, 4));
        assert_eq!(doubled_area(&ring.polygons[0].outer), 32);
        assert_eq!(doubled_area(&ring.polygons[0].holes[0]), -8);
    }

    #[test]
    fn rings_meet_at_corners_and_nest() {
        let cap = cap_of(2, &["##...", "##...", "..##.", "..##.", "....."]);
        assert_eq!(cap.polygons.len(), 2);
        let touch = cap_of(2, &["###..", "###..", "#####", "..###", "..###"]);
        let area: i64 = touch.polygons.iter().map(|p| doubled_area(&p.outer)).sum();
        assert_eq!(area, 16);
    }

    #[test]
    fn slabs_agree_with_the_lattice_rule_on_random_sides() {
        let mut random = Random::new(5);
        for round in 0..200 {
            let shell = 1 + round % 5;
            let density = 40 + (round as u32 * 7) % 60;
            let n = 2 * shell + 1;
            let cells: Vec<bool> = (0..n * n).map(|_| random.below(100) < density).collect();
            let blocked = |x: i32, y: i32| cells[((y + shell) * n + x + shell) as usize];
            let cap = Cap::vectorise(&Side::ALL[2], shell, &blocked);
            for m in shell + 1..shell + 9 {
                let side = (2 * m + 1) as usize;
                let mut found = vec![false; side * side];
                cap.slab(m, &mut |x, y| found[(y + m) as usize * side + (x + m) as usize] = true);
                for y in -m..=m {
                    for x in -m..=m {
                        let around = |v: i32| (v * shell).div_euclid(m)..=-(-v * shell).div_euclid(m);
                        let rule = around(y).all(|r| around(x).all(|c| blocked(c, r)));
                        let at = (y + m) as usize * side + (x + m) as usize;
                        assert_eq!(found[at], rule, "shell {shell} slab {m} cell {x} {y} of {cells:?}");
                    }
                }
            }
        }
    }
}
