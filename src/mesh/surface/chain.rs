//! Chains: the outlines of patches, simplified.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use crate::mesh::lists::Lists;
use crate::mesh::surface::grow::Patches;
use crate::mesh::surface::patch::EDGE;
use crate::mesh::surface::position::key;
use crate::mesh::surface::weld::Welded;
use crate::numeric::mesh::SLACK;

/// A chain of n points is cut at its farthest point down to this depth for each doubling of n, and
/// then at its middle. Few chains get that far: cuts at the farthest point are mostly balanced.
const DEPTH: u32 = 4;

/// Chains of up to this many points are cut at their farthest points only.
const SHORT: u32 = 16;

/// How often each patch runs along an edge, in the edge's direction less against it.
pub(crate) type Runs = SmallVec<[(u32, i32); 2]>;

/// An edge of outlines before simplification.
pub(crate) struct BorderEdge {
    ends: [u32; 2],
    runs: Runs,
}

/// A straight edge in place of a chain.
pub(crate) struct Straight {
    pub(crate) ends: [u32; 2],
    pub(crate) slack: f64,
    pub(crate) runs: Runs,
    /// Tells the chain of an open edge from others.
    pub(crate) chain: u64,
}

/// The edges of triangles that do not cancel inside a patch.
pub(crate) fn borders(mesh: &Welded, patches: &Patches) -> Vec<BorderEdge> {
    let mut borders = Vec::new();
    let mut steps: Vec<(u32, i32)> = Vec::new();
    for beside in mesh.edges.chunk_by(|a, b| a.ends == b.ends) {
        steps.clear();
        steps.extend(beside.iter().map(|edge| {
            let (t, up) = edge.run();
            let (patch, turned) = patches.of[t as usize];
            (patch, if up != turned { 1 } else { -1 })
        }));
        steps.sort_unstable();
        let sums = steps.chunk_by(|a, b| a.0 == b.0).map(|run| (run[0].0, run.iter().map(|r| r.1).sum()));
        let runs: Runs = sums.filter(|&(_, sum)| sum != 0).collect();
        if !runs.is_empty() {
            borders.push(BorderEdge { ends: beside[0].ends, runs });
        }
    }
    borders
}

/// Whether the runs are those of an edge passed in the same, or in the opposite, direction.
fn same_runs(a: &Runs, b: &Runs, opposite: bool) -> bool {
    let sign = if opposite { -1 } else { 1 };
    a.len() == b.len() && a.iter().zip(b).all(|(x, y)| x.0 == y.0 && x.1 == sign * y.1)
}

/// Replaces chains of edges between the same patches by straight ones.
pub(crate) fn simplify(mesh: &Welded, borders: &[BorderEdge], tolerance: f64) -> Vec<Straight> {
    let at =
        Lists::new(mesh.positions.len(), borders.iter().zip(0..).flat_map(|(r, i)| r.ends.map(|v| (v, i))));
    // Leaving a vertex along an edge: the other end, and whether that is against its direction.
    let leave = |border: u32, v: u32| {
        let ends = borders[border as usize].ends;
        if ends[0] == v { (ends[1], false) } else { (ends[0], true) }
    };
    let passes = |v: u32| {
        let &[a, b] = at.of(v) else { return false };
        // Arriving along one and leaving along the other.
        let (arrives_against, leaves_against) = (!leave(a, v).1, leave(b, v).1);
        same_runs(&borders[a as usize].runs, &borders[b as usize].runs, arrives_against != leaves_against)
    };
    let mut used = vec![false; borders.len()];
    let mut straight = Vec::new();
    let mut chain = Vec::new();
    let mut follow = |start: u32, first: u32, used: &mut Vec<bool>| {
        chain.clear();
        chain.push(start);
        let (mut v, mut border) = (start, first);
        loop {
            used[border as usize] = true;
            v = leave(border, v).0;
            chain.push(v);
            if v == start || !passes(v) {
                break;
            }
            let next = if at.of(v)[0] == border { at.of(v)[1] } else { at.of(v)[0] };
            if used[next as usize] {
                break;
            }
            border = next;
        }
        let against = leave(first, start).1;
        let sign = if against { -1 } else { 1 };
        let runs: Runs = borders[first as usize].runs.iter().map(|r| (r.0, sign * r.1)).collect();
        straighten(mesh, &chain, &runs, tolerance, &mut straight);
    };
    for v in 0..mesh.positions.len() as u32 {
        if at.of(v).is_empty() || passes(v) {
            continue;
        }
        for &border in at.of(v) {
            if !used[border as usize] {
                follow(v, border, &mut used);
            }
        }
    }
    // The rest are rings.
    for border in 0..borders.len() as u32 {
        if !used[border as usize] {
            follow(borders[border as usize].ends[0], border, &mut used);
        }
    }
    straight
}

