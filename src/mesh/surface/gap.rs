//! Closing gaps: cracks between panels that nearly meet, and corners that nearly lie on edges.
//!
//! A vertex moves to an earlier one within half of the gap, where there is one. Edges are then
//! split, once, at the vertices within half of the gap of them. The result deviates from the
//! triangles by no more than the gap:
//!
//! *Each point of a triangle made is within the gap of a point of the triangle that it was made
//! from.* The first step moves each corner by half of the gap at most, and so each point of the
//! triangle, which is a mean of the corners with the same shares before and after. For the second,
//! let the vertices of a split edge, in order, be `v1 ... vn`, and `f1 ... fn` points of the edge
//! in the same order, none twice, with `fi` within half of the gap of `vi`. With the points `fi` as
//! further corners on its sides, the moved triangle is cut into triangles without its points being
//! changed. Each of these becomes the one with `vi` in place of `fi`: again, each point moves as
//! the mean of corners that move by half of the gap at most. Both steps together make the gap. ∎
//!
//! The sides of the triangles made are not split again, as their points may lie the whole gap away
//! already. All triangles at an edge are split alike, so what was joined stays joined. Nothing
//! leaves the mesh's box, since vertices move only to where others are. Between the two steps
//! triangles may be dropped, which is always safe: faces between boxes are, while they are whole.

use std::cell::Cell;

use glam::{DVec3, Vec3};
use hashbrown::HashMap;
use smallvec::SmallVec;

use crate::mesh::index::Index;
use crate::mesh::surface::patch::NONE;
use crate::numeric::mesh::{GAP_LENGTH, GAP_ROOM};

/// Boxes and vertices that are looked at for each edge, on average over all edges, at most.
const MOST_LOOKS: usize = 256;

/// Where two triangles go on from their edge in directions of which the cosine is at most this, the
/// edge is left alone: it lies in the plane of both, and no crack comes of it.
const STRAIGHT: f64 = -0.9999;

/// The vertices at which edges are split, from the lesser end to the greater.
type Chains = HashMap<[u32; 2], SmallVec<[u32; 4]>>;

/// How far a vertex moves in each step.
fn half_of(gap: f64) -> f64 {
    gap * 0.5 * (1.0 - GAP_ROOM)
}

/// The first step: the triangles with other numbers of the same positions, without those of which
/// two corners come together. Where triangles hide from their front only (`front`), those that
/// turned by more than a right angle are dropped.
///
/// Costs the vertices.
pub(super) fn join(positions: &[Vec3], triangles: &[[u32; 3]], gap: f64, front: bool) -> Vec<[u32; 3]> {
    let moved = moved(positions, half_of(gap));
    let made = triangles.iter().map(|t| (*t, t.map(|v| moved[v as usize])));
    let kept = |&(old, new): &_| has_corners(&new) && !(front && is_turned(positions, old, new));
    made.filter(kept).map(|(_, new)| new).collect()
}

/// The second step. Returns whether any edge is split. Triangles are dropped as in the first.
///
/// Costs n log n for n triangles. Where it takes more looks than are allowed, some edges are not
/// split, and where more triangles would come of it than there were, none is.
pub(super) fn split_near(positions: &[Vec3], triangles: &mut Vec<[u32; 3]>, gap: f64, front: bool) -> bool {
    let chains = chains(positions, triangles, half_of(gap));
    if chains.is_empty() {
        return false;
    }
    let mut all = Vec::with_capacity(triangles.len());
    for &old in &*triangles {
        fan(old, &chains, |new| {
            if !(front && is_turned(positions, old, new)) {
                all.push(new);
            }
        });
    }
    *triangles = all;
    true
}

/// Whether the front of a triangle became its back.
fn is_turned(positions: &[Vec3], old: [u32; 3], new: [u32; 3]) -> bool {
    normal(positions, old).dot(normal(positions, new)) <= 0.0
}

