//! Kinds of entities and cameras: who is culled, who hides, and who is left to Bevy's own test.

mod common;

use common::*;

const WALL: u32 = 0;

/// A wall, and 50 boxes behind it.
fn stage(world: &mut World) {
    world.register_disabling_component::<Asleep>();
    opaque(world, WALL, Vec3::ZERO, Vec3::new(30.0, 30.0, 1.0));
    things_behind(world, 1);
}

/// Runs some frames, so that what is prepared is ready and what rests is still.
fn rest(pair: &mut Pair) -> (Lists, Lists) {
    settle(&mut pair.ours);
    (0..12).for_each(|_| _ = pair.frame(|_| {}));
    pair.frame(|_| {})
}

/// How many of the 50 boxes are hidden from the camera.
fn hidden((ours, bevys): &(Lists, Lists)) -> usize {
    bevys[&CAMERA].len() - ours[&CAMERA].len()
}

type Change = fn(&mut EntityWorldMut);

fn mirror(wall: &mut EntityWorldMut) {
    wall.get_mut::<Transform>().unwrap().scale.x = -30.0;
}

type Skin = (SkinnedMesh, DynamicSkinnedMeshBounds);

/// Bounds that are smaller than the mesh.
fn small_box() -> (NoAutoAabb, Aabb) {
    (NoAutoAabb, Aabb::from_min_max(Vec3::splat(-0.4999), Vec3::splat(0.4999)))
}

#[test]
fn who_hides() {
    // What is changed on the wall, how much it hides at once, and why it hides nothing after a rest.
    let cases: &[(&str, Change, usize, &str)] = &[
        ("an opaque wall", |_| {}, 50, ""),
        ("one that is disabled", |wall| done(wall.insert(Disabled)), 0, "disables"),
        ("one that the program disables", |wall| done(wall.insert(Asleep)), 0, "disables"),
        ("not inherited", |wall| done(wall.remove::<InheritedVisibility>()), 0, "no InheritedVisibility"),
        ("without ViewVisibility", |wall| done(wall.remove::<ViewVisibility>()), 0, "no ViewVisibility"),
        ("without Visibility", |wall| done(wall.remove::<Visibility>()), 0, "no Visibility"),
        ("without GlobalTransform", |wall| done(wall.remove::<GlobalTransform>()), 0, "no GlobalTransform"),
        ("without Mesh3d", |wall| done(wall.remove::<Mesh3d>()), 0, "no Mesh3d"),
        ("without Aabb", |wall| done(wall.insert(NoAutoAabb).remove::<Aabb>()), 0, "no Aabb"),
        ("without its mesh", |wall| done(wall.insert(Mesh3d::default())), 0, "its mesh is not there"),
        ("of unknown material", |wall| done(wall.remove::<Opaque>()), 0, "nothing says that it is opaque"),
        ("one that is told not to hide", |wall| done(wall.insert(NotOccluder)), 0, "it has NotOccluder"),
        ("of its own opinion", |wall| done(wall.insert(NoOcclusionCulling)), 0, "it has NoOcclusionCulling"),
        ("one that is not drawn", |wall| done(wall.insert(Visibility::Hidden)), 0, "not visible"),
        ("one on another layer", |wall| done(wall.insert(RenderLayers::layer(2))), 0, ""),
        ("on a far layer", |wall| done(wall.insert(RenderLayers::from_layers(&[0, 40]))), 0, "render layer"),
        ("one on more layers", |wall| done(wall.insert(RenderLayers::from_layers(&[0, 7]))), 50, ""),
        ("one that casts no shadow", |wall| done(wall.insert(NotShadowCaster)), 50, ""),
        ("one that is never culled", |wall| done(wall.insert(NoFrustumCulling)), 0, "NoFrustumCulling"),
        ("one that the graphics processor culls", |wall| done(wall.insert(NoCpuCulling)), 0, "NoCpuCulling"),
        ("a skin without bones", |wall| done(wall.insert(Skin::default())), 0, "it has SkinnedMesh"),
        ("seen from afar", |wall| done(wall.insert(VisibilityRange::abrupt(5.0, 1e9))), 0, "VisibilityRange"),
        ("one that is skinned", |wall| done(wall.insert(SkinnedMesh::default())), 0, "it has SkinnedMesh"),
        ("one that reaches out of its box", |wall| done(wall.insert(small_box())), 0, "out of its Aabb"),
        ("one that morphs", |wall| done(wall.insert(MorphWeights::default())), 0, "it has MorphWeights"),
        ("one with a lamp in it", |wall| done(wall.insert(PointLight::default())), 0, "before nearer things"),
        ("one that is flat", |wall| wall.get_mut::<Transform>().unwrap().scale.y = 0.0, 0, "flat"),
        ("one that moves", |wall| wall.get_mut::<Transform>().unwrap().translation.x += 0.5, 0, ""),
        ("a mirrored one of which fronts are drawn", mirror, 0, "mirror"),
        ("one of which both sides are drawn", |wall| mirror(wall.insert(Opaque::Both)), 0, ""),
    ];
    for (what, change, at_once, why) in cases {
        let mut pair = Pair::new(stage);
        assert_eq!(hidden(&rest(&mut pair)), 50);
        let wall = entity(pair.ours.world_mut(), WALL);
        assert_eq!(CascaScene::all_why_not(pair.ours.world()).count(), 50, "only the wall hides");
        let found = pair.frame(|world| on(world, WALL, change));
        assert_eq!(hidden(&found), *at_once, "{what}, at once");
        let later = hidden(&rest(&mut pair));
        let found = CascaScene::why_not(pair.ours.world(), wall).map(|why| why.to_string());
        assert_eq!(found.is_none(), why.is_empty(), "{what}: {found:?}");
        assert!(found.unwrap_or_default().contains(why), "{what}");
        assert_eq!(later > 0, why.is_empty() && *what != "one on another layer", "{what}, later");
    }
    let mut pair = Pair::new(stage);
    pair.ours.world_mut().resource_mut::<CascaSettings>().enabled = false;
    assert_eq!(why_not(&mut pair.ours, WALL), Some(WhyNot::Off));
}

