//! Objects that are reported on expiry, by applications that report late, early, twice or not at
//! all. The model: an object may be anywhere within its greatest speed times the time since its
//! last report.

use casca::internals::SceneInternals;

use crate::common::*;

const METHODS: [Method; 3] = [Method::point(), Method::cell(), Method::Frustum];
const EYE: Vec3 = Vec3::new(29.5, 32.5, 10.5);

/// All round, but for the frustum method, which sees only what is right of the wall's end.
fn view(method: Method) -> View {
    match method {
        Method::Frustum => View::from_planes(EYE, &[Plane { normal: Vec3::X, offset: -30.2 }]).unwrap(),
        _ => around(EYE),
    }
}

fn ball(x: f32) -> Sphere {
    Sphere::new(Vec3::new(x, 32.5, 37.5), 0.25)
}

/// A wall from x = 2 to 30 before the eye, and what stands behind it.
fn scene() -> Scene {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(2.0, 2.0, 28.0), Vec3::new(30.0, 62.0, 34.0)));
    scene
}

#[test]
fn a_report_near_the_wall_of_a_volume_makes_it_expire_sooner() {
    for method in METHODS {
        let mut scene = scene();
        let id = scene.insert(ObjectDesc::dynamic(ball(28.5)).max_speed(1.0).reported_on_expiry()).unwrap();
        let (mut query, view) = (query_by(method), view(method));
        let mut frame = |scene: &mut Scene, now: f64, report: Option<f32>| {
            let due = scene.begin_frame(now).unwrap();
            if let Some(x) = report {
                scene.update(id, ball(x), None).unwrap();
            }
            let seen = query.run(scene, &view).contains(id);
            scene.end_frame([query.pvs()]).unwrap();
            (due, seen)
        };
        assert!(!frame(&mut scene, 0.0, None).1, "{method:?}");
        let (_, high) = scene.tbv(id).unwrap().expect("it is hidden");
        // A jump to a tenth of a unit from the wall of its volume: there it has a tenth of a
        // second.
        let x = high.x as f32 - 0.35;
        frame(&mut scene, 0.001, Some(x));
        let (due, seen) = frame(&mut scene, 0.2, None);
        assert!(due.contains(&id) && seen, "{method:?}: due {due:?}, seen {seen}");
    }
}

#[test]
fn reports_back_and_forth_keep_one_expiry() {
    let mut scene = scene();
    let id = scene.insert(ObjectDesc::dynamic(ball(20.0)).max_speed(1.0).reported_on_expiry()).unwrap();
    let mut query = query_by(Method::point());
    scene.begin_frame(0.0).unwrap();
    look(&mut scene, &mut query, &view(Method::point()));
    let (low, high) = scene.tbv(id).unwrap().expect("it is hidden");
    let held = scene.memory().objects;
    for i in 0..100_000u32 {
        // Every report is a little nearer to a wall than the one before.
        let near = high.x as f32 - 0.3 - 0.2 * (1.0 - i as f32 / 1e5);
        let x = if i % 2 == 0 { near } else { low.x as f32 + 0.5 };
        scene.begin_frame(f64::from(i) * 1e-7).unwrap();
        scene.update(id, ball(x), None).unwrap();
        if i % 64 == 0 {
            look(&mut scene, &mut query, &view(Method::point()));
        }
    }
    assert!(scene.memory().objects < held + 16_384, "{} and {held}", scene.memory().objects);
    assert_eq!(scene.begin_frame(60.0).unwrap(), [id]);
}

#[test]
fn a_frame_without_end_loses_nobody() {
    for (method, end) in METHODS.into_iter().flat_map(|m| [(m, 0), (m, 1), (m, 2)]) {
        let mut scene = scene();
        let id = scene.insert(ObjectDesc::dynamic(ball(27.0)).max_speed(8.0).reported_on_expiry()).unwrap();
        let (mut query, view) = (query_by(method), view(method));
        scene.begin_frame(0.0).unwrap();
        assert!(!query.run(&scene, &view).contains(id));
        match end {
            0 => {}
            1 => drop(scene.end_frame([]).unwrap()),
            _ => drop(scene.end_frame([Query::new().pvs()]).unwrap()),
        }
        // It was in no set, and nobody asked for it: it may be 8 units away.
        let due = scene.begin_frame(1.0).unwrap();
        assert!(due.contains(&id) && query.run(&scene, &view).contains(id), "{method:?} {end}: {due:?}");
        // Told where it is, it is hidden again.
        scene.update(id, ball(27.0), None).unwrap();
        assert!(!query.run(&scene, &view).contains(id));
    }
}

