//! Input that makes no sense: nothing is culled wrongly, nothing panics.

mod common;

use common::*;

#[test]
fn transforms_that_make_no_sense_hide_nothing() {
    let bad = [
        Transform::from_xyz(f32::NAN, 0.0, 0.0),
        Transform::from_xyz(f32::INFINITY, 0.0, 0.0),
        Transform::from_scale(Vec3::ZERO),
        Transform::from_scale(Vec3::new(9.0, 0.0, 9.0)),
        Transform::from_scale(Vec3::splat(f32::NAN)),
        Transform::from_scale(Vec3::splat(1e30)),
        Transform::from_scale(Vec3::splat(f32::MAX)),
        Transform::from_scale(Vec3::splat(1e-40)),
        Transform::from_scale(Vec3::new(-9.0, 9.0, 9.0)),
        Transform::from_rotation(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)),
        Transform::from_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
    ];
    let wall = Transform::from_scale(Vec3::new(30.0, 30.0, 1.0));
    // The last two have occluders of their own, and move.
    let still = bad.len() as u32;
    let bad = [&bad[..], &bad[..2]].concat();
    let count = bad.len() as u32;
    let mut pair = Pair::new(|world| {
        let cube = world.resource::<Cube>().0.clone();
        (0..count).for_each(|nr| _ = opaque(world, nr, Vec3::ZERO, wall.scale));
        (still..count).for_each(|nr| on(world, nr, |it| done(it.insert(Occluder(cube.clone())))));
        things_behind(world, count);
    });
    for frame in 0..60 {
        let (ours, bevys) = pair.frame(|world| {
            for (nr, bad) in (0..).zip(&bad) {
                let entity = entity(world, nr);
                let mut at = world.get_mut::<Transform>(entity).unwrap();
                match frame % 30 {
                    20 => *at = *bad,
                    25 => *at = wall,
                    _ if nr >= still && frame % 30 < 20 => at.translation.y += 0.01,
                    _ => {}
                }
            }
        });
        match frame % 30 {
            // In the same frame.
            20..25 => assert_eq!(ours, bevys, "frame {frame}"),
            10..20 => assert!(ours[&CAMERA].iter().all(|nr| *nr < count), "frame {frame}"),
            _ => {}
        }
    }
    // All are managed again.
    let world = pair.ours.world_mut();
    let mut managed = world.query::<(&Nr, &InScene)>();
    assert_eq!(managed.iter(world).count() as u32, count + 50);
}

#[test]
fn meshes_that_make_no_sense_hide_nothing() {
    let square = || vec![[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0], [-9.0f32, 9.0, 0.0]];
    use PrimitiveTopology::{LineList, TriangleList, TriangleStrip};
    let empty = |topology| Mesh::new(topology, RenderAssetUsages::default());
    let mesh = |topology, positions: Vec<[f32; 3]>, indices: &[u32]| {
        empty(topology)
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
            .with_inserted_indices(Indices::U32(indices.to_vec()))
    };
    let good = [0, 1, 2, 0, 2, 3];
    let make = || {
        let nan = square().into_iter().map(|[x, y, _]| [x, y, f32::NAN]).collect();
        [
            (empty(TriangleList), "positions in its mesh cannot be read"),
            (mesh(TriangleList, vec![], &[]), "no triangles"),
            (mesh(TriangleList, square(), &[0, 1, 2, 0, 2, 9]), "triangle 1 names vertex 9"),
            (mesh(TriangleList, square(), &[0, 1]), "no triangles"),
            (mesh(TriangleList, nan, &good), "must be finite"),
            (mesh(LineList, square(), &good), "not a list of triangles"),
            (mesh(TriangleStrip, square(), &good), "not a list of triangles"),
            (mesh(TriangleList, square(), &[0, 1, 2, 0, 2, 3, 0, 1, 2]), "3 triangles"),
        ]
    };
    let mut pair = Pair::new(|world| {
        let settings = world.get_resource_mut::<CascaSettings>();
        settings.into_iter().for_each(|mut settings| settings.most_triangles = 2);
        let meshes = make().map(|(mesh, _)| world.resource_mut::<Assets<Mesh>>().add(mesh));
        let count = meshes.len() as u32;
        for (nr, mesh) in (0..).zip(meshes) {
            // With bounds of their own, since some have none.
            let bounds = Aabb::from_min_max(Vec3::splat(-9.0), Vec3::splat(9.0));
            world.spawn((Nr(nr), Mesh3d(mesh.clone()), Transform::default(), bounds, Opaque::Both));
            world.spawn((Nr(nr + count), Mesh3d(mesh.clone()), Transform::default(), bounds, Occluder(mesh)));
        }
        world.spawn((Nr(900), Mesh3d(Handle::default()), Transform::default(), Opaque::Both));
        things_behind(world, 2 * count);
    });
    for _ in 0..10 {
        let (ours, bevys) = pair.frame(|_| {});
        assert_eq!(ours, bevys);
    }
    assert_eq!(pair.ours.world().resource::<CascaScene>().occluders(), 0);
    for (nr, (_, why)) in (0..).zip(make().into_iter().chain(make())) {
        let found = why_not(&mut pair.ours, nr).unwrap().to_string();
        assert!(found.contains(why), "{nr}: {found}");
    }
    assert_eq!(why_not(&mut pair.ours, 900), Some(WhyNot::NoMesh));
}

