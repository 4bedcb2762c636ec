//! The sun on small scenes: which objects are casters, and which are not.

use crate::common::*;
use crate::scenes::{ABOVE, ahead, casters, solid};

#[test]
fn casters_are_those_whose_shadow_may_be_seen() {
    let mut scene = empty();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let wall = solid(&mut scene, [20.0, 1.0, 28.0], [44.0, 12.0, 30.0]);
    // Behind the camera, with the sun behind it: its shadow falls before the camera.
    let tower = solid(&mut scene, [28.0, 1.0, 56.0], [36.0, 28.0, 58.0]);
    // Beside the view, and so is its shadow.
    let beside = solid(&mut scene, [2.0, 1.0, 40.0], [4.0, 20.0, 42.0]);
    // In the shadow of the tower, and so is all that it might shade.
    let shaded = solid(&mut scene, [31.0, 6.0, 51.0], [33.0, 8.0, 53.0]);
    // In sight of the camera, but in the shadow of the tower.
    let seen = solid(&mut scene, [31.0, 1.0, 42.0], [33.0, 2.0, 44.0]);
    let mut camera = Query::new();
    let pvs = camera.run(&scene, &ahead()).clone();
    for (id, visible) in [(ground, true), (wall, true), (tower, false), (shaded, false), (seen, true)] {
        assert_eq!(pvs.contains(id), visible, "{id}");
    }
    let found = casters(&scene, &ahead(), Vec3::new(0.0, -1.0, -1.0));
    for id in [ground, wall, tower] {
        assert!(found.contains(&id), "{id} of {found:?}");
    }
    for id in [beside, shaded, seen] {
        assert!(!found.contains(&id), "{id} of {found:?}");
    }
    // From the front the tower's shadow falls where the camera sees nothing, and the other two
    // stand in the light.
    let found = casters(&scene, &ahead(), Vec3::new(0.0, -1.0, 1.0));
    assert!(!found.contains(&tower) && !found.contains(&beside), "{found:?}");
    assert!(found.contains(&seen), "{found:?}");
    // From the side, what stands beside the view is a caster.
    let found = casters(&scene, &ahead(), Vec3::new(1.0, -0.4, 0.0));
    assert!(found.contains(&beside) && !found.contains(&tower), "{found:?}");
}

#[test]
fn what_lies_behind_all_receivers_casts_nothing_on_them() {
    let mut scene = empty();
    // None hides another; only depth along the light tells them apart.
    let mut ball = |y: f32| scene.fixed(Sphere::new(Vec3::new(32.0, y, 30.0), 1.5));
    let (above, seen, below) = (ball(25.0), ball(4.0), ball(0.9));
    let plane = |y: f32, way: f32| Plane { normal: Vec3::Y * way, offset: -y * way };
    let eye = Vec3::new(32.0, 5.0, 50.0);
    // Seen is the part of the middle ball above y = 4.
    let view = View::from_planes(eye, &[plane(4.0, 1.0), plane(6.0, -1.0)]).unwrap();
    let mut camera = Query::new();
    assert_eq!(camera.run(&scene, &view).visible(), [seen]);
    assert_eq!(casters(&scene, &view, Vec3::NEG_Y), [above, seen]);
    assert_eq!(casters(&scene, &view, Vec3::Y), [below, seen]);
    // Across, the others are beside the rays.
    assert_eq!(casters(&scene, &view, Vec3::X), [seen]);
    let mut all = casters(&scene, &around(eye), Vec3::NEG_Y);
    all.sort_unstable();
    assert_eq!(all, [above, seen, below]);
}

