//! Convex shells that are open on one side, such as cones without a base: solids inside them hide
//! what lies beyond them.
//!
//! Let a flat lid close the opening of a shell, so that both together are a convex mesh, and let a
//! point lie in the solid that [`convex_solid`] finds inside it, and farther from the lid's plane
//! than the lid's corners. Both rays of any line through the point leave the closed mesh, and only
//! one of them can reach the lid. So the other one meets the shell: each line through the solid
//! meets it, somewhere within the hull of its corners. The part of a line that lies before the hull
//! or beyond it meets the shell, too, if it passes the solid in between.

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::mesh::convex::convex_solid;
use crate::shape::{Convex, MAX_CONVEX};

/// Shells of a mesh that are drawn, at most: the largest ones.
const MOST: usize = 8;

/// Meshes of more triangles are not searched: leaves and hair.
const MOST_TRIANGLES: usize = 1 << 14;

/// No vertex.
const NONE: u32 = u32::MAX;

/// The shells of a mesh.
#[derive(Debug, Clone, Default)]
pub(crate) struct MeshShells {
    /// The solids inside them, the largest first.
    pub(crate) solids: Vec<Convex>,
    /// The share of the area of the mesh that is not of these shells.
    pub(crate) gap: f64,
}

/// The shells of a mesh. `first` names the first position that is equal to each. Costs the
/// triangles times the corners of a shell.
pub(super) fn open_shells(positions: &[Vec3], triangles: &[[u32; 3]], first: &[u32]) -> MeshShells {
    let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize].as_dvec3());
    let area = |triangles: &[[u32; 3]]| -> f64 {
        triangles.iter().map(corners).map(|[a, b, c]| (b - a).cross(c - a).length()).sum()
    };
    // Volume, area and solid.
    let mut shells: Vec<(f64, f64, Convex)> = Vec::new();
    let (order, ends) = pieces(triangles, first);
    let mut start = 0;
    for end in ends {
        let piece = &order[std::mem::replace(&mut start, end)..end];
        // One or two triangles hold nothing, with a lid that is flat.
        if !(3..=2 * MAX_CONVEX).contains(&piece.len()) {
            continue;
        }
        let Some(lid) = lid(piece, positions) else { continue };
        let closed: Vec<[u32; 3]> = piece.iter().chain(&lid.triangles).copied().collect();
        let volume: f64 = closed.iter().map(corners).map(|[a, b, c]| a.dot(b.cross(c))).sum();
        if let Some(solid) = convex_solid(positions, &closed, volume.signum(), lid.room) {
            shells.push((solid.volume(), area(piece), solid));
        }
    }
    if shells.is_empty() {
        return MeshShells { gap: 1.0, ..MeshShells::default() };
    }
    shells.sort_by(|a, b| b.0.total_cmp(&a.0));
    shells.truncate(MOST);
    let share = shells.iter().map(|shell| shell.1).sum::<f64>() / area(triangles);
    MeshShells { solids: shells.into_iter().map(|shell| shell.2).collect(), gap: (1.0 - share).max(0.0) }
}

/// Whether a mesh is searched for shells.
pub(super) fn may_have_shells(triangles: &[[u32; 3]]) -> bool {
    triangles.len() <= MOST_TRIANGLES
}

/// The triangles in connected pieces, whose corners are numbered by position, and where each piece
/// ends.
fn pieces(triangles: &[[u32; 3]], first: &[u32]) -> (Vec<[u32; 3]>, Vec<usize>) {
    // The vertex that stands for those at its place: the first one that a triangle names.
    let mut numbers = vec![NONE; first.len()];
    let mut number = |v: u32| {
        let number = &mut numbers[first[v as usize] as usize];
        if *number == NONE {
            *number = v;
        }
        *number
    };
    let triangles: Vec<[u32; 3]> = triangles
        .iter()
        .map(|t| t.map(&mut number))
        .filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
        .collect();
    let mut parents: Vec<u32> = (0..first.len() as u32).collect();
    for &[a, b, c] in &triangles {
        for other in [b, c] {
            let (p, q) = (root(&mut parents, a), root(&mut parents, other));
            parents[p.max(q) as usize] = p.min(q);
        }
    }
    let of: Vec<u32> = triangles.iter().map(|t| root(&mut parents, t[0])).collect();
    let mut counts = vec![0usize; first.len()];
    of.iter().for_each(|&piece| counts[piece as usize] += 1);
    let (mut ends, mut reached) = (Vec::new(), 0);
    for count in counts.iter_mut().filter(|count| **count > 0) {
        let start = reached;
        reached += std::mem::replace(count, start);
        ends.push(reached);
    }
    let mut order = vec![[0; 3]; triangles.len()];
    for (t, &piece) in triangles.iter().zip(&of) {
        let place = &mut counts[piece as usize];
        order[*place] = *t;
        *place += 1;
    }
    (order, ends)
}