#[test]
fn a_wall_that_rests_or_trembles_hides_where_it_is() {
    // Together they move no point of the wall by 1/10,000 of its 30 m: in metres and in radians.
    const SHIFT: f32 = 1e-3;
    const TURN: f32 = 4e-5;
    const HULL: u32 = 60;
    let mut pair = Pair::new(|world| {
        stage(world);
        let hull = world.spawn((Nr(HULL), Transform::default(), Visibility::default())).id();
        on(world, WALL, |wall| done(wall.insert(ChildOf(hull))));
    });
    for frame in 0..90 {
        // What it is a part of moves in five of thirty frames, and it trembles in the others.
        let (phase, moves) = (frame % 30, frame % 30 < 5);
        let found = pair.frame(|world| {
            if moves {
                on(world, HULL, |hull| hull.get_mut::<Transform>().unwrap().translation.y += 0.5);
                return;
            }
            on(world, WALL, |wall| {
                let mut at = wall.get_mut::<Transform>().unwrap();
                at.translation.x = SHIFT * dice(frame);
                at.rotation = Quat::from_rotation_y(TURN * dice(frame + 100));
            });
        });
        let waits = (phase < 12).then(|| WhyNot::Moves(12 - phase.max(4)));
        assert_eq!(hidden(&found), if waits.is_some() { 0 } else { 50 }, "frame {frame}");
        assert_eq!(why_not(&mut pair.ours, WALL), waits, "frame {frame}");
        let world = pair.ours.world_mut();
        let wall = entity(world, WALL);
        let id = world.get::<InScene>(wall).unwrap().id();
        let known = world.resource::<CascaScene>().scene().unwrap().transform(id).unwrap();
        let place = world.get::<GlobalTransform>(wall).unwrap().affine().to_cols_array();
        assert_eq!(known.map(|at| at.to_cols_array()), waits.is_none().then_some(place), "frame {frame}");
    }
}

#[test]
fn a_wall_that_is_drawn_again_hides_again() {
    fn cube(wall: &mut EntityWorldMut) {
        wall.insert(Mesh3d(wall.resource::<Cube>().0.clone()));
    }
    fn class(wall: &mut EntityWorldMut) {
        wall.insert(VisibilityClass([TypeId::of::<Mesh3d>()].into_iter().collect()));
    }
    let cases: [(Change, Change); 7] = [
        // Bevy notes the class of a mesh once more.
        (|wall| done(wall.remove::<Mesh3d>()), cube),
        (|wall| done(wall.insert(NotOccluder)), |wall| done(wall.remove::<NotOccluder>())),
        (|wall| done(wall.insert(RenderLayers::layer(2))), |wall| done(wall.remove::<RenderLayers>())),
        (|wall| done(wall.insert(Disabled)), |wall| done(wall.remove::<Disabled>())),
        (|wall| done(wall.insert(Asleep)), |wall| done(wall.remove::<Asleep>())),
        (|wall| done(wall.remove::<VisibilityClass>()), class),
        (|wall| done(wall.insert(VisibilityClass::default())), class),
    ];
    let mut app = headless(true);
    stage(app.world_mut());
    settle(&mut app);
    let [wall, camera] = [WALL, CAMERA].map(|nr| entity(app.world_mut(), nr));
    let list = |app: &App| -> BTreeSet<Entity> {
        let seen = app.world().get::<VisibleEntities>(camera).unwrap();
        seen.get(TypeId::of::<Mesh3d>()).iter().copied().collect()
    };
    for (nr, (take, give)) in cases.iter().enumerate() {
        for pause in [0, 1, 12] {
            on(app.world_mut(), WALL, take);
            for _ in 0..pause {
                app.update();
                assert!(list(&app).len() >= 50, "case {nr}");
            }
            on(app.world_mut(), WALL, give);
            settle(&mut app);
            assert_eq!(list(&app), BTreeSet::from([wall]), "case {nr}, after {pause} frames");
        }
    }
}

