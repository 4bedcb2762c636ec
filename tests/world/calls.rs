//! Calls one by one: ids, old results, errors, budgets, and other threads.

use crate::common::*;

/// Pages of 512 m.
fn options(budget: usize) -> WorldOptions {
    WorldOptions::new(1.0).reach(1).budget(budget)
}

fn world(budget: usize) -> World {
    World::new(options(budget)).unwrap()
}

fn ball(x: f32, y: f32, z: f32) -> ObjectDesc {
    ObjectDesc::fixed(Sphere::new(Vec3::new(x, y, z), 1.0))
}

fn view_at(world: &World, eye: DVec3) -> View {
    world.scene().view(eye, &around(Vec3::ZERO)).unwrap()
}

fn see(world: &World, eye: DVec3) -> Pvs {
    Query::new().run(world.scene(), &view_at(world, eye)).clone()
}

#[test]
fn ids_and_keys_stay_over_shifts_and_are_never_given_twice() {
    let mut world = world(usize::MAX);
    let mut eye = DVec3::new(1e6, 10.0, -1e6);
    let mut known: BTreeSet<ObjectId> = BTreeSet::new();
    let mut keys = BTreeSet::new();
    let mut living: Vec<(ObjectId, u64)> = Vec::new();
    let mut most = 0;
    for round in 0..30 {
        eye.x += 400.0;
        let page = world.page_at(eye).unwrap();
        world
            .load(page, PageObjects::new((0..3).map(|i| ball(20.0 * i as f32, 10.0, 5.0))).unwrap())
            .unwrap();
        world.begin_frame(f64::from(round), eye).unwrap();
        for _ in 0..3 {
            let id = world.insert(ball(0.0, 0.0, 0.0), eye + DVec3::Y).unwrap();
            let key = world.scene().key(id).unwrap();
            assert!(known.insert(id) && keys.insert(key), "{id} was there before");
            living.push((id, key));
            most = most.max(world.scene().len());
            assert!(id.index() < most, "free slots are given first: {id} among {most}");
        }
        for (id, key) in &living {
            assert_eq!((world.scene().key(*id), world.scene().id_from_key(*key)), (Ok(*key), Ok(*id)));
        }
        let gone = living.remove(living.len() / 2).0;
        world.remove(gone).unwrap();
        assert_eq!(world.remove(gone), Err(Error::UnknownObject(gone)));
        assert!(!world.scene().contains(gone));
        if round % 4 == 3 {
            world.drop_page(page).unwrap();
        }
    }
    let pages: BTreeSet<PageId> =
        living.iter().map(|(id, _)| world.page_at(world.place(*id).unwrap()).unwrap()).collect();
    let in_pages: usize = pages.iter().map(|page| world.page_objects(*page).len()).sum();
    assert!(in_pages > 30 && world.scene().len() == living.len() + in_pages);
}

#[test]
fn results_from_before_a_shift_are_refused_as_those_of_another_scene() {
    let mut world = world(usize::MAX);
    let mut eye = DVec3::new(100.0, 10.0, 100.0);
    world.begin_frame(0.0, eye).unwrap();
    let id = world.insert(ObjectDesc::dynamic(Sphere::new(Vec3::ZERO, 1.0)), eye + DVec3::X * 9.0).unwrap();
    let mut query = Query::new();
    let mut kept = KeptQuery::new();
    let view = view_at(&world, eye);
    let old = query.run(world.scene(), &view).clone();
    kept.run(world.scene(), &view);
    let job = kept.prepare(world.scene(), &view);
    assert!(old.is_valid_for(world.scene(), &view) && query.sight(world.scene()).unwrap().has_occlusion());

    eye.x += 1500.0;
    assert!(world.begin_frame(1.0, eye).unwrap().shifted);
    assert_eq!(world.origin(), DVec3::new(1536.0, 0.0, 0.0));
    let now = view_at(&world, eye);
    assert!(!old.is_valid_for(world.scene(), &view) && !old.is_valid_for(world.scene(), &now));
    assert!(!query.sight(world.scene()).unwrap().has_occlusion());
    assert!(!kept.is_valid_for(world.scene(), &view) && !kept.is_valid_for(world.scene(), &now));
    let found = std::thread::spawn(move || job.run()).join().unwrap();
    assert!(!kept.install(found, world.scene()));
    assert!(kept.run(world.scene(), &now).contains(id));
    // It is passed over, and so nothing goes into volumes.
    assert_eq!(world.end_frame([&old]).unwrap().hidden, 0);
    let stranger = see(&World::new(options(1)).unwrap(), eye);
    assert_eq!(world.end_frame([&stranger]), Err(Error::ForeignPvs));
    assert!(world.end_frame([query.run(world.scene(), &now)]).is_ok());
    assert!(world.take_retired().is_some() && world.take_retired().is_none());
}

