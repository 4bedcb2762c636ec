//! Kept queries: when a result serves, and what of it changes. That every set has all that the eye
//! sees while objects move, come and go and the camera walks and jumps is what `tests/attack` tries.

use std::thread;

use crate::common::worlds::{World, camera};
use crate::common::*;

/// Seconds from frame to frame.
const TICK: f64 = 1.0 / 30.0;

fn kept(reach: f32, turn: f32) -> KeptQuery {
    KeptQuery::with_options(KeptOptions::new().reach(reach).turn(turn)).unwrap()
}

/// A wall across the grid, an object behind it and one before it.
fn wall() -> (Scene, [ObjectId; 3]) {
    let mut scene = empty();
    let wall = scene.solid(Aabb::new(Vec3::new(2.0, 2.0, 15.0), Vec3::new(30.0, 30.0, 17.0)));
    let mut ball = |z: f32| scene.fixed(Sphere::new(Vec3::new(16.0, 16.0, z), 1.0));
    let ids = [wall, ball(24.0), ball(4.0)];
    (scene, ids)
}

const EYE: Vec3 = Vec3::new(16.0, 16.0, 10.0);

fn beside(step: f32) -> View {
    around(EYE + Vec3::X * step)
}

#[test]
fn a_result_serves_until_the_eye_goes_too_far_and_follows_static_objects() {
    let (mut scene, [wall, behind, before]) = wall();
    let mut query = kept(0.5, 0.0);
    assert!(query.pvs().is_empty() && !query.is_valid_for(&scene, &beside(0.0)));
    let mut refreshes = |scene: &Scene, step: f32| {
        let pvs = query.run(scene, &beside(step));
        assert!(pvs.contains(wall) && pvs.contains(before) && !pvs.contains(behind));
        query.refreshes()
    };
    assert_eq!([0.0, 0.1, 0.2, 0.3, 0.9].map(|step| refreshes(&scene, step)), [1, 2, 2, 2, 2]);
    assert_eq!(refreshes(&scene, 3.0), 3, "it went too far");
    let ball = Sphere::new(Vec3::new(16.0, 20.0, 4.0), 0.5);
    let mover = scene.insert(ObjectDesc::dynamic(ball)).unwrap();
    assert_eq!(refreshes(&scene, 3.0), 3, "a dynamic object came");
    scene.update(mover, Sphere::new(ball.center + Vec3::Y, 0.5), None).unwrap();
    scene.set_layers(mover, 3).unwrap();
    scene.remove(mover).unwrap();
    assert_eq!(refreshes(&scene, 3.0), 3, "and moved and went");
    let block = Aabb::new(Vec3::splat(1.0), Vec3::splat(2.0));
    let id = scene.fixed(block);
    assert_eq!(refreshes(&scene, 3.0), 3, "a static object came");
    scene.set_layers(id, 3).unwrap();
    assert_eq!(refreshes(&scene, 3.0), 3);
    scene.update(id, Aabb::new(Vec3::splat(1.0), Vec3::splat(2.5)), None).unwrap();
    assert_eq!(refreshes(&scene, 3.0), 3);
    scene.remove(id).unwrap();
    assert_eq!(refreshes(&scene, 3.0), 3);
    assert_eq!(refreshes(&scene.clone(), 3.0), 4, "another scene");
}

#[test]
fn questions_rest_on_the_kept_buffers_while_static_objects_stay() {
    let (mut scene, [wall, ..]) = wall();
    let mut query = kept(0.5, 0.0);
    assert!(query.sight(&scene).is_none(), "there was no run");
    for step in [0.0, 0.1, 0.4] {
        query.run(&scene, &beside(step));
    }
    assert_eq!(query.refreshes(), 2, "for the first view and for the way from the second one on");
    let sight = query.sight(&scene).unwrap();
    let [behind, before] = [24.0, 13.0].map(|z| sight.may_see_point(Vec3::new(16.0, 16.0, z)));
    assert!(sight.has_occlusion() && before && !behind);
    scene.remove(wall).unwrap();
    let sight = query.sight(&scene).unwrap();
    assert!(!sight.has_occlusion() && sight.may_see_point(Vec3::new(16.0, 16.0, 24.0)));
}