#[test]
fn casters_may_lie_deeper_than_the_nearest_point_of_a_receiver() {
    let mut scene = empty();
    // A slope, and a ball close above its lower end.
    let corners = [[31.0, 5.9, 30.0], [31.0, 5.9, 31.9], [32.9, 4.0, 31.9], [32.9, 4.0, 30.0]];
    let slope = TriMesh::new(corners.map(Vec3::from).to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let slope = scene.fixed(Arc::new(slope));
    let ball = scene.solid(Sphere::new(Vec3::new(32.8, 4.35, 31.0), 0.05));
    // Below the ball, the shadow is in sight.
    let ceiling = Plane { normal: Vec3::NEG_Y, offset: 4.2 };
    let view = View::from_planes(Vec3::new(40.0, 4.1, 31.0), &[ceiling]).unwrap();
    assert_eq!(Query::new().run(&scene, &view).visible(), [slope]);
    let found = casters(&scene, &view, Vec3::NEG_Y);
    assert!(found.contains(&slope) && found.contains(&ball), "{found:?}");
}

#[test]
fn moving_casters_that_no_camera_sees_are_found_in_their_volumes() {
    let mut scene = empty();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let bird = Sphere::new(Vec3::new(32.0, 28.0, 30.0), 0.5);
    let dynamic = ObjectDesc::dynamic(bird).max_speed(4.0).occluder(bird);
    let reported = scene.insert(dynamic.clone()).unwrap();
    let silent = scene.insert(dynamic.reported_on_expiry()).unwrap();
    let (mut camera, mut sun, mut out) = (Query::new(), Query::new(), Vec::new());
    for frame in 0..5 {
        let due = scene.begin_frame(f64::from(frame) * 0.1).unwrap();
        assert!(due.is_empty(), "{due:?}");
        let pvs = camera.run(&scene, &ahead());
        assert_eq!(pvs.visible(), [ground]);
        sun.shadow_casters(&scene, &camera, &ABOVE, &mut out).unwrap();
        assert!(out.contains(&reported) && out.contains(&silent), "{frame} {out:?}");
        // One of them moves in its volume and tells so.
        let away = Sphere::new(bird.center + Vec3::Y, bird.radius);
        scene.update(reported, away, Some(away.into())).unwrap();
        scene.end_frame([camera.pvs()]).unwrap();
        assert!(scene.tbv(silent).unwrap().is_some());
    }
    // A strip of ground beside the place where both were: only the silent one may have flown there.
    let strip = [(Vec3::X, 34.2), (Vec3::NEG_X, -34.5), (Vec3::NEG_Y, -2.0)];
    let strip = strip.map(|(normal, at)| Plane { normal, offset: -at });
    let pvs = camera.run(&scene, &View::from_planes(Vec3::new(34.3, 1.5, 60.0), &strip).unwrap());
    assert_eq!(pvs.visible(), [ground]);
    sun.shadow_casters(&scene, &camera, &ABOVE, &mut out).unwrap();
    assert!(out.contains(&silent) && !out.contains(&reported), "{out:?}");
    // Beside the rays, neither is a caster.
    camera.run(&scene, &ahead());
    sun.shadow_casters(&scene, &camera, &Light::directional(Vec3::new(-1.0, -0.1, 0.0)), &mut out).unwrap();
    assert!(!out.contains(&reported) && !out.contains(&silent), "{out:?}");
}

#[test]
fn receivers_of_unknown_place_may_be_shaded_by_all_that_the_light_meets() {
    let mut scene = empty();
    let ball = Sphere::new(Vec3::new(32.0, 4.0, 30.0), 0.5);
    let lost = ObjectDesc::dynamic(ball).max_speed(4.0).reported_on_expiry();
    let lost = scene.insert(lost).unwrap();
    let far = solid(&mut scene, [2.0, 28.0, 2.0], [4.0, 30.0, 4.0]);
    let below = solid(&mut scene, [2.5, 2.0, 2.5], [3.5, 4.0, 3.5]);
    assert_eq!(casters(&scene, &ahead(), Vec3::NEG_Y), [lost]);
    let away = Plane { normal: Vec3::NEG_X, offset: 1.0 };
    let mut query = Query::new();
    scene.begin_frame(0.0).unwrap();
    look(&mut scene, &mut query, &View::from_planes(Vec3::ZERO, &[away]).unwrap());
    assert_eq!(scene.begin_frame(1e6).unwrap(), [lost]);
    let found = casters(&scene, &ahead(), Vec3::NEG_Y);
    assert!(found.contains(&lost) && found.contains(&far) && !found.contains(&below), "{found:?}");
}

#[test]
fn what_makes_no_sense_is_refused_and_nothing_seen_gets_no_casters() {
    let mut scene = empty();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let huge = Sphere::new(Vec3::ZERO, 3e38);
    let (mut camera, mut sun) = (Query::new(), Query::new());
    let mut out = Vec::new();
    let unrun = sun.shadow_casters(&scene, &camera, &ABOVE, &mut out);
    assert_eq!(unrun, Err(Error::ForeignPvs));
    camera.run(&scene, &ahead());
    sun.shadow_casters(&scene, &camera, &Light::directional(Vec3::NEG_Y * 1e-40), &mut out).unwrap();
    assert_eq!(out, [ground]);
    for light in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::new(0.0, f32::NAN, 1.0)] {
        let message = sun
            .shadow_casters(&scene, &camera, &Light::directional(light), &mut out)
            .unwrap_err()
            .to_string();
        assert!(message.contains("direction of the light"), "{message}");
    }
    assert_eq!(sun.shadow_casters(&empty(), &camera, &ABOVE, &mut out), Err(Error::ForeignPvs));
    assert_eq!((out.as_slice(), sun.pvs().visible()), (&[ground][..], &[ground][..]));

    let nothing = Plane { normal: Vec3::Y, offset: -1000.0 };
    let nothing = View::from_planes(Vec3::splat(32.0), &[nothing]).unwrap();
    camera.run(&scene, &nothing);
    sun.shadow_casters(&scene, &camera, &ABOVE, &mut out).unwrap();
    assert!(out.is_empty() && sun.pvs().is_empty());
    scene.end_frame([camera.pvs(), sun.pvs()]).unwrap();
    assert!(!sun.pvs().is_valid_for(&scene, &nothing));

    // Huge bounds are taken.
    let huge = scene.fixed(huge);
    let everywhere = scene.fixed(Aabb::new(Vec3::splat(f32::MIN), Vec3::splat(f32::MAX)));
    for light in [Vec3::NEG_Y, Vec3::new(0.3, -1.0, 0.2), Vec3::splat(f32::MAX)] {
        for view in [ahead(), around(Vec3::splat(3.0))] {
            let found = casters(&scene, &view, light);
            assert!([ground, huge, everywhere].iter().all(|id| found.contains(id)), "{found:?}");
        }
    }
    // Receivers removed since are left out.
    camera.run(&scene, &ahead());
    for id in [ground, huge, everywhere] {
        scene.remove(id).unwrap();
    }
    sun.shadow_casters(&scene, &camera, &ABOVE, &mut out).unwrap();
    assert!(out.is_empty());
    // The light's view of a point has no width.
    let point = scene.fixed(Sphere::new(Vec3::new(32.0, 4.0, 30.0), 0.0));
    assert_eq!(casters(&scene, &ahead(), Vec3::NEG_Y), [point]);
}