#[test]
fn meshes_that_change_or_go_hide_as_they_are() {
    let mut pair = Pair::new(stage);
    assert_eq!(hidden(&rest(&mut pair)), 50);
    let cube = |world: &World| world.resource::<Cube>().0.id();
    // In the same box, two of its twelve triangles, which the camera sees from their edge; and a
    // speck.
    let mut sides = Mesh::from(Cuboid::new(1.0, 1.0, 1.0));
    sides.insert_indices(Indices::U32(vec![8, 9, 10, 10, 11, 8]));
    for mesh in [sides, Cuboid::new(0.01, 0.01, 0.01).into()] {
        let found = pair.frame(|world| {
            let cube = cube(world);
            *world.resource_mut::<Assets<Mesh>>().get_mut(cube).unwrap() = mesh.clone();
        });
        assert!(hidden(&found) < 5 && hidden(&rest(&mut pair)) < 5);
    }
    assert_eq!(pair.ours.world().resource::<CascaScene>().occluders(), 1);
    let remove = |world: &mut World| {
        let cube = cube(world);
        world.resource_mut::<Assets<Mesh>>().remove(cube);
    };
    assert_eq!(hidden(&pair.frame(remove)), 0, "nothing is drawn without a mesh");
    let mut pair = Pair::new(|world| {
        stage(world);
        let proxy = world.resource_mut::<Assets<Mesh>>().add(Mesh::from(Cuboid::new(1.0, 1.0, 1.0)));
        on(world, WALL, |wall| done(wall.insert(Occluder(proxy.clone()))));
    });
    assert_eq!(hidden(&rest(&mut pair)), 50);
    assert_eq!(hidden(&pair.frame(remove)), 0, "nor does what hides in its place");
}

#[test]
fn meshes_hide_however_they_are_stored() {
    let (both, renderer) = (RenderAssetUsages::default(), RenderAssetUsages::RENDER_WORLD);
    for (usage, packed) in [(renderer, false), (both, true), (renderer, true)] {
        let mut app = headless(true);
        let mut mesh = Mesh::from(Cuboid::new(1.0, 1.0, 1.0)).translated_by(Vec3::X * 0.2);
        if packed {
            mesh.compress_positions().unwrap();
        }
        mesh.asset_usage = usage;
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        app.update();
        if !packed {
            let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
            meshes.get_mut_untracked(&mesh).unwrap().take_gpu_data().unwrap();
        }
        stage(app.world_mut());
        for sides in [Opaque::Front, Opaque::Both] {
            on(app.world_mut(), WALL, |wall| done(wall.insert((Mesh3d(mesh.clone()), sides))));
            settle(&mut app);
            // Bevy draws it as a point.
            let why = (packed && usage == renderer).then_some(WhyNot::Positions);
            assert_eq!(lists(&mut app)[&CAMERA].len(), if why.is_some() { 51 } else { 1 }, "{sides:?}");
            assert_eq!(why_not(&mut app, WALL), why);
        }
    }
}