#[test]
fn a_frame_takes_in_and_out_no_more_than_its_budget_and_says_when_a_page_is_done() {
    let mut world = world(10);
    let eye = DVec3::splat(10.0);
    let (a, b) = (PageId::new(0, 0, 0), PageId::new(1, 0, 0));
    let objects = |n: usize| PageObjects::new((0..n).map(|_| ball(4.0, 4.0, 28.0))).unwrap();
    world.load(a, objects(25)).unwrap();
    world.load(b, objects(7)).unwrap();
    world.load(a, objects(2)).unwrap();
    let mut seen = Vec::new();
    for frame in 0..5 {
        let report = world.begin_frame(f64::from(frame), eye).unwrap();
        seen.push((world.scene().len(), report.loaded.clone(), report.dropped.clone()));
        assert_eq!(see(&world, eye).len(), world.scene().len());
        if frame == 3 {
            world.drop_page(a).unwrap();
            assert_eq!(world.drop_page(PageId::new(5, 0, 0)), Err(Error::UnknownPage { x: 5, y: 0, z: 0 }));
        }
    }
    let none = Vec::new;
    let expected = [(10, none()), (20, none()), (30, vec![a]), (34, vec![b, a])];
    for (frame, (count, loaded)) in expected.into_iter().enumerate() {
        assert_eq!(seen[frame], (count, loaded, none()));
    }
    assert_eq!(seen[4], (24, none(), none()));
    assert!(!world.is_loaded(a) && world.is_loaded(b) && world.page_objects(b).len() == 7);
    // It may be loaded again at once.
    world.load(a, objects(1)).unwrap();
    let report = world.settle(eye).unwrap();
    assert_eq!((report.dropped, report.loaded, world.scene().len()), (vec![a], vec![a], 8));
    // What waits is dropped at once.
    world.load(b, objects(30)).unwrap();
    world.drop_page(b).unwrap();
    assert_eq!(world.settle(eye).unwrap().dropped, vec![b]);
    assert_eq!(world.scene().len(), 1);
}

#[test]
fn an_origin_that_moves_in_steps_keeps_everything_in_sight() {
    let mut world = world(64);
    let mut eye = DVec3::new(0.0, 10.0, 0.0);
    let wall = Aabb::new(Vec3::new(30.0, -50.0, -90.0), Vec3::new(33.0, 80.0, 90.0));
    let mut ids = Vec::new();
    for i in 0..30 {
        let at = eye + DVec3::new(200.0 * f64::from(i), 0.0, 0.0);
        let wall = world.insert(ObjectDesc::fixed(wall).occluder(wall), at).unwrap();
        let before = world.insert(ball(20.0, 0.0, 0.0), at).unwrap();
        let behind = world.insert(ObjectDesc::dynamic(Sphere::new(Vec3::X * 50.0, 1.0)), at).unwrap();
        ids.push([wall, before, behind]);
    }
    let (mut shifts, mut steps, mut at_once) = (0, 0, 0);
    let mut query = Query::new();
    for frame in 0..230 {
        eye.x = 25.0 * f64::from(frame);
        let report = world.begin_frame(f64::from(frame) * 0.1, eye).unwrap();
        shifts += usize::from(report.shifted);
        steps += usize::from(world.is_shifting());
        at_once += usize::from(report.shifted && !world.is_shifting() && steps == 0);
        let pvs = query.run(world.scene(), &view_at(&world, eye));
        for (i, [wall, before, behind]) in ids.iter().enumerate() {
            let x = 200.0 * i as f64 - eye.x;
            // The eye is between the wall of its stretch and the one before.
            let own = x > -30.0 && x <= 170.0 && (30.0 + x) > 0.0;
            if own {
                assert!(pvs.contains(*wall) && pvs.contains(*before), "frame {frame}, {i}");
                assert!(!pvs.contains(*behind), "frame {frame}, {i}: the wall hides it");
            }
        }
        world.end_frame([query.pvs()]).unwrap();
    }
    assert!(shifts >= 4 && steps > 20 * shifts && at_once == 0, "{shifts} shifts in {steps} frames");
}