#[test]
fn turned_cameras_are_served_too() {
    let (scene, [wall, behind, _]) = wall();
    let view = |angle: f32| {
        let forward = Quat::from_rotation_y(angle) * Vec3::Z;
        looking(EYE, forward, [1.0, 1.5, 0.1, 60.0])
    };
    let mut query = kept(0.0, 0.2);
    for (angle, refreshes) in [(0.0, 1), (0.05, 2), (0.19, 2), (0.3, 2), (-0.19, 3)] {
        let pvs = query.run(&scene, &view(angle));
        assert!(pvs.contains(wall) && !pvs.contains(behind));
        assert_eq!(query.refreshes(), refreshes, "{angle}");
    }
}

#[test]
fn a_camera_that_goes_straight_on_has_smaller_sets_than_one_that_goes_to_and_fro() {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(12.0, 2.0, 15.0), Vec3::new(20.0, 30.0, 16.0)));
    let beside_wall = scene.fixed(Sphere::new(Vec3::new(25.9, 16.0, 24.0), 0.5));
    let walk = |at: fn(i32) -> Vec3| {
        let mut query = kept(0.5, 0.1);
        let mut sees = |frame: i32| {
            query.run(&scene, &looking(EYE + at(frame), Vec3::Z, [1.0, 1.5, 0.1, 60.0]));
            query.pvs().contains(beside_wall)
        };
        let frames = (0..60).filter(|frame| sees(*frame)).count();
        (frames, query.refreshes())
    };
    let (seen, refreshes) = walk(|frame| Vec3::Z * 0.02 * frame as f32);
    assert!(seen == 0 && (3..9).contains(&refreshes), "{seen} {refreshes}");
    let (seen, refreshes) = walk(|frame| Vec3::Z * 0.06 * (frame % 2) as f32);
    assert!(seen > 50 && refreshes < 6, "all that can be seen from around it: {seen} {refreshes}");
    let (seen, refreshes) = walk(|frame| Vec3::Z * 0.3 * (frame % 2) as f32);
    assert_eq!((seen, refreshes), (0, 60), "it jumps");
}

#[test]
fn a_door_hides_while_it_is_closed() {
    let mut scene = empty();
    for (x, w) in [(2.0, 12.0), (18.0, 12.0)] {
        scene.solid(Aabb::new(Vec3::new(x, 2.0, 15.0), Vec3::new(x + w, 30.0, 17.0)));
    }
    let door = |up: f32| Aabb::new(Vec3::new(13.5, 2.0 + up, 15.5), Vec3::new(18.5, 30.0, 16.5));
    let id = scene.insert(ObjectDesc::dynamic(door(0.0)).occluder(door(0.0))).unwrap();
    let behind = scene.fixed(Sphere::new(Vec3::new(16.0, 10.0, 24.0), 0.5));
    let mut query = kept(0.05, 0.0);
    for (up, seen) in [(0.0, false), (20.0, true), (0.0, false)] {
        scene.update(id, door(up), Some(door(up).into())).unwrap();
        let pvs = query.run(&scene, &beside(0.0));
        assert_eq!((pvs.contains(behind), query.refreshes()), (seen, 1), "{up}");
    }
}

/// A volume that was passed over, since nothing on the layers of the view is inside, counts once
/// its object is shown.
#[test]
fn a_hidden_object_that_is_put_on_a_layer_of_the_view_is_seen() {
    let mut scene = empty();
    let ball = Sphere::new(EYE + Vec3::Z * 6.0, 0.5);
    let id = scene.insert(ObjectDesc::dynamic(ball).max_speed(1.0).layers(2)).unwrap();
    let mut query = kept(0.1, 0.1);
    for (frame, layers) in [2, 2, u64::MAX, u64::MAX].into_iter().enumerate() {
        scene.begin_frame(frame as f64 * TICK).unwrap();
        scene.set_layers(id, layers).unwrap();
        let hidden = scene.tbv(id).unwrap().is_some();
        let pvs = query.run(&scene, &beside(0.0).with_layers(1));
        assert_eq!((pvs.contains(id), hidden), (layers != 2, frame == 1 || frame == 2), "{frame}");
        scene.end_frame([query.pvs()]).unwrap();
    }
    assert_eq!(query.refreshes(), 1);
}

