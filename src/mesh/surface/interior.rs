//! Dropping the faces between boxes that abut: nobody sees them, and they cut the walls around them
//! into pieces.
//!
//! A rectangle along two axes goes if rectangles of the same plane that face the other way cover
//! it, and if the mesh winds around both of its sides: then every ray that comes to it from outside
//! a closed mesh has met another face, which stays. To drop triangles is always safe, as they hide
//! nothing any more; all that this rule is for is that nothing is lost by it. So numbers that are
//! rounded do no harm, and limits keep the cost down.

use glam::{Vec2, Vec3};
use hashbrown::HashMap;

/// Rectangles of one plane that are compared with one of them, at most.
const MOST_BESIDE: usize = 256;

/// Pieces into which they cut it, at most.
const MOST_PIECES: u32 = 1024;

/// Triangles that a line is compared with, on average over all lines, at most.
const MOST_ON_LINE: usize = 256;

/// Entries of columns for each triangle, at most.
const MOST_ENTRIES: usize = 16;

/// Where a line passes a rectangle, as shares of its sides: seldom on an edge of a triangle.
const SAMPLE: Vec2 = Vec2::new(0.381_966, 0.573_576);

/// The two axes beside one, in turn.
fn beside(axis: usize) -> (usize, usize) {
    ((axis + 1) % 3, (axis + 2) % 3)
}

/// A point without its coordinate along an axis.
fn flat(p: Vec3, axis: usize) -> Vec2 {
    let (j, k) = beside(axis);
    Vec2::new(p[j], p[k])
}

/// A rectangle of two triangles.
#[derive(Debug, Clone, Copy)]
struct Rectangle {
    axis: usize,
    /// The coordinate of its plane.
    at: f32,
    /// Whether it is turned to greater coordinates.
    up: bool,
    min: Vec2,
    max: Vec2,
    triangles: [u32; 2],
}

/// The triangle as half of a rectangle across an axis: the axis, whether it is turned upwards, and
/// the ends of its diagonal.
fn half_of(positions: &[Vec3], t: [u32; 3]) -> Option<(usize, bool, [u32; 2])> {
    let [a, b, c] = t.map(|v| positions[v as usize]);
    let axis = (0..3).find(|&axis| a[axis] == b[axis] && b[axis] == c[axis])?;
    let (j, k) = beside(axis);
    let is_slanted = |side: usize| {
        let (p, q) = ([a, b, c][side], [b, c, a][side]);
        p[j] != q[j] && p[k] != q[k]
    };
    let mut slanted = (0..3).filter(|&side| is_slanted(side));
    let side = slanted.next().filter(|_| slanted.next().is_none())?;
    let up = (flat(b, axis) - flat(a, axis)).perp_dot(flat(c, axis) - flat(a, axis)) > 0.0;
    let ends = [t[side], t[(side + 1) % 3]];
    Some((axis, up, [ends[0].min(ends[1]), ends[0].max(ends[1])]))
}

