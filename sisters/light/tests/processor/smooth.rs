//! Light that is smoothed for pictures.

use crate::common::{cuboid, indirect, lamp, leak_questions, lit, matt, room, rooms, scene};
use casca_radiosity::{Cache, Grid, Scene, Settings};
use glam::Vec3 as V;

/// A room of 4 x 3 x 2 metres with a lamp near a corner.
fn cache(rays: u32) -> Cache {
    let walls = room(V::ZERO, V::new(4.0, 3.0, 2.0), 0);
    lit(&scene(walls, vec![matt(0.6)], vec![lamp(V::new(0.4, 2.7, 0.4), 10.0)], 0.0), 24, rays, 10)
}

/// The light of points on its floor and a wall.
fn ask(cache: &Cache) -> Vec<f64> {
    let of = |i: usize| {
        let (u, v) = ((i as f32 + 0.5) / 200.0, (i as f32 * 0.618 + 0.3).fract());
        match i % 2 {
            0 => indirect(cache, V::new(0.3 + 3.4 * u, 0.0, 0.2 + 1.6 * v), V::Y),
            _ => indirect(cache, V::new(4.0, 0.2 + 2.6 * u, 0.2 + 1.6 * v), -V::X),
        }
    };
    (0..200).map(of).collect()
}

/// The root of the mean square of differences over the mean.
fn apart(found: &[f64], known: &[f64]) -> f64 {
    let squares = found.iter().zip(known).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    (squares / known.len() as f64).sqrt() / (known.iter().sum::<f64>() / known.len() as f64)
}

#[test]
fn means_take_away_most_of_the_noise() {
    let known = ask(&cache(1024));
    let mut few = cache(24);
    let raw = ask(&few);
    few.smooth(2);
    let (before, after) = (apart(&raw, &known), apart(&ask(&few), &known));
    println!("{before} to {after}");
    assert!(after < 0.6 * before, "{before} to {after}");
    // Other means start from the light as it is, and so does the next pass.
    few.smooth(0);
    assert_eq!(ask(&few), raw);
    few.smooth(2);
    let (smoothed, _) = (ask(&few), few.converge(1.0, 1));
    // Converging smooths as well: only a pass more has changed it.
    assert!(apart(&ask(&few), &smoothed) < 0.02 && apart(&ask(&few), &raw) > 0.05);
    few = cache(24);
    few.smooth(2);
    few.pass();
    let mut other = cache(24);
    other.pass();
    assert_eq!(ask(&few), ask(&other));
}

#[test]
fn no_mean_reaches_through_a_wall() {
    for thickness in [0.0, 0.02, 0.1] {
        let lights = vec![lamp(V::new(-2.0, 2.0, 0.3), 10.0)];
        let mut cache = lit(&scene(rooms(thickness), vec![matt(0.7)], lights, 0.0), 24, 16, 4);
        cache.smooth(4);
        for (point, normal) in leak_questions(1.0, thickness) {
            assert_eq!(indirect(&cache, point, normal), 0.0, "{thickness} {point}");
        }
        let bright: f64 = leak_questions(-1.0, thickness).iter().map(|(p, n)| indirect(&cache, *p, *n)).sum();
        assert!(bright > 10.0);
    }
}

#[test]
fn links_that_are_found_part_by_part_are_those_found_at_once() {
    // A thin board: links across it are cut, although all around stays.
    let board = |at: V| cuboid(at, at + V::new(0.02, 0.9, 1.2), 0);
    let objects = vec![room(V::ZERO, V::new(4.0, 3.0, 2.0), 0).into(), board(V::new(0.3, 0.0, 0.4)).into()];
    let s = Scene { objects, ..scene(vec![], vec![matt(0.6)], vec![lamp(V::new(2.0, 2.5, 1.0), 5.0)], 0.0) };
    let settings = Settings::new(Grid::around(&s.objects, 20));
    let ended = |smooths: bool| {
        let mut cache = Cache::new(&s, settings).unwrap();
        let smooth = |cache: &mut Cache| (0..u32::from(smooths)).for_each(|_| cache.smooth(1));
        smooth(&mut cache);
        cache.request(V::new(2.0, 0.0, 1.0), V::Y).unwrap();
        for _ in 0..40 {
            cache.gather_part((16, 8), 50).unwrap();
            smooth(&mut cache);
        }
        for i in 1..6 {
            cache.set_objects(vec![(1, board(V::new(0.3 + 0.45 * i as f32, 0.0, 0.4)).into())]).unwrap();
            smooth(&mut cache);
            cache.gather(8).unwrap();
            smooth(&mut cache);
        }
        cache.direct();
        cache.darken();
        (0..5).for_each(|_| _ = cache.pass());
        cache.smooth(3);
        ask(&cache)
    };
    let (parts, whole) = (ended(true), ended(false));
    assert!(whole.iter().sum::<f64>() > 1.0);
    assert_eq!(parts, whole);
}