/// A camera that looks along z, with a near distance.
fn ahead(near: f32) -> View {
    looking(EYE, Vec3::Z, [1.0, 1.5, near, 60.0])
}

#[test]
fn occluders_before_the_near_plane_hide_nothing_whether_they_move_or_the_plane_does() {
    let mut scene = empty();
    let screen = |z: f32| Aabb::from_center(EYE + Vec3::Z * z, Vec3::new(5.0, 5.0, 0.1));
    let behind = scene.fixed(Sphere::new(EYE + Vec3::Z * 9.0, 0.5));
    let mover = scene.insert(ObjectDesc::dynamic(screen(3.0)).occluder(screen(3.0))).unwrap();
    let mut query = kept(0.0, 0.1);
    for (z, seen) in [(3.0, false), (0.9, true), (3.0, false)] {
        scene.update(mover, screen(z), Some(screen(z).into())).unwrap();
        assert_eq!(query.run(&scene, &ahead(1.0)).contains(behind), seen, "{z}");
    }
    scene.remove(mover).unwrap();
    scene.solid(screen(1.8));
    for (near, seen) in [(0.5, false), (1.8, true), (0.5, true)] {
        assert_eq!(query.run(&scene, &ahead(near)).contains(behind), seen, "{near}");
    }
    assert_eq!(
        query.refreshes(),
        2,
        "the result of the first view serves the second, that of the third the last"
    );
}

#[test]
fn views_of_other_layers_and_scenes_get_results_of_their_own() {
    let (mut scene, [_, behind, before]) = wall();
    let (other, _) = wall();
    scene.set_layers(before, 2).unwrap();
    let mut query = kept(0.5, 0.1);
    assert!(query.run(&scene, &beside(0.0)).contains(before));
    assert!(!query.run(&scene, &beside(0.0).with_layers(1)).contains(before));
    assert!(query.run(&scene, &beside(0.0).with_layers(2)).contains(before));
    assert_eq!(query.refreshes(), 3);
    let foreign = query.run(&other, &beside(0.0));
    assert!(!foreign.contains(before) && !foreign.contains(behind) && foreign.len() == 2);
    assert!(scene.end_frame([query.pvs()]).is_err());
}

#[test]
fn orthographic_views_are_served_while_they_stay() {
    let (mut scene, [wall, behind, before]) = wall();
    let sun = |x: f32| {
        let eye = Vec3::new(x, 16.0, 1.0);
        let matrix =
            directx::orthographic(-9.0, 9.0, -9.0, 9.0, 0.1, 40.0) * look_to_mat4(eye, Vec3::Z, Vec3::Y);
        View::orthographic(Vec3::Z, matrix).unwrap()
    };
    let ball = |x: f32| Sphere::new(Vec3::new(x, 16.0, 28.0), 0.5);
    let mover = scene.insert(ObjectDesc::dynamic(ball(16.0)).max_speed(5.0)).unwrap();
    let mut query = kept(0.5, 0.1);
    for (frame, (x, at, seen, refreshes)) in
        [(16.0, 16.0, false, 1), (16.0, 17.0, false, 1), (18.0, 17.0, false, 2), (27.0, 30.5, true, 3)]
            .into_iter()
            .enumerate()
    {
        scene.begin_frame(frame as f64).unwrap();
        scene.update(mover, ball(at), None).unwrap();
        let pvs = query.run(&scene, &sun(x));
        assert!(pvs.contains(wall) && !pvs.contains(behind));
        assert_eq!((pvs.contains(mover), pvs.contains(before)), (seen, x < 20.0), "{frame}");
        assert_eq!(query.refreshes(), refreshes);
        scene.end_frame([query.pvs()]).unwrap();
    }
}

