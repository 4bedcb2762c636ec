//! Entities that come and go by thousands, and worlds that move away.

mod common;

use bevy_transform::TransformSystems;
use common::*;

const PAGE: u32 = 1000;

/// A page of a land: a wall across the way, and things before and behind it.
fn page(world: &mut World, n: u32) {
    let x = n as f32 * 20.0;
    opaque(world, n * PAGE, Vec3::new(x, 3.0, 0.0), Vec3::new(0.5, 6.0, 14.0 + (n % 3) as f32));
    for i in 1..PAGE {
        let at = Vec3::new(x + (i % 20) as f32, (i / 400) as f32 + 0.3, ((i / 20) % 20) as f32 - 9.5);
        spawn_box(world, n * PAGE + i, at, Vec3::splat(0.3));
    }
}

#[test]
fn pages_come_and_go() {
    for most_new in [300, 1 << 14] {
        let mut pair = Pair::new(|world| {
            (0..4).for_each(|n| page(world, n));
            spawn_camera(world, CAMERA, Transform::from_xyz(-10.0, 1.5, 0.0).looking_to(Vec3::X, Vec3::Y));
        });
        pair.ours.world_mut().resource_mut::<CascaSettings>().most_new = most_new;
        let (mut hidden, mut grids) = (0, BTreeSet::new());
        for frame in 0..160u32 {
            let (ours, bevys) = pair.frame(|world| {
                if frame.is_multiple_of(4) {
                    page(world, frame / 4 + 4);
                    let mut all = world.query::<(Entity, &Nr)>();
                    let gone = all.iter(world).filter(|(_, nr)| nr.0 / PAGE == frame / 4);
                    let gone: Vec<Entity> = gone.map(|(entity, _)| entity).collect();
                    gone.into_iter().for_each(|entity| done(world.despawn(entity)));
                }
                let camera = entity(world, CAMERA);
                world.get_mut::<Transform>(camera).unwrap().translation.x += 5.0;
            });
            hidden += bevys[&CAMERA].len() - ours[&CAMERA].len();
            if frame % 20 == 3 {
                judge(&mut pair.ours, CAMERA, &ours[&CAMERA]);
            }
            let scene = pair.ours.world().resource::<CascaScene>().scene().unwrap();
            grids.insert(format!("{:?}", scene.grid()));
        }
        println!("{most_new}: {} hidden in a frame, {} grids", hidden / 160, grids.len());
        assert!(hidden > 160 * 300 && grids.len() < 3, "{hidden} {grids:?}");
        // The scene holds what lives, and nothing else.
        (0..20).for_each(|_| done(pair.frame(|_| {})));
        let world = pair.ours.world_mut();
        let mut known = world.query_filtered::<(Entity, &InScene), With<Mesh3d>>();
        let scene = world.resource::<CascaScene>().scene().unwrap();
        let ids: BTreeSet<_> = known.iter(world).map(|(_, known)| known.id()).collect();
        assert_eq!(ids.len(), 4 * PAGE as usize);
        assert_eq!(ids, scene.ids().collect());
    }
}

#[derive(Component)]
struct Gone;

#[test]
fn who_goes_while_it_is_taken_over_hides_nothing() {
    let mut app = headless(true);
    // A system that runs beside the plugin's, and takes its time to say who is gone.
    let late = |mut commands: Commands, gone: Query<Entity, With<Gone>>| {
        gone.iter().for_each(|entity| commands.entity(entity).despawn());
    };
    let late = late.after(TransformSystems::Propagate).before_ignore_deferred(CascaSystems::Sync);
    app.add_systems(PostUpdate, late.after(VisibilitySystems::CalculateBounds));
    let world = app.world_mut();
    spawn_box(world, 1, Vec3::new(0.0, 0.0, -10.0), Vec3::ONE);
    spawn_camera(world, CAMERA, Transform::from_xyz(0.0, 0.0, 20.0).looking_to(Vec3::NEG_Z, Vec3::Y));
    let wall = |world: &mut World| {
        let wall = opaque(world, 0, Vec3::ZERO, Vec3::splat(20.0));
        world.entity_mut(wall).insert(Aabb::from_min_max(Vec3::splat(-0.5), Vec3::splat(0.5)));
        wall
    };
    // The mesh is prepared.
    let first = wall(world);
    settle(&mut app);
    assert!(!lists(&mut app)[&CAMERA].contains(&1));
    app.world_mut().despawn(first);
    app.update();
    assert!(lists(&mut app)[&CAMERA].contains(&1));
    for frame in 0..3 {
        let second = wall(app.world_mut());
        app.world_mut().entity_mut(second).insert(Gone);
        app.update();
        assert!(lists(&mut app)[&CAMERA].contains(&1), "frame {frame}");
        assert_eq!(app.world().resource::<CascaScene>().scene().unwrap().len(), 1, "frame {frame}");
    }
}