#[test]
fn an_occluder_that_nobody_reports_hides_nothing() {
    for method in [Method::point(), Method::cell()] {
        let mut scene = empty();
        let block = |x: f32| Aabb::new(Vec3::new(x, 10.0, 10.0), Vec3::new(x + 4.0, 22.0, 22.0));
        let desc = ObjectDesc::dynamic(block(12.0)).occluder(block(12.0));
        let mover = scene.insert(desc.max_speed(8.0).reported_on_expiry()).unwrap();
        let ball = Sphere::new(Vec3::new(24.0, 16.0, 16.0), 0.5);
        let behind = scene.fixed(ball);
        let view = around(Vec3::new(4.5, 16.5, 16.5));
        let (mut query, mut kept) = (query_by(method), KeptQuery::new());
        scene.begin_frame(0.0).unwrap();
        let pvs = query.run(&scene, &view);
        assert!(pvs.contains(mover) && !pvs.contains(behind), "{method:?}");
        assert!(!kept.run(&scene, &view).contains(behind));
        scene.end_frame([query.pvs()]).unwrap();
        let opaque = scene.grid().cell_of(glam::DVec3::splat(14.5));
        assert!(scene.is_opaque(opaque));
        // It was seen, and ought to be reported. It is not, and may have left.
        scene.begin_frame(2.0).unwrap();
        assert!(!query.pvs().is_valid_for(&scene, &view) && !scene.is_opaque(opaque));
        let pvs = query.run(&scene, &view);
        assert!(pvs.contains(mover) && pvs.contains(behind), "{method:?}");
        assert!(kept.run(&scene, &view).contains(behind));
        // The report is late, but it comes.
        scene.update(mover, block(12.0), Some(block(12.0).into())).unwrap();
        let pvs = query.run(&scene, &view);
        assert!(pvs.contains(mover) && !pvs.contains(behind) && scene.is_opaque(opaque), "{method:?}");
        scene.remove(mover).unwrap();
        assert!(query.run(&scene, &view).contains(behind));
    }
}

#[test]
fn what_a_frame_showed_is_not_asked_for() {
    let mut scene = scene();
    let id = scene.insert(ObjectDesc::dynamic(ball(33.0)).max_speed(1.0).reported_on_expiry()).unwrap();
    let mut query = query_by(Method::point());
    for frame in 0..4 {
        let due = scene.begin_frame(f64::from(frame) * 0.1).unwrap();
        assert!(due.is_empty(), "{due:?}");
        scene.update(id, ball(33.0), None).unwrap();
        assert!(query.run(&scene, &view(Method::point())).contains(id));
        scene.end_frame([query.pvs()]).unwrap();
    }
}

/// How many reports are due in a frame of 100 hidden movers that stand on the floor of the level.
fn reports_due(y: f32, cell: f32) -> (f64, usize) {
    let mut scene = Scene::new(cell).unwrap();
    scene.solid(Aabb::new(Vec3::new(0.0, 0.0, 60.0), Vec3::new(128.0, 16.0, 62.0)));
    let mover = |i: usize| Sphere::new(Vec3::new(20.0 + 0.8 * i as f32, y, 30.0), 1.0);
    let ids: Vec<ObjectId> = (0..100)
        .map(|i| scene.insert(ObjectDesc::dynamic(mover(i)).max_speed(2.0).reported_on_expiry()).unwrap())
        .collect();
    let (mut query, view) = (Query::new(), around(Vec3::new(64.0, 3.0, 110.0)));
    let (mut total, mut shown) = (0, 0);
    for frame in 0..120 {
        let due = scene.begin_frame(f64::from(frame) / 60.0).unwrap();
        total += if frame > 10 { due.len() } else { 0 };
        for id in due {
            let i = ids.iter().position(|&other| other == id).unwrap();
            scene.update(id, mover(i), None).unwrap();
        }
        let pvs = query.run(&scene, &view);
        shown += ids.iter().filter(|&&id| frame > 10 && pvs.contains(id)).count();
        scene.end_frame([query.pvs()]).unwrap();
    }
    (total as f64 / 109.0, shown)
}