/// The buffers of a kept result reach as far as the scene did when it was found.
#[test]
fn movers_beyond_the_scene_are_seen_along_parallel_rays() {
    let (mut scene, _) = wall();
    let look = look_to_mat4(Vec3::new(16.0, 16.0, -20.0), Vec3::Z, Vec3::Y);
    let matrix = directx::orthographic(-100.0, 100.0, -100.0, 100.0, 0.1, 80.0) * look;
    let view = View::orthographic(Vec3::Z, matrix).unwrap();
    let mut query = kept(0.0, 0.0);
    query.run(&scene, &view);
    let ball = |x: f32| Sphere::new(Vec3::new(x, 16.0, 16.0), 1.0);
    let mover = scene.insert(ObjectDesc::dynamic(ball(60.0)).max_speed(5.0)).unwrap();
    for (frame, x) in [60.0, 44.0, -40.0].into_iter().enumerate() {
        scene.begin_frame(frame as f64).unwrap();
        scene.update(mover, ball(x), None).unwrap();
        assert!(query.run(&scene, &view).contains(mover), "{x}");
        assert_eq!(query.refreshes(), 1);
    }
}

/// A wall that goes opens what it hid, and one that comes hides it again, without a new result.
#[test]
fn walls_that_come_and_go_are_followed() {
    let (mut scene, [wall, behind, before]) = wall();
    let shape = scene.occluder(wall).unwrap().unwrap().clone();
    let Occluder::Box(shape) = shape else { unreachable!("the wall is a box") };
    // Another wall hides the place behind partly: it is drawn again where pixels are opened.
    let far = Aabb::new(Vec3::new(2.0, 2.0, 18.0), Vec3::new(12.0, 30.0, 19.0));
    scene.solid(far);
    let aside = scene.fixed(Sphere::new(Vec3::new(7.0, 16.0, 22.0), 0.5));
    let mut query = kept(0.2, 0.0);
    [0.0, 0.02].iter().for_each(|step| _ = query.run(&scene, &beside(*step)));
    let mut check = |scene: &Scene, sees: bool, step: f32| {
        let pvs = query.run(scene, &beside(step));
        assert!(pvs.contains(before) && pvs.contains(behind) == sees, "{sees} {step}");
        assert!(!pvs.contains(aside), "the far wall hides it");
        let sight = query.sight(scene).unwrap();
        assert!(sight.has_occlusion() && sight.may_see_point(Vec3::new(16.0, 16.0, 24.0)) == sees);
        assert_eq!(query.refreshes(), 2, "for the first view and for the way from the second one on");
    };
    check(&scene, false, 0.03);
    scene.remove(wall).unwrap();
    check(&scene, true, 0.1);
    let again = scene.solid(shape);
    check(&scene, false, 0.1);
    scene.set_occluder(again, None).unwrap();
    check(&scene, true, 0.15);
    scene.set_occluder(again, Some(shape.into())).unwrap();
    check(&scene, false, 0.15);
    scene.set_layers(again, 2).unwrap();
    check(&scene, false, 0.05);
}

/// What stands in the streets of a small town, and a box far away that comes or goes in each frame:
/// how often the camera waited, how many jobs were of use, and the sets, kept and fresh.
fn stream(comes_and_goes: bool, hides: bool) -> (u64, usize, Vec<ObjectId>, Vec<ObjectId>) {
    let mut scene = empty();
    for (i, j) in (0..8).flat_map(|i| (0..8).map(move |j| (i, j))) {
        let corner = Vec3::new(i as f32, 0.0, j as f32) * 10.0;
        scene.solid(Aabb::new(corner + Vec3::new(2.0, 0.0, 2.0), corner + Vec3::new(8.0, 9.0, 8.0)));
        for k in 0..10 {
            let at = corner + Vec3::new((k % 5) as f32 * 0.3, 0.2, (k / 5) as f32 * 0.3);
            scene.fixed(Aabb::from_center(at, Vec3::splat(0.1)));
        }
    }
    let far = Aabb::from_center(Vec3::new(75.0, 4.0, 75.0), Vec3::splat(0.9));
    let desc = ObjectDesc::fixed(far);
    let desc = if hides { desc.occluder(far) } else { desc };
    let mut there = None;
    let mut change = |scene: &mut Scene| match there.take() {
        _ if !comes_and_goes => {}
        Some(id) => scene.remove(id).unwrap(),
        None => there = Some(scene.insert(desc.clone()).unwrap()),
    };
    let (mut query, mut fresh) = (kept(0.15, 0.1), Query::new());
    let (mut fits, mut kept, mut found) = (0, Vec::new(), Vec::new());
    for frame in 0..60u8 {
        scene.begin_frame(f64::from(frame) / 60.0).unwrap();
        change(&mut scene);
        let eye = Vec3::new(0.9, 1.7, 20.0 + f32::from(frame) * 0.025);
        let view = looking(eye, Vec3::new(0.3, 0.0, 1.0), [1.0, 1.77, 0.1, 500.0]);
        kept.extend(query.run(&scene, &view));
        found.extend(fresh.run(&scene, &view));
        let done = query.prepare(&scene, &view).run();
        scene.end_frame([query.pvs()]).unwrap();
        // Meanwhile the scene changed again.
        change(&mut scene);
        fits += usize::from(query.install(done, &scene));
    }
    (query.refreshes(), fits, kept, found)
}