#[test]
fn changes_during_a_shift_are_in_both_scenes() {
    let mut world = world(1);
    let eye = DVec3::new(0.0, 10.0, 0.0);
    let ids: Vec<ObjectId> = (0..8)
        .map(|i| world.insert(ball(0.0, 0.0, 0.0), eye + DVec3::Z * f64::from(10 * i + 5)).unwrap())
        .collect();
    let there = eye + DVec3::X * 1600.0;
    for _ in 0..4 {
        assert!(!world.begin_frame(0.0, there).unwrap().shifted && world.is_shifting());
    }
    // Some were taken over, the others were not.
    for (i, id) in ids.iter().enumerate() {
        match i % 4 {
            0 => world.remove(*id).unwrap(),
            1 => world.set_place(*id, there + DVec3::Z * 3.0).unwrap(),
            2 => {
                world.set_layers(*id, 2).unwrap();
                world.set_user_data(*id, 77).unwrap();
            }
            _ => world.set_shapes(*id, Sphere::new(Vec3::ZERO, 7.0), None).unwrap(),
        }
    }
    // In the slots of those that were removed: one was passed, the other one was not.
    let new = [0, 1].map(|_| world.insert(ball(0.0, 1.0, 0.0), there).unwrap());
    assert!(world.settle(there).unwrap().shifted && !world.is_shifting());
    let scene = world.scene();
    for (i, id) in ids.iter().enumerate() {
        match i % 4 {
            0 => assert!(!scene.contains(*id)),
            1 => {
                assert_eq!(world.place(*id), Ok(there + DVec3::Z * 3.0));
                let middle = (there - world.origin()).as_vec3() + Vec3::Z * 3.0;
                assert_eq!(scene.bounds(*id).unwrap().aabb().center(), middle);
            }
            2 => assert_eq!((scene.layers(*id), scene.user_data(*id)), (Ok(2), Ok(77))),
            _ => assert!((scene.bounds(*id).unwrap().aabb().max.y - 17.0).abs() < 1e-5),
        }
    }
    assert!(new.iter().all(|id| scene.contains(*id)) && scene.len() == 8);
}

#[test]
fn movers_reported_on_expiry_are_due_after_a_shift_and_count_as_visible_until_then() {
    let mut world = world(usize::MAX);
    let mut eye = DVec3::new(0.0, 10.0, 0.0);
    let wall = Aabb::new(Vec3::new(10.0, -50.0, -90.0), Vec3::new(13.0, 80.0, 90.0));
    world.insert(ObjectDesc::fixed(wall).occluder(wall), eye).unwrap();
    let bird = ObjectDesc::dynamic(Sphere::new(Vec3::ZERO, 0.5)).max_speed(5.0).reported_on_expiry();
    let bird = world.insert(bird, eye + DVec3::X * 40.0).unwrap();
    let mut query = Query::new();
    let mut frame = |world: &mut World, now: f64, eye: DVec3, told: Option<DVec3>| {
        let report = world.begin_frame(now, eye).unwrap();
        told.into_iter().for_each(|at| world.set_place(bird, at).unwrap());
        let contains = query.run(world.scene(), &view_at(world, eye)).contains(bird);
        world.end_frame([query.pvs()]).unwrap();
        (report, contains)
    };
    let behind = DVec3::new(40.0, 10.0, 1.0);
    frame(&mut world, 0.0, eye, None);
    let (report, contains) = frame(&mut world, 0.01, eye, None);
    assert!(!contains && report.due.is_empty(), "it is in a volume");
    // It is not known where it is, as soon as the origin has moved.
    eye.x -= 1500.0;
    assert!(world.settle(eye).unwrap().shifted);
    assert!(see(&world, eye).contains(bird));
    let (report, contains) = frame(&mut world, 0.02, eye, Some(behind));
    assert!(report.due == [bird] && !contains);
    let (report, contains) = frame(&mut world, 0.03, eye, None);
    assert!(report.due.is_empty() && !contains, "it is in a volume again");
    // The same time: even so its place is not that of the last report.
    eye.x -= 1500.0;
    let (report, contains) = frame(&mut world, 0.03, eye, None);
    assert!(report.shifted && contains);
    assert_eq!(report.due, [bird]);
    world.set_place(bird, behind).unwrap();
    assert!(!see(&world, eye).contains(bird));
}

