//! Sets that are kept over frames: while [`Pvs::is_valid_for`] says so, they have all that a new
//! query finds; and copies of a scene, whose sets and ids are their own.

use crate::common::*;

fn ball(x: f32) -> Sphere {
    Sphere::new(Vec3::new(x, 32.0, 36.5), 0.25)
}

/// A wall that ends at x = 32, and a mover behind it near its end.
fn scene() -> (Scene, ObjectId) {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(2.0, 2.0, 28.0), Vec3::new(32.0, 62.0, 34.0)));
    let id = scene.insert(ObjectDesc::dynamic(ball(30.5)).max_speed(8.0)).unwrap();
    (scene, id)
}

#[test]
fn a_set_does_not_hold_once_what_is_in_a_revealed_volume_moves() {
    for method in [Method::point(), Method::cell()] {
        let (mut scene, id) = scene();
        let mut kept = query_by(method);
        let view = around(Vec3::new(30.5, 32.5, 10.5));
        scene.begin_frame(0.0).unwrap();
        look(&mut scene, &mut kept, &view);
        scene.begin_frame(0.1).unwrap();
        let pvs = kept.run(&scene, &view);
        assert!(
            !pvs.contains(id) && pvs.revealed().contains(&id) && pvs.is_valid_for(&scene, &view),
            "{method:?}"
        );
        let mut appeared = false;
        for i in 1..16 {
            scene.update(id, ball(30.5 + 0.25 * i as f32), None).unwrap();
            let found = query_by(method).run(&scene, &view).contains(id);
            let pvs = kept.pvs();
            assert!(pvs.contains(id) || !found || !pvs.is_valid_for(&scene, &view), "{method:?} step {i}");
            appeared |= found && scene.tbv(id).unwrap().is_some();
        }
        assert!(appeared, "{method:?}: it came into sight inside of its volume");
    }
}

#[test]
fn a_set_that_another_camera_outlives_does_not_hold_either() {
    let (mut scene, id) = scene();
    let (mut main, mut client) = (Query::new(), query_by(Method::cell()));
    let here = around(Vec3::new(12.5, 32.5, 4.5));
    let there = around(Vec3::new(30.5, 32.5, 10.5));
    for (frame, x) in [30.5f32, 30.5, 30.7, 31.2, 31.8, 32.6, 33.4].into_iter().enumerate() {
        scene.begin_frame(frame as f64 * 0.1).unwrap();
        scene.update(id, ball(x), None).unwrap();
        main.run(&scene, &here);
        if !client.pvs().is_valid_for(&scene, &there) {
            client.run(&scene, &there);
        }
        scene.end_frame([main.pvs()]).unwrap();
        let found = query_by(Method::cell()).run(&scene, &there).contains(id);
        assert!(client.pvs().contains(id) || !found, "frame {frame}");
    }
}

/// The occluder of a hidden object is drawn when its volume is revealed: if it moves, what it hid
/// may be seen.
#[test]
fn a_set_does_not_hold_once_an_occluder_in_a_revealed_volume_moves() {
    let mut scene = empty();
    let view = around(Vec3::new(4.5, 32.5, 32.5));
    let away = around(Vec3::new(60.5, 2.5, 2.5));
    let screen = Aabb::new(Vec3::new(50.0, 0.0, 0.0), Vec3::new(51.0, 20.0, 20.0));
    let block = |y: f32| Aabb::from_center(Vec3::new(30.0, y, 32.5), Vec3::new(1.0, 3.0, 3.0));
    let mover = scene.insert(ObjectDesc::dynamic(block(32.5)).occluder(block(32.5)).max_speed(8.0)).unwrap();
    let behind = scene.fixed(Sphere::new(Vec3::new(50.0, 32.5, 32.5), 0.5));
    // Put into a volume by a camera that it is hidden from.
    let hide = scene.solid(screen);
    scene.begin_frame(0.0).unwrap();
    let mut query = Query::new();
    let nothing = casca::Plane { normal: Vec3::X, offset: -1e6 };
    look(&mut scene, &mut query, &View::from_planes(away.eye().unwrap().as_vec3(), &[nothing]).unwrap());
    assert!(scene.tbv(mover).unwrap().is_some());
    let pvs = query.run(&scene, &view);
    assert!(pvs.contains(mover) && pvs.revealed().contains(&mover) && pvs.contains(hide));
    assert!(!pvs.contains(behind), "drawn though in a volume");
    scene.update(mover, block(36.8), Some(block(36.8).into())).unwrap();
    assert!(scene.tbv(mover).unwrap().is_some(), "still in its volume");
    let kept = query.pvs().clone();
    let found = query.run(&scene, &view).contains(behind);
    assert!(found && !kept.is_valid_for(&scene, &view));
}

