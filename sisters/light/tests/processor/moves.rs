//! What moves: the same rays as in a cache that is made anew, and few of them sent again.

use crate::common::{
    bits, cuboid, gathered, holed, indirect, lamp, matt, painted, placed, room, scene, turned,
};
use casca_radiosity::{Cache, Grid, LightError, Material, Object, Scene, Settings, Window};
use glam::{Affine3A, Vec3 as V};

/// Passes end with the first that changes less than this share of the light, far below the 5% that
/// tests allow, and after so many.
const SETTLED: f64 = 1e-5;
const MOST_PASSES: u32 = 60;

/// Two rooms with a door between them, which is object 1, and a box on the floor, which is object 2.
fn house(open: f32, at: V) -> Scene {
    let mut walls = room(V::ZERO, V::new(8.0, 3.0, 4.0), 0);
    // A wall across, but for a gap of a metre at its end.
    walls.extend(cuboid(V::new(3.9, 0.0, 0.0), V::new(4.1, 3.0, 3.0), 0));
    let door = cuboid(V::new(3.95, 0.0, 3.0 - open), V::new(4.05, 3.0, 4.0 - open), 0);
    let chest = cuboid(at, at + V::new(0.6, 0.5, 0.7), 0);
    let objects = [walls, door, chest].map(Object::from).into();
    let lights = vec![lamp(V::new(2.0, 2.2, 1.9), 10.0)];
    Scene { objects, ..scene(vec![], vec![matt(0.6)], lights, 0.0) }
}

fn grid(scene: &Scene, cells: u32) -> Settings {
    Settings::new(Grid { min: V::ZERO, max: V::new(8.0, 3.0, 4.0), ..Grid::around(&scene.objects, cells) })
}

fn made(scene: &Scene) -> Cache {
    gathered(scene, grid(scene, 40), 24)
}

fn light(cache: &mut Cache) -> Vec<[u32; 3]> {
    bits(cache, 400, V::new(8.0, 3.0, 4.0))
}

#[test]
fn what_moved_is_as_if_made_anew() {
    let places = [V::new(1.0, 0.0, 2.0), V::new(1.3, 0.0, 2.1), V::new(6.0, 0.9, 1.0), V::new(2.0, 0.0, 3.3)];
    let mut cache = made(&house(0.0, places[0]));
    light(&mut cache);
    for (i, place) in places.into_iter().enumerate() {
        let scene = house(0.0, place);
        let moved = cache.set_objects(vec![(2, scene.objects[2].clone())]).unwrap();
        cache.request_all();
        cache.gather(24).unwrap();
        let mut anew = made(&scene);
        println!("{moved:?}");
        // Triangles without textures were once no triangles that stay.
        assert!(moved.kept > 20 * moved.dropped, "{i}: {moved:?}");
        assert!(moved.sent < moved.rays / 10, "{i}: {moved:?}");
        assert_eq!(cache.statistics().rays, anew.statistics().rays, "{i}");
        assert_eq!(cache.statistics().dark_rays, anew.statistics().dark_rays, "{i}");
        assert_eq!(light(&mut cache), light(&mut anew), "{i}");
    }
}

#[test]
fn a_door_lets_light_in_and_keeps_it_out() {
    let place = V::new(1.0, 0.0, 2.0);
    let mut cache = made(&house(0.0, place));
    (0..8).for_each(|_| _ = cache.pass());
    let far = |cache: &Cache| indirect(cache, V::new(6.0, 0.0, 2.0), V::Y);
    assert_eq!(far(&cache), 0.0);
    for (open, is_lit) in [(0.9, true), (0.0, false), (0.9, true)] {
        let scene = house(open, place);
        let moved = cache.set_objects(vec![(1, scene.objects[1].clone())]).unwrap();
        cache.request_all();
        cache.gather(24).unwrap();
        cache.direct();
        (0..8).for_each(|_| _ = cache.pass());
        println!("door {open}: {moved:?}, {}", far(&cache));
        let mut anew = made(&scene);
        anew.converge(SETTLED, MOST_PASSES);
        if is_lit {
            let truth = far(&anew);
            assert!(truth > 0.01 && (far(&cache) / truth - 1.0).abs() < 0.05, "{}, {truth}", far(&cache));
        } else {
            // Light that was there dies by the albedo, pass by pass; no new light comes.
            let before = far(&cache);
            (0..30).for_each(|_| _ = cache.pass());
            assert!(before < 0.05 && far(&cache) < 1e-4 * before.max(1e-9), "{before}, {}", far(&cache));
        }
        assert_eq!(light(&mut cache), light(&mut anew));
    }
}

#[test]
fn objects_may_change_their_number_of_triangles() {
    let scene = house(0.3, V::new(1.0, 0.0, 2.0));
    let mut cache = made(&scene);
    let mut other = scene.clone();
    other.objects[1].triangles.truncate(3);
    other.objects[2].triangles.clear();
    // And comes back.
    for (now, objects) in [(&other, [1, 2]), (&scene, [2, 1])] {
        for object in objects {
            cache.set_objects(vec![(object, now.objects[object].clone())]).unwrap();
        }
        cache.request_all();
        cache.gather(24).unwrap();
        assert_eq!(light(&mut cache), light(&mut made(now)));
    }
}

#[test]
fn lights_that_move_need_no_rays() {
    let scene = house(0.5, V::new(1.0, 0.0, 2.0));
    let mut cache = made(&scene);
    cache.converge(SETTLED, MOST_PASSES);
    let rays = cache.statistics().rays;
    let other = vec![lamp(V::new(6.0, 1.0, 2.0), 10.0)];
    cache.set_lights(&other).unwrap();
    let mut anew = made(&Scene { lights: other, ..scene });
    assert_eq!(light(&mut cache), light(&mut anew));
    assert_eq!(cache.statistics().rays, rays);
}