#[test]
fn who_is_told_of_a_new_origin_goes_on_hiding() {
    let rig = 900_000;
    let mut pair = Pair::new(|world| {
        (0..3).for_each(|n| page(world, n));
        spawn_camera(world, CAMERA, Transform::from_xyz(-10.0, 1.5, 0.0).looking_to(Vec3::X, Vec3::Y));
        // One with children, turned and scaled: their places have other roundings.
        let turn = Transform::from_xyz(33.3, 2.0, 4.7).with_scale(Vec3::new(0.7, 1.3, 0.9));
        let parent = spawn_box(world, rig, Vec3::ZERO, Vec3::ONE);
        *world.get_mut(parent).unwrap() = turn.looking_to(Vec3::new(1.0, 0.3, 0.2), Vec3::Y);
        for i in 0..20 {
            let at = Vec3::new(0.3 + 0.317 * i as f32, 1.1, 0.77 - 0.239 * i as f32);
            let child = spawn_box(world, rig + 10 + i, at, Vec3::splat(0.4));
            world.entity_mut(child).insert(ChildOf(parent));
        }
        // One that stays where it is when all else is moved: first before the camera, later behind
        // a wall.
        spawn_box(world, rig + 2, Vec3::new(-9.0, 1.5, 0.0), Vec3::splat(0.1));
    });
    let moving = |pair: &mut Pair| {
        let world = pair.ours.world_mut();
        let mut all = world.query::<(&Nr, &InScene)>();
        all.iter(world).filter(|(_, known)| known.moves()).map(|(nr, _)| nr.0).collect::<Vec<_>>()
    };
    let shift = |world: &mut World, by: Vec3| {
        world.get_resource_mut::<CascaScene>().into_iter().for_each(|mut casca| casca.shift_origin(by));
    };
    let mut before = 0;
    for frame in 0..90 {
        let by = if frame == 30 { 700.25 } else { -1234.567 };
        let is_shift = frame == 30 || frame == 60;
        let (ours, bevys) = pair.frame(|world| {
            if is_shift {
                shift(world, Vec3::X * by);
                let mut all = world.query_filtered::<(&Nr, &mut Transform), Without<ChildOf>>();
                let moved = all.iter_mut(world).filter(|(nr, _)| nr.0 != rig + 2);
                moved.for_each(|(_, mut at)| at.translation.x -= by);
            }
        });
        let hidden = bevys[&CAMERA].len() - ours[&CAMERA].len();
        if is_shift {
            assert_eq!(moving(&mut pair), [rig + 2], "frame {frame}");
            assert!(hidden > 1000 && hidden + 2 > before, "frame {frame}: {hidden} of {before}");
            // Places are those of the entities in every bit.
            let world = pair.ours.world_mut();
            let mut all = world.query::<(&InScene, &GlobalTransform)>();
            let scene = world.resource::<CascaScene>().scene().unwrap();
            for (known, place) in all.iter(world).filter(|(known, _)| !known.moves()) {
                let ours = scene.transform(known.id()).unwrap().unwrap().to_cols_array();
                assert_eq!(ours, place.affine().to_cols_array());
            }
        }
        if frame % 15 == 0 || is_shift {
            judge(&mut pair.ours, CAMERA, &ours[&CAMERA]);
        }
        before = hidden;
    }
    // A shift that nobody can follow: all have moved, and none is lost.
    let (ours, _) = pair.frame(|world| {
        shift(world, Vec3::X * f32::NAN);
        let mut all = world.query_filtered::<&mut Transform, Without<ChildOf>>();
        all.iter_mut(world).for_each(|mut at| at.translation.y += 5.0);
    });
    judge(&mut pair.ours, CAMERA, &ours[&CAMERA]);
    assert!(moving(&mut pair).len() > 2000);
}

#[test]
fn what_comes_into_the_light_with_a_new_origin_casts_its_shadow() {
    let mut pair = Pair::new(|world| {
        (0..256).for_each(|n| done(spawn_box(world, n, Vec3::X * n as f32, Vec3::splat(0.5))));
        spawn_camera(world, CAMERA, Transform::from_xyz(8.0, 0.0, 20.0));
        let lamp = PointLight { shadow_maps_enabled: true, range: 20.0, ..Default::default() };
        world.spawn((Nr(CAMERA + 1), lamp, Transform::from_xyz(8.0, 0.0, 2.0)));
        let sun = DirectionalLight { shadow_maps_enabled: true, ..Default::default() };
        world.spawn((Nr(CAMERA + 2), sun, Transform::default().looking_to(Vec3::NEG_Y, Vec3::Z)));
    });
    for frame in 0..60 {
        let (step, by) = (frame % 20, Vec3::X * if frame % 20 == 14 { 64.0 } else { 0.0 });
        pair.frame(|world| {
            // Without rounding: nothing else tells that things are elsewhere. Half of them moved before.
            if by != Vec3::ZERO {
                world.get_resource_mut::<CascaScene>().into_iter().for_each(|mut it| it.shift_origin(by));
            }
            let mut things = world.query_filtered::<(&Nr, &mut Transform), With<Mesh3d>>();
            for (nr, mut at) in things.iter_mut(world) {
                at.translation = (at.translation - by).with_y((step.min(11) * nr.0 % 2) as f32);
            }
        });
        assert_eq!(light_lists(&mut pair.ours), light_lists(&mut pair.bevys), "frame {frame}");
    }
}
