//! Layers: views of some layers. That these lose nothing, and show nothing of others, is what
//! `tests/attack` tries.

use casca::internals::SceneInternals;
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::FRAME_SECONDS;

use crate::common::*;

const METHODS: [Method; 3] = [Method::Frustum, Method::cell(), Method::point()];

const WALL: Aabb = Aabb { min: Vec3::new(0.0, 0.0, 8.0), max: Vec3::new(16.0, 16.0, 11.0) };

fn behind() -> Sphere {
    Sphere::new(Vec3::new(8.5, 8.5, 13.5), 0.5)
}

#[test]
fn a_wall_hides_in_the_views_that_show_it_and_in_no_others() {
    let view = around(Vec3::new(8.5, 8.5, 2.5));
    for (method, dynamic) in METHODS[1..].iter().flat_map(|&m| [(m, false), (m, true)]) {
        let mut scene = empty();
        let desc = if dynamic { ObjectDesc::dynamic(WALL) } else { ObjectDesc::fixed(WALL) };
        let wall = scene.insert(desc.occluder(WALL).layers(1)).unwrap();
        let ball = scene.fixed(behind());
        let mut query = query_by(method);
        let mut sees = |scene: &Scene, mask| query.run(scene, &view.clone().with_layers(mask)).contains(ball);
        let opaque = |scene: &Scene| scene.static_opacity().count() + scene.dynamic_opacity().count();
        let filled = 16 * 16 * 3;
        assert!(!sees(&scene, 1) && !sees(&scene, 3) && sees(&scene, 2), "{method:?}");
        scene.set_layers(wall, u64::MAX).unwrap();
        assert!(!sees(&scene, 1) && !sees(&scene, 2) && opaque(&scene) == filled, "{method:?}");
        scene.set_layers(wall, 6).unwrap();
        assert!(sees(&scene, 1) && !sees(&scene, 2) && !sees(&scene, 12) && sees(&scene, 8), "{method:?}");
        scene.set_layers(wall, 0).unwrap();
        assert!(sees(&scene, u64::MAX) && opaque(&scene) == 0, "no view shows it");
        assert!(matches!(scene.occluder(wall), Ok(Some(Occluder::Box(b))) if *b == WALL), "it is kept");
        assert!(scene.update(wall, WALL, None).is_err(), "an update must name the occluder");
        scene.update(wall, WALL, Some(WALL.into())).unwrap();
        assert!(sees(&scene, u64::MAX), "{method:?}");
        scene.set_layers(wall, 1 << 63).unwrap();
        assert!(!sees(&scene, 1 << 63) && sees(&scene, 1 << 62) && opaque(&scene) == filled, "{method:?}");
        scene.remove(wall).unwrap();
        assert!(sees(&scene, u64::MAX) && opaque(&scene) == 0 && scene.layers(wall).is_err());
    }
}

/// Solids on different layers are not joined, and a view is told of no cell that solids fill which
/// it does not show.
#[test]
fn solids_on_different_layers_do_not_fill_cells_together() {
    let view = around(Vec3::new(8.5, 8.5, 2.5));
    // The second fills the slit between the others, which ends inside of cells.
    let between = |from: f32, to: f32| Aabb::new(Vec3::new(from, 0.0, 8.0), Vec3::new(to, 16.0, 11.0));
    let walls = [between(0.0, 8.5), between(8.5, 9.0), between(9.0, 16.0)];
    for method in &METHODS[1..] {
        let mut query = query_by(*method);
        let cases = [
            ([1, 1, 1], [true, false]),
            ([1, 2, 1], [false, false]),
            ([3, 2, 3], [false, true]),
            ([3, 3, 3], [true, true]),
        ];
        for (masks, hidden) in cases {
            let mut scene = empty();
            for (wall, mask) in walls.iter().zip(masks) {
                scene.insert(ObjectDesc::fixed(*wall).occluder(*wall).layers(mask)).unwrap();
            }
            let ball = scene.fixed(behind());
            scene.begin_frame(0.0).unwrap();
            for (mask, hidden) in [1, 2].into_iter().zip(hidden) {
                let seen = query.run(&scene, &view.clone().with_layers(mask)).contains(ball);
                // Solids on different masks leave their seam open, and that is all right; so does
                // the point method, where the eye looks along the seam.
                let joined = masks.iter().all(|&m| m == masks[0]) && matches!(method, Method::Cell(_));
                assert!(seen || hidden, "lost: {masks:?} {mask} {method:?}");
                assert!(!seen || !hidden || !joined, "not hidden: {masks:?} {mask} {method:?}");
            }
        }
    }
}

