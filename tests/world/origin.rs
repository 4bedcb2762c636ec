//! An origin that is set elsewhere: what an eye sees stays in the set, nothing from before is taken for a
//! result of now, and where nothing rounds, the sets are the same.

use crate::common::worlds::{SIZE, hiding, is_free, points_of};
use crate::common::*;

/// Boxes whose corners are multiples of a sixteenth.
fn exact_box() -> impl Strategy<Value = Aabb> {
    (prop::array::uniform3(0u16..480), prop::array::uniform3(1u16..160)).prop_map(|(min, size)| {
        let at = |v: [u16; 3]| Vec3::from_array(v.map(|v| f32::from(v) / 16.0));
        Aabb::new(at(min), at(min) + at(size))
    })
}

fn methods() -> [Method; 4] {
    [Method::point(), Method::Point(PointOptions::new().coherent(true)), Method::cell(), Method::Frustum]
}

proptest! {
    #![proptest_config(cases(96))]

    #[test]
    fn sets_are_the_same_where_nothing_rounds(
        walls in prop::collection::vec(exact_box(), 1..8),
        targets in prop::collection::vec(exact_box(), 1..20),
        dynamic in prop::collection::vec(exact_box(), 1..20),
        eye in vector(0.0..SIZE),
        offset in prop::array::uniform3(-4096i32..4096),
        far in prop::sample::select(vec![0.0, 1e5, 1e6, 4_194_304.5]),
        times in prop::sample::select(vec![0.5, 250.0]),
    ) {
        let mut scene = Scene::new(0.5).unwrap();
        // A level far away is as near as any to an origin near it.
        scene.set_origin(DVec3::splat(far)).unwrap();
        for &b in &walls {
            scene.solid(b);
        }
        for &b in &targets {
            scene.fixed(b);
        }
        let mut on_expiry = Vec::new();
        for (i, &b) in dynamic.iter().enumerate() {
            let desc = ObjectDesc::dynamic(b).max_speed(1.0);
            if i % 3 == 0 {
                on_expiry.push(scene.insert(desc.reported_on_expiry()).unwrap());
            } else {
                scene.insert(desc).unwrap();
            }
        }
        // Eyes and offsets are multiples of a sixteenth, too.
        let eye = (eye * 16.0).round() / 16.0;
        let offset = DVec3::from_array(offset.map(f64::from)) * times;
        let (place, own) = (eye.as_dvec3() + far, around(Vec3::ZERO));
        let view = scene.view(place, &own).unwrap();
        let mut queries = methods().map(query_by);
        scene.begin_frame(0.0).unwrap();
        // What is hidden goes into volumes.
        queries[0].run(&scene, &view);
        scene.end_frame([queries[0].pvs()]).unwrap();
        let seen = queries.each_mut().map(|query| sorted(query.run(&scene, &view)));
        let mut kept = KeptQuery::new();
        kept.run(&scene, &view);

        scene.set_origin(scene.origin() + offset).unwrap();
        let shifted = scene.view(place, &own).unwrap();
        prop_assert!(!kept.is_valid_for(&scene, &view) && !kept.is_valid_for(&scene, &shifted));
        for (query, seen) in queries.iter_mut().zip(&seen) {
            prop_assert!(!query.pvs().is_valid_for(&scene, &view));
            prop_assert!(!query.pvs().is_valid_for(&scene, &shifted));
            prop_assert!(!query.sight(&scene).is_some_and(|sight| sight.has_occlusion()));
            let found = sorted(query.run(&scene, &shifted));
            // Margins grow with the coordinates, so more objects may be found. The shift drops volumes:
            // an object that was visible only because its volume was revealed is tested at the place
            // of its last report now, and may be hidden there.
            let is_found = |id| found.contains(id) || on_expiry.contains(id);
            let alike = if times < 1.0 { found == *seen } else { seen.iter().all(is_found) };
            let coherent = matches!(query.method(), Method::Point(options) if options.coherent);
            prop_assert!(alike || coherent, "{:?}: {:?} {:?}", query.method(), found, seen);
        }
    }

    #[test]
    fn nothing_that_is_seen_is_lost_by_shifts(
        walls in prop::collection::vec((vector(0.0..SIZE), vector(0.0..6.0)), 1..8),
        targets in prop::collection::vec((vector(0.0..SIZE), vector(0.01..1.0)), 1..40),
        shifts in prop::collection::vec((vector(-3e4..3e4), vector(0.0..SIZE), vector(-0.4..0.4)), 1..4),
        method in 0usize..4,
    ) {
        let of = |(p, half): &(Vec3, Vec3)| Aabb::from_center(*p, *half);
        let (mut walls, mut targets) = (walls.iter().map(of).collect::<Vec<_>>(), targets.iter().map(of).collect::<Vec<_>>());
        let mut scene = empty();
        for &b in &walls {
            scene.solid(b);
        }
        let ids: Vec<ObjectId> = targets.iter().enumerate().map(|(i, &b)| {
            let at = Affine3A::from_translation(b.center());
            let own = Aabb::new(b.min - b.center(), b.max - b.center());
            let desc = match i % 4 {
                0 => ObjectDesc::fixed(b),
                1 => ObjectDesc::dynamic(b),
                2 => ObjectDesc::dynamic(b).max_speed(0.5).reported_on_expiry(),
                _ => ObjectDesc::dynamic(own).placed(at),
            };
            scene.insert(desc).unwrap()
        }).collect();
        let mut query = query_by(methods()[method]);
        let mut origin = Vec3::ZERO;
        for (frame, (offset, eye, step)) in shifts.iter().enumerate() {
            for id in scene.begin_frame(frame as f64 * 0.1).unwrap() {
                let i = ids.iter().position(|other| *other == id).unwrap();
                scene.update(id, targets[i], None).unwrap();
            }
            scene.set_origin(scene.origin() + offset.as_dvec3()).unwrap();
            origin += *offset;
            // As an application does, in single precision.
            for b in walls.iter_mut().chain(&mut targets) {
                *b = Aabb::new(b.min - *offset, b.max - *offset);
            }
            for (i, id) in ids.iter().enumerate().filter(|(i, _)| i % 4 == 1) {
                targets[i] = Aabb::new(targets[i].min + *step, targets[i].max + *step);
                scene.update(*id, targets[i], None).unwrap();
            }
            let eye = *eye - origin;
            let hiding = hiding(&walls, eye.as_dvec3());
            let pvs = query.run(&scene, &around(eye));
            for (i, id) in ids.iter().enumerate() {
                // What stands by its transform was rounded as a whole.
                let b = if i % 4 == 3 { scene.bounds(*id).unwrap().aabb() } else { targets[i] };
                let b = if i % 4 == 3 { Aabb::from_center(b.center(), (b.max - b.min) * 0.45) } else { b };
                let seen = points_of(&b, 3).any(|p| is_free(&hiding, eye.as_dvec3(), p));
                prop_assert!(!seen || pvs.contains(*id), "object {} in frame {}", i, frame);
            }
            scene.end_frame([query.pvs()]).unwrap();
        }
        for id in ids {
            scene.remove(id).unwrap();
        }
        prop_assert!(scene.len() == walls.len());
    }
}

