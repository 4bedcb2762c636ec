//! Splitting edges of triangles at vertices that lie on them: boxes that abut, panels of a wall.
//!
//! Where the corner of one face lies on an edge of another, the two share no edge, and a seam stays
//! open between them. Split at that corner, they do. Only edges along an axis are split: there,
//! coordinates in single precision tell exactly what lies on an edge, and walls mostly stand so.
//! The triangles cover the same points as before.

use glam::Vec3;
use hashbrown::HashMap;
use smallvec::SmallVec;

use crate::mesh::surface::position::key;

/// The vertices on one line along an axis, in order.
type Line = Vec<(f32, u32)>;

/// The lines along one axis, by the bits of the two other coordinates.
type Lines = HashMap<[u32; 2], Line>;

/// The two other coordinates of a position, as keys.
fn beside(p: Vec3, axis: usize) -> [u32; 2] {
    let key = key(p);
    [key[(axis + 1) % 3], key[(axis + 2) % 3]]
}

/// The axis along which an edge runs, if it does.
fn axis_of(a: Vec3, b: Vec3) -> Option<usize> {
    (0..3).find(|&axis| beside(a, axis) == beside(b, axis))
}

/// The lines along each axis that hold an edge, with all vertices on them.
fn lines(positions: &[Vec3], triangles: &[[u32; 3]]) -> [Lines; 3] {
    let mut lines: [Lines; 3] = Default::default();
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (p, q) = (positions[from as usize], positions[to as usize]);
            if let Some(axis) = axis_of(p, q) {
                lines[axis].entry(beside(p, axis)).or_default();
            }
        }
    }
    for (axis, lines) in lines.iter_mut().enumerate().filter(|(_, lines)| !lines.is_empty()) {
        for (&p, v) in positions.iter().zip(0..) {
            if let Some(line) = lines.get_mut(&beside(p, axis)) {
                line.push((p[axis], v));
            }
        }
        lines.values_mut().for_each(|line| line.sort_unstable_by(|a, b| a.0.total_cmp(&b.0)));
    }
    lines
}

/// The vertices strictly between the ends of an edge, from the lesser to the greater coordinate,
/// and whether the edge runs so.
fn between<'a>(positions: &[Vec3], lines: &'a [Lines; 3], from: u32, to: u32) -> (&'a [(f32, u32)], bool) {
    let (p, q) = (positions[from as usize], positions[to as usize]);
    let Some(axis) = axis_of(p, q) else { return (&[], true) };
    let Some(line) = lines[axis].get(&beside(p, axis)) else { return (&[], true) };
    let (low, high) = (p[axis].min(q[axis]), p[axis].max(q[axis]));
    let first = line.partition_point(|v| v.0 <= low);
    let last = line.partition_point(|v| v.0 < high);
    (line.get(first..last).unwrap_or(&[]), p[axis] < q[axis])
}

/// Splits the triangles whose edges pass through vertices. Returns whether there are any.
///
/// Costs the vertices and triangles. Where more triangles would come of it than there were, as of
/// many long edges on one line, nothing is split.
pub(super) fn split(positions: &[Vec3], triangles: &mut Vec<[u32; 3]>) -> bool {
    let lines = lines(positions, triangles);
    if lines.iter().all(|lines| lines.values().all(|line| line.len() <= 2)) {
        return false;
    }
    let count = |&[a, b, c]: &[u32; 3]| {
        [(a, b), (b, c), (c, a)].map(|(p, q)| between(positions, &lines, p, q).0.len()).iter().sum::<usize>()
    };
    let more = triangles.iter().map(count).sum::<usize>();
    if more == 0 || more > triangles.len() {
        return false;
    }
    let mut all = Vec::with_capacity(triangles.len() + more);
    let mut open: SmallVec<[[u32; 3]; 8]> = SmallVec::new();
    for triangle in &*triangles {
        open.push(*triangle);
        while let Some(t) = open.pop() {
            let cut = (0..3).find_map(|side| {
                let (a, b) = (t[side], t[(side + 1) % 3]);
                let (points, up) = between(positions, &lines, a, b);
                (!points.is_empty()).then_some((a, b, t[(side + 2) % 3], points, up))
            });
            let Some((a, b, tip, points, up)) = cut else {
                all.push(t);
                continue;
            };
            // A fan from the corner beyond the edge; its outer sides may be cut, too.
            let mut last = a;
            let mut add = |v: u32| {
                if last != tip && v != tip {
                    open.push([last, v, tip]);
                }
                last = v;
            };
            match up {
                true => points.iter().for_each(|p| add(p.1)),
                false => points.iter().rev().for_each(|p| add(p.1)),
            }
            add(b);
        }
    }
    *triangles = all;
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the area of triangles.
    fn area(positions: &[Vec3], triangles: &[[u32; 3]]) -> f32 {
        let corner = |v: u32| positions[v as usize];
        triangles.iter().map(|&[a, b, c]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).z).sum()
    }

    #[test]
    fn edges_are_split_at_the_vertices_on_them() {
        // A square of two triangles; above it two rectangles, beside it a corner in the middle.
        let positions: Vec<Vec3> = [
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 4.0),
            (0.0, 4.0),
            (1.5, 4.0),
            (2.5, 4.0),
            (4.0, 1.0),
            (2.0, 2.0),
            (-0.0, 9.0),
        ]
        .map(|(x, y)| Vec3::new(x, y, 0.0))
        .to_vec();
        let square = [[0, 1, 2], [0, 2, 3]];
        let mut triangles = square.to_vec();
        // Enough triangles that the limit allows it.
        triangles.push([3, 4, 8]);
        let before = area(&positions, &triangles);
        assert!(split(&positions, &mut triangles));
        assert_eq!(area(&positions, &triangles), before);
        let has = |from: u32, to: u32| {
            let sides = triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
            sides.filter(|&side| side == (from, to)).count()
        };
        for (from, to) in [(1, 6), (6, 2), (2, 5), (5, 4), (4, 3), (3, 0), (0, 1)] {
            assert_eq!(has(from, to), 1, "{from} {to}");
        }
        assert_eq!((has(1, 2), has(2, 3), has(0, 2)), (0, 0, 1), "slanted edges stay");
        assert!(triangles.iter().all(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
        assert!(!split(&positions, &mut triangles), "the second time nothing is left");
    }

    #[test]
    fn triangles_without_area_vanish() {
        let mut positions = [0.0, 1.0, 2.0, 7.0].map(|x| Vec3::new(x, 0.0, 0.0)).to_vec();
        positions.extend([Vec3::Y, Vec3::ONE]);
        let mut triangles = vec![[0, 2, 1], [0, 1, 3], [0, 1, 2], [4, 5, 0], [5, 4, 3]];
        assert!(split(&positions, &mut triangles));
        assert!(triangles.iter().all(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
        assert!(triangles.contains(&[4, 5, 0]) && triangles.contains(&[5, 4, 3]));
    }

    #[test]
    fn many_edges_on_one_line_are_left_alone() {
        let n = 3000u32;
        let mut positions: Vec<Vec3> = (0..n).map(|i| Vec3::new(i as f32, 0.0, 0.0)).collect();
        positions.push(Vec3::Y);
        let mut triangles: Vec<[u32; 3]> = (1..n).map(|i| [0, i, n]).collect();
        let before = triangles.clone();
        assert!(!split(&positions, &mut triangles));
        assert_eq!(triangles, before);
    }
}