#[test]
fn who_is_never_hidden() {
    let mut pair = Pair::new(|world| {
        stage(world);
        on(world, 1, |thing| done(thing.insert(NoFrustumCulling)));
        on(world, 2, |thing| done(thing.insert(VisibilityRange::abrupt(0.0, 1e9))));
        on(world, 3, |thing| done(thing.insert(SkinnedMesh::default())));
        on(world, 4, |thing| done(thing.insert(MorphWeights::default())));
        on(world, 5, |thing| done(thing.insert(NoOcclusionCulling)));
        // A sprite, say, of a class of its own, and one without bounds.
        let class = || VisibilityClass([TypeId::of::<Mesh3d>()].into_iter().collect());
        let at = Transform::from_xyz(0.0, 0.0, -10.0);
        let around = Sphere { center: Vec3::new(0.0, 0.0, -10.0).into(), radius: 1.0 };
        world.spawn((Nr(51), Visibility::default(), class(), at, around));
        world.spawn((Nr(52), Visibility::default(), class(), at));
        // With bounds that follow its bones.
        on(world, 6, |thing| done(thing.insert((SkinnedMesh::default(), DynamicSkinnedMeshBounds))));
    });
    let (ours, _) = rest(&mut pair);
    assert_eq!(ours[&CAMERA], BTreeSet::from([WALL, 1, 2, 3, 4, 5, 51, 52]));
    // A lamp shines past the wall, and so may one that gets its light later.
    let (ours, bevys) = pair.frame(|world| on(world, 8, |thing| done(thing.insert(PointLight::default()))));
    assert!(ours[&CAMERA].contains(&8) && bevys[&CAMERA].contains(&8));
    let (ours, _) = rest(&mut pair);
    assert!(ours[&CAMERA].contains(&8));
    // A clone is another object.
    let thing = entity(pair.ours.world_mut(), 9);
    let clone = pair.ours.world_mut().entity_mut(thing).clone_and_spawn();
    pair.ours.update();
    let id = |entity| pair.ours.world().get::<InScene>(entity).unwrap().id();
    assert_ne!(id(thing), id(clone));
    pair.ours.world_mut().despawn(clone);
    // A culler on the graphics processor: the entity is in no list, and is drawn all the same.
    pair.frame(|world| on(world, 7, |thing| done(thing.insert(NoCpuCulling))));
    let thing = entity(pair.ours.world_mut(), 7);
    assert!(pair.ours.world().get::<ViewVisibility>(thing).unwrap().get());
    assert!(pair.ours.world().get::<InScene>(thing).is_none());
}

#[test]
fn kinds_of_cameras() {
    let lens = |area| {
        Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::Fixed { width: area, height: area },
            area: bevy_math::Rect::from_center_size(Vec2::ZERO, Vec2::splat(area)),
            ..OrthographicProjection::default_3d()
        })
    };
    let place = Transform::from_xyz(0.0, 0.0, 20.0).looking_to(Vec3::NEG_Z, Vec3::Y);
    let sub = SubCameraView { full_size: UVec2::splat(100), offset: Vec2::ZERO, size: UVec2::splat(50) };
    let mut pair = Pair::new(|world| {
        stage(world);
        (1..8).for_each(|n| _ = spawn_camera(world, CAMERA + n, place));
        on(world, CAMERA + 1, |camera| done(camera.insert(lens(12.0))));
        on(world, CAMERA + 2, |camera| done(camera.insert(NoCpuCulling)));
        on(world, CAMERA + 3, |camera| done(camera.insert(NoOcclusionCulling)));
        on(world, CAMERA + 4, |camera| done(camera.insert(RenderLayers::layer(5))));
        let of = |n| Camera { is_active: n != 5, invert_culling: n == 6, ..Default::default() };
        spawn_camera(world, CAMERA + 9, place.with_scale(Vec3::new(-1.0, 1.0, 1.0)));
        [5, 6].iter().for_each(|n| on(world, CAMERA + n, |camera| done(camera.insert(of(*n)))));
        let part = Camera { sub_camera_view: Some(sub), ..Default::default() };
        on(world, CAMERA + 7, |camera| done(camera.insert(part.clone())));
        // From behind the wall.
        spawn_camera(world, CAMERA + 8, Transform::from_xyz(0.0, 0.0, -20.0).looking_to(Vec3::Z, Vec3::Y));
        // Before the wall, and not in the part of the view.
        spawn_box(world, 62, Vec3::new(4.0, -4.0, 5.0), Vec3::splat(0.4));
        // On another layer than the wall, together with two of the things.
        for nr in [1, 2] {
            on(world, nr, |thing| done(thing.insert(RenderLayers::from_layers(&[0, 5]))));
        }
    });
    let (ours, bevys) = rest(&mut pair);
    let of = |lists: &Lists, n: u32| lists[&(CAMERA + n)].clone();
    assert_eq!(of(&ours, 0), BTreeSet::from([WALL, 62]));
    assert_eq!(of(&ours, 1), BTreeSet::from([WALL, 62]), "parallel rays");
    assert!(of(&bevys, 1).len() > 40);
    for n in [2, 3, 4, 5, 6, 9] {
        assert_eq!(of(&ours, n), of(&bevys, n), "camera {n}");
    }
    assert_eq!(of(&ours, 4), BTreeSet::from([1, 2]));
    assert!(of(&ours, 5).is_empty() && of(&ours, 8).len() == 51);
    assert_eq!(of(&ours, 7), BTreeSet::from([WALL]), "a part of a view");
    // What one camera of several sees is drawn.
    let visible = visible(&mut pair.ours);
    assert_eq!(visible.iter().filter(|nr| **nr < CAMERA).count(), 52);
    // Cameras that go are forgotten.
    let gone = entity(pair.ours.world_mut(), CAMERA);
    pair.frame(|world| {
        let camera = entity(world, CAMERA);
        world.despawn(camera);
    });
    assert!(pair.ours.world().resource::<CascaScene>().camera(gone).is_none());
}