#[test]
fn neither_threads_nor_the_order_of_requests_matter() {
    let scene = house(0.5, V::new(1.0, 0.0, 2.0));
    let of = |points: &mut (dyn Iterator<Item = i32> + Send)| {
        let mut cache = Cache::new(&scene, grid(&scene, 40)).unwrap();
        points.for_each(|i| cache.request(V::new(0.2 + 0.25 * i as f32, 0.0, 1.7), V::Y).unwrap());
        cache.gather(16).unwrap();
        light(&mut cache)
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let found = one.install(|| of(&mut (0..30)));
    assert!(found == of(&mut (0..30)) && found == of(&mut (0..30).rev()));
}

#[test]
fn light_stays_while_something_moves_in_each_frame() {
    let place = |frame: u32| V::new(1.0 + 0.05 * frame as f32, 0.0, 1.2);
    let settled = |frame: u32| {
        let mut cache = made(&house(0.9, place(frame)));
        cache.converge(SETTLED, MOST_PASSES);
        cache
    };
    let mut cache = settled(0);
    let points: Vec<V> = (0..40).map(|i| V::new(0.1 + 0.19 * i as f32, 3.0, 0.3 + 0.08 * i as f32)).collect();
    let mean = |cache: &Cache| points.iter().map(|p| indirect(cache, *p, -V::Y)).sum::<f64>() / 40.0;
    let mut moved = 0;
    for frame in 1..=40 {
        let chest = house(0.9, place(frame)).objects[2].clone();
        moved += cache.set_objects(vec![(2, chest)]).unwrap().waiting;
        for i in 0..40 {
            cache.request(V::new(0.1 + 0.19 * i as f32, 0.0, 2.5), V::Y).unwrap();
        }
        cache.gather_part((24, 6), 60).unwrap();
        cache.direct_part(400);
        (0..2).for_each(|_| _ = cache.pass());
        if frame % 10 == 0 {
            // What moved was dark until rays from it were sent, and its darkness spread: 0.93.
            let share = mean(&cache) / mean(&settled(frame));
            println!("{frame}: {share}, {} wait", cache.waiting());
            assert!((share - 1.0).abs() < 0.02, "{frame}: {share}");
        }
    }
    // All that was hit has had its turn, although something was asked for in each frame.
    assert!(cache.waiting() < 100 && moved > 1000, "{} {moved}", cache.waiting());
}

/// The house full of boxes that are turned, so that most hits are read from what stands in, and with a
/// chest that is full of holes.
fn cluttered(open: f32, at: V) -> Scene {
    let mut scene = house(open, at);
    scene.materials.push(Material { texture: Some(0), ..matt(0.8) });
    scene.textures.push(holed());
    let mut chest = std::mem::take(&mut scene.objects[2].triangles);
    chest.iter_mut().for_each(|t| t.material = 1);
    scene.objects[2] = painted(chest, 1.5);
    for i in 0..60 {
        let random = |k: i32| ((i * 7 + k) as f32 * 0.618_034).fract();
        let size = V::new(0.1 + 0.5 * random(1), 0.05 + 0.3 * random(2), 0.1 + 0.4 * random(3));
        let place = V::new(7.6 * random(4), 2.2 * random(5) * random(6), 3.6 * random(0));
        let turn = Affine3A::from_translation(place) * turned();
        scene.objects[0].triangles.extend(placed(&cuboid(V::ZERO, size, 0), turn));
    }
    scene
}

/// Random moves of the door and of the chest, in cells of one size and with windows around the
/// chest's room and in the wall.
#[test]
fn many_moves_are_as_if_made_anew() {
    let window = |x, half, finer| Some(Window { middle: V::new(x, 1.0, 2.0), half, finer });
    let all = [[None; 2], [window(2.0, 1.2, 4), None], [window(4.0, 1.4, 2), window(3.5, 0.6, 2)]];
    for (number, windows) in all.into_iter().enumerate() {
        let made = |scene: &Scene| gathered(scene, Settings { windows, ..grid(scene, 20) }, 12);
        let random = |i: usize| (((i + 10 * number) as f32 + 0.5) * 0.618_034).fract();
        let mut cache = made(&cluttered(0.3, V::new(1.0, 0.0, 2.0)));
        for i in 0..3 {
            let at =
                V::new(0.2 + 6.8 * random(3 * i), 1.2 * random(3 * i + 1), 0.2 + 2.6 * random(3 * i + 2));
            let scene = cluttered(random(7 * i), at);
            let objects = [1, 2].map(|o| (o, scene.objects[o].clone()));
            // None, one alone, and both; of two with one number the last counts.
            let wrong = cache.set_objects(vec![(1, Object::default()), (9, Object::default())]);
            assert!(matches!(wrong, Err(LightError::Missing { number: 9, count: 3, .. })));
            assert_eq!(cache.set_objects(Vec::new()).unwrap().sent, 0);
            cache.set_objects(objects[i % 2..].to_vec()).unwrap();
            cache.set_objects([vec![(2, scene.objects[0].clone())], objects.to_vec()].concat()).unwrap();
            cache.request_all();
            cache.gather(12).unwrap();
            let mut anew = made(&scene);
            assert_eq!(cache.statistics().dark_rays, anew.statistics().dark_rays, "{number} {i}");
            assert_eq!(light(&mut cache), light(&mut anew), "{number} {i}");
        }
    }
}
