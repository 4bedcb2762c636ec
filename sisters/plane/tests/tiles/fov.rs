//! Which tiles are seen.

use std::collections::BTreeSet;

use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles, TilePoint};
use glam::Vec2;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use crate::cases::cases;
use crate::maps::{drawn, map_and_eye, point};
use crate::oracle::{Oracle, UNIT};

/// What the library sees.
fn seen(map: &BitGrid, eye: TilePoint, options: &FovOptions) -> BTreeSet<(u32, u32)> {
    let mut fov = FieldOfView::new();
    let seen = fov.run(&OpaqueTiles::new(map.clone()), eye, options).cells().collect();
    let (columns, rows) = fov.bounds();
    assert!(fov.seen().cells().all(|(x, y)| columns.contains(&x) && rows.contains(&y)));
    seen
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn exactly_the_tiles_that_rays_reach((map, eye) in map_and_eye()) {
        let truth = Oracle { opaque: &map, eye }.seen();
        prop_assert_eq!(seen(&map, point(eye), &FovOptions::default()), truth);
    }

    #[test]
    fn ranges_take_away_the_tiles_beyond((map, eye) in map_and_eye(), eighths in 1..90_i128) {
        let oracle = Oracle { opaque: &map, eye };
        let options = FovOptions::default().in_circle(eighths as f32 / 8.0).unwrap();
        let range = eighths * UNIT / 8;
        let truth: BTreeSet<_> = oracle.seen().into_iter().filter(|&tile| oracle.in_range(tile, range)).collect();
        prop_assert_eq!(seen(&map, point(eye), &options), truth);
    }

    #[test]
    fn sectors_take_away_the_directions_outside(
        (map, eye) in map_and_eye(),
        middle in -3.2..3.2_f32,
        half in 0.01..3.5_f32,
    ) {
        // Rays this much inside are seen for certain, rays this much outside are not.
        const DOUBT: f64 = 1e-6;
        let toward = Vec2::from_angle(middle);
        let middle = f64::from(toward.y).atan2(f64::from(toward.x));
        let limits = [-DOUBT, DOUBT].map(|doubt| f64::from(half) + doubt);
        let direction = |angle: f64| [angle.cos(), angle.sin()].map(|part| (part * (1u64 << 40) as f64) as i128);
        let bounds: Vec<_> = limits.iter().flat_map(|limit| [middle - limit, middle + limit]).map(direction).collect();
        let oracle = Oracle { opaque: &map, eye };
        let mut truth = [BTreeSet::new(), BTreeSet::new()];
        for ray in oracle.directions(&bounds) {
            let turn = (ray[1] as f64).atan2(ray[0] as f64) - middle;
            let turn = turn.sin().atan2(turn.cos()).abs();
            for (truth, limit) in truth.iter_mut().zip(limits) {
                if turn < limit {
                    truth.extend(oracle.tiles_along(ray));
                }
            }
        }
        let found = seen(&map, point(eye), &FovOptions::default().in_sector(toward, half).unwrap());
        prop_assert!(truth[0].is_subset(&found), "misses {:?}", truth[0].difference(&found));
        prop_assert!(found.is_subset(&truth[1]), "adds {:?}", found.difference(&truth[1]));
    }

    #[test]
    fn numbers_of_all_sizes_are_taken(
        (map, eye) in map_and_eye(),
        far in proptest::array::uniform2(prop_oneof![Just(0.0), any::<f64>(), -4294967296.0..4294967296.0]),
        radius: f32,
        direction in proptest::array::uniform2(any::<f32>()),
        half: f32,
    ) {
        let [x, y] = eye.map(|at| at as f64 / UNIT as f64);
        let Ok(eye) = TilePoint::new(x + far[0], y + far[1]) else { return Ok(()) };
        let options = FovOptions::default();
        let options = options.in_circle(radius).unwrap_or(options);
        let options = options.in_sector(Vec2::from(direction), half).unwrap_or(options);
        let all = seen(&map, eye, &FovOptions::default());
        prop_assert!(seen(&map, eye, &options).is_subset(&all));
    }

    #[test]
    fn runs_leave_nothing_behind((first, eye_1) in map_and_eye(), (second, eye_2) in map_and_eye(), radius in 0.1..20.0_f32) {
        let options = FovOptions::default().in_circle(radius).unwrap();
        let maps = [OpaqueTiles::new(first), OpaqueTiles::new(second)];
        let mut kept = FieldOfView::new();
        for (map, eye) in [(0, eye_1), (1, eye_2), (1, eye_1), (0, eye_2)] {
            let seen = kept.run(&maps[map], point(eye), &options);
            let mut fresh = FieldOfView::new();
            prop_assert_eq!(seen, fresh.run(&maps[map], point(eye), &options));
        }
    }

    #[test]
    fn tiles_that_change_are_as_new((map, eye) in map_and_eye(), changes in proptest::collection::vec((0..12_u32, 0..12_u32), 0..9)) {
        let (mut bits, mut changed) = (map.clone(), OpaqueTiles::new(map));
        for (x, y) in changes {
            let opaque = !bits.get(x, y);
            bits.set(x, y, opaque);
            changed.set(x, y, opaque);
        }
        let seen = |tiles: &OpaqueTiles| FieldOfView::new().run(tiles, point(eye), &FovOptions::default()).clone();
        prop_assert_eq!(seen(&changed), seen(&OpaqueTiles::new(bits)));
    }
}