#[test]
fn small_changes_far_away_leave_results_and_jobs_of_use_the_same_each_time() {
    for (comes_and_goes, hides) in [(false, false), (true, false), (true, true)] {
        let (refreshes, fits, kept, found) = stream(comes_and_goes, hides);
        assert!(refreshes <= 3 && fits == 60, "{refreshes} waits, {fits} jobs, {hides}");
        assert!(kept.len() * 10 < found.len() * 13, "{} of {}", kept.len(), found.len());
        let again = stream(comes_and_goes, hides);
        let numbers = |ids: &[ObjectId]| ids.iter().map(|id| id.index()).collect::<Vec<_>>();
        assert_eq!((again.0, numbers(&again.2)), (refreshes, numbers(&kept)));
    }
}

/// A copy of the scene for jobs takes over what changed: its results are those of a new copy.
#[test]
fn jobs_see_the_static_objects_of_the_scene_as_it_is() {
    let mut scene = empty();
    let mut random = Random(7);
    let mut next = |n: usize| random.below(n);
    let mut query = kept(0.1, 0.1);
    let mut ids: Vec<ObjectId> = Vec::new();
    for round in 0..60 {
        for _ in 0..6 {
            let at = Vec3::new(next(30) as f32, next(30) as f32, next(30) as f32);
            let shape = Aabb::new(at, at + Vec3::new(2.0, 1.0 + next(3) as f32, 1.0));
            let desc =
                [ObjectDesc::fixed(shape), ObjectDesc::dynamic(shape)][usize::from(next(4) == 0)].clone();
            match next(4) {
                0 | 1 => ids.push(scene.insert(desc.occluder(shape)).unwrap()),
                2 if !ids.is_empty() => scene.remove(ids.swap_remove(next(ids.len()))).unwrap(),
                _ if !ids.is_empty() => {
                    let id = ids[next(ids.len())];
                    scene.update(id, shape, Some(shape.into())).unwrap();
                }
                _ => {}
            }
        }
        let set = |query: &mut KeptQuery| {
            let done = query.prepare(&scene, &beside(0.0)).run();
            let mut other = kept(0.1, 0.1);
            assert!(other.install(done, &scene));
            let ids = sorted(other.run(&scene, &beside(0.0)));
            assert_eq!(other.refreshes(), 0);
            ids
        };
        assert_eq!(set(&mut query), set(&mut kept(0.1, 0.1)), "round {round}");
    }
}

