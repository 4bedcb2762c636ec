//! Chains: the outlines of patches, simplified.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::mesh::surface::patch::Patches;
use crate::mesh::surface::weld::{Welded, key};
use crate::mesh::surface::{Cluster, NONE, Patch, Rules, Side, Surface};

/// Patches in a cluster, at most.
const CLUSTER: usize = 12;

/// A chain of n points is cut at its farthest point down to this depth for each doubling of n, and then at its middle. Few
/// chains get that far: cuts at the farthest point are mostly balanced.
const DEPTH: u32 = 4;

/// Chains of up to this many points are cut at their farthest points only.
const SHORT: u32 = 16;

/// How often each patch runs along an edge, in the edge's direction less against it.
type Runs = SmallVec<[(u32, i32); 2]>;

/// An edge of outlines before simplification.
struct Rim {
    ends: [u32; 2],
    runs: Runs,
}

/// A straight edge in place of a chain.
struct Straight {
    ends: [u32; 2],
    slack: f64,
    runs: Runs,
    /// Tells the chain of an open edge from others.
    chain: u64,
}

/// The outlines of all patches.
pub(crate) fn outline(mesh: &Welded, patches: &Patches, rules: &Rules) -> Surface {
    let rims = rims(mesh, patches);
    let straight = simplify(mesh, &rims, rules.tolerance);
    gather(mesh, patches, &straight, rules)
}

/// The edges of triangles that do not cancel inside a patch.
fn rims(mesh: &Welded, patches: &Patches) -> Vec<Rim> {
    let mut rims = Vec::new();
    let mut steps: Vec<(u32, i32)> = Vec::new();
    for beside in mesh.edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        steps.clear();
        steps.extend(beside.iter().map(|&(_, _, t, up)| {
            let (patch, turned) = patches.of[t as usize];
            (patch, if up != turned { 1 } else { -1 })
        }));
        steps.sort_unstable();
        let sums = steps.chunk_by(|a, b| a.0 == b.0).map(|run| (run[0].0, run.iter().map(|r| r.1).sum()));
        let runs: Runs = sums.filter(|&(_, sum)| sum != 0).collect();
        if !runs.is_empty() {
            rims.push(Rim { ends: [beside[0].0, beside[0].1], runs });
        }
    }
    rims
}

/// Whether the runs are those of an edge passed in the same, or in the opposite, direction.
fn same_runs(a: &Runs, b: &Runs, opposite: bool) -> bool {
    let sign = if opposite { -1 } else { 1 };
    a.len() == b.len() && a.iter().zip(b).all(|(x, y)| x.0 == y.0 && x.1 == sign * y.1)
}

