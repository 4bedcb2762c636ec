//! Windows of finer cells: no leak at their faces, light as of fine cells, and moves.

use crate::common::{
    bits, cuboid, gathered, indirect, lamp, leak_questions, matt, on_faces, placed, room, rooms, scene,
    sheet, total, turned, wall_questions,
};
use casca_radiosity::{Cache, Grid, LightError, Scene, Settings, Window};
use glam::{Affine3A, Vec3 as V};

/// Passes end with the first that changes less than this share of the light, far below the 0.6% that
/// tests allow, and after so many.
const SETTLED: f64 = 1e-6;
const MOST_PASSES: u32 = 60;

fn around(scene: &Scene, cells: u32, windows: [Option<Window>; 2]) -> Settings {
    Settings { windows, ..Settings::new(Grid::around(&scene.objects, cells)) }
}

/// Two rooms with a wall in a face of cells, without windows, and with some whose faces lie in it,
/// before it and behind it; with and without a turn.
#[test]
fn a_sealed_room_is_dark_wherever_windows_end() {
    let walls = [0.0, 0.02, 0.25].map(|thickness| [Affine3A::IDENTITY, turned()].map(|p| (thickness, p)));
    for (thickness, place) in walls.into_iter().flatten() {
        let lights = vec![lamp(place.transform_point3(V::new(-2.0, 2.0, 0.3)), 10.0)];
        let scene = scene(placed(&rooms(thickness), place), vec![matt(0.7)], lights, 0.0);
        let mut walked: Option<Cache> = None;
        for x in [f32::NAN, -2.0, -1.0, -0.6, 0.0, 1.0, 2.0] {
            let middle = place.transform_point3(V::new(x, 1.5, 0.0));
            let outer = Window { middle, half: 1.0, finer: 2 };
            let windows = [outer, Window { half: 0.5, finer: 4, ..outer }];
            let settings = around(&scene, 20, windows.map(|window| Some(window).filter(|_| x.is_finite())));
            let anew = gathered(&scene, settings, 16);
            // Windows that moved there lead light through no wall, either.
            let mut moved = walked.take().unwrap_or_else(|| anew.clone());
            if x.is_finite() {
                moved.move_windows(middle).unwrap();
                moved.request_all();
                moved.gather(16).unwrap();
                moved.direct();
            }
            for (mut cache, how) in [(anew, "anew"), (moved, "moved")] {
                (0..8).for_each(|_| _ = cache.pass());
                let ask = |side: f32| {
                    let all = leak_questions(side, thickness).into_iter();
                    all.map(|(p, n)| total(&cache, place.transform_point3(p), place.transform_vector3(n)))
                        .collect::<Vec<f64>>()
                };
                let (bright, dark) = (ask(-1.0), ask(1.0));
                assert!(bright.iter().sum::<f64>() > 50.0, "{thickness} {x} {how}");
                let most = dark.into_iter().fold(0.0, f64::max);
                assert_eq!(most, 0.0, "{thickness} {x} {how}");
                walked = Some(cache).filter(|_| x.is_finite());
            }
        }
    }
}

/// A room with a table, of which a coarse grid knows little.
fn furnished() -> Scene {
    let mut all = room(V::ZERO, V::new(8.0, 3.0, 8.0), 0);
    all.extend(cuboid(V::new(3.1, 0.7, 3.2), V::new(4.9, 0.8, 4.7), 0));
    for (x, z) in [(3.1, 3.2), (4.8, 3.2), (3.1, 4.6), (4.8, 4.6)] {
        all.extend(cuboid(V::new(x, 0.0, z), V::new(x + 0.1, 0.7, z + 0.1), 0));
    }
    scene(all, vec![matt(0.7)], vec![lamp(V::new(4.0, 2.4, 4.0), 10.0)], 0.0)
}

/// Points of the floor below and beside the table.
fn below() -> impl Iterator<Item = V> {
    (0..100).map(|i| V::new(2.6 + 0.28 * (i % 10) as f32, 0.0, 2.7 + 0.25 * (i / 10) as f32))
}

