//! Work in parts ends in the same light.

use crate::common::{cuboid, lamp, lit, matt, room, scene};
use casca_radiosity::{Cache, Grid, LightError, Object, Scene, Settings};
use glam::Vec3 as V;

/// A room with two boxes and a lamp.
fn furnished(boxes: [V; 2]) -> Scene {
    let mut objects = vec![Object::from(room(V::ZERO, V::new(4.0, 3.0, 4.0), 0))];
    objects.extend(boxes.map(|at| Object::from(cuboid(at, at + V::new(0.5, 0.7, 0.4), 0))));
    let lights = vec![lamp(V::new(2.0, 2.4, 1.9), 10.0)];
    Scene { objects, ..scene(vec![], vec![matt(0.6)], lights, 0.3) }
}

const BOXES: [V; 2] = [V::new(1.0, 0.0, 2.0), V::new(2.5, 0.4, 1.0)];
const RAYS: u32 = 16;
const CELLS: u32 = 24;

fn made(scene: &Scene) -> Cache {
    Cache::new(scene, Settings::new(Grid::around(&scene.objects, CELLS))).unwrap()
}

/// Light after some passes from the dark, as bits.
fn light(cache: &mut Cache) -> Vec<[u32; 6]> {
    cache.darken();
    (0..3).for_each(|_| _ = cache.pass());
    let of = |i: i32| {
        let (x, z) = (i as f32 / 200.0, (i as f32 * 0.618).fract());
        let found = cache.irradiance(V::new(4.0 * x, 0.0, 4.0 * z), V::Y).unwrap();
        let [a, b] = [found.indirect, found.direct].map(|l| l.to_array().map(f32::to_bits));
        [a[0], a[1], a[2], b[0], b[1], b[2]]
    };
    (0..200).map(of).collect()
}

#[test]
fn parts_add_up_to_the_light_of_the_whole() {
    let scene = furnished(BOXES);
    let mut whole = lit(&scene, CELLS, RAYS, 0);
    let mut parts = made(&scene);
    parts.request(V::new(2.0, 0.0, 2.0), V::Y).unwrap();
    let mut turns = 0;
    while parts.gather_part((RAYS, RAYS), 37).unwrap() > 0 {
        turns += 1;
        // Between parts of rays some light, and others are asked for.
        parts.direct_part(20);
        if turns == 5 {
            parts.request_all();
        }
        assert!(turns < 1000);
    }
    assert!(turns > 20 && parts.waiting() == 0);
    while parts.direct_part(50) > 0 {}
    assert_eq!(parts.statistics().rays, whole.statistics().rays);
    assert_eq!(light(&mut parts), light(&mut whole));
}

#[test]
fn states_that_were_asked_for_send_their_rays_first() {
    let mut cache = made(&furnished(BOXES));
    let seen = cache.request_radiances(&[(V::new(2.0, 1.5, 2.0), -V::Y)]).unwrap()[0].unwrap();
    assert!(seen.point.abs_diff_eq(V::new(2.0, 0.0, 2.0), 1e-5) && seen.normal == V::Y, "{seen:?}");
    assert_eq!(seen.material, 0);
    assert_eq!(cache.request_radiances(&[(V::new(2.0, 9.0, 2.0), V::Y)]), Ok(vec![None]));
    let asked = cache.waiting();
    assert!((1..30).contains(&asked));
    cache.gather_part((40, 10), usize::MAX).unwrap();
    assert_eq!(cache.statistics().rays, 40 * asked);
    // Those wait that were hit; another question goes before them.
    let hit = cache.waiting();
    cache.request_radiances(&[(V::new(2.0, 1.5, 2.0), V::new(0.1, 0.2, 1.0))]).unwrap();
    let more = cache.gather_part((40, 10), 1).unwrap();
    assert_eq!(cache.statistics().rays, 40 * (asked + 1));
    assert!(more + 1 >= hit);
    // The rest in order: those asked for, then those hit.
    let before = cache.statistics().rays;
    cache.gather_part((40, 10), usize::MAX).unwrap();
    let middle = cache.statistics().rays;
    cache.gather_part((40, 10), 5).unwrap();
    assert_eq!((middle - before) % 40, 0);
    assert_eq!(cache.statistics().rays - middle, 50);
}

#[test]
fn old_light_is_found_anew_in_turn() {
    let scene = furnished(BOXES);
    let [mut whole, mut parts] = [(); 2].map(|()| lit(&scene, CELLS, 4, 0));
    assert_eq!(parts.direct_part(10), 0, "all have their light");
    let lights = [lamp(V::new(0.7, 0.5, 3.0), 4.0)];
    for cache in [&mut whole, &mut parts] {
        cache.set_lights(&lights).unwrap();
        assert_eq!(cache.direct_part(0), cache.statistics().gathered, "all have an old light");
        cache
            .set_objects(vec![(1, furnished([V::new(1.2, 0.0, 2.3), BOXES[1]]).objects[1].clone())])
            .unwrap();
        cache.request_all();
        cache.gather(4).unwrap();
    }
    whole.direct();
    let left = parts.direct_part(100);
    assert_eq!(left + 100, parts.statistics().gathered);
    while parts.direct_part(1000) > 0 {}
    assert_eq!(light(&mut parts), light(&mut whole));
}

#[test]
fn rays_without_number_or_too_many_are_refused_and_all_wait_on() {
    let mut cache = made(&furnished(BOXES));
    cache.request_all();
    let waiting = cache.waiting();
    for rays in [(0, 4), (4, 0), (5000, 4), (4, u32::MAX)] {
        assert!(
            matches!(cache.gather_part(rays, 10), Err(LightError::Value { what: "rays", .. })),
            "{rays:?}"
        );
    }
    for wrong in [(V::NAN, V::Y), (V::ZERO, V::ZERO)] {
        assert!(cache.request_radiances(&[(V::ONE, V::X), wrong]).is_err());
    }
    assert_eq!(cache.waiting(), waiting);
    assert_eq!(cache.gather_part((4, 4), 0).unwrap(), waiting);
}