/// The rectangles among some triangles, by plane, and in a plane by their least first coordinate.
fn rectangles(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Rectangle> {
    let mut halves: HashMap<(usize, bool, [u32; 2]), u32> = HashMap::new();
    let mut found = Vec::new();
    for (&t, number) in triangles.iter().zip(0..) {
        let Some(half) = half_of(positions, t) else { continue };
        let Some(other) = halves.remove(&half) else {
            halves.insert(half, number);
            continue;
        };
        let (axis, up, ends) = half;
        let tip = |t: [u32; 3]| t.into_iter().find(|v| !ends.contains(v));
        if tip(t) == tip(triangles[other as usize]) {
            continue;
        }
        let [p, q] = ends.map(|v| positions[v as usize]);
        let (min, max) = (flat(p, axis).min(flat(q, axis)), flat(p, axis).max(flat(q, axis)));
        found.push(Rectangle { axis, at: p[axis] + 0.0, up, min, max, triangles: [other, number] });
    }
    let plane = |r: &Rectangle| (r.axis, r.at.to_bits());
    found.sort_unstable_by(|a, b| {
        plane(a).cmp(&plane(b)).then(a.min.x.total_cmp(&b.min.x)).then(a.triangles.cmp(&b.triangles))
    });
    found
}

/// Whether rectangles cover one, which is given by its corners.
fn is_covered(min: Vec2, max: Vec2, by: &[&Rectangle], pieces: &mut u32) -> bool {
    if min.cmpge(max).any() {
        return true;
    }
    *pieces += 1;
    let overlaps = |r: &&Rectangle| r.min.cmplt(max).all() && min.cmplt(r.max).all();
    let Some(first) = by.iter().position(overlaps).filter(|_| *pieces <= MOST_PIECES) else { return false };
    let (own, rest) = (by[first], &by[first + 1..]);
    let (low, high) = (own.min.max(min), own.max.min(max));
    // What it leaves on its left and right, and below and above it.
    is_covered(min, Vec2::new(low.x, max.y), rest, pieces)
        && is_covered(Vec2::new(high.x, min.y), max, rest, pieces)
        && is_covered(Vec2::new(low.x, min.y), Vec2::new(high.x, low.y), rest, pieces)
        && is_covered(Vec2::new(low.x, high.y), Vec2::new(high.x, max.y), rest, pieces)
}

/// The rectangles that others of their planes cover which face the other way. Those that come in
/// pairs of the same corners, and touch no other triangle, are sheets with two sides, and stay.
fn covered(all: &[Rectangle], is_sheet: impl Fn(&Rectangle) -> bool) -> Vec<Rectangle> {
    let mut covered = Vec::new();
    let mut others: Vec<&Rectangle> = Vec::new();
    for plane in all.chunk_by(|a, b| a.axis == b.axis && a.at == b.at) {
        let widest = plane.iter().map(|r| r.max.x - r.min.x).fold(0.0, f32::max);
        for own in plane {
            let first = plane.partition_point(|r| r.min.x < own.min.x - widest);
            let last = plane.partition_point(|r| r.min.x < own.max.x);
            let beside = plane.get(first..last).filter(|beside| beside.len() <= MOST_BESIDE);
            others.clear();
            others.extend(beside.unwrap_or(&[]).iter().filter(|r| r.up != own.up));
            let is_hidden = is_covered(own.min, own.max, &others, &mut 0);
            if is_hidden && !is_sheet(own) {
                covered.push(*own);
            }
        }
    }
    covered
}

/// Triangles by their first coordinate beside an axis.
struct Columns {
    min: f32,
    scale: f32,
    /// Where the triangles of each column start.
    starts: Vec<usize>,
    triangles: Vec<u32>,
}

impl Columns {
    /// The columns of triangles as seen along an axis; narrow ones, unless triangles reach over
    /// many.
    fn new(positions: &[Vec3], triangles: &[[u32; 3]], axis: usize) -> Self {
        let across = |t: &[u32; 3]| {
            let x = t.map(|v| flat(positions[v as usize], axis).x);
            (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]))
        };
        let start = (f32::INFINITY, f32::NEG_INFINITY);
        let (min, max) = triangles.iter().map(across).fold(start, |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let mut columns = Self { min, scale: 0.0, starts: Vec::new(), triangles: Vec::new() };
        let mut count = triangles.len().next_power_of_two();
        loop {
            let scale = count as f32 / (max - min);
            columns.scale = if scale.is_finite() { scale } else { 0.0 };
            columns.starts = vec![0; count + 1];
            let mut entries = 0;
            for (x0, x1) in triangles.iter().map(across) {
                let (from, to) = (columns.column(x0), columns.column(x1));
                entries += to - from + 1;
                if entries > MOST_ENTRIES * triangles.len() {
                    break;
                }
                columns.starts[from..=to].iter_mut().for_each(|n| *n += 1);
            }
            if entries <= MOST_ENTRIES * triangles.len() {
                break;
            }
            count /= 2;
        }
        let mut reached = 0;
        for start in &mut columns.starts {
            reached += std::mem::replace(start, reached);
        }
        columns.triangles = vec![0; reached];
        let mut ends = columns.starts.clone();
        for ((x0, x1), number) in triangles.iter().map(across).zip(0..) {
            for end in &mut ends[columns.column(x0)..=columns.column(x1)] {
                columns.triangles[*end] = number;
                *end += 1;
            }
        }
        columns
    }

    fn column(&self, x: f32) -> usize {
        (((x - self.min) * self.scale) as usize).min(self.starts.len().saturating_sub(2))
    }

    /// The triangles that a line may pass.
    fn at(&self, x: f32) -> &[u32] {
        let column = self.column(x);
        &self.triangles[self.starts[column]..self.starts[column + 1]]
    }
}

