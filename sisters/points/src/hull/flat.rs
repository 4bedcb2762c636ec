//! Extreme points of collinear and of flat points.

use crate::numeric::turn;
use bitvec::vec::BitVec;
use glam::DVec3;
use std::cmp::Ordering;

/// The two ends of points on a line.
pub(super) fn ends(points: &[DVec3]) -> BitVec {
    let low = points.iter().copied().min_by(|a, b| order(*a, *b));
    let high = points.iter().copied().max_by(|a, b| order(*a, *b));
    points.iter().map(|&p| Some(p) == low || Some(p) == high).collect()
}

/// The corners of points in a plane, which are not collinear when seen along `axis` (Andrew 1979,
/// the monotone chain).
pub(super) fn corners(points: &[DVec3], axis: usize) -> BitVec {
    let key = |p: DVec3| DVec3::new(p[(axis + 1) % 3], p[(axis + 2) % 3], 0.0);
    let mut sorted: Vec<u32> = (0..points.len() as u32).collect();
    let at = |i: u32| points[i as usize];
    sorted.sort_unstable_by(|&a, &b| order(key(at(a)), key(at(b))).then(a.cmp(&b)));
    let mut groups = sorted.clone();
    groups.dedup_by_key(|i| at(*i));
    let mut extreme = BitVec::repeat(false, points.len());
    let mut mark = |chain: &[u32]| chain.iter().for_each(|&i| extreme.set(i as usize, true));
    mark(&chain(groups.iter().copied(), axis, points));
    mark(&chain(groups.iter().rev().copied(), axis, points));
    for pair in sorted.windows(2) {
        if at(pair[0]) == at(pair[1]) && extreme[pair[0] as usize] {
            extreme.set(pair[1] as usize, true);
        }
    }
    extreme
}

/// Half of the hull: the points in this order without those at which the way does not turn left.
fn chain(order: impl Iterator<Item = u32>, axis: usize, points: &[DVec3]) -> Vec<u32> {
    let mut chain: Vec<u32> = Vec::new();
    for i in order {
        while let [.., a, b] = chain[..] {
            if turn(axis, points[a as usize], points[b as usize], points[i as usize]) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(i);
    }
    chain
}

/// By x, then y, then z. Coordinates are finite; -0 equals 0.
fn order(a: DVec3, b: DVec3) -> Ordering {
    a.to_array().partial_cmp(&b.to_array()).unwrap_or(Ordering::Equal)
}
