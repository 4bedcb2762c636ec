//! Worlds of three kinds, in step with Bevy's own culling and under the eyes of an exact oracle.

mod common;

use common::*;

const FRAMES: u32 = 300;

/// What must hold after each frame, and by the oracle after some.
fn check(pair: &mut Pair, frame: u32, change: impl Fn(&mut World), every: u32) -> usize {
    let (ours, bevys) = pair.frame(change);
    let world = pair.ours.world_mut();
    let camera = entity(world, CAMERA);
    // The set of the library for this camera, and Bevy's, are ours.
    let scene = world.resource::<CascaScene>();
    let found = scene.camera(camera).expect("the camera has occlusion").pvs();
    let number = |id: &casca::ObjectId| {
        let bits = scene.scene().unwrap().user_data(*id).unwrap();
        world.get::<Nr>(Entity::from_bits(bits)).unwrap().0
    };
    let both = found.visible().iter().map(number).filter(|nr| bevys[&CAMERA].contains(nr)).collect();
    assert_eq!(ours[&CAMERA], both, "frame {frame}");
    if frame.is_multiple_of(every) {
        assert!(judge(&mut pair.ours, CAMERA, &ours[&CAMERA]) > 0, "frame {frame}");
    }
    bevys[&CAMERA].len() - ours[&CAMERA].len()
}

fn look(world: &mut World, at: Vec3, to: Vec3) {
    let place = Transform::from_translation(at).looking_at(to, Vec3::Y);
    on(world, CAMERA, |camera| done(camera.insert(place)));
}

#[test]
fn a_walk_through_a_city() {
    // Blocks of houses with people among them.
    let mut pair = Pair::new(|world| {
        opaque(world, 0, Vec3::new(0.0, -0.5, 0.0), Vec3::new(400.0, 1.0, 400.0));
        for n in 1..145 {
            let (height, i, j) = (10.0 + 30.0 * dice(n), (n - 1) / 12, (n - 1) % 12);
            let middle = Vec3::new(i as f32 * 24.0 - 132.0, height / 2.0, j as f32 * 24.0 - 132.0);
            opaque(world, n, middle, Vec3::new(17.0, height, 17.0));
        }
        for n in 145..745 {
            let middle = Vec3::new(dice(n) * 280.0 - 140.0, 0.9, dice(n + 7777) * 280.0 - 140.0);
            spawn_box(world, n, middle, Vec3::new(0.6, 1.8, 0.4));
        }
        spawn_camera(world, CAMERA, Transform::from_xyz(0.0, 1.7, 0.5).looking_to(Vec3::X, Vec3::Y));
    });
    let mut hidden = 0;
    for frame in 0..FRAMES {
        let t = frame as f32 / FRAMES as f32;
        let at = Vec3::new(-140.0 + 280.0 * t, 1.7, 0.5);
        let to = at + Vec3::new((t * 9.0).cos(), 0.05 * (t * 31.0).sin(), (t * 9.0).sin());
        hidden += check(&mut pair, frame, |world| look(world, at, to), 6);
    }
    assert!(hidden > 100 * FRAMES as usize, "little is hidden: {hidden}");
}

#[test]
fn a_building_with_doors_that_open() {
    let doors = 4;
    let mut pair = Pair::new(|world| {
        // Five rooms in a row along x, with doors between them, and things in each.
        let size = Vec3::new(60.0, 0.2, 8.0);
        opaque(world, 0, Vec3::new(24.0, -0.1, 0.0), size);
        opaque(world, 1, Vec3::new(24.0, 3.1, 0.0), size);
        opaque(world, 2, Vec3::new(24.0, 1.5, -4.1), Vec3::new(60.0, 3.4, 0.2));
        opaque(world, 3, Vec3::new(24.0, 1.5, 4.1), Vec3::new(60.0, 3.4, 0.2));
        for i in 0..doors {
            let x = 6.0 + 12.0 * i as f32;
            opaque(world, 4 + 3 * i, Vec3::new(x, 1.5, -2.4), Vec3::new(0.3, 3.2, 3.4));
            opaque(world, 5 + 3 * i, Vec3::new(x, 1.5, 2.4), Vec3::new(0.3, 3.2, 3.4));
            let door = spawn_box(world, 6 + 3 * i, Vec3::new(x, 1.5, 0.0), Vec3::new(0.2, 3.2, 1.6));
            let proxy: Handle<Mesh> = world.resource::<Cube>().0.clone();
            world.entity_mut(door).insert(Occluder(proxy));
        }
        for n in 4 + 3 * doors..200 {
            let middle = Vec3::new(dice(n) * 56.0 - 4.0, 0.2 + dice(n + 1) * 2.0, dice(n + 2) * 7.0 - 3.5);
            spawn_box(world, n, middle, Vec3::splat(0.3));
        }
        spawn_camera(world, CAMERA, Transform::from_xyz(0.0, 1.7, 0.0).looking_to(Vec3::X, Vec3::Y));
    });
    let (mut hidden, mut least, mut most) = (0, usize::MAX, 0);
    for frame in 0..FRAMES {
        let t = frame as f32;
        let change = |world: &mut World| {
            let at = Vec3::new(-3.0 + 0.02 * t, 1.7, 0.2);
            look(world, at, at + Vec3::new(1.0, 0.0, 0.1 * (0.03 * t).sin()));
            for i in 0..doors {
                // Open for a while, each in its turn, and all for a while.
                let open = (0.05 * t + i as f32).sin().max(0.0) * 1.5;
                on(world, 6 + 3 * i, |door| {
                    let mut door = door.get_mut::<Transform>().unwrap();
                    let hinge = Vec3::new(6.0 + 12.0 * i as f32, 1.5, -0.8);
                    door.rotation = Quat::from_rotation_y(open);
                    door.translation = hinge + door.rotation * Vec3::new(0.0, 0.0, 0.8);
                });
            }
        };
        let n = check(&mut pair, frame, change, 2);
        (hidden, least, most) = (hidden + n, least.min(n), most.max(n));
    }
    assert!(hidden > 60 * FRAMES as usize, "little is hidden: {hidden}");
    assert!(least + 5 < most, "doors change nothing");
}