/// How often triangles wind around a point of a rectangle, told by those above and by those below;
/// `None` if it lies on an edge of one.
fn windings(positions: &[Vec3], triangles: &[[u32; 3]], r: &Rectangle, near: &[u32]) -> Option<(i32, i32)> {
    let point = r.min + (r.max - r.min) * SAMPLE;
    let (mut above, mut below) = (0, 0);
    for &number in near {
        let corners = triangles[number as usize].map(|v| positions[v as usize]);
        let [a, b, c] = corners.map(|p| flat(p, r.axis) - point);
        let shares = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
        let (least, most) =
            (shares.iter().fold(f32::MAX, |a, b| a.min(*b)), shares.iter().fold(f32::MIN, |a, b| a.max(*b)));
        if least < 0.0 && most > 0.0 {
            continue;
        }
        let total: f32 = shares.iter().sum();
        if total == 0.0 {
            continue;
        }
        if least == 0.0 || most == 0.0 {
            return None;
        }
        let height: f32 =
            shares.iter().zip(corners).map(|(share, p)| share / total * (p[r.axis] - r.at)).sum();
        // Where it rises, a ray upwards leaves the inside.
        let turn = if total > 0.0 { 1 } else { -1 };
        if corners.iter().all(|p| p[r.axis] == r.at) {
            continue;
        }
        if height > 0.0 { above += turn } else { below -= turn }
    }
    Some((above, below))
}