#[test]
fn a_result_found_on_another_thread_serves_if_it_still_fits() {
    let (mut scene, [wall, behind, _]) = wall();
    let mut query = kept(0.5, 0.0);
    [0.0, 0.1].iter().for_each(|step| _ = query.run(&scene, &beside(*step)));
    let job = query.prepare(&scene, &beside(2.0));
    let done = thread::spawn(move || job.run()).join().unwrap();
    query.run(&scene, &beside(0.2));
    assert!(query.install(done, &scene));
    for (step, refreshes) in [(0.3, 2), (2.0, 2), (2.4, 2), (0.2, 3)] {
        assert!(!query.run(&scene, &beside(step)).contains(behind));
        assert_eq!(query.refreshes(), refreshes, "{step}");
    }
    // Made ready before a wall goes, installed after it.
    let (early, late) = (query.prepare(&scene, &beside(0.2)), query.prepare(&scene, &beside(0.2)));
    let early = early.run();
    scene.remove(wall).unwrap();
    for result in [early, late.run()] {
        query.reset();
        assert!(query.install(result, &scene));
        assert!(query.run(&scene, &beside(0.2)).contains(behind));
        assert_eq!(query.refreshes(), 3, "it follows");
    }
    let (other, _) = self::wall();
    let done: KeptResult = query.prepare(&scene, &beside(0.2)).run();
    assert!(!query.install(done, &other));
}

#[test]
fn options_out_of_range_are_refused() {
    for bad in [f32::NAN, -0.1, f32::INFINITY] {
        assert!(KeptQuery::with_options(KeptOptions::new().reach(bad)).is_err(), "{bad}");
        assert!(KeptQuery::with_options(KeptOptions::new().turn(bad)).is_err(), "{bad}");
    }
    let mut query = KeptQuery::new();
    assert!(query.set_point_options(PointOptions::new().pixel_degrees(0.0)).is_err());
    query.set_point_options(PointOptions::fast()).unwrap();
    let (scene, [_, behind, _]) = wall();
    assert!(!query.run(&scene, &beside(0.0)).contains(behind));
    query.reset();
    query.run(&scene, &beside(0.0));
    assert_eq!(query.refreshes(), 2);
    assert_eq!(query.options(), KeptOptions::default());
}

/// A kept set may be larger than that of a query, but not much where nothing moves and nothing is
/// near.
#[test]
fn without_a_reach_sets_are_those_of_a_query() {
    let walls: Vec<Aabb> = (0..20)
        .map(|i| Vec3::new((i * 7 % 30) as f32, (i * 13 % 28) as f32, (i * 5 % 27) as f32 + 3.0))
        .map(|p| Aabb::new(p - 1.6, p + 1.6))
        .collect();
    let targets: Vec<Sphere> = (0..200)
        .map(|i| Sphere::new(Vec3::new((i * 7 % 31) as f32, (i * 11 % 29) as f32, (i * 17 % 30) as f32), 0.2))
        .collect();
    let world = World::new(&walls, &targets);
    let (mut query, mut kept) = (Query::new(), kept(0.0, 0.0));
    kept.set_point_options(PointOptions::new()).unwrap();
    for i in 0..10 {
        let view = around(Vec3::new(1.0 + 3.0 * i as f32, 16.5, 1.5));
        let found = query.run(&world.scene, &view).len();
        assert_eq!(kept.run(&world.scene, &view).len(), found);
    }
}

/// A result for no reach and no turn holds for the view that it was found for, whatever that has
/// for a near plane or a reach of its own.
#[test]
fn a_result_without_reach_serves_its_own_view() {
    let (scene, [_, behind, _]) = wall();
    let eye = Vec3::new(16.0, 16.0, 6.0);
    let view = looking(eye, Vec3::Z, [1.0, 1.5, 0.3, 60.0]);
    let planes = View::from_planes(eye, &camera(eye, 2, 0.3)).unwrap();
    let wide = beside(0.0).with_reach(0.25).unwrap();
    for view in [planes, view.clone().with_turn(0.1).unwrap(), view, wide] {
        let mut query = kept(0.0, 0.0);
        let sets: Vec<_> = (0..4).map(|_| query.run(&scene, &view).visible().to_vec()).collect();
        assert!(query.is_valid_for(&scene, &view) && !sets[0].contains(&behind));
        assert!(sets.iter().all(|set| *set == sets[0]));
        assert_eq!(query.refreshes(), 1);
        assert!(!query.is_valid_for(&scene, &beside(0.0).with_reach(0.26).unwrap()));
        assert!(query.sight(&scene).is_some_and(|sight| !sight.may_see_point(Vec3::new(16.0, 16.0, 28.0))));
    }
}