#[test]
fn copies_of_a_scene_are_scenes_of_their_own() {
    let mut a = empty();
    let wall = Aabb::new(Vec3::new(8.0, 0.0, 0.0), Vec3::new(10.0, 32.0, 32.0));
    let w = a.solid(wall);
    let far = a.fixed(Sphere::new(Vec3::new(20.0, 16.0, 16.0), 1.0));
    let gone = a.fixed(Sphere::new(Vec3::new(3.0, 3.0, 16.0), 0.5));
    let view = around(Vec3::new(2.5, 16.5, 16.5));
    let mut query = Query::new();
    assert!(!query.run(&a, &view).contains(far));
    let mut b = a.clone();
    // What was there before is known to both.
    assert!(a.bounds(far).is_ok() && b.bounds(far).is_ok());
    a.remove(gone).unwrap();
    b.remove(w).unwrap();
    assert!(!query.pvs().is_valid_for(&b, &view), "a set of before");
    query.run(&a, &view);
    assert!(!query.pvs().is_valid_for(&b, &view) && query.pvs().is_valid_for(&a, &view));
    assert_eq!(b.end_frame([query.pvs()]), Err(Error::ForeignPvs));
    assert_eq!(query.pvs().draw_list(&b, &DrawOptions::default(), &mut Vec::new()), Err(Error::ForeignPvs));
    // What came after is known to one.
    let small = |at: f32| ObjectDesc::fixed(Sphere::new(Vec3::splat(at), 0.1));
    let (x, y) = (a.insert(small(1.0)).unwrap(), b.insert(small(2.0)).unwrap());
    assert_ne!(x, y);
    assert_eq!(a.bounds(y).unwrap_err(), Error::UnknownObject(y));
    assert_eq!(b.remove(x).unwrap_err(), Error::UnknownObject(x));
    // In the place of the wall, which is gone from b only, b has y: the id of the wall is not its.
    assert!(b.bounds(w).is_err() && a.bounds(w).is_ok());
    assert!(query.run(&b, &view).contains(y) && !query.pvs().contains(x) && query.pvs().contains(far));
    let mut c = b.clone();
    c.remove(y).unwrap();
    let z = c.insert(small(3.0)).unwrap();
    assert!(b.bounds(z).is_err() && b.bounds(y).is_ok() && c.bounds(y).is_err() && c.bounds(z).is_ok());
}

#[derive(Debug, Clone)]
enum Step {
    Move(usize, Vec3),
    /// A new set from an eye, given to the end of the frame or not.
    Look(usize, bool),
    End,
    Time(f64),
}

fn step() -> impl Strategy<Value = Step> {
    let offset = points(-0.8..0.8, 0.4);
    prop_oneof![
        8 => (any::<usize>(), offset).prop_map(|(w, o)| Step::Move(w, o)),
        4 => (0..3usize, any::<bool>()).prop_map(|(e, g)| Step::Look(e, g)),
        2 => Just(Step::End),
        1 => (0.0..0.2f64).prop_map(Step::Time),
    ]
}

/// Moves, queries of which only some are given to the end of the frame, and sets that are kept
/// while they hold.
fn play(method: Method, steps: Vec<Step>) -> Result<(), TestCaseError> {
    let mut scene = empty();
    for (x, y) in [(10.0, 0.0), (10.0, 14.0)] {
        scene.solid(Aabb::new(Vec3::new(x, y, 0.0), Vec3::new(x + 2.0, y + 10.0, 24.0)));
    }
    let mut movers: Vec<(ObjectId, Sphere)> = (0..10)
        .map(|i| {
            let at = Vec3::new(13.5 + (i % 3) as f32 * 2.0, 4.0 + (i / 3) as f32 * 4.0, 12.0);
            let sphere = Sphere::new(at, 0.4);
            let desc = ObjectDesc::dynamic(sphere).max_speed(4.0);
            (scene.insert(if i % 2 == 0 { desc.occluder(sphere) } else { desc }).unwrap(), sphere)
        })
        .collect();
    let views =
        [Vec3::new(3.5, 12.5, 12.5), Vec3::new(3.5, 3.5, 12.5), Vec3::new(20.5, 12.5, 3.5)].map(around);
    let mut kept: [Option<Pvs>; 3] = [None, None, None];
    let mut given: Vec<Pvs> = Vec::new();
    let mut now = 0.0;
    for step in steps {
        match step {
            Step::Move(which, offset) => {
                let i = which % movers.len();
                let (id, sphere) = &mut movers[i];
                sphere.center = (sphere.center + offset).clamp(Vec3::ONE, Vec3::splat(23.0));
                scene.update(*id, *sphere, i.is_multiple_of(2).then(|| (*sphere).into())).unwrap();
            }
            Step::Look(eye, give) => {
                let mut query = query_by(method);
                let pvs = query.run(&scene, &views[eye]).clone();
                given.extend(give.then(|| pvs.clone()));
                kept[eye] = Some(pvs);
            }
            Step::End => drop(scene.end_frame(&std::mem::take(&mut given)).unwrap()),
            Step::Time(by) => {
                now += by;
                scene.begin_frame(now).unwrap();
            }
        }
        for (pvs, view) in kept.iter().zip(&views) {
            let Some(pvs) = pvs.as_ref().filter(|p| p.is_valid_for(&scene, view)) else { continue };
            let mut query = query_by(method);
            let found: BTreeSet<ObjectId> = query.run(&scene, view).visible().iter().copied().collect();
            let lost: Vec<_> = found.iter().filter(|id| !pvs.contains(**id)).collect();
            prop_assert!(lost.is_empty(), "a kept set of {:?} lacks {:?}", method, lost);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn kept_sets_have_all_that_new_ones_have(steps in prop::collection::vec(step(), 1..60), cell in any::<bool>()) {
        play(if cell { Method::cell() } else { Method::point() }, steps)?;
    }
}