/// Whether no two corners are equal.
fn has_corners(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

fn normal(positions: &[Vec3], t: [u32; 3]) -> DVec3 {
    let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
    (b - a).cross(c - a)
}

/// For each vertex, the number of the vertex that it moves to, or its own: the nearest of those
/// before it that stay, within a distance.
///
/// Vertices that stay are farther than the distance from each other, so that a cell of the grid has
/// a few dozen of them at most, whatever is given.
fn moved(positions: &[Vec3], distance: f64) -> Vec<u32> {
    let scale = 0.5 / distance;
    let cell = |p: DVec3| (p * scale).floor().to_array().map(|c| (c + 0.0).to_bits());
    let mut last_of: HashMap<[u64; 3], u32> = HashMap::new();
    // The vertex before it in its cell.
    let mut before = vec![NONE; positions.len()];
    let mut moved = Vec::with_capacity(positions.len());
    for (p, v) in positions.iter().map(|p| p.as_dvec3()).zip(0u32..) {
        let (low, high) = (cell(p - distance), cell(p + distance));
        let mut nearest = (distance * distance, v);
        for corner in 0..8usize {
            // Where both are the same cell, it is asked once.
            if (0..3).any(|axis| corner >> axis & 1 == 1 && low[axis] == high[axis]) {
                continue;
            }
            let key = [0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { high[axis] } else { low[axis] });
            let mut other = last_of.get(&key).copied().unwrap_or(NONE);
            while other != NONE {
                let found = (positions[other as usize].as_dvec3().distance_squared(p), other);
                if found < nearest {
                    nearest = found;
                }
                other = before[other as usize];
            }
        }
        if nearest.1 == v {
            before[v as usize] = last_of.insert(cell(p), v).unwrap_or(NONE);
        }
        moved.push(nearest.1);
    }
    moved
}

/// Edges of triangles in order, each with the number of these. Those within a plane are left
/// out.
fn open_edges(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<([u32; 2], usize)> {
    let sides = |&[a, b, c]: &[u32; 3]| [(a, b, c), (b, c, a), (c, a, b)];
    let mut all: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    all.extend(triangles.iter().flat_map(sides).map(|(a, b, tip)| ([a.min(b), a.max(b)], tip)));
    all.sort_unstable();
    let is_straight = |beside: &[([u32; 2], u32)]| {
        let &[(ends, one), (_, two)] = beside else { return false };
        let [a, b] = ends.map(|v| positions[v as usize].as_dvec3());
        let along = (b - a).normalize_or_zero();
        let [one, two] = [one, two].map(|tip| {
            let p = positions[tip as usize].as_dvec3() - a;
            (p - along * along.dot(p)).normalize_or_zero()
        });
        one.dot(two) <= STRAIGHT
    };
    let around = all.chunk_by(|a, b| a.0 == b.0).filter(|beside| !is_straight(beside));
    around.map(|beside| (beside[0].0, beside.len())).collect()
}

/// Finds the vertices near edges.
fn chains(positions: &[Vec3], triangles: &[[u32; 3]], distance: f64) -> Chains {
    let mut chains = Chains::new();
    let edges = open_edges(positions, triangles);
    let mut corners: Vec<u32> = edges.iter().flat_map(|edge| edge.0).collect();
    corners.sort_unstable();
    corners.dedup();
    let point = |i: u32| positions[corners[i as usize] as usize];
    let index = Index::new(corners.len(), &|i| [point(i); 3]);
    let looks = Cell::new(MOST_LOOKS * edges.len());
    let mut more = 0;
    let mut found: Vec<(f64, f64, u32)> = Vec::new();
    for (ends, around) in edges {
        let segment = ends.map(|v| positions[v as usize].as_dvec3());
        let reach = distance - GAP_LENGTH * segment[0].distance(segment[1]);
        found.clear();
        let is_near = |low: DVec3, high: DVec3| {
            looks.set(looks.get().saturating_sub(1));
            passes(segment, low - distance, high + distance)
        };
        let is_over = index.any(is_near, |i| {
            looks.set(looks.get().saturating_sub(1));
            if let Some((share, apart)) = foot(segment, point(i).as_dvec3())
                && apart <= reach
            {
                found.push((share, apart, corners[i as usize]));
            }
            looks.get() == 0
        });
        if is_over {
            break;
        }
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        found.dedup_by_key(|f| f.0);
        if !found.is_empty() {
            more += found.len() * around;
            chains.insert(ends, found.iter().map(|f| f.2).collect());
        }
        if more > triangles.len() {
            return Chains::new();
        }
    }
    chains
}

/// Where a point's foot lies strictly between the ends of a segment: its share of the way, and how
/// far it is.
fn foot([a, b]: [DVec3; 2], p: DVec3) -> Option<(f64, f64)> {
    let share = (p - a).dot(b - a) / (b - a).length_squared();
    (share > 0.0 && share < 1.0).then(|| (share, (p - a - (b - a) * share).length()))
}

/// Whether a segment may pass a box.
fn passes([a, b]: [DVec3; 2], low: DVec3, high: DVec3) -> bool {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let along = b[axis] - a[axis];
        if along == 0.0 {
            if a[axis] < low[axis] || a[axis] > high[axis] {
                return false;
            }
            continue;
        }
        let (one, two) = ((low[axis] - a[axis]) / along, (high[axis] - a[axis]) / along);
        (from, to) = (from.max(one.min(two)), to.min(one.max(two)));
    }
    from <= to
}

/// Cuts a triangle at the vertices of its edges.
fn fan(triangle: [u32; 3], chains: &Chains, mut made: impl FnMut([u32; 3])) {
    // With each, which of its sides are whole edges, which may be cut.
    let mut open: SmallVec<[([u32; 3], [bool; 3]); 8]> = SmallVec::new();
    open.push((triangle, [true; 3]));
    while let Some((t, whole)) = open.pop() {
        let cut = (0..3).filter(|&side| whole[side]).find_map(|side| {
            let (a, b) = (t[side], t[(side + 1) % 3]);
            chains.get(&[a.min(b), a.max(b)]).map(|chain| (side, a, b, chain))
        });
        let Some((side, a, b, chain)) = cut else {
            made(t);
            continue;
        };
        let [next, tip] = [1, 2].map(|turn| (side + turn) % 3);
        let mut last = a;
        let mut add = |v: u32| {
            let is_whole = [false, v == b && whole[next], last == a && whole[tip]];
            if has_corners(&[last, v, t[tip]]) {
                open.push(([last, v, t[tip]], is_whole));
            }
            last = v;
        };
        match a < b {
            true => chain.iter().for_each(|&v| add(v)),
            false => chain.iter().rev().for_each(|&v| add(v)),
        }
        add(b);
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec2};

    use super::*;
    use crate::random::Random;

    type Soup = (Vec<Vec3>, Vec<[u32; 3]>);

    /// How far a point is from a triangle: from its plane if the foot is inside, or from a side.
    fn distance(p: DVec3, t: [DVec3; 3]) -> f64 {
        let normal = (t[1] - t[0]).cross(t[2] - t[0]);
        let sides = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
        let inside = |&(a, b): &(DVec3, DVec3)| (b - a).cross(p - a).dot(normal) > 0.0;
        if sides.iter().all(inside) {
            return (p - t[0]).dot(normal.normalize()).abs();
        }
        let from_side = |(a, b): (DVec3, DVec3)| {
            let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.distance(if share.is_nan() { a } else { a.lerp(b, share) })
        };
        sides.map(from_side).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Bricks in rows, each moved a little, in a plane that is turned.
    fn bricks(random: &mut Random, crack: f64, turn: DQuat) -> Soup {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for row in 0..4 {
            for column in 0..4 {
                let low = DVec2::new(f64::from(column) + 0.3 * f64::from(row % 2), 0.5 * f64::from(row));
                let first = positions.len() as u32;
                for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.0, 0.5)] {
                    let at = (low + DVec2::new(x, y)).extend(0.0) + random.point(crack);
                    positions.push((turn * at).as_vec3());
                }
                triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            }
        }
        (positions, triangles)
    }

    fn soup(random: &mut Random) -> Soup {
        let positions = (0..40).map(|_| random.point(1.0).as_vec3()).collect();
        let mut corner = || random.within(0.0, 39.99) as u32;
        (positions, (0..40).map(|_| [corner(), corner(), corner()]).collect())
    }

    fn close(positions: &[Vec3], triangles: &[[u32; 3]], gap: f64, front: bool) -> Vec<[u32; 3]> {
        let mut made = join(positions, triangles, gap, front);
        split_near(positions, &mut made, gap, front);
        made
    }

    /// The triangles made, each after the one that it was made from.
    fn pairs(positions: &[Vec3], triangles: &[[u32; 3]], gap: f64) -> Vec<([u32; 3], [u32; 3])> {
        let moved = moved(positions, half_of(gap));
        let joined = triangles.iter().map(|t| (*t, t.map(|v| moved[v as usize])));
        let joined: Vec<_> = joined.filter(|(_, new)| has_corners(new)).collect();
        let all: Vec<[u32; 3]> = joined.iter().map(|pair| pair.1).collect();
        let chains = chains(positions, &all, half_of(gap));
        let mut pairs = Vec::new();
        joined.iter().for_each(|&(old, new)| fan(new, &chains, |made| pairs.push((old, made))));
        let made: Vec<[u32; 3]> = pairs.iter().map(|pair| pair.1).collect();
        assert_eq!(made, close(positions, triangles, gap, false));
        pairs
    }

    fn corners(positions: &[Vec3], t: [u32; 3]) -> [DVec3; 3] {
        t.map(|v| positions[v as usize].as_dvec3())
    }

    /// How far triangles leave those that they were made from, in gaps, at some points.
    fn deviation(random: &mut Random, positions: &[Vec3], made: &[([u32; 3], [u32; 3])], gap: f64) -> f64 {
        let mut farthest = 0.0f64;
        for &(old, new) in made {
            let (old, [a, b, c]) = (corners(positions, old), corners(positions, new));
            for _ in 0..8 {
                let (u, v) = (random.within(-0.5, 1.0).max(0.0), random.within(-0.5, 1.0).max(0.0));
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                farthest = farthest.max(distance(a + (b - a) * u + (c - a) * v, old));
            }
        }
        farthest / gap
    }

    #[test]
    fn no_point_moves_farther_than_the_gap() {
        let mut random = Random::new(1);
        let (mut farthest, mut split, mut moved) = (0.0f64, 0, 0);
        for round in 0..160 {
            let turn =
                DQuat::from_euler(glam::EulerRot::XYZ, 0.3 + random.next(), random.next(), random.next());
            let gap: f64 = [0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 10.0][round % 7];
            let made = match round % 3 {
                0 => soup(&mut random),
                1 => bricks(&mut random, gap.min(0.2) * 0.3, turn),
                _ => bricks(&mut random, gap.min(0.2), turn),
            };
            let pairs = pairs(&made.0, &made.1, gap);
            split += usize::from(pairs.len() > made.1.len());
            moved += usize::from(pairs.iter().any(|(old, new)| old != new));
            farthest = farthest.max(deviation(&mut random, &made.0, &pairs, gap));
        }
        assert!(farthest <= 1.0 + 1e-6, "{farthest}");
        assert!(farthest > 0.6 && split > 40 && moved > 100, "{farthest} {split} {moved}");
    }

    #[test]
    fn each_step_takes_half_of_the_gap() {
        let deviation = |one: f32, two: f32| {
            let v = Vec3::new;
            let moved_to = [v(0.0, one, 0.0), v(10.0, one, 0.0), v(5.0, one, 8.0)];
            let apart = [v(0.0, 0.0, 0.0), v(10.0, 0.0, 0.0), v(5.0, -8.0, 0.0)];
            let near = [v(5.0, one + two, 0.0), v(3.0, 9.0, 0.0), v(7.0, 9.0, 0.0)];
            let positions = [moved_to, apart, near].concat();
            let mut farthest = 0.0f64;
            for (old, new) in pairs(&positions, &[[0, 1, 2], [3, 4, 5], [6, 7, 8]], 1.0) {
                let from = |v: u32| distance(positions[v as usize].as_dvec3(), corners(&positions, old));
                farthest = new.map(from).into_iter().fold(farthest, f64::max);
            }
            (farthest * 1000.0).round()
        };
        assert_eq!(deviation(0.499, 0.499), 998.0);
        assert_eq!(deviation(0.499, 0.501), 499.0, "edges are split");
        assert_eq!(deviation(0.501, 0.499), 499.0, "vertices move");
    }

    /// Edges of one triangle only.
    fn borders(triangles: &[[u32; 3]]) -> usize {
        let mut edges: Vec<[u32; 2]> = Vec::new();
        edges.extend(
            triangles
                .iter()
                .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)].map(|(p, q)| [p.min(q), p.max(q)])),
        );
        edges.sort_unstable();
        edges.chunk_by(|a, b| a == b).filter(|beside| beside.len() == 1).count()
    }

    #[test]
    fn rows_of_bricks_grow_together() {
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.5, 0.7, 0.2);
        let (positions, triangles) = bricks(&mut Random::new(3), 1e-3, turn);
        assert_eq!(borders(&close(&positions, &triangles, 1e-6, false)), 64);
        // 8 at both sides, 8 below and above, and 6 where rows end before others.
        assert_eq!(borders(&close(&positions, &triangles, 0.02, false)), 22);
    }

    #[test]
    fn triangles_that_turn_over_hide_nothing_from_their_front() {
        // All corners of the second one move to those of the first, which is turned the other way.
        let corners = [(-4.0, -0.09), (4.0, -0.09), (0.0, 0.06), (-4.0, 0.0), (4.0, 0.0), (0.0, -0.03)];
        let positions = corners.map(|(x, y)| Vec3::new(x, y, 0.0));
        let triangles = [[0, 1, 2], [3, 4, 5]];
        assert_eq!(close(&positions, &triangles, 0.2, false), [[0, 1, 2]; 2]);
        assert_eq!(close(&positions, &triangles, 0.2, true), [[0, 1, 2]]);
    }

    #[test]
    fn work_is_bounded() {
        let v = Vec3::new;
        // Thousands of long edges past thousands of vertices, near to each other and far apart.
        for (step, gap) in [(1e-3, 0.01), (1.0, 1e-3), (1e-3, 1e30), (1e30, 1e-30), (1e-3, 1e-40), (1.0, 1.5)]
        {
            let n = 5000u32;
            let long =
                |i: u32| [v(0.0, i as f32 * step, 0.0), v(1e30, i as f32 * step, 1.0), v(0.5, 0.0, 1.0)];
            let positions: Vec<Vec3> = (0..n).flat_map(long).collect();
            let triangles: Vec<[u32; 3]> = (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let closed = close(&positions, &triangles, gap, false);
            assert!(closed.len() <= 2 * triangles.len());
        }
        // Vertices on one line, which all long edges follow.
        let n = 5000u32;
        let on_line =
            |i: u32| [v(i as f32, 0.0, 0.0), v(i as f32, 1.0, 0.0), v((n - i) as f32 + 0.1, 0.0, 0.001)];
        let positions: Vec<Vec3> = (0..n).flat_map(on_line).collect();
        let triangles: Vec<[u32; 3]> = (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        assert_eq!(close(&positions, &triangles, 0.01, false).len(), triangles.len());
    }
}