#[test]
fn every_kind_of_shape_goes_with_the_origin() {
    let mut scene = empty();
    let at = Vec3::splat(8.0);
    let mesh = || {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        mesh(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    };
    let ball = Sphere::new(at, 1.0);
    let b = Aabb::from_center(at, Vec3::ONE);
    let turned = Obb::new(at, Vec3::ONE, Quat::from_rotation_y(0.3));
    let hull = Arc::new(Convex::from_points(&[at, at + Vec3::X, at + Vec3::Y, at + Vec3::Z]).unwrap());
    let instance = Instance::new(mesh(), Affine3A::from_translation(at)).unwrap();
    let descs = [
        ObjectDesc::fixed(ball).occluder(ball),
        ObjectDesc::fixed(b).occluder(b),
        ObjectDesc::fixed(turned).occluder(turned),
        ObjectDesc::fixed(b).occluder(hull),
        ObjectDesc::fixed(instance.clone()).occluder(instance.clone()),
        ObjectDesc::dynamic(b).occluder(b).layers(2),
        ObjectDesc::dynamic(mesh()).occluder(mesh()).placed(Affine3A::from_translation(at)),
    ];
    let ids = descs.map(|desc| scene.insert(desc).unwrap());
    let before: Vec<Aabb> = ids.iter().map(|id| scene.bounds(*id).unwrap().aabb()).collect();
    // Far shifts round, near ones hardly.
    for offset in
        [Vec3::new(100.25, -3.5, 0.1), Vec3::splat(1e5), Vec3::splat(-1e5), Vec3::new(-100.25, 3.5, -0.1)]
    {
        scene.set_origin(scene.origin() + offset.as_dvec3()).unwrap();
    }
    for (id, before) in ids.iter().zip(before) {
        let after = scene.bounds(*id).unwrap().aabb();
        assert!(after.min.abs_diff_eq(before.min, 0.2) && after.max.abs_diff_eq(before.max, 0.2));
        assert!(scene.occluder(*id).unwrap().is_some());
    }
    // An orbit ends where it began but for rounding, and an occluder never grows.
    let Some(casca::Occluder::Sphere(left)) = scene.occluder(ids[0]).unwrap() else { panic!() };
    assert!(
        left.radius < ball.radius && left.center.distance(ball.center) + left.radius <= ball.radius + 0.03
    );
    let moved = Affine3A::from_translation(Vec3::splat(3.0));
    scene.set_transform(ids[6], moved).unwrap();
    assert_eq!(scene.transform(ids[6]).unwrap(), Some(moved));

    let grid = *scene.grid();
    assert!(matches!(scene.set_origin(DVec3::NAN), Err(Error::NotFinite { .. })));
    assert!(matches!(scene.set_origin(DVec3::splat(1e15)), Err(Error::GridTooFar { .. })));
    assert_eq!(*scene.grid(), grid);
    assert!(matches!(scene.bounds(ids[1]).unwrap(), Bounds::Box(_)));
}

#[test]
fn meshes_in_world_space_become_instances_and_hide_on() {
    let mut scene = empty();
    // Two panels side by side, which share an edge.
    let panel = |y: f32| {
        let corners = [(y, -6.0), (y + 6.0, -6.0), (y + 6.0, 6.0), (y, 6.0)];
        let positions = corners.map(|(y, z)| Vec3::new(4.0, y, z)).to_vec();
        Arc::new(TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap())
    };
    let panels = [-6.0, 0.0].map(|y| scene.solid(panel(y)));
    let hidden = scene.fixed(Aabb::new(Vec3::new(8.0, 1.0, -1.0), Vec3::new(9.0, 2.0, 1.0)));
    let seen = scene.fixed(Aabb::new(Vec3::new(8.0, 11.0, -1.0), Vec3::new(9.0, 13.0, 1.0)));
    for origin in [DVec3::ZERO, DVec3::new(1000.3, -20.7, 3.1), DVec3::splat(-512.0)] {
        scene.set_origin(origin).unwrap();
        let is_instance = |id| matches!(scene.bounds(id).unwrap(), Bounds::Instance(_));
        assert!(origin == DVec3::ZERO || panels.into_iter().all(is_instance));
        let view = scene.view(DVec3::ZERO, &around(Vec3::ZERO)).unwrap();
        let mut query = Query::new();
        let pvs = query.run(&scene, &view);
        assert!(panels.iter().all(|&id| pvs.contains(id)), "from {origin}");
        assert!(pvs.contains(seen) && !pvs.contains(hidden), "from {origin}");
    }
    scene.remove(panels[0]).unwrap();
    assert_eq!(scene.len(), 3);
}

#[test]
fn a_ground_of_boxes_makes_the_same_cells_opaque() {
    use casca::internals::SceneInternals;
    let mut scene = empty();
    // Two boxes that fill cells together.
    for (a, b) in [(0.0, 3.5), (3.5, 9.0)] {
        scene.solid(Aabb::new(Vec3::new(a, 2.0, 2.0), Vec3::new(b, 5.0, 5.0)));
    }
    let count = scene.static_opacity().count();
    scene.set_origin(DVec3::new(1024.0, -64.0, 3.0)).unwrap();
    assert_eq!(scene.static_opacity().count(), count);
    for id in scene.ids().collect::<Vec<_>>() {
        scene.remove(id).unwrap();
    }
    assert_eq!((scene.static_opacity().count(), count), (0, 81));
}

#[test]
fn an_occluder_thinner_than_the_rounding_leaves_no_cells_behind() {
    // A ball that moves and hides: after the shift it hides nothing, and a large one has no place in
    // a zone.
    for (layers, time) in [(u64::MAX, 0.0), (0x0984_a428_3bd5_9140, 15.18)] {
        let mut scene = empty();
        scene.begin_frame(time).unwrap();
        /// Less than half a unit in the last place of the coordinates below.
        const THIN: f32 = 1.438_178e-12;
        let ball = Sphere::new(Vec3::new(9.9, -14.009_999, 5.85), THIN);
        let desc = ObjectDesc::dynamic(ball).occluder(ball).max_speed(19.78).layers(layers);
        let id = scene.insert(desc).unwrap();
        scene.set_origin(DVec3::new(13.219_999, 6.15, 8.32)).unwrap();
        let everywhere = Aabb::new(Vec3::splat(-30.0), Vec3::splat(30.0));
        scene.set_bounds(id, everywhere).unwrap();
        let mut query = Query::new();
        let seen = query.run(&scene, &around(Vec3::ZERO));
        assert!(seen.contains(id));
        scene.remove(id).unwrap();
    }
}

#[test]
fn what_is_hidden_is_found_where_cells_are_numbered_anew() {
    for on_expiry in [false, true] {
        let mut scene = empty();
        let wall = scene.solid(Aabb::new(Vec3::new(0.0, 0.0, 15.0), Vec3::new(32.0, 32.0, 17.0)));
        let ball = ObjectDesc::dynamic(Sphere::new(Vec3::new(16.0, 16.0, 8.0), 0.5)).max_speed(1.0);
        let id = scene.insert(if on_expiry { ball.reported_on_expiry() } else { ball }).unwrap();
        // The view ends 20 units beyond the eye along x.
        let near = Plane { normal: Vec3::NEG_X, offset: 20.0 };
        let (place, own) = (DVec3::new(16.0, 16.0, 24.0), View::from_planes(Vec3::ZERO, &[near]).unwrap());
        let mut query = Query::new();
        for frame in 0..20 {
            scene.begin_frame(f64::from(frame) / 60.0).unwrap();
            query.run(&scene, &scene.view(place, &own).unwrap());
            scene.end_frame([query.pvs()]).unwrap();
        }
        assert!(!query.pvs().contains(id), "the wall hides it");
        assert!(scene.tbv(id).unwrap().is_some());
        scene.set_origin(DVec3::new(4e5, 0.0, 0.0)).unwrap();
        scene.remove(wall).unwrap();
        assert!(query.run(&scene, &scene.view(place, &own).unwrap()).contains(id));
    }
}