#[test]
fn pages_are_prepared_and_results_found_on_other_threads() {
    let mut world = world(5);
    let eye = DVec3::new(-2e6, 10.0, 3e5);
    let mut query = Query::new();
    std::thread::scope(|scope| {
        let (give, take) = std::sync::mpsc::channel();
        scope.spawn(move || {
            for x in 0..12 {
                let objects = PageObjects::new((0..20).map(|i| ball(25.0 * i as f32, 10.0, 30.0))).unwrap();
                give.send((x, objects)).unwrap();
            }
        });
        let page = world.page_at(eye).unwrap();
        let mut kept = KeptQuery::new();
        for frame in 0..80 {
            if let Ok((x, objects)) = take.recv() {
                world.load(PageId { x: page.x + x, ..page }, objects).unwrap();
            }
            let eye = eye + DVec3::X * 20.0 * f64::from(frame);
            world.begin_frame(f64::from(frame), eye).unwrap();
            let view = view_at(&world, eye);
            // A job reads a copy while the world goes on.
            let job = kept.prepare(world.scene(), &view);
            let job = scope.spawn(move || job.run());
            assert_eq!(query.run(world.scene(), &view).len(), world.scene().len(), "nothing hides");
            assert_eq!(kept.run(world.scene(), &view).len(), world.scene().len());
            kept.install(job.join().unwrap(), world.scene());
        }
    });
    assert_eq!(world.scene().len(), 240);
}

#[test]
fn what_makes_no_sense_is_refused_and_changes_nothing() {
    assert!(matches!(World::new(WorldOptions::new(0.0)), Err(Error::CellSize(_))));
    assert!(matches!(World::new(WorldOptions::new(f32::NAN)), Err(Error::CellSize(_))));
    for options in [options(0), options(1).reach(0), options(1).reach(17)] {
        assert!(matches!(World::new(options), Err(Error::Setting { .. })));
    }
    let mut world = world(usize::MAX);
    for at in [DVec3::NAN, DVec3::X * f64::INFINITY] {
        assert!(matches!(world.begin_frame(0.0, at), Err(Error::NotFinite { .. })));
        assert!(matches!(world.insert(ball(0.0, 0.0, 0.0), at), Err(Error::NotFinite { .. })));
    }
    assert!(matches!(world.begin_frame(f64::NAN, DVec3::ZERO), Err(Error::NotFinite { .. })));
    assert!(matches!(world.begin_frame(0.0, DVec3::X * 1e30), Err(Error::TooFar { .. })));
    assert!(matches!(world.page_at(DVec3::X * 1e15), Err(Error::TooFar { .. })));
    let far = PageId::new(0, i32::MIN, 0);
    assert!(matches!(world.load(far, PageObjects::default()), Err(Error::TooFar { .. })));
    let huge = Aabb::new(Vec3::ZERO, Vec3::ONE);
    let huge = ObjectDesc::fixed(huge).placed(Affine3A::from_scale(Vec3::splat(f32::MAX)));
    assert!(matches!(world.insert(huge, DVec3::ZERO), Err(Error::NotFinite { .. })));
    assert!(world.insert(ball(f32::NAN, 0.0, 0.0), DVec3::ZERO).is_err());
    let twisted = ball(0.0, 0.0, 0.0).placed(Affine3A::from_scale(Vec3::new(1.0, 2.0, 1.0)));
    assert!(matches!(PageObjects::new([twisted]), Err(Error::SphereScale { .. })));
    let id = world.insert(ball(0.0, 0.0, 0.0), DVec3::splat(1e9)).unwrap();
    let scale = Affine3A::from_scale(Vec3::new(1.0, 2.0, 1.0));
    assert!(world.set_transform(id, DVec3::ZERO, scale).is_err());
    assert_eq!((world.place(id), world.page(id)), (Ok(DVec3::splat(1e9)), Ok(None)));
    // The farthest place of all, and views from there.
    let end = DVec3::new((1u64 << 36) as f64, 100.0, -((1u64 << 36) as f64));
    world.settle(end).unwrap();
    assert!(see(&world, end).contains(id));
    assert!(world.scene().view(end * 1e30, &around(Vec3::ZERO)).is_err());
    let b = world.scene_box(end - 0.3, end + 0.3).unwrap();
    assert!(b.contains((end - world.origin()).as_vec3()) && (b.max - b.min).max_element() < 0.7);
    world.remove(id).unwrap();
    assert_eq!(world.set_place(id, end), Err(Error::UnknownObject(id)));
    let mut frustum = query_by(Method::Frustum);
    assert!(frustum.run(world.scene(), &view_at(&world, end)).is_empty());
    assert!(format!("{world:?}").contains("World") && world.memory_bytes() > 0);
}