/// Drops the faces between boxes that abut. Returns whether there are any.
///
/// Costs the triangles: limits end the search where many lie over each other.
pub(super) fn drop_interior(
    positions: &[Vec3],
    triangles: &mut Vec<[u32; 3]>,
    around: impl Fn(u32, u32, &mut dyn FnMut(u32)),
) -> bool {
    let all = rectangles(positions, triangles);
    let is_sheet = |r: &Rectangle| {
        let [one, two] = r.triangles.map(|t| triangles[t as usize]);
        let sides = [one, two].into_iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
        let mut is_free = true;
        for (from, to) in sides {
            around(from, to, &mut |t| {
                let corners = triangles[t as usize].map(|v| positions[v as usize][r.axis]);
                is_free &= corners.iter().all(|&c| c == r.at);
            });
        }
        is_free
    };
    let covered = covered(&all, is_sheet);
    let mut columns: [Option<Columns>; 3] = Default::default();
    let mut work = MOST_ON_LINE * triangles.len();
    let mut gone = vec![false; triangles.len()];
    let mut any = false;
    for r in covered {
        let columns = columns[r.axis].get_or_insert_with(|| Columns::new(positions, triangles, r.axis));
        let near = columns.at(r.min.x + (r.max.x - r.min.x) * SAMPLE.x);
        let Some(left) = work.checked_sub(near.len()) else { break };
        work = left;
        let inside = windings(positions, triangles, &r, near);
        if inside.is_some_and(|(above, below)| above > 0 && above == below) {
            r.triangles.iter().for_each(|&t| gone[t as usize] = true);
            any = true;
        }
    }
    let mut gone = gone.into_iter();
    triangles.retain(|_| !gone.next().unwrap_or(false));
    any
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::random::Random;

    /// A box of twelve triangles turned outwards.
    fn append(min: Vec3, max: Vec3, positions: &mut Vec<Vec3>, triangles: &mut Vec<[u32; 3]>) {
        let first = positions.len() as u32;
        let corner = |i: u32| Vec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), max, min);
        positions.extend((0..8).map(corner));
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        for f in faces.map(|f| f.map(|v| first + v)) {
            triangles.extend([[f[0], f[1], f[2]], [f[0], f[2], f[3]]]);
        }
    }

    /// Where a ray first meets one of some triangles.
    fn first_hit(from: DVec3, along: DVec3, positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
        let meets = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
            let (p, q) = (b - a, c - a);
            let normal = p.cross(q);
            let at = (a - from).dot(normal) / along.dot(normal);
            let point = from + along * at;
            let shares = [(a, b), (b, c), (c, a)].map(|(s, e)| (e - s).cross(point - s).dot(normal));
            (at > 0.0 && shares.iter().all(|&s| s >= 0.0)).then_some(at)
        };
        triangles.iter().filter_map(meets).fold(f64::INFINITY, f64::min)
    }

    /// The triangles that stay.
    fn rest(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let mut rest = triangles.to_vec();
        drop_interior(positions, &mut rest, |a, b, found| {
            let holds = |t: &[u32; 3]| t.contains(&a) && t.contains(&b);
            (0..).zip(triangles).filter(|(_, t)| holds(t)).for_each(|(i, _)| found(i));
        });
        rest
    }

    fn dropped(positions: &[Vec3], triangles: &[[u32; 3]]) -> usize {
        triangles.len() - rest(positions, triangles).len()
    }

    #[test]
    fn rays_from_outside_meet_the_same_faces() {
        let mut random = Random::new(31);
        let (mut gone, mut hits) = (0, 0);
        for _ in 0..150 {
            let (mut positions, mut triangles) = (Vec::new(), Vec::new());
            let mut whole = |n: f64| (random.within(0.0, n) as i32) as f32;
            for _ in 0..2 + whole(8.0) as usize {
                let min = Vec3::new(whole(4.0), whole(4.0), whole(2.0));
                let max = min + Vec3::new(1.0 + whole(3.0), 1.0 + whole(3.0), 1.0 + whole(2.0));
                append(min, max, &mut positions, &mut triangles);
            }
            let kept = rest(&positions, &triangles);
            gone += triangles.len() - kept.len();
            for _ in 0..200 {
                let from = random.point(1.0).normalize() * 20.0;
                let along = DVec3::splat(3.0) + random.point(4.0) - from;
                let (all, rest) = (
                    first_hit(from, along, &positions, &triangles),
                    first_hit(from, along, &positions, &kept),
                );
                assert!(all == rest, "{all} {rest}");
                hits += usize::from(all.is_finite());
            }
        }
        assert!(gone > 200 && hits > 5000, "{gone} {hits}");
    }

    #[test]
    fn faces_between_boxes_go() {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        let v = Vec3::new;
        append(v(0.0, 0.0, 0.0), v(2.0, 2.0, 1.0), &mut positions, &mut triangles);
        append(v(2.0, 0.0, 0.0), v(3.0, 2.0, 1.0), &mut positions, &mut triangles);
        assert_eq!(dropped(&positions, &triangles), 4, "one face each");
        append(v(0.0, 2.0, 0.0), v(3.0, 3.0, 1.0), &mut positions, &mut triangles);
        assert_eq!(dropped(&positions, &triangles), 10, "and where one box lies on two");
        append(v(0.5, -1.0, 0.25), v(1.0, 0.0, 0.75), &mut positions, &mut triangles);
        assert_eq!(dropped(&positions, &triangles), 12, "of a post only its end");
    }

    #[test]
    fn sheets_with_two_sides_stay() {
        let v = Vec3::new;
        let mut positions = vec![v(0.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(1.0, 1.0, 1.0), v(0.0, 1.0, 1.0)];
        let sheet = [[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]];
        let mut triangles = sheet.to_vec();
        assert_eq!(dropped(&positions, &triangles), 0, "alone");
        // A room that is turned inwards around it.
        append(v(-1.0, -1.0, -1.0), v(2.0, 2.0, 2.0), &mut positions, &mut triangles);
        triangles[4..].iter_mut().for_each(|t| t.swap(1, 2));
        assert_eq!(dropped(&positions, &triangles), 0, "in a room");
        triangles[4..].iter_mut().for_each(|t| t.swap(1, 2));
        assert_eq!(dropped(&positions, &triangles), 0, "in a box that it does not touch");
        // A curtain in a tube that is open at both ends.
        let mut positions = Vec::new();
        let mut tube = Vec::new();
        append(v(0.0, 0.0, 0.0), v(1.0, 1.0, 1.0), &mut positions, &mut tube);
        append(v(0.0, 0.0, 1.0), v(1.0, 1.0, 2.0), &mut positions, &mut tube);
        let is_end = |t: &[u32; 3]| t.iter().all(|&v| [0.0, 2.0].contains(&positions[v as usize].z));
        let ends: Vec<[u32; 3]> = tube.iter().copied().filter(is_end).collect();
        assert_eq!((ends.len(), dropped(&positions, &tube)), (4, 4), "closed, it is a box in two parts");
        tube.retain(|t| !is_end(t));
        assert_eq!(dropped(&positions, &tube), 0);
    }

    #[test]
    fn thousands_of_faces_over_each_other_are_left_alone() {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..3000 {
            let at = i as f32 * 1e-3;
            let (min, max) = (Vec3::new(at, at, 0.0), Vec3::new(at + 10.0, at + 10.0, 1.0));
            append(min, max, &mut positions, &mut triangles);
            append(min + Vec3::Z, max + Vec3::Z, &mut positions, &mut triangles);
        }
        let mut rest = triangles.clone();
        assert!(!drop_interior(&positions, &mut rest, |_, _, _| {}));
        assert_eq!(rest, triangles);
    }
}