#[test]
fn what_stands_on_the_floor_of_a_grid_is_rarely_due() {
    let level = Aabb::new(Vec3::ZERO, Vec3::new(128.0, 16.0, 128.0));
    let fitted = cell_for(level, 500).unwrap();
    let high = reports_due(9.0, fitted);
    for (name, floor) in [("fitted", reports_due(1.0, fitted)), ("of a metre", reports_due(1.0, 1.0))] {
        // As rarely as far above the floor, and the wall hides them all the same.
        assert!(
            floor.0 < 2.0 * high.0 + 1.0 && high.0 < 5.0,
            "{name}: {} and {} reports due",
            floor.0,
            high.0
        );
        assert_eq!(floor.1, 0, "{name}");
    }
}

#[test]
fn an_unreported_object_may_leave_the_grid() {
    for method in METHODS {
        let mut scene = empty();
        let wall = Aabb::new(Vec3::new(12.0, -8.0, 0.0), Vec3::new(13.0, 20.0, 32.0));
        scene.solid(wall);
        let ball = Sphere::new(Vec3::new(16.5, 0.75, 16.5), 0.5);
        let id = scene.insert(ObjectDesc::dynamic(ball).max_speed(4.0).reported_on_expiry()).unwrap();
        let mut query = query_by(method);
        let behind = around(Vec3::new(4.5, 3.5, 16.5));
        scene.begin_frame(0.0).unwrap();
        look(&mut scene, &mut query, &behind);
        if matches!(method, Method::Frustum) {
            continue;
        }
        let (low, high) = scene.tbv(id).unwrap().unwrap_or_else(|| panic!("{method:?}: the wall hides it"));
        assert!(low.y < -1.0 && high.y > 2.0, "{low} {high}");
        // It may be below the floor, where eyes beside the wall look: inside the grid, below it and
        // far away.
        for eye in [Vec3::new(14.0, 5.0, 16.5), Vec3::new(15.0, -6.0, 12.0), Vec3::new(16.5, -90.0, 16.5)] {
            let down = Plane { normal: -Vec3::Y, offset: -0.2 };
            let view = View::from_planes(eye, &[down]).unwrap();
            assert!(query.run(&scene, &view).contains(id), "{method:?} from {eye}");
            assert!(!query.pvs().is_empty() && query.pvs().is_valid_for(&scene, &view));
        }
        scene.remove(id).unwrap();
    }
}

#[test]
fn an_object_that_is_due_is_in_every_set_though_its_old_place_is_out_of_the_view() {
    for method in METHODS {
        let mut scene = empty();
        // In the cell of the eye, and behind it.
        let ball = Sphere::new(Vec3::new(16.1, 16.5, 16.5), 0.05);
        let id = scene.insert(ObjectDesc::dynamic(ball).max_speed(1.0).reported_on_expiry()).unwrap();
        assert_eq!(scene.begin_frame(7.0).unwrap(), [id]);
        let eye = Vec3::new(16.5, 16.5, 16.5);
        let ahead = Plane { normal: Vec3::X, offset: -16.5 };
        let view = View::from_planes(eye, &[ahead]).unwrap();
        assert!(query_by(method).run(&scene, &view).contains(id), "{method:?}");
        scene.update(id, ball, None).unwrap();
        assert!(!query_by(method).run(&scene, &view).contains(id), "{method:?}");
    }
}