/// An eye inside a solid that its view does not show sees as if the solid were not there: a player
/// in its own body.
#[test]
fn an_eye_in_a_solid_of_another_layer_has_occlusion() {
    let eye = Vec3::new(8.5, 8.5, 2.5);
    let body = Aabb::from_center(eye, Vec3::splat(2.0));
    for method in &METHODS[1..] {
        let mut scene = empty();
        scene.insert(ObjectDesc::fixed(WALL).occluder(WALL).layers(1)).unwrap();
        scene.insert(ObjectDesc::dynamic(body).occluder(body).layers(2)).unwrap();
        let ball = scene.insert(ObjectDesc::fixed(behind()).layers(3)).unwrap();
        let mut query = query_by(*method);
        let view = around(eye);
        assert!(!query.run(&scene, &view.clone().with_layers(1)).contains(ball), "{method:?}");
        assert!(query.run(&scene, &view.clone().with_layers(2)).contains(ball), "{method:?}");
    }
}

/// Occluders on more masks than there is room for still hide by themselves.
#[test]
fn many_masks_lose_nothing_and_hide_by_buffers() {
    let mut scene = empty();
    let wall = |i: u32| {
        let min = Vec3::new(0.0, 0.0, 4.0 + 0.2 * i as f32);
        Aabb::new(min, Vec3::new(16.0, 16.0, min.z + 0.1))
    };
    for i in 0..40 {
        scene.insert(ObjectDesc::fixed(wall(i)).occluder(wall(i)).layers(1 << i)).unwrap();
    }
    let ball = scene.fixed(behind());
    let view = around(Vec3::new(8.5, 8.5, 2.5));
    let mut query = Query::new();
    for i in 0..41 {
        assert_eq!(query.run(&scene, &view.clone().with_layers(1 << i)).contains(ball), i == 40, "{i}");
    }
}

/// A scene on one layer gives the sets of a scene without layers.
#[test]
fn one_layer_for_all_changes_no_set() {
    let options = SceneOptions { seed: 5, frames: 12, ..Default::default() };
    for (kind, scale) in [(SceneKind::City, 0.5), (SceneKind::Rooms, 1.0), (SceneKind::Rocks, 0.5)] {
        let mut world = build(kind, &SceneOptions { scale, ..options });
        let cell = world.grid.cell;
        let [mut plain, mut layered] = std::array::from_fn(|_| Driver::new(&world, cell, |_| ()).unwrap());
        for object in 0..world.objects.len() {
            layered.scene.set_layers(layered.id(object), 4).unwrap();
        }
        let mut queries = METHODS.map(|method| [(); 2].map(|()| query_by(method)));
        for frame in (0..world.frames).step_by(4) {
            let moved = world.set_frame(frame);
            for driver in [&mut plain, &mut layered] {
                driver.scene.begin_frame(frame as f64 * FRAME_SECONDS).unwrap();
                driver.update(&world.objects, &moved).unwrap();
            }
            let view = view_of(&world.camera(frame, 16.0 / 9.0)).unwrap();
            for [query, on_layer] in &mut queries {
                let set = |pvs: &Pvs| pvs.visible().iter().map(|id| id.index()).collect::<BTreeSet<_>>();
                let expected = set(query.run(&plain.scene, &view));
                let found = set(on_layer.run(&layered.scene, &view.clone().with_layers(4)));
                assert_eq!(found, expected, "{} {frame} {:?}", kind.name(), query.method());
            }
            plain.scene.end_frame(queries.iter().map(|[query, _]| query.pvs())).unwrap();
            layered.scene.end_frame(queries.iter().map(|[_, query]| query.pvs())).unwrap();
        }
    }
}

