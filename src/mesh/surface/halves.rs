//! Halves of lists of nodes, by their places: what is bundled.

use glam::DVec3;

use crate::mesh::surface::grow::Patches;

/// A node to be bundled.
#[derive(Clone, Copy)]
pub(super) struct Item {
    /// Its middle, as [`ordered`] numbers.
    middle: [i64; 3],
    pub(super) node: u32,
}

impl Item {
    pub(super) fn new(node: u32, middle: DVec3) -> Self {
        Self { middle: middle.to_array().map(ordered), node }
    }
}

/// A number whose order is that of [`f64::total_cmp`], and back.
fn ordered(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}

fn unordered(bits: i64) -> f64 {
    f64::from_bits((bits ^ ((bits >> 63) as u64 >> 1) as i64) as u64)
}

/// Orders nodes where their places do not: patches of triangles first.
pub(super) fn rank(grown: &Patches, node: u32) -> (bool, u64, u32) {
    if (node as usize) < grown.seeds.len() {
        let (area, seed) = grown.rank(node);
        (false, area, seed)
    } else {
        (true, 0, node)
    }
}

/// Two halves of a list, along the longest axis of their middles. Lists of up to `sorted` are in
/// order.
pub(super) fn halve<'a>(all: &'a mut [Item], sorted: usize, grown: &Patches) -> [&'a mut [Item]; 2] {
    let (mut min, mut max) = ([i64::MAX; 3], [i64::MIN; 3]);
    for item in all.iter() {
        for i in 0..3 {
            (min[i], max[i]) = (min[i].min(item.middle[i]), max[i].max(item.middle[i]));
        }
    }
    match (DVec3::from(max.map(unordered)) - DVec3::from(min.map(unordered))).max_position() {
        0 => halve_along::<0>(all, sorted, grown),
        1 => halve_along::<1>(all, sorted, grown),
        _ => halve_along::<2>(all, sorted, grown),
    }
}

fn halve_along<'a, const AXIS: usize>(
    all: &'a mut [Item],
    sorted: usize,
    grown: &Patches,
) -> [&'a mut [Item]; 2] {
    let order = |a: &Item, b: &Item| {
        let places = a.middle[AXIS].cmp(&b.middle[AXIS]);
        places.then_with(|| rank(grown, a.node).cmp(&rank(grown, b.node)))
    };
    let half = all.len() / 2;
    if all.len() <= sorted {
        all.sort_unstable_by(order);
    } else {
        all.select_nth_unstable_by(half, order);
    }
    all.split_at_mut(half).into()
}
