//! Equal positions.

use std::hash::BuildHasher;

use glam::Vec3;
use hashbrown::DefaultHashBuilder;

use crate::mesh::surface::position::key;

/// Buckets get about this many positions, until there are as many buckets as a processor writes to
/// at a time.
const BUCKET: usize = 8192;
const MOST_BUCKETS: usize = 256;

/// A position with its place and a hash.
#[derive(Clone, Copy, Default)]
struct Entry {
    key: [u32; 3],
    place: u32,
    hash: u32,
}

/// For each position, the place of the first that is equal to it.
///
/// Positions are dealt to buckets by a hash first, so that the table of each bucket stays in the
/// processor's cache.
pub(crate) fn first_of_equals(positions: &[Vec3]) -> Vec<u32> {
    let hasher = DefaultHashBuilder::default();
    let entry = |(p, place): (&Vec3, u32)| {
        let key @ [x, y, z] = key(*p);
        let hash = hasher.hash_one((u64::from(x) << 32 | u64::from(y), z));
        Entry { key, place, hash: (hash >> 32) as u32 }
    };
    let mut first = vec![0; positions.len()];
    let mut table = Vec::new();
    let buckets = (positions.len() / BUCKET).next_power_of_two().min(MOST_BUCKETS);
    if buckets == 1 {
        let entries: Vec<Entry> = positions.iter().zip(0..).map(entry).collect();
        find(&entries, &mut table, &mut first);
        return first;
    }
    let hashes: Vec<u32> = positions.iter().zip(0..).map(|p| entry(p).hash).collect();
    let bucket = |hash: u32| hash as usize & (buckets - 1);
    let mut ends = vec![0usize; buckets + 1];
    hashes.iter().for_each(|&hash| ends[bucket(hash) + 1] += 1);
    for i in 1..ends.len() {
        ends[i] += ends[i - 1];
    }
    let mut dealt = vec![Entry::default(); positions.len()];
    for ((p, &hash), place) in positions.iter().zip(&hashes).zip(0..) {
        let end = &mut ends[bucket(hash)];
        dealt[*end] = Entry { key: key(*p), place, hash };
        *end += 1;
    }
    let mut start = 0;
    for &end in &ends[..buckets] {
        find(&dealt[start..end], &mut table, &mut first);
        start = end;
    }
    first
}

/// Finds the first of equals among entries, which come in the order of their places. The memory of
/// the table is used again.
fn find(entries: &[Entry], table: &mut Vec<u32>, first: &mut [u32]) {
    const NONE: u32 = u32::MAX;
    // At most half of it is taken. The lower bits of the hashes of a bucket are equal.
    let bits = (2 * entries.len()).next_power_of_two().trailing_zeros().max(1);
    table.clear();
    table.resize(1 << bits, NONE);
    for (own, number) in entries.iter().zip(0..) {
        let mut at = (own.hash >> (u32::BITS - bits)) as usize;
        first[own.place as usize] = loop {
            match table[at] {
                NONE => {
                    table[at] = number;
                    break own.place;
                }
                other => {
                    let other = &entries[other as usize];
                    if other.hash == own.hash && other.key == own.key {
                        break other.place;
                    }
                }
            }
            at = (at + 1) & (table.len() - 1);
        };
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::random::Random;

    #[test]
    fn the_first_of_equals_is_found_however_many_there_are() {
        let mut random = Random::new(9);
        for count in [0, 1, 2, 3, 100, BUCKET, 5 * BUCKET] {
            let mut coordinate = || (random.within(-0.5, 0.5) * 20.0).round() as f32;
            let positions: Vec<Vec3> =
                (0..count).map(|_| Vec3::new(coordinate(), coordinate(), coordinate())).collect();
            let mut known = BTreeMap::new();
            // Zeros are equal.
            let key = |p: &Vec3| p.to_array().map(|c| (c * 2.0) as i32);
            let wanted: Vec<u32> =
                positions.iter().zip(0..).map(|(p, i)| *known.entry(key(p)).or_insert(i)).collect();
            assert_eq!(first_of_equals(&positions), wanted, "{count}");
        }
    }
}