/// Where the people of the crowd are at a time.
fn walk(world: &mut World, t: f32) {
    let mut people = world.query::<(&Nr, &mut Transform)>();
    for (nr, mut transform) in people.iter_mut(world).filter(|(nr, _)| (21..5021).contains(&nr.0)) {
        // Half of them stand still half of the time.
        let t = if nr.0.is_multiple_of(2) { t } else { t.min(120.0) };
        let angle = dice(nr.0) * 6.3 + 0.01 * t;
        let middle = Vec3::new(dice(nr.0 + 1) * 160.0 - 80.0, 0.9, dice(nr.0 + 2) * 160.0 - 80.0);
        let to = middle + Vec3::new(angle.cos(), 0.0, angle.sin()) * 6.0;
        if transform.translation != to {
            transform.translation = to;
        }
    }
}

#[test]
fn a_crowd_of_5000_that_moves() {
    let (mut n, mut waiting) = (0, 0);
    let mut pair = Pair::new(|world| {
        opaque(world, 0, Vec3::new(0.0, -0.5, 0.0), Vec3::new(200.0, 1.0, 200.0));
        for i in 0..20 {
            let middle = Vec3::new(dice(i) * 160.0 - 80.0, 4.0, dice(i + 100) * 160.0 - 80.0);
            opaque(world, 1 + i, middle, Vec3::new(20.0 * dice(i + 200) + 6.0, 8.0, 3.0));
        }
        for i in 21..5021 {
            spawn_box(world, i, Vec3::ZERO, Vec3::new(0.5, 1.8, 0.5));
        }
        walk(world, 0.0);
        spawn_camera(world, CAMERA, Transform::from_xyz(0.0, 1.7, 90.0).looking_to(Vec3::NEG_Z, Vec3::Y));
    });
    for frame in 0..FRAMES {
        let t = frame as f32;
        let change = |world: &mut World| {
            walk(world, t);
            let at = Vec3::new(20.0 * (0.01 * t).sin(), 1.7, 90.0 - 0.3 * t);
            look(world, at, at + Vec3::new((0.02 * t).sin() * 0.5, 0.0, -1.0));
        };
        n += check(&mut pair, frame, change, 20);
        // Most leave their volumes so soon that they get no others for some hundred frames.
        let world = pair.ours.world_mut();
        let ids: Vec<_> = world.query::<&InScene>().iter(world).map(InScene::id).collect();
        let scene = world.resource::<CascaScene>().scene().unwrap();
        let now = ids.iter().filter(|id| scene.tbv(**id).unwrap().is_some()).count();
        waiting = waiting.max(now);
    }
    println!("{} hidden in a frame; up to {waiting} wait in volumes", n as f32 / FRAMES as f32);
    assert!(waiting > 0, "the scene is not told that frames end");
    assert!(n > 500 * FRAMES as usize, "little is hidden: {n}");
}

#[test]
fn a_camera_rests_where_little_is_hidden() {
    let grid = |n: u32, x: f32| Vec3::new(x + (n % 20) as f32 - 9.5, (n / 20) as f32 - 9.5, -40.0);
    let mut pair = Pair::new(|world| {
        // Far from them, as many behind a wall.
        (0..400).for_each(|n| _ = spawn_box(world, n, grid(n, 0.0), Vec3::splat(0.5)));
        (401..801).for_each(|n| _ = spawn_box(world, n, grid(n - 401, 900.0), Vec3::splat(0.5)));
        opaque(world, 400, Vec3::new(900.0, 0.0, -10.0), Vec3::new(60.0, 60.0, 1.0));
        spawn_camera(world, CAMERA, Transform::from_xyz(0.0, 0.0, 20.0).looking_to(Vec3::NEG_Z, Vec3::Y));
    });
    pair.ours.world_mut().resource_mut::<CascaSettings>().least_hidden = 0.5;
    let camera = entity(pair.ours.world_mut(), CAMERA);
    let mut asked = [0; 2];
    for frame in 0..400 {
        let (ours, bevys) = pair.frame(|world| {
            // A camera that stands asks once.
            let x = if frame < 200 { 0.0 } else { 900.0 } + 0.02 * (frame % 200) as f32;
            on(world, CAMERA, |camera| camera.get_mut::<Transform>().unwrap().translation.x = x);
        });
        let asks = pair.ours.world().resource::<CascaScene>().camera(camera).is_some();
        asked[frame / 200] += u32::from(asks);
        assert!(asks || ours == bevys, "frame {frame}");
        assert!(frame < 300 || asks && ours[&CAMERA].len() == 1, "frame {frame}");
    }
    // A frame rests for each four things that were found: 100.
    assert!(asked[0] < 10 && asked[1] >= 100, "{asked:?}");
}