#[test]
fn whoever_is_overdue_is_in_each_set_once_until_it_is_reported() {
    // Behind the wall; the largest is in no zone.
    let shape = |i: usize, dice: &mut Random| {
        let at = |n: usize, dice: &mut Random| 6.0 + dice.below(n) as f32 * 0.5;
        Sphere::new(
            Vec3::new(at(36, dice), at(90, dice), 40.0),
            if i == 0 { 3.7 } else { 0.25 + (i % 3) as f32 * 0.5 },
        )
    };
    for (method, by_cell) in METHODS.into_iter().map(|m| (m, false)).chain([(Method::point(), true)]) {
        let (mut scene, mut dice) = (scene(), Random(7));
        let (mut query, view) = (query_by(method), view(method));
        // The bounds of each, and whether it was reported since the clock last moved.
        let mut balls: Vec<(ObjectId, Sphere, bool)> = Vec::new();
        let (mut now, mut counts) = (0.0, [0; 2]);
        for step in 0..1500 {
            if by_cell && step == 700 {
                query_by(Method::cell()).run(&scene, &view);
            }
            let i = dice.below(24);
            match dice.below(24) {
                _ if i >= balls.len() => {
                    let ball = shape(balls.len(), &mut dice);
                    let desc = ObjectDesc::dynamic(ball).max_speed(1.0).reported_on_expiry();
                    balls.push((scene.insert(desc).unwrap(), ball, true));
                }
                0..3 => {
                    // Or to the same time.
                    let passed = dice.below(2);
                    now += passed as f64;
                    balls.iter_mut().for_each(|ball| ball.2 &= passed == 0);
                    let mut due = scene.begin_frame(now).unwrap();
                    let mut expected: Vec<_> = balls.iter().filter(|b| !b.2).map(|b| b.0).collect();
                    due.sort_unstable();
                    expected.sort_unstable();
                    assert_eq!(due, expected, "{method:?} {step}");
                }
                3 => {
                    let by = Vec3::new(8.0, -16.0, 3.5);
                    scene.set_origin(by.as_dvec3()).unwrap();
                    scene.set_origin(DVec3::ZERO).unwrap();
                }
                4 => scene.set_layers(balls[i].0, 1 << dice.below(3)).unwrap(),
                5 => {
                    scene.remove(balls[i].0).unwrap();
                    balls.remove(i);
                }
                6 => scene = scene.clone(),
                7..9 => {
                    scene.set_bounds(balls[i].0, balls[i].1).unwrap();
                    balls[i].2 = true;
                }
                9 | 10 => {
                    scene.update_many(balls.iter().map(|b| (b.0, b.1))).unwrap();
                    balls.iter_mut().for_each(|ball| ball.2 = true);
                }
                way => {
                    let (id, ball, current) = &mut balls[i];
                    if way > 14 {
                        *ball = shape(usize::from(ball.radius < 3.0), &mut dice);
                    }
                    scene.update(*id, *ball, None).unwrap();
                    assert!(*current || !query.pvs().is_valid_for(&scene, &view), "{method:?} {step}");
                    *current = true;
                }
            }
            let overdue = balls.iter().filter(|b| !b.2).count();
            let mut found = query.run(&scene, &view).visible().to_vec();
            found.retain(|id| balls.iter().any(|b| b.0 == *id));
            let mut expected: Vec<_> = balls.iter().filter(|b| !b.2).map(|b| b.0).collect();
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, expected, "{method:?} {step}");
            counts[usize::from(overdue > 0)] += 1;
        }
        assert!(counts.iter().all(|&n| n > 100), "{counts:?}");
    }
}

#[test]
fn views_of_other_layers_put_nobody_whose_report_is_overdue_into_a_volume() {
    let mut scene = scene();
    let desc = ObjectDesc::dynamic(ball(20.0)).layers(0b10).max_speed(1.0).reported_on_expiry();
    let id = scene.insert(desc).unwrap();
    let (mut query, view) = (query_by(Method::point()), view(Method::point()).with_layers(0b01));
    let mut end = |scene: &mut Scene| {
        query.run(scene, &view);
        scene.end_frame([query.pvs()]).unwrap().hidden
    };
    assert_eq!(scene.begin_frame(1.0).unwrap(), [id]);
    assert_eq!(end(&mut scene), 0, "its place is not known");
    scene.update(id, ball(20.0), None).unwrap();
    assert_eq!(end(&mut scene), 1);
}
