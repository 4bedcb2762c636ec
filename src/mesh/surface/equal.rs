//! Equal positions.

use glam::Vec3;
use hashbrown::HashMap;

use crate::mesh::surface::position::key;

/// For each position, the place of the first that is equal to it.
pub(crate) fn first_of_equals(positions: &[Vec3]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    positions.iter().zip(0..).map(|(p, place)| *first.entry(key(*p)).or_insert(place)).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::random::Random;

    #[test]
    fn the_first_of_equals_is_found_however_many_there_are() {
        let mut random = Random::new(9);
        for count in [0, 1, 2, 3, 100, 8192] {
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
