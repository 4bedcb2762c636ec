//! Patches gathered from grown triangles and straight edges: slabs, boxes, outlines and clusters.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::mesh::surface::chain::Straight;
use crate::mesh::surface::grow::Patches;
use crate::mesh::surface::patch::{Cluster, NONE, Patch, Rules, Side, Surface, radius, slack};
use crate::mesh::surface::weld::Welded;
use crate::numeric::mesh::SLAB;

/// Patches in a cluster, at most.
const CLUSTER: usize = 12;

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
pub(crate) fn gather(mesh: &Welded, grown: &Patches, straight: &[Straight], rules: &Rules) -> Surface {
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
    let radius_of = |p: usize| radius(boxes[p].0, boxes[p].1);
    let mut order: Vec<u32> = (0..count as u32)
        .filter(|&p| radius_of(p as usize) >= rules.least && !outlines[p as usize].is_empty())
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

    // The patches at each edge, of those that are kept.
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
        let room = SLAB * f64::from(boxes[old].0.abs().max(boxes[old].1.abs()).max_element());
        surface.patches.push(Patch {
            first,
            last: surface.sides.len() as u32,
            normal: grown.normals[old],
            lo: lo - room,
            hi: hi + room,
            min: boxes[old].0,
            max: boxes[old].1,
            slack: slack(&surface.sides[first as usize..]),
        });
    }
    for (first, last) in ranges {
        surface.clusters.push(Cluster::new(first, last, &surface.patches));
    }
    surface
}