#[test]
fn a_window_is_as_good_as_fine_cells_everywhere() {
    let scene = furnished();
    let window = Window { middle: V::new(4.0, 0.5, 4.0), half: 2.0, finer: 4 };
    let mut truth = gathered(&scene, around(&scene, 128, [None; 2]), 64);
    let mut with = gathered(&scene, around(&scene, 16, [Some(window), None]), 64);
    let mut coarse = gathered(&scene, around(&scene, 16, [None; 2]), 64);
    let [truth, with, coarse] = [&mut truth, &mut with, &mut coarse].map(|cache| {
        cache.converge(SETTLED, MOST_PASSES);
        below().map(|p| indirect(cache, p, V::Y)).collect::<Vec<_>>()
    });
    let error = |other: &[f64]| {
        let of = |(a, b): (&f64, &f64)| (a - b).abs();
        truth.iter().zip(other).map(of).sum::<f64>() / truth.iter().sum::<f64>()
    };
    println!("errors: {} with a window, {} without", error(&with), error(&coarse));
    assert!(error(&with) < 0.05 && error(&with) < 0.5 * error(&coarse));
}

fn light(cache: &mut Cache) -> Vec<[u32; 3]> {
    bits(cache, 400, V::new(8.0, 3.0, 8.0))
}

#[test]
fn windows_that_moved_are_as_if_made_anew() {
    let scene = furnished();
    let windows = |middle: V| {
        let outer = Window { middle, half: 2.0, finer: 2 };
        [Some(outer), Some(Window { half: 1.0, finer: 2, ..outer })]
    };
    let start = V::new(3.0, 1.0, 4.0);
    let mut cache = gathered(&scene, around(&scene, 24, windows(start)), 16);
    light(&mut cache);
    // It stays for small steps.
    assert_eq!(cache.move_windows(start + V::new(0.2, 0.2, 0.2)).unwrap().kept, 0);
    let (mut kept, mut dropped) = (0, 0);
    for eye in [V::new(3.7, 1.0, 4.0), V::new(4.4, 1.4, 4.6), V::new(-9e9, 1.0, 7.0)] {
        let moved = cache.move_windows(eye).unwrap();
        assert!(moved.kept > 0 && moved.sent < moved.rays / 2, "{eye} {moved:?}");
        (kept, dropped) = (kept + moved.kept, dropped + moved.dropped);
        cache.request_all();
        cache.gather(16).unwrap();
        let mut anew = gathered(&scene, around(&scene, 24, windows(eye)), 16);
        let (of_moved, of_anew) = (cache.statistics(), anew.statistics());
        assert_eq!((of_moved.gathered, of_moved.rays), (of_anew.gathered, of_anew.rays), "{eye}");
        assert_eq!(of_moved.dark_rays, of_anew.dark_rays, "{eye}");
        assert_eq!(light(&mut cache), light(&mut anew), "{eye}");
    }
    println!("{kept} states stay, {dropped} are dropped");
    assert!(kept > dropped);
    // Objects move as before.
    let chest = cuboid(V::new(1.0, 0.0, 5.0), V::new(1.7, 0.6, 6.0), 0);
    let mut more = scene.clone();
    more.objects.push(chest.into());
    let mut cache = gathered(&more, around(&scene, 24, windows(start)), 16);
    let gone = casca_radiosity::Object::default();
    cache.set_objects(vec![(1, gone.clone())]).unwrap();
    cache.move_windows(V::new(5.0, 1.0, 4.0)).unwrap();
    cache.set_objects(vec![(1, more.objects[1].clone())]).unwrap();
    cache.request_all();
    cache.gather(16).unwrap();
    let mut anew = gathered(&more, around(&scene, 24, windows(V::new(5.0, 1.0, 4.0))), 16);
    assert_eq!(light(&mut cache), light(&mut anew));
}

