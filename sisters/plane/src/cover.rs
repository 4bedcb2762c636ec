//! Whether solids together cover a cell.
//!
//! The solids are taken out of the cell, one after the other: the remainder of a convex piece
//! outside of a convex solid is the parts beyond its first side, beyond its second but not its
//! first, and so on. A piece is an open set: a point of a cell that no solid contains has others
//! around it that none contains, since solids are closed. So the solids cover the cell if and only
//! if no piece is left. Pieces are lists of lines, their corners crossings of two lines, and the
//! side of a line on which a corner lies is the sign of a polynomial of degree 4 in the
//! coordinates, which is computed exactly. Rectangles come first, with pieces that are rectangles.
//! Where there are too many solids or pieces, the answer is no.

use glam::DVec2;
use smallvec::SmallVec;

use crate::geometry::Shape;
use crate::geometry::block::Block;
use crate::geometry::expansion::Expansion;
use crate::geometry::polygon::ring;

/// Pieces that are cut at a side, at most: each costs some microseconds.
const MOST_CUTS: usize = 400;

/// Solids that are looked at for a cell, at most.
const MOST_SOLIDS: usize = 12;

/// Sides of a polygon that is looked at, at most. Discs would have 32.
const MOST_SIDES: usize = 12;

/// `a x + b y + c`: positive on the left of the line.
#[derive(Debug, Clone)]
struct Line([Expansion; 3]);

impl Line {
    fn between(p: DVec2, q: DVec2) -> Self {
        let number = |v: f64| Expansion::difference(v, 0.0);
        let (a, b) = (Expansion::difference(p.y, q.y), Expansion::difference(q.x, p.x));
        let c = number(0.0).minus(&a.times(&number(p.x))).minus(&b.times(&number(p.y)));
        Self([a, b, c])
    }

    fn turned(&self) -> Self {
        Self(self.0.each_ref().map(|part| Expansion::difference(0.0, 0.0).minus(part)))
    }

    /// The crossing with a line that turns left of this one: x, y and the positive number that both
    /// are divided by.
    fn crossing(&self, other: &Self) -> [Expansion; 3] {
        let [a, b] = [&self.0, &other.0];
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].times(&b[j]).minus(&a[j].times(&b[i])))
    }

    /// The sign of the side of a point.
    fn side(&self, point: &[Expansion; 3]) -> f64 {
        let none = Expansion::difference(0.0, 0.0);
        let all = (0..3).fold(none, |sum, i| {
            let product = self.0[i].times(&point[i]);
            sum.minus(&Expansion::difference(0.0, 0.0).minus(&product))
        });
        all.sign()
    }
}

/// A convex set that is not empty and open: the points on the left of lines that run
/// counterclockwise around it.
#[derive(Debug, Clone)]
struct Piece(Vec<Line>);

impl From<&Block> for Piece {
    fn from(&Block { min, max }: &Block) -> Self {
        let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        Self((0..4).map(|i| Line::between(corners[i], corners[(i + 1) % 4])).collect())
    }
}

impl Piece {
    /// The part on the left of a line, if there is one.
    fn left_of(&self, line: &Line) -> Option<Self> {
        let (lines, count) = (&self.0, self.0.len());
        // The corners where the lines end.
        let sides: Vec<f64> =
            (0..count).map(|i| line.side(&lines[i].crossing(&lines[(i + 1) % count]))).collect();
        if sides.iter().all(|&side| side <= 0.0) {
            return None;
        }
        if sides.iter().all(|&side| side >= 0.0) {
            return Some(self.clone());
        }
        let mut kept = Vec::with_capacity(count + 1);
        for i in 0..count {
            let (begins, ends) = (sides[(i + count - 1) % count] > 0.0, sides[i] > 0.0);
            if begins || ends {
                kept.push(lines[i].clone());
            }
            if begins && !ends {
                kept.push(line.clone());
            }
        }
        Some(Self(kept))
    }
}

/// Whether some solids, the first that are looked at, together contain all of the rectangle between
/// two corners. In doubt, no.
pub(crate) fn covers<'a>(lo: DVec2, hi: DVec2, solids: impl Iterator<Item = &'a Shape>) -> bool {
    let corners = [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)];
    let cell = Block { min: lo, max: hi };
    // Those that only touch the border take nothing away.
    let overlaps = |solid: &&Shape| solid.block().overlaps(&cell);
    let solids: SmallVec<[&Shape; MOST_SOLIDS]> = solids.filter(overlaps).take(MOST_SOLIDS).collect();
    let in_some = |&corner: &DVec2| solids.iter().any(|solid| solid.contains(corner));
    if !corners.iter().all(in_some) {
        return false;
    }
    let mut blocks: SmallVec<[Block; 8]> = SmallVec::from_slice(&[cell]);
    for rect in solids.iter().filter(|solid| matches!(solid, Shape::Rect(_))) {
        blocks = without(&blocks, &rect.block());
    }
    let mut pieces: Vec<Piece> = blocks.iter().map(Piece::from).collect();
    let mut cuts = 0;
    for sides in solids.into_iter().filter_map(sides) {
        if pieces.is_empty() || cuts > MOST_CUTS {
            break;
        }
        let mut left = Vec::new();
        for mut piece in pieces {
            for side in &sides {
                cuts += 1;
                left.extend(piece.left_of(&side.turned()));
                match piece.left_of(side) {
                    Some(rest) => piece = rest,
                    None => break,
                }
            }
        }
        pieces = left;
    }
    pieces.is_empty()
}