fn root(parents: &mut [u32], mut v: u32) -> u32 {
    while parents[v as usize] != v {
        parents[v as usize] = parents[parents[v as usize] as usize];
        v = parents[v as usize];
    }
    v
}

/// A flat lid on an opening.
struct Lid {
    triangles: Vec<[u32; 3]>,
    /// Points that lie by this much in the hull of the piece are farther from the plane of the lid
    /// than its corners.
    room: f64,
}

/// The lid of a piece with one opening; `None` if it has none or several, or if its triangles are
/// not wound alike.
fn lid(piece: &[[u32; 3]], positions: &[Vec3]) -> Option<Lid> {
    let mut edges: SmallVec<[(u32, u32); 96]> = SmallVec::new();
    edges.extend(piece.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]));
    edges.sort_unstable();
    if edges.windows(2).any(|w| w[0] == w[1]) {
        return None;
    }
    // The lid runs along the open edges in the other direction.
    let open = edges.iter().filter(|&&(a, b)| edges.binary_search(&(b, a)).is_err());
    let mut after: SmallVec<[(u32, u32); 32]> = open.map(|&(a, b)| (b, a)).collect();
    after.sort_unstable();
    if after.windows(2).any(|w| w[0].0 == w[1].0) {
        return None;
    }
    let &(first, mut next) = after.first()?;
    let mut ring = vec![first];
    while next != first {
        if ring.len() == after.len() {
            return None;
        }
        ring.push(next);
        next = after[after.binary_search_by_key(&next, |edge| edge.0).ok()?].1;
    }
    if ring.len() != after.len() || ring.len() < 3 {
        return None;
    }
    let corners: Vec<DVec3> = ring.iter().map(|&v| positions[v as usize].as_dvec3()).collect();
    let fan = |i: usize| (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
    let normal = (1..corners.len() - 1).map(fan).sum::<DVec3>().try_normalize()?;
    let height = |v: &u32| normal.dot(positions[*v as usize].as_dvec3() - corners[0]);
    // The piece lies on one side of the lid; no point of its hull is farther on the other side.
    let sum: f64 = piece.iter().flatten().map(height).sum();
    let outwards = |v: &u32| if sum > 0.0 { -height(v) } else { height(v) };
    let low = ring.iter().map(outwards).fold(f64::INFINITY, f64::min);
    let high = piece.iter().flatten().map(outwards).fold(f64::NEG_INFINITY, f64::max);
    let triangles = (1..ring.len() - 1).map(|i| [ring[0], ring[i], ring[i + 1]]).collect();
    // Twice, for rounding.
    Some(Lid { triangles, room: 2.0 * (high - low) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::surface::first_of_equals;
    use crate::random::Random;

    fn open_shells(positions: &[Vec3], triangles: &[[u32; 3]]) -> MeshShells {
        super::open_shells(positions, triangles, &first_of_equals(positions))
    }

    /// A cone with this number of sides, without its base.
    fn cone(sides: u32, radius: f32, low: f32, high: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let rim = |i: u32| {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / sides as f32).sin_cos();
            Vec3::new(cos * radius, low, sin * radius)
        };
        let mut positions: Vec<Vec3> = (0..sides).map(rim).collect();
        positions.push(Vec3::Y * high);
        (positions, (0..sides).map(|i| [i, sides, (i + 1) % sides]).collect())
    }

    fn meets(t: [DVec3; 3], from: DVec3, along: DVec3) -> bool {
        let side = |a: DVec3, b: DVec3| (a - from).cross(b - from).dot(along);
        let sides = [side(t[0], t[1]), side(t[1], t[2]), side(t[2], t[0])];
        sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
    }

    #[test]
    fn every_line_through_the_solid_meets_the_shell() {
        let mut random = Random::new(3);
        for sides in [3, 5, 9, 20] {
            let (positions, triangles) = cone(sides, 2.0, 0.5, 3.0);
            let shells = open_shells(&positions, &triangles);
            assert_eq!((shells.solids.len(), shells.gap), (1, 0.0), "{sides}");
            let solid = &shells.solids[0];
            let base = 0.5 * f64::from(sides) * (std::f64::consts::TAU / f64::from(sides)).sin() * 4.0;
            let whole = base * 2.5 / 3.0;
            assert!(
                solid.volume() > 0.99 * whole && solid.volume() < 1.000_001 * whole,
                "{}",
                solid.volume()
            );
            let middle = solid.middle();
            for _ in 0..3000 {
                // Points of the solid, most of them near its surface.
                let corner = solid.vertices[(random.next() * solid.vertices.len() as f64) as usize];
                let other = solid.vertices[(random.next() * solid.vertices.len() as f64) as usize];
                let p = corner.lerp(other, random.next()).lerp(middle, random.next().powi(4));
                let along = random.point(1.0);
                let hit =
                    triangles.iter().any(|t| meets(t.map(|v| positions[v as usize].as_dvec3()), p, along));
                assert!(hit, "{sides}: {p} {along}");
            }
        }
    }

    #[test]
    fn shells_with_two_openings_or_dents_have_no_solid() {
        let (mut positions, mut triangles) = cone(8, 2.0, 0.0, 3.0);
        triangles.pop();
        assert!(open_shells(&positions, &triangles).solids.is_empty(), "its opening is not flat");
        let (_, triangles) = cone(8, 2.0, 0.0, 3.0);
        positions[3].y += 0.8;
        assert!(open_shells(&positions, &triangles).solids.is_empty(), "nor is this one");
        positions[3].y = 0.0;
        positions[3] *= 0.5;
        assert!(open_shells(&positions, &triangles).solids.is_empty(), "a dent");
        // A tube: each end is open.
        let ring = |y: f32| (0..6).map(move |i| Vec3::new((i as f32).cos(), y, (i as f32).sin()));
        let positions: Vec<Vec3> = ring(0.0).chain(ring(2.0)).collect();
        let side = |i: u32| {
            let j = (i + 1) % 6;
            [[i, i + 6, j + 6], [i, j + 6, j]]
        };
        let tube: Vec<[u32; 3]> = (0..6).flat_map(side).collect();
        assert!(open_shells(&positions, &tube).solids.is_empty());
        // Closed at one end, it is a cup.
        let cup: Vec<[u32; 3]> = tube.iter().copied().chain((1..5).map(|i| [6, 6 + i + 1, 6 + i])).collect();
        let turned: Vec<[u32; 3]> = tube.into_iter().chain((1..5).map(|i| [6, 6 + i, 6 + i + 1])).collect();
        let count = |triangles: &[[u32; 3]]| open_shells(&positions, triangles).solids.len();
        assert_eq!(count(&cup) + count(&turned), 1);
    }

    #[test]
    fn the_shells_of_a_tree_are_found_one_by_one() {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..12 {
            let (p, t) = cone(8, 2.0 - 0.1 * i as f32, i as f32, i as f32 + 2.0);
            let first = positions.len() as u32;
            positions.extend(p);
            triangles.extend(t.into_iter().map(|t| t.map(|v| v + first)));
        }
        let MeshShells { solids: shells, gap } = open_shells(&positions, &triangles);
        assert_eq!(shells.len(), MOST);
        assert!(gap > 0.2 && gap < 0.3, "four of twelve are left, the smaller ones: {gap}");
        assert!(shells.windows(2).all(|w| w[0].volume() >= w[1].volume()));
    }
}