#[test]
fn wrong_windows_are_refused_by_name() {
    let scene = furnished();
    let good = Window { middle: V::ONE, half: 1.0, finer: 4 };
    let said = |windows: &[Window]| {
        let windows = [windows.first().copied(), windows.get(1).copied()];
        Cache::new(&scene, around(&scene, 16, windows)).map(drop).map_err(|e| e.to_string())
    };
    assert_eq!(said(&[good, Window { half: 0.3, ..good }]), Ok(()));
    let wrong: [(&[Window], &str); 8] = [
        (&[Window { finer: 3, ..good }], "window 0"),
        (&[Window { finer: 1, ..good }], "16 times at most"),
        (&[Window { finer: 32, ..good }], "16 times at most"),
        (&[good, Window { finer: 8, ..good }], "4 times at most"),
        (&[Window { middle: V::new(0.0, f32::NAN, 0.0), ..good }], "middle of window 0"),
        (&[good, Window { half: 0.0, ..good }], "window 1"),
        (&[Window { half: f32::INFINITY, ..good }], "window 0"),
        (&[Window { half: 40.0, ..good }], "window 0"),
    ];
    for (windows, word) in wrong {
        let error = said(windows).unwrap_err();
        assert!(error.contains(word), "{error}");
    }
    let mut cache = Cache::new(&scene, around(&scene, 16, [Some(good), None])).unwrap();
    assert!(matches!(cache.move_windows(V::NAN), Err(LightError::Value { .. })));
    for eye in [V::MAX, V::MIN, V::splat(1e20)] {
        cache.move_windows(eye).unwrap();
    }
    // Without a window nothing moves.
    let mut cache = Cache::new(&scene, around(&scene, 16, [None; 2])).unwrap();
    assert_eq!(cache.move_windows(V::splat(100.0)).unwrap().kept, 0);
}

/// Beside a wall under the sky, light falls from cell to cell. Two floors in one room of cells of
/// the same size, as a grid and as a window, show it alike.
#[test]
fn light_between_cells_of_a_window_is_as_between_those_of_a_grid() {
    let mut all = sheet(V::ZERO, V::Z * 4.0, V::X * 4.0, 0);
    all.extend(cuboid(V::new(1.9, 0.0, 0.0), V::new(2.1, 1.3, 4.0), 0));
    let scene = scene(all, vec![matt(0.2)], vec![], 1.0);
    let ask = |cells, windows| {
        let grid = Grid { min: V::splat(-0.25), max: V::new(4.25, 4.25, 4.25), cells };
        let mut cache = gathered(&scene, Settings { windows, ..Settings::new(grid) }, 512);
        cache.converge(SETTLED, MOST_PASSES);
        let at = |i: usize| V::new(2.12 + 1.7 * i as f32 / 60.0, 0.0, 1.0 + (i as f32 * 0.618).fract());
        (0..60).map(|i| indirect(&cache, at(i), V::Y)).collect::<Vec<_>>()
    };
    let truth = ask(36, [None; 2]);
    let found = ask(9, [Some(Window { middle: V::splat(2.0), half: 9.0, finer: 4 }), None]);
    let error = truth.iter().zip(&found).map(|(a, b)| (a - b).abs()).sum::<f64>() / truth.iter().sum::<f64>();
    println!("beside a wall: {error}");
    assert!(error < 0.006, "{error}");
}

#[test]
fn walls_in_the_faces_of_windows_have_their_states() {
    let scene = on_faces();
    for x in [1.0, 1.5, 3.0, 3.5] {
        let window = Window { middle: V::new(x, 3.0, 3.0), half: 1.0, finer: 2 };
        let cache = gathered(&scene, around(&scene, 16, [Some(window), None]), 16);
        assert_eq!(cache.statistics().dark_rays, 0, "{x}");
        for (point, normal) in wall_questions() {
            assert!(cache.irradiance(point, normal).unwrap().states > 0, "{x}: {point}");
        }
    }
}