/// An object that is due for a report hides nothing, whatever its layers were in the meantime.
#[test]
fn an_overdue_wall_changes_its_layers() {
    let view = around(Vec3::new(8.5, 8.5, 2.5));
    for method in &METHODS[1..] {
        let mut scene = empty();
        let desc = ObjectDesc::dynamic(WALL).occluder(WALL).max_speed(1.0).reported_on_expiry();
        let wall = scene.insert(desc).unwrap();
        let ball = scene.fixed(behind());
        let mut query = query_by(*method);
        let mut run = |scene: &Scene| {
            let pvs = query.run(scene, &view);
            (pvs.contains(ball), pvs.contains(wall))
        };
        assert_eq!(run(&scene), (false, true));
        assert_eq!(scene.begin_frame(1.0).unwrap(), [wall]);
        for layers in [1, 2, u64::MAX, 1, u64::MAX] {
            scene.set_layers(wall, layers).unwrap();
            assert_eq!(run(&scene), (true, true), "it may be anywhere");
        }
        scene.update(wall, WALL, Some(WALL.into())).unwrap();
        assert_eq!(run(&scene), (false, true), "it was reported");
        scene.begin_frame(2.0).unwrap();
        scene.set_layers(wall, 1).unwrap();
        scene.remove(wall).unwrap();
        let again = scene.solid(WALL);
        assert_eq!(run(&scene), (false, false));
        assert!(scene.contains(again));
    }
}

#[test]
fn an_object_on_no_layer_in_view_gets_a_volume() {
    let view = around(Vec3::new(8.5, 8.5, 2.5));
    for method in &METHODS[1..] {
        let mut scene = empty();
        let bird = scene.insert(ObjectDesc::dynamic(behind()).layers(2)).unwrap();
        let mut query = query_by(*method);
        for frame in 0..4 {
            scene.begin_frame(f64::from(frame)).unwrap();
            scene.translate(bird, Vec3::X * 0.01).unwrap();
            let pvs = query.run(&scene, &view.clone().with_layers(1));
            assert!(pvs.is_empty() && pvs.revealed().is_empty());
            scene.end_frame([query.pvs()]).unwrap();
            assert!(scene.tbv(bird).unwrap().is_some());
        }
        assert_eq!(query.run(&scene, &view.clone().with_layers(3)).visible(), [bird]);
        assert_eq!(query.run(&scene, &view).visible(), [bird]);
        assert_eq!(query.run(&scene, &view.clone().with_layers(0)).visible(), []);
    }
}

#[test]
fn a_set_holds_for_its_own_layers() {
    let view = around(Vec3::new(8.5, 8.5, 2.5));
    for method in METHODS {
        let mut scene = empty();
        let ball = scene.insert(ObjectDesc::fixed(behind()).layers(2)).unwrap();
        let mut query = query_by(method);
        let two = view.clone().with_layers(2);
        assert_eq!((two.layers(), view.layers()), (2, u64::MAX));
        let pvs = query.run(&scene, &two).clone();
        assert!(pvs.is_valid_for(&scene, &two) && !pvs.is_valid_for(&scene, &view));
        assert!(!pvs.is_valid_for(&scene, &view.clone().with_layers(3)));
        scene.set_layers(ball, 2).unwrap();
        assert!(pvs.is_valid_for(&scene, &two), "nothing changed");
        scene.set_layers(ball, 1).unwrap();
        assert!(!pvs.is_valid_for(&scene, &two));
        assert_eq!(scene.iter().map(|(_, object)| object.layers()).collect::<Vec<_>>(), [1]);
    }
}
