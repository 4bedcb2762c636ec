//! Halves of lists of nodes, by their places: what is bundled.

use glam::DVec3;
use smallvec::SmallVec;

use crate::mesh::surface::grow::Patches;

/// Longer lists are divided at guesses of their middle first.
const LONG: usize = 128;

/// How many entries, about evenly spaced, give a guess.
const SAMPLE: usize = 31;

/// Guesses that may be wrong before the rest is left to the standard library.
const GUESSES: usize = 12;

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
        let (rest, nth) = narrowed::<AXIS>(all, half);
        rest.select_nth_unstable_by(nth, order);
    }
    all.split_at_mut(half).into()
}

/// Moves entries until those before a short part of the list are less than those in it, and those
/// behind are greater: the part, and where in it the entry of a rank is.
fn narrowed<const AXIS: usize>(mut all: &mut [Item], mut nth: usize) -> (&mut [Item], usize) {
    for _ in 0..GUESSES {
        if all.len() <= LONG {
            break;
        }
        let step = all.len() / SAMPLE;
        let mut sample: SmallVec<[i64; SAMPLE]> =
            (0..SAMPLE).map(|i| all[i * step + step / 2].middle[AXIS]).collect();
        sample.sort_unstable();
        // On the side of the rank on which less is left, so that most is done.
        let rank = nth * SAMPLE / all.len();
        let guess = if 2 * nth >= all.len() { rank.saturating_sub(2) } else { rank + 2 };
        let pivot = sample[guess.min(SAMPLE - 1)];
        let mut low = 0;
        for at in 0..all.len() {
            let is_less = all[at].middle[AXIS] < pivot;
            all.swap(at, low);
            low += usize::from(is_less);
        }
        if low <= nth {
            all = &mut all[low..];
            nth -= low;
        } else {
            all = &mut all[..low];
        }
    }
    (all, nth)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn the_part_that_is_left_holds_the_entry_of_the_rank() {
        let mut random = Random::new(4);
        for round in 0..200 {
            let count = 1 + (random.next() * 3000.0) as usize;
            // Many equal places, few, or none.
            let steps = [3.0, 100.0, 1e9][round % 3];
            let place = |_| DVec3::splat((random.next() * steps).floor());
            let mut all: Vec<Item> = (0..count).map(place).map(|p| Item::new(0, p)).collect();
            let mut sorted: Vec<i64> = all.iter().map(|item| item.middle[1]).collect();
            sorted.sort_unstable();
            for nth in [0, count / 3, count / 2, count - 1] {
                let (part, within) = narrowed::<1>(&mut all, nth);
                let mut own: Vec<i64> = part.iter().map(|item| item.middle[1]).collect();
                own.sort_unstable();
                assert_eq!(own[within], sorted[nth]);
                let first = nth - within;
                assert_eq!(own, sorted[first..first + own.len()], "{count} {nth}");
                let mut rest: Vec<i64> = all.iter().map(|item| item.middle[1]).collect();
                assert!(rest[..first].iter().all(|&m| m <= sorted[first]));
                rest.sort_unstable();
                assert_eq!(rest, sorted, "none is lost");
            }
        }
    }
}