/// What is left of some blocks outside of another, as blocks: exact, as coordinates are compared
/// only.
fn without(blocks: &[Block], taken: &Block) -> SmallVec<[Block; 8]> {
    let mut rest = SmallVec::new();
    for &block in blocks {
        if !block.overlaps(taken) {
            rest.push(block);
            continue;
        }
        let mut middle = block;
        for axis in 0..2 {
            if middle.min[axis] < taken.min[axis] {
                let mut before = middle;
                before.max[axis] = taken.min[axis];
                middle.min[axis] = taken.min[axis];
                rest.push(before);
            }
            if middle.max[axis] > taken.max[axis] {
                let mut beyond = middle;
                beyond.min[axis] = taken.max[axis];
                middle.max[axis] = taken.max[axis];
                rest.push(beyond);
            }
        }
    }
    rest
}

/// The sides of a polygon that can be looked at, counterclockwise.
fn sides(solid: &Shape) -> Option<Vec<Line>> {
    let Shape::Polygon(polygon) = solid else { return None };
    let few = polygon.corners().len() <= MOST_SIDES;
    few.then(|| ring(polygon.corners()).map(|(a, b)| Line::between(a, b)).collect())
}

#[cfg(test)]
mod tests {
    use glam::Vec2;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg32;

    use super::*;
    use crate::geometry::{ConvexPolygon, Disc, Rect};

    fn at(x: f32, y: f32) -> Vec2 {
        Vec2::new(x, y)
    }

    fn rect(min: [f32; 2], max: [f32; 2]) -> Shape {
        Rect::new(min.into(), max.into()).into()
    }

    fn polygon(points: &[Vec2]) -> Shape {
        ConvexPolygon::new(points).unwrap().into()
    }

    fn is_covered(solids: &[Shape]) -> bool {
        covers(DVec2::ZERO, DVec2::ONE, solids.iter())
    }

    #[test]
    fn solids_that_meet_cover_and_those_with_a_gap_do_not() {
        let seam = 0.3f32;
        let left = rect([-1.0, -1.0], [seam, 2.0]);
        assert!(is_covered(&[left.clone(), rect([seam, 0.0], [1.0, 1.0])]));
        assert!(!is_covered(&[left.clone(), rect([seam.next_up(), 0.0], [1.0, 1.0])]));
        // Three rectangles around a corner, and a triangle in the remainder.
        let three = [left.clone(), rect([seam, 0.5], [1.5, 1.0]), rect([0.7, -0.1], [1.0, 0.5])];
        let fill = [polygon(&[at(seam, 0.5), at(0.7, 0.5), at(0.7, -0.5), at(seam, -0.1)])];
        assert!(!is_covered(&three) && is_covered(&[&three[..], &fill].concat()));
        // Along a side that no number of single precision lies on.
        let (a, b) = (at(0.1, -0.7), at(0.77, 1.3));
        let halves =
            [polygon(&[a, b, at(-3.0, 3.0), at(-3.0, -3.0)]), polygon(&[a, b, at(3.0, 3.0), at(3.0, -3.0)])];
        assert!(is_covered(&halves) && !is_covered(&halves[..1]));
        let moved = polygon(&[at(0.1f32.next_up(), -0.7), b, at(3.0, 3.0), at(3.0, -3.0)]);
        assert!(!is_covered(&[halves[0].clone(), moved]));
        assert!(!is_covered(&[]) && !is_covered(&[Disc::new(at(0.5, 0.5), 9.0).into()]));
        // Overlaps, also of many.
        let many: Vec<Shape> =
            (0..11).map(|i| rect([i as f32 / 11.0 - 0.1, 0.0], [(i + 1) as f32 / 11.0, 1.0])).collect();
        assert!(is_covered(&many) && !is_covered(&many[2..]));
    }

    /// Points in exact arithmetic: corners of solids, of the cell, and many between.
    #[test]
    fn no_point_of_a_covered_cell_is_free() {
        let mut random = Pcg32::seed_from_u64(41);
        let mut covered = 0;
        for _ in 0..3000 {
            let lattice = |random: &mut Pcg32| {
                Vec2::new(random.random_range(-3..8) as f32, random.random_range(-3..8) as f32) / 4.0
            };
            let solids: Vec<Shape> = (0..random.random_range(2..7))
                .filter_map(|_| {
                    let points: Vec<Vec2> = (0..5).map(|_| lattice(&mut random)).collect();
                    let [a, b] = [points[0], points[1]];
                    match random.random_range(0..2) {
                        0 => Some(Rect::new(a.min(b), a.max(b)).into()),
                        _ => ConvexPolygon::new(&points).ok().map(Shape::from),
                    }
                })
                .collect();
            let free = |p: DVec2| !solids.iter().any(|solid| solid.contains(p));
            let step = 1.0 / 64.0;
            let points = (0..65 * 65).map(|i| DVec2::new(f64::from(i % 65), f64::from(i / 65)) * step);
            let some_free = points.into_iter().any(free);
            // What is left between corners of a lattice of quarters is larger than a step.
            let found = is_covered(&solids);
            assert!(!found || !some_free, "{solids:?}");
            covered += u32::from(found);
        }
        assert!(covered > 100, "{covered}");
    }
}
