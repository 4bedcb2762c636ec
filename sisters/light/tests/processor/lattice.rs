//! Sealed boxes with walls, lamps and neighbours on a lattice: in faces of cells, in one plane, and
//! on each other's edges.

use crate::common::{cuboid, gathered, lamp, matt, room, scene, total};
use casca_radiosity::{Grid, Settings};
use casca_truth::cases;
use glam::Vec3 as V;
use proptest::prelude::*;

/// The side of the room, in metres.
const SIDE: f32 = 6.0;

/// Whole coordinates.
fn whole(least: i32, most: i32) -> impl Strategy<Value = V> + Clone {
    let coordinate = (least..=most).prop_map(|i| i as f32);
    [coordinate.clone(), coordinate.clone(), coordinate].prop_map(V::from)
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn no_light_enters_a_sealed_box(
        (min, size) in (whole(1, 3), whole(1, 2)),
        lamps in prop::collection::vec(whole(0, 12), 1..5),
        others in prop::collection::vec((whole(0, 5), whole(0, 2)), 0..4),
        cells in prop_oneof![Just(6_u32), Just(12), Just(15)],
    ) {
        let max = min + size;
        let mut walls = room(V::ZERO, V::splat(SIDE), 0);
        walls.extend(cuboid(min, max, 0));
        // Some touch the box, some have no height.
        walls.extend(others.iter().flat_map(|&(at, size)| cuboid(at, (at + size).min(V::splat(SIDE)), 0)));
        let outside = |p: &V| p.cmplt(min).any() || p.cmpgt(max).any();
        let lamps: Vec<_> = lamps.iter().map(|p| p / 2.0).filter(outside).map(|p| lamp(p, 9.0)).collect();
        let s = scene(walls, vec![matt(0.7)], lamps, 3.0);
        let grid = Grid { min: V::ZERO, max: V::splat(SIDE), cells };
        let mut cache = gathered(&s, Settings::new(grid), 16);
        (0..4).for_each(|_| _ = cache.pass());
        for (axis, i, k) in (0..3).flat_map(|axis| (1..4).flat_map(move |i| (1..4).map(move |k| (axis, i, k)))) {
            for (at, sign) in [(min, 1.0), (max, -1.0)] {
                let (mut point, mut normal) = (at, V::ZERO);
                normal[axis] = sign;
                for (across, share) in [((axis + 1) % 3, i), ((axis + 2) % 3, k)] {
                    point[across] = min[across] + size[across] * share as f32 / 4.0;
                }
                let light = total(&cache, point, normal);
                prop_assert!(light == 0.0, "{light} at {point} of {min} to {max}, {cells} cells");
            }
        }
    }
}