/// Replaces chains of edges between the same patches by straight ones.
fn simplify(mesh: &Welded, rims: &[Rim], tolerance: f64) -> Vec<Straight> {
    let mut at: Vec<SmallVec<[u32; 2]>> = vec![SmallVec::new(); mesh.positions.len()];
    for (i, rim) in rims.iter().enumerate() {
        for v in rim.ends {
            at[v as usize].push(i as u32);
        }
    }
    // Leaving a vertex along an edge: the other end, and whether that is against its direction.
    let leave = |rim: u32, v: u32| {
        let ends = rims[rim as usize].ends;
        if ends[0] == v { (ends[1], false) } else { (ends[0], true) }
    };
    let passes = |v: u32| {
        let &[a, b] = at[v as usize].as_slice() else { return false };
        // Arriving along one and leaving along the other.
        let (arrives_against, leaves_against) = (!leave(a, v).1, leave(b, v).1);
        same_runs(&rims[a as usize].runs, &rims[b as usize].runs, arrives_against != leaves_against)
    };
    let mut used = vec![false; rims.len()];
    let mut straight = Vec::new();
    let mut follow = |start: u32, first: u32, used: &mut Vec<bool>| {
        let mut chain = vec![start];
        let (mut v, mut rim) = (start, first);
        loop {
            used[rim as usize] = true;
            v = leave(rim, v).0;
            chain.push(v);
            if v == start || !passes(v) {
                break;
            }
            let next = if at[v as usize][0] == rim { at[v as usize][1] } else { at[v as usize][0] };
            if used[next as usize] {
                break;
            }
            rim = next;
        }
        let against = leave(first, start).1;
        let sign = if against { -1 } else { 1 };
        let runs: Runs = rims[first as usize].runs.iter().map(|r| (r.0, sign * r.1)).collect();
        straighten(mesh, &chain, &runs, tolerance, &mut straight);
    };
    for v in 0..mesh.positions.len() as u32 {
        if at[v as usize].is_empty() || passes(v) {
            continue;
        }
        for &rim in &at[v as usize] {
            if !used[rim as usize] {
                follow(v, rim, &mut used);
            }
        }
    }
    // What is left are rings.
    for rim in 0..rims.len() as u32 {
        if !used[rim as usize] {
            follow(rims[rim as usize].ends[0], rim, &mut used);
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

/// Cuts a chain where it is farthest from a straight line, until it is close enough. For n points that costs n
/// log n: what has been cut too often is halved.
fn straighten(mesh: &Welded, chain: &[u32], runs: &Runs, tolerance: f64, out: &mut Vec<Straight>) {
    let at = |i: usize| mesh.positions[chain[i] as usize].as_dvec3();
    let deepest = SHORT + DEPTH * chain.len().ilog2();
    let mut spans = vec![(0, chain.len() - 1, 0)];
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
        let slack = if slack > 0.0 { slack * (1.0 + 1e-6) } else { 0.0 };
        out.push(Straight { ends: [chain[a], chain[b]], slack, runs: runs.clone(), chain: chain_hash });
    }
}

/// A number that tells the points between a chain's ends from others, whichever end it starts at
/// (after FNV-1a, Fowler, Noll and Vo 1991, by words).
fn hash(mesh: &Welded, chain: &[u32]) -> u64 {
    let at = |i: usize| key(mesh.positions[chain[i] as usize]);
    let last = chain.len() - 1;
    let upwards = at(0) <= at(last);
    (1..last).flat_map(|i| at(if upwards { i } else { last - i })).fold(0xcbf2_9ce4_8422_2325, |h, word| {
        (h ^ u64::from(word)).wrapping_mul(0x100_0000_01b3).rotate_left(29)
    })
}

/// Puts patches together that lie together: orders those of a range, and adds its clusters.
fn cluster(order: &mut [u32], middles: &[DVec3], first: u32, out: &mut Vec<(u32, u32)>) {
    if order.len() <= CLUSTER {
        out.push((first, first + order.len() as u32));
        return;
    }
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &p in order.iter() {
        (min, max) = (min.min(middles[p as usize]), max.max(middles[p as usize]));
    }
    let axis = (max - min).max_position();
    let half = order.len() / 2;
    order.sort_by(|&a, &b| {
        let place = |p: u32| middles[p as usize][axis];
        place(a).total_cmp(&place(b)).then(a.cmp(&b))
    });
    let (low, high) = order.split_at_mut(half);
    cluster(low, middles, first, out);
    cluster(high, middles, first + half as u32, out);
}

/// Puts each directed edge after one that ends where it starts, as far as that goes.
fn in_rings(outline: &mut Vec<u32>, straight: &[Straight]) {
    let ends = |d: u32| {
        let [a, b] = straight[(d >> 1) as usize].ends;
        if d & 1 == 0 { (a, b) } else { (b, a) }
    };
    // By their starts, backwards, so that the last of each start is free.
    let mut rest: HashMap<u32, Vec<u32>> = HashMap::with_capacity(outline.len());
    for &d in outline.iter().rev() {
        rest.entry(ends(d).0).or_default().push(d);
    }
    let starts: Vec<u32> = outline.iter().map(|&d| ends(d).0).collect();
    outline.clear();
    for start in starts {
        let mut at = start;
        while let Some(next) = rest.get_mut(&at).and_then(Vec::pop) {
            outline.push(next);
            at = ends(next).1;
        }
    }
}

/// The patches that run along an edge.
enum Beside {
    One,
    /// Two of them, and whether they run in opposite directions.
    Two([u32; 2], bool),
    /// None, more than two, or one several times.
    More,
}

impl Beside {
    fn new(edge: &Straight, number: &[u32]) -> Self {
        let mut kept = edge.runs.iter().map(|r| (number[r.0 as usize], r.1)).filter(|r| r.0 != NONE);
        match (kept.next(), kept.next(), kept.next()) {
            (Some((_, x)), None, None) if x.abs() == 1 => Self::One,
            (Some((p, x)), Some((q, y)), None) if x.abs() == 1 && y.abs() == 1 => Self::Two([p, q], x == -y),
            _ => Self::More,
        }
    }
}

/// Patches with their slabs, boxes and outlines, in clusters.
fn gather(mesh: &Welded, grown: &Patches, straight: &[Straight], rules: &Rules) -> Surface {
    let count = grown.normals.len();
    let mut spans = vec![(f64::INFINITY, f64::NEG_INFINITY); count];
    let mut boxes = vec![(Vec3::INFINITY, Vec3::NEG_INFINITY); count];
    for (t, &(patch, _)) in grown.of.iter().enumerate() {
        for v in mesh.triangles[t] {
            let p = mesh.positions[v as usize];
            let (span, around) = (&mut spans[patch as usize], &mut boxes[patch as usize]);
            let along = grown.normals[patch as usize].dot(p.as_dvec3());
            *span = (span.0.min(along), span.1.max(along));
            *around = (around.0.min(p), around.1.max(p));
        }
    }
    let mut outlines: Vec<Vec<u32>> = vec![Vec::new(); count];
    for (i, edge) in straight.iter().enumerate() {
        for &(patch, steps) in &edge.runs {
            let directed = 2 * i as u32 + u32::from(steps < 0);
            outlines[patch as usize].extend((0..steps.abs()).map(|_| directed));
        }
    }
    outlines.iter_mut().for_each(|outline| in_rings(outline, straight));
    let radius = |p: usize| crate::mesh::surface::radius(boxes[p].0, boxes[p].1);
    let mut order: Vec<u32> = (0..count as u32)
        .filter(|&p| radius(p as usize) >= rules.least && !outlines[p as usize].is_empty())
        .collect();
    let middles: Vec<DVec3> = boxes.iter().map(|b| (b.0.as_dvec3() + b.1.as_dvec3()) * 0.5).collect();
    let mut ranges = Vec::new();
    if !order.is_empty() {
        cluster(&mut order, &middles, 0, &mut ranges);
    }
    let mut number = vec![NONE; count];
    for (new, &old) in order.iter().enumerate() {
        number[old as usize] = new as u32;
    }

    // What lies at each edge, of what is kept.
    let beside: Vec<Beside> = straight.iter().map(|edge| Beside::new(edge, &number)).collect();
    let sine = (1.0 - rules.cosine * rules.cosine).max(0.0).sqrt();
    let mut surface = Surface { front: rules.front.then_some(sine), ..Surface::default() };
    for &old in &order {
        let patch = number[old as usize];
        let old = old as usize;
        let first = surface.sides.len() as u32;
        for &directed in &outlines[old] {
            let edge = &straight[(directed >> 1) as usize];
            let ends = edge.ends.map(|v| mesh.positions[v as usize]);
            let [from, to] = if directed & 1 == 0 { ends } else { [ends[1], ends[0]] };
            let (twin, opposite) = match beside[(directed >> 1) as usize] {
                Beside::Two([p, q], opposite) => (if p == patch { q } else { p }, opposite),
                Beside::One => {
                    surface.open.push((surface.sides.len() as u32, edge.chain));
                    (NONE, false)
                }
                Beside::More => (NONE, false),
            };
            let slack = if edge.slack > 0.0 { (edge.slack as f32).next_up() } else { 0.0 };
            surface.sides.push(Side { from, to, slack, twin, opposite });
        }
        let (lo, hi) = spans[old];
        let room = 1e-12 * f64::from(boxes[old].0.abs().max(boxes[old].1.abs()).max_element());
        surface.patches.push(Patch {
            first,
            last: surface.sides.len() as u32,
            normal: grown.normals[old],
            lo: lo - room,
            hi: hi + room,
            min: boxes[old].0,
            max: boxes[old].1,
            slack: crate::mesh::surface::slack(&surface.sides[first as usize..]),
        });
    }
    for (first, last) in ranges {
        surface.clusters.push(Cluster::new(first, last, &surface.patches));
    }
    surface
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::surface::patch::grow;

    fn rules(tolerance: f64) -> Rules {
        Rules { tolerance, cosine: 0.2, least: 0.0, front: false }
    }

    /// A comb: a ridge with long teeth, ever shorter.
    fn comb(n: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let x = |i: u32| i as f32 * 0.05;
        let mut p: Vec<Vec3> = (0..=n).map(|i| Vec3::new(x(i), 0.0, 0.0)).collect();
        p.extend((0..=n).map(|i| Vec3::new(x(i), -1.0, 0.0)));
        p.extend((0..n).map(|i| Vec3::new(x(i) + 0.025, 4000.0 - 2000.0 * i as f32 / n as f32, 0.0)));
        let (low, tip) = (n + 1, 2 * n + 2);
        let tooth = |i: u32| [[i, i + 1, tip + i], [i + 1, i, low + i], [i + 1, low + i, low + i + 1]];
        (p, (0..n).flat_map(tooth).collect())
    }

    #[test]
    fn long_zigzags_are_cut_evenly() {
        let (p, t) = comb(20_000);
        let surface = Surface::new(&p, &t, &rules(2.5));
        // Always cut at the farthest point, each tooth would keep its two sides.
        let (sides, teeth) = (surface.sides.len(), 20_000);
        assert!(surface.patches.len() == 1 && sides > 100 && sides < teeth, "{sides}");
    }

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

    #[test]
    fn thousands_of_triangles_share_an_edge_or_a_vertex() {
        let n = 20_000u32;
        let around = |i: u32| {
            let angle = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            DVec3::new(5.0 * angle.cos(), 5.0 * angle.sin(), 1.0).as_vec3()
        };
        let mut p = vec![Vec3::ZERO, Vec3::Z * 3.0];
        p.extend((0..n).map(around));
        // Where more than two meet, each is a patch of its own, and none hides the edge.
        let leaves: Vec<[u32; 3]> = (0..n).map(|i| [0, 1, i + 2]).collect();
        let surface = Surface::new(&p, &leaves, &rules(0.01));
        assert_eq!((surface.patches.len(), surface.sides.len()), (n as usize, 3 * n as usize));
        assert!(surface.sides.iter().all(|s| s.twin == NONE && !s.opposite));
        // A cone around the vertex is one ring of patches.
        let cone: Vec<[u32; 3]> = (0..n).map(|i| [0, i + 2, (i + 1) % n + 2]).collect();
        let welded = Welded::new(&p, &cone);
        let patches = grow(&welded, &rules(0.01));
        let surface = outline(&welded, &patches, &rules(0.01));
        assert!(surface.patches.len() < 20 && surface.sides.len() < 500, "{}", surface.sides.len());
    }
}