/// On large maps, each ray of many finds only tiles that are seen, and each tile that is seen is on
/// some ray to it.
#[test]
fn words_and_long_rows_agree_with_rays() {
    let mut random = Pcg32::seed_from_u64(7);
    for (width, height, stones) in [(70, 90, 160), (200, 66, 900), (130, 64, 2500)] {
        let mut map = BitGrid::new(width, height);
        let mut tile = || [random.random_range(0..width), random.random_range(0..height)];
        for [x, y] in (0..stones).map(|_| tile()) {
            map.set(x, y, true);
        }
        let eye = tile().map(|at| i128::from(at) * UNIT + UNIT / 2);
        let oracle = Oracle { opaque: &map, eye };
        assert_eq!(seen(&map, point(eye), &FovOptions::default()), oracle.seen());
    }
}

#[test]
fn eyes_on_walls_and_in_walls() {
    let map = drawn(&["....", ".##.", "...."]);
    let seen = |x, y| seen(&map, TilePoint::new(x, y).unwrap(), &FovOptions::default());
    // On the lower side of a wall: the wall, and all that is not above.
    let below = seen(1.5, 1.0);
    assert!(below.contains(&(1, 1)) && below.contains(&(3, 0)));
    assert!(!below.contains(&(2, 1)) && !below.contains(&(0, 2)) && !below.contains(&(1, 2)));
    // Inside of a wall: that tile blocks nothing, but its neighbour does.
    let inside = seen(1.5, 1.5);
    assert!(inside.contains(&(1, 1)) && inside.contains(&(0, 1)) && inside.contains(&(2, 1)));
    assert!(!inside.contains(&(3, 1)));
    // On the border of two walls: only these.
    assert_eq!(seen(2.0, 1.5), BTreeSet::from([(1, 1), (2, 1)]));
    // On a corner of the wall: three of four quarters are free.
    let corner = seen(1.0, 2.0);
    assert!(corner.contains(&(1, 1)) && corner.contains(&(0, 1)) && corner.contains(&(1, 2)));
    assert!(!corner.contains(&(2, 1)) && !corner.contains(&(2, 0)));
}

#[test]
fn eyes_far_outside_and_empty_maps() {
    let (options, far) = (FovOptions::default(), 1e5);
    let map = drawn(&["....", ".##.", "...."]);
    for (x, y) in [(far, 1.5), (-far, 1.5), (1.5, far), (far, -far), (-far, -far), (far, far), (-7.25, 1e6)] {
        let eye = TilePoint::new(x, y).unwrap();
        let truth = Oracle { opaque: &map, eye: [x, y].map(|at| (at * UNIT as f64) as i128) }.seen();
        assert_eq!(seen(&map, eye, &options), truth, "from ({x}, {y})");
    }
    for (width, height) in [(0, 0), (0, 5), (5, 0)] {
        assert!(seen(&BitGrid::new(width, height), TilePoint::center_of(0, 0), &options).is_empty());
    }
    let farthest = (1_u64 << 32) as f64;
    let left = seen(&map, TilePoint::new(-farthest, 1.5).unwrap(), &options);
    assert!(left.contains(&(1, 1)) && !left.contains(&(3, 1)));
    assert!(TilePoint::new(farthest + 1.0, 0.0).is_err() && TilePoint::new(f64::NAN, 0.0).is_err());
    assert_eq!(seen(&map, TilePoint::center_of(u32::MAX, u32::MAX), &options).len(), 10);
}

#[test]
fn options_are_checked() {
    let options = FovOptions::default();
    for radius in [0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
        assert!(options.in_circle(radius).is_err());
        assert!(options.in_sector(Vec2::X, radius).is_err());
    }
    for direction in [Vec2::ZERO, Vec2::NAN, Vec2::new(f32::INFINITY, 0.0)] {
        assert!(options.in_sector(direction, 1.0).is_err());
    }
    assert_eq!(options.in_circle(f32::INFINITY), Ok(options));
    assert_eq!(options.in_sector(Vec2::splat(1e-40), f32::INFINITY), Ok(options));
    // Tiny sectors still hold the direction that they are about.
    let row = BitGrid::new(9, 1);
    let ahead = options.in_sector(Vec2::X, f32::MIN_POSITIVE).unwrap();
    assert_eq!(seen(&row, TilePoint::center_of(4, 0), &ahead).len(), 5);
}