#[test]
fn cameras_and_lights_that_make_no_sense_cull_as_bevy_does() {
    let lens = |fov, aspect_ratio, near| {
        Projection::Perspective(PerspectiveProjection { fov, aspect_ratio, near, ..Default::default() })
    };
    let good = (1.0, 1.0, 0.1);
    let lenses = [(0.0, 1.0, 0.1), (f32::NAN, 1.0, 0.1), (1.0, 0.0, 0.1), (1.0, f32::INFINITY, 0.1)];
    let lenses = lenses.into_iter().chain([(1.0, 1.0, 0.0), (1.0, 1.0, f32::NAN), good]);
    // Bevy itself takes no others in a build with assertions: they have no direction.
    let places = [Transform::from_xyz(f32::NAN, 0.0, 0.0), Transform::from_xyz(0.0, f32::INFINITY, 0.0)];
    let views = lenses.map(|lens| (lens, Transform::from_xyz(0.0, 0.0, 20.0)));
    let views = views.chain(places.map(|place| (good, place)));
    let mut pair = Pair::new(|world| {
        things_behind(world, 0);
        for (nr, ((fov, ratio, near), place)) in (CAMERA + 1..).zip(views.clone()) {
            let camera = Camera { order: nr as isize, ..Default::default() };
            world.spawn((Nr(nr), Camera3d::default(), camera, lens(fov, ratio, near), place));
        }
        for (nr, place) in (2_000_000..).zip(places) {
            let sun = DirectionalLight { shadow_maps_enabled: true, ..Default::default() };
            world.spawn((Nr(nr), sun, place));
            let lamp = PointLight { shadow_maps_enabled: true, range: f32::NAN, ..Default::default() };
            world.spawn((Nr(nr + 10), lamp, place));
        }
    });
    for _ in 0..5 {
        let (ours, bevys) = pair.frame(|_| {});
        assert_eq!(ours, bevys);
    }
}

#[test]
fn settings_that_make_no_sense_cull_by_frustum() {
    let mut pair = Pair::new(|world| {
        opaque(world, 0, Vec3::ZERO, Vec3::new(30.0, 30.0, 1.0));
        things_behind(world, 1);
    });
    let options = casca::PointOptions::new().pixel_degrees(f32::NAN);
    pair.ours.insert_resource(CascaSettings { options, ..Default::default() });
    let (ours, bevys) = pair.frame(|_| {});
    assert_eq!(ours, bevys);
    // Nothing is taken over, and nothing is ever still.
    let (most_new, still_after, most_triangles) = (0, u32::MAX, 0);
    pair.ours.insert_resource(CascaSettings { most_new, still_after, most_triangles, ..Default::default() });
    for nr in 100..105 {
        pair.frame(|world| done(opaque(world, nr, Vec3::ZERO, Vec3::ONE)));
        assert_eq!(why_not(&mut pair.ours, nr), Some(WhyNot::Waits));
    }
}

#[test]
fn far_from_the_origin_and_in_huge_worlds_nothing_visible_is_lost() {
    for far in [1e4, 1e6] {
        let mut pair = Pair::new(|world| {
            let origin = Vec3::new(far, 0.0, -far);
            for i in 0..200u32 {
                let at = Vec3::new((i % 20) as f32 * 6.0, 0.0, (i / 20) as f32 * 9.0);
                let size = Vec3::new(1.0 + (i % 7) as f32, 6.0, 2.0);
                opaque(world, i, origin + at, size);
            }
            // Things at the ends of the world.
            for (nr, at) in (200..).zip([-far * 30.0, far * 30.0, far * 1e6]) {
                opaque(world, nr, Vec3::new(at, 0.0, 0.0), Vec3::splat(far));
            }
            let eye = Transform::from_translation(origin + Vec3::new(50.0, 1.0, -30.0));
            spawn_camera(world, CAMERA, eye.looking_to(Vec3::Z, Vec3::Y));
        });
        settle(&mut pair.ours);
        let (ours, bevys) = pair.frame(|_| {});
        judge(&mut pair.ours, CAMERA, &ours[&CAMERA]);
        // Single precision leaves half a metre open at the far end.
        let [ours, bevys] = [ours, bevys].map(|lists| lists[&CAMERA].len());
        assert!(far > 1e5 || ours * 2 < bevys, "{ours} {bevys}");
    }
}