fn distance_to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let d = b - a;
    let length = d.length_squared();
    let t = if length > 0.0 { ((p - a).dot(d) / length).clamp(0.0, 1.0) } else { 0.0 };
    (p - a - d * t).length()
}

/// Cuts a chain where it is farthest from a straight line, until it is close enough. For n points
/// that costs n log n: a chain that was cut too often is halved.
fn straighten(mesh: &Welded, chain: &[u32], runs: &Runs, tolerance: f64, out: &mut Vec<Straight>) {
    let at = |i: usize| mesh.positions[chain[i] as usize].as_dvec3();
    let deepest = SHORT + DEPTH * chain.len().ilog2();
    let mut spans: SmallVec<[(usize, usize, u32); 8]> = smallvec![(0, chain.len() - 1, 0)];
    while let Some((a, b, depth)) = spans.pop() {
        let (mut farthest, mut slack) = (a, 0.0f64);
        for i in a + 1..b {
            let d = distance_to_segment(at(i), at(a), at(b));
            if d > slack {
                (farthest, slack) = (i, d);
            }
        }
        // A ring must not collapse.
        let ring = chain[a] == chain[b];
        if b > a + 1 && farthest > a && (slack > tolerance || ring) {
            let cut = if depth < deepest { farthest } else { a.midpoint(b) };
            spans.extend([(cut, b, depth + 1), (a, cut, depth + 1)]);
            continue;
        }
        let chain_hash = hash(mesh, &chain[a..=b]);
        // Room for the rounding of the distances.
        let slack = if slack > 0.0 { slack * (1.0 + SLACK) } else { 0.0 };
        out.push(Straight { ends: [chain[a], chain[b]], slack, runs: runs.clone(), chain: chain_hash });
    }
}

/// A number that tells the points between a chain's ends from others, whichever end it starts at
/// (after FNV-1a, Fowler, Noll and Vo 1991, by words).
fn hash(mesh: &Welded, chain: &[u32]) -> u64 {
    let at = |i: usize| key(mesh.positions[chain[i] as usize]);
    let last = chain.len() - 1;
    let upwards = at(0) <= at(last);
    (1..last)
        .flat_map(|i| at(if upwards { i } else { last - i }))
        .fold(EDGE, |h, word| (h ^ u64::from(word)).wrapping_mul(0x100_0000_01b3).rotate_left(29))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn no_point_of_a_chain_is_farther_than_the_slack() {
        let spiral = |i: u32| {
            let angle = f64::from(i) * 0.07;
            DVec3::new(angle.cos(), angle.sin(), 0.0) * (1.0 + f64::from(i) * 0.01)
        };
        let zigzag = |i: u32| DVec3::new(f64::from(i) * 0.01, f64::from(i % 2 * (5000 - i)), 0.0);
        let wave = |i: u32| DVec3::new(f64::from(i) * 0.01, (f64::from(i) * 0.02).sin(), 0.0);
        let shapes: [&dyn Fn(u32) -> DVec3; 3] = [&spiral, &zigzag, &wave];
        for (shape, n) in shapes.iter().flat_map(|s| [2, 3, 40, 5000].map(|n| (s, n))) {
            for ring in [false, true] {
                let mut positions: Vec<Vec3> = (0..n).map(|i| shape(i).as_vec3()).collect();
                positions.push(Vec3::new(-3.0, -3.0, 1.0));
                let mesh = Welded::new(&positions, &[]);
                let mesh = Welded { positions, ..mesh };
                let mut chain: Vec<u32> = (0..n).collect();
                if ring {
                    chain.extend([n, 0]);
                }
                let mut pieces = Vec::new();
                straighten(&mesh, &chain, &Runs::new(), 0.05, &mut pieces);
                let mut at = 0;
                for piece in &pieces {
                    // Pieces follow each other from end to end.
                    assert_eq!(piece.ends[0], chain[at]);
                    let length = chain[at + 1..].iter().position(|&v| v == piece.ends[1]).unwrap() + 1;
                    let point = |v: u32| mesh.positions[v as usize].as_dvec3();
                    let [a, b] = piece.ends.map(point);
                    for &v in &chain[at..=at + length] {
                        let along = (point(v) - a).dot(b - a) / (b - a).length_squared();
                        let nearest = a + (b - a) * along.clamp(0.0, 1.0);
                        assert!(point(v).distance(nearest) <= piece.slack, "{n} {ring} {v}");
                    }
                    assert!(piece.slack <= 0.05 * 1.001 && piece.ends[0] != piece.ends[1]);
                    at += length;
                }
                assert_eq!(at, chain.len() - 1);
            }
        }
    }
}
