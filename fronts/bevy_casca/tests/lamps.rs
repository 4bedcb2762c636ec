//! Lamps whose light falls on nothing that a camera sees: they have no shadow maps.

mod common;

use bevy_light::cluster::Clusters;
use common::*;

const WALL: u32 = 0;
/// Behind the wall, in the light of the lamps.
const THING: u32 = 25;
/// Behind the wall, far from the lamps.
const TOWER: u32 = 60;
/// A camera behind the wall that sees the things. It is not active.
const SECOND: u32 = CAMERA + 1;
const BULB: u32 = 2_000_000;
const SPOT: u32 = 2_000_001;

fn stage(world: &mut World) {
    opaque(world, WALL, Vec3::ZERO, Vec3::new(30.0, 30.0, 1.0));
    things_behind(world, 1);
    on(world, THING, |thing| done(thing.insert(RenderLayers::from_layers(&[0, 6]))));
    spawn_box(world, TOWER, Vec3::new(0.0, 0.0, -40.0), Vec3::new(3.0, 90.0, 3.0));
    spawn_camera(world, SECOND, Transform::from_xyz(0.0, 0.0, -20.0).looking_to(Vec3::Z, Vec3::Y));
    on(world, SECOND, |second| second.get_mut::<Camera>().unwrap().is_active = false);
    let bulb = PointLight { shadow_maps_enabled: true, range: 5.0, ..Default::default() };
    world.spawn((Nr(BULB), bulb, Transform::from_xyz(0.0, 0.0, -8.0)));
    let spot = SpotLight { shadow_maps_enabled: true, range: 5.0, ..Default::default() };
    world.spawn((Nr(SPOT), spot, Transform::from_xyz(0.0, 0.0, -7.0).looking_to(Vec3::NEG_Z, Vec3::Y)));
}

/// Which of the two lamps are on. Renderers read the lists of others no more.
fn lamps(app: &mut App) -> [bool; 2] {
    let lamps = [BULB, SPOT].map(|nr| entity(app.world_mut(), nr));
    let world = app.world();
    let is_on = lamps.map(|lamp| world.get::<ViewVisibility>(lamp).unwrap().get());
    let cube = world.get::<CubemapVisibleEntities>(lamps[0]).unwrap();
    let has_casters = cube.iter().any(|list| !list.entities.is_empty());
    assert!(has_casters || !is_on[0] || !world.get::<PointLight>(lamps[0]).unwrap().shadow_maps_enabled);
    assert!(!is_on[1] || !world.get::<VisibleMeshEntities>(lamps[1]).unwrap().entities.is_empty());
    is_on
}

#[test]
fn a_lamp_is_on_where_its_light_may_be_seen() {
    type Change = fn(&mut EntityWorldMut);
    fn activate(camera: &mut EntityWorldMut) {
        camera.get_mut::<Camera>().unwrap().is_active = true;
    }
    fn afar(thing: &mut EntityWorldMut) {
        thing.insert(VisibilityRange::abrupt(0.0, 1e9));
    }
    let cases: &[(&str, u32, Change, [bool; 2])] = &[
        ("behind a wall", WALL, |_| {}, [false; 2]),
        ("without it", WALL, |wall| done(wall.insert(Visibility::Hidden)), [true; 2]),
        ("volumetric", BULB, |lamp| done(lamp.insert(VolumetricLight)), [true, false]),
        ("let alone", SPOT, |lamp| done(lamp.insert(NoOcclusionCulling)), [false, true]),
        ("with a mesh", BULB, |lamp| done(lamp.insert(Mesh3d::default())), [true; 2]),
        ("never culled", TOWER, |tower| done(tower.insert(NoFrustumCulling)), [true; 2]),
        ("culled by others", TOWER, |tower| done(tower.insert(NoCpuCulling)), [true; 2]),
        ("bent by a shader", TOWER, |tower| done(tower.insert(NoOcclusionCulling)), [true; 2]),
        ("morphing", TOWER, |tower| done(tower.insert(MorphWeights::default())), [true; 2]),
        ("without a box", TOWER, |tower| done(tower.insert(NoAutoAabb).remove::<Aabb>()), [true; 2]),
        ("drawn, far from light", TOWER, afar, [false; 2]),
        ("drawn, in the light", THING, afar, [true; 2]),
        ("another camera", SECOND, activate, [true; 2]),
        ("a blind one", SECOND, |second| activate(second.insert(RenderLayers::layer(5))), [false; 2]),
        ("one of other layers", SECOND, |second| activate(second.insert(RenderLayers::layer(6))), [true; 2]),
        ("all is seen", CAMERA, |camera| done(camera.insert(NoOcclusionCulling)), [true; 2]),
    ];
    for (what, nr, change, expected) in cases {
        let mut pair = Pair::new(stage);
        assert_eq!(lamps(&mut pair.ours), [false; 2]);
        pair.frame(|world| on(world, *nr, change));
        for _ in 0..2 {
            assert_eq!(lamps(&mut pair.ours), *expected, "{what}");
            settle(&mut pair.ours);
        }
        assert_eq!(lamps(&mut pair.bevys), [true; 2], "{what}");
    }
    // Before the wall: a cone may look away from it.
    let mut pair = Pair::new(stage);
    for (z, to, expected) in [
        (4.0, Vec3::Z, [true, false]),
        (4.0, Vec3::new(0.0, 1.0, -1.0), [true; 2]),
        (9.0, Vec3::NEG_Z, [false; 2]),
        (-8.0, Vec3::NEG_Z, [false; 2]),
    ] {
        let place = Transform::from_xyz(0.0, 0.0, z).looking_to(to, Vec3::X);
        pair.frame(|world| {
            [BULB, SPOT].iter().for_each(|nr| on(world, *nr, |lamp| done(lamp.insert(place))))
        });
        assert_eq!(lamps(&mut pair.ours), expected, "{z}, {to}");
    }
    pair.ours.world_mut().resource_mut::<CascaSettings>().shadows = Shadows::All;
    pair.frame(|_| {});
    assert_eq!(lamps(&mut pair.ours), [true; 2], "all casters are asked for");
    pair.ours.world_mut().resource_mut::<CascaSettings>().shadows = Shadows::Lit;
    let without =
        |lamp: &mut EntityWorldMut| lamp.get_mut::<PointLight>().unwrap().shadow_maps_enabled = false;
    pair.frame(|world| on(world, BULB, without));
    assert_eq!(lamps(&mut pair.ours), [true, false], "without shadows it costs little");
}

#[test]
fn clusters_reach_as_far_as_lamps_that_are_off() {
    let mut pair = Pair::new(stage);
    let near = || Clusters { last_frame_farthest_z: Some(5.0), ..Clusters::default() };
    pair.frame(|world| on(world, CAMERA, |camera| done(camera.insert(near()))));
    assert_eq!(lamps(&mut pair.ours), [false; 2]);
    let camera = entity(pair.ours.world_mut(), CAMERA);
    let far = pair.ours.world().get::<Clusters>(camera).unwrap().last_frame_farthest_z.unwrap();
    // The bulb is 28 m away, and shines 5 m farther.
    assert!((33.0..33.1).contains(&far), "{far}");
}
