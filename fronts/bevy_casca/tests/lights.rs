//! Casters of each kind of light, beside Bevy's lists and under the eyes of an exact oracle.

mod common;

use casca_scenes::world::Camera;
use casca_truth::oracle::{Oracle, OracleOptions};
use common::*;
use glam::camera::rh::proj::directx;

const SUN: u32 = 1_000_001;
const BULB: u32 = 1_000_002;
const SPOT: u32 = 1_000_003;
/// It casts no shadow, though it hides from cameras.
const GHOST: u32 = 40;

/// A yard with walls, a roof, a ghost, and small things all over the place, some of which move.
fn yard(world: &mut World) {
    let mut solid = |nr: u32, middle: [f32; 3], size: [f32; 3]| opaque(world, nr, middle.into(), size.into());
    solid(0, [0.0, -0.5, 0.0], [80.0, 1.0, 80.0]);
    // A roof, which the sun shines on, and walls, which the lamps shine on.
    solid(1, [-15.0, 6.0, 0.0], [20.0, 0.5, 30.0]);
    // A tower behind the camera, whose shadow falls before it.
    solid(2, [0.0, 30.0, 36.0], [6.0, 60.0, 3.0]);
    for i in 0..37 {
        let at = [dice(i) * 60.0 - 30.0, 2.0, dice(i + 50) * 60.0 - 30.0];
        solid(3 + i, at, [1.0 + 5.0 * dice(i + 100), 4.0, 0.8]);
    }
    let ghost = solid(GHOST, [6.0, 2.0, 0.0], [0.5, 6.0, 30.0]);
    world.entity_mut(ghost).insert(NotShadowCaster);
    // So many that the sun is not asked in each frame.
    for i in (41..400).chain(401..1200) {
        let at = Vec3::new(dice(i) * 70.0 - 35.0, 0.3 + 5.0 * dice(i + 1), dice(i + 2) * 70.0 - 35.0);
        spawn_box(world, i, at, Vec3::splat(0.4));
    }
    // High in the air, before the near planes of all cascades.
    spawn_box(world, 400, Vec3::new(-36.0, 180.0, 108.0), Vec3::new(40.0, 1.0, 40.0));
    let front = Transform::from_xyz(0.0, 3.0, 30.0).looking_at(Vec3::new(0.0, 2.0, 0.0), Vec3::Y);
    spawn_camera(world, CAMERA, front);
    let down = Transform::default().looking_to(Vec3::new(0.2, -1.0, -0.6), Vec3::Y);
    world.spawn((Nr(SUN), DirectionalLight { shadow_maps_enabled: true, ..Default::default() }, down));
    let bulb = PointLight { shadow_maps_enabled: true, range: 40.0, ..Default::default() };
    world.spawn((Nr(BULB), bulb, Transform::from_xyz(4.0, 2.5, 6.0)));
    let spot = SpotLight { shadow_maps_enabled: true, range: 50.0, outer_angle: 0.6, ..Default::default() };
    let aim = Transform::from_xyz(-6.0, 3.0, 14.0).looking_to(Vec3::new(0.2, -0.1, -1.0), Vec3::Y);
    world.spawn((Nr(SPOT), spot, aim));
}

/// A tick of the yard: things move, lights turn.
fn tick(world: &mut World, frame: u32) {
    let mut things = world.query::<(&Nr, &mut Transform)>();
    for (nr, mut transform) in things.iter_mut(world) {
        let t = frame as f32 * 0.05;
        match nr.0 {
            300..400 => transform.translation.x += 0.1 * (t + nr.0 as f32).cos(),
            BULB => transform.translation.z += 0.05 * t.cos(),
            SPOT => transform.rotate_y(0.01),
            SUN if frame % 20 == 19 => transform.rotate(Quat::from_rotation_y(0.4)),
            _ => {}
        }
    }
}

fn camera(view: Mat4, projection: glam::Mat4) -> Camera {
    let view = glam::Mat4::from_cols_array(&view.to_cols_array());
    Camera { eye: view.inverse().w_axis.truncate(), view, projection }
}

/// The cameras of the shadow maps of all lights.
fn shadow_cameras(app: &mut App) -> BTreeMap<View, Camera> {
    let mut out = BTreeMap::new();
    let sun = entity(app.world_mut(), SUN);
    for (i, cascade) in app.world().get::<Cascades>(sun).unwrap().cascades.values().flatten().enumerate() {
        // Depths are clamped: rays start far before the near plane.
        let (side, depth) =
            (1.0 / cascade.clip_from_cascade.x_axis.x, 1.0 / cascade.clip_from_cascade.z_axis.z);
        let lens = directx::orthographic(-side, side, -side, side, -300.0, depth);
        out.insert((SUN, CAMERA, i), camera(cascade.world_from_cascade.inverse(), lens));
    }
    let place = |app: &mut App, nr| {
        let entity = entity(app.world_mut(), nr);
        (entity, *app.world().get::<GlobalTransform>(entity).unwrap())
    };
    let (bulb, at) = place(app, BULB);
    let lamp = app.world().get::<PointLight>(bulb).unwrap();
    for (i, face) in CUBE_MAP_FACES.iter().enumerate() {
        let turned = Transform::IDENTITY.looking_at(face.target, face.up);
        let view = (Transform::from_translation(at.translation()) * turned).compute_affine().inverse();
        let lens = directx::perspective(1.570_796_4, 1.0, lamp.shadow_map_near_z, lamp.range);
        out.insert((BULB, BULB, i), camera(view.into(), lens));
    }
    let (spot, at) = place(app, SPOT);
    let lamp = app.world().get::<SpotLight>(spot).unwrap();
    let lens = directx::perspective(2.0 * lamp.outer_angle, 1.0, lamp.shadow_map_near_z, lamp.range);
    let view: Affine3A = spot_light_world_from_view(&at).inverse();
    out.insert((SPOT, SPOT, 0), camera(view.into(), lens));
    out
}

#[test]
fn casters_that_are_left_out_are_hidden_from_the_light() {
    let mut pair = Pair::new(yard);
    let options = OracleOptions { width: 48, height: 48, samples_per_object: 6, ..Default::default() };
    let mut left_out = BTreeMap::<u32, usize>::new();
    for frame in 0..60 {
        pair.frame(|world| tick(world, frame));
        let (ours, bevys) = (light_lists(&mut pair.ours), light_lists(&mut pair.bevys));
        assert!(ours.keys().eq(bevys.keys()), "{:?} {:?}", ours.keys(), bevys.keys());
        let cameras = shadow_cameras(&mut pair.ours);
        assert!(ours.keys().eq(cameras.keys()));
        for (key, list) in &ours {
            assert!(list.is_subset(&bevys[key]), "{key:?}: {:?}", list.difference(&bevys[key]));
            *left_out.entry(key.0).or_default() += bevys[key].len() - list.len();
            if frame % 5 != 0 {
                continue;
            }
            let (_, mut objects) = truth(&mut pair.ours);
            objects[GHOST as usize].occludes = false;
            // What is not in Bevy's list lies beyond the light's range.
            (0..).zip(&mut objects).for_each(|(nr, object)| object.tested = bevys[key].contains(&nr));
            let all: Vec<usize> = (0..objects.len()).collect();
            let mut oracle = Oracle::new(&objects, options);
            let verdict = oracle.frame(&objects, &all, &cameras[key], &|i| list.contains(&(i as u32)));
            assert_eq!(verdict.false_negatives, [], "frame {frame}, view {key:?}");
        }
        let tower = ours.iter().any(|(key, list)| key.0 == SUN && list.contains(&2));
        assert!(tower, "it casts no shadow");
    }
    for light in [SUN, BULB, SPOT] {
        assert!(left_out[&light] > 500, "{light}: {left_out:?}");
    }
}

#[test]
fn lists_are_bevys_where_all_casters_are_asked_for() {
    let mut pair = Pair::new(yard);
    // What is chosen later in a frame counts from the next one on.
    let late = |mut settings: ResMut<CascaSettings>| settings.enabled = true;
    pair.ours.add_systems(PostUpdate, late.after(CascaSystems::Sync).before(CascaSystems::Cameras));
    for frame in 0..24 {
        let mut settings = pair.ours.world_mut().resource_mut::<CascaSettings>();
        (settings.shadows, settings.enabled) = (Shadows::All, frame % 8 < 6);
        let (ours, bevys) = pair.frame(|world| {
            tick(world, frame);
            let (bulb, thing) = (entity(world, BULB), entity(world, 50));
            // Layers and lamps change, also while casca is off.
            match frame {
                3 => done(world.entity_mut(thing).insert(RenderLayers::layer(4))),
                5 => done(world.entity_mut(bulb).insert(RenderLayers::layer(3))),
                10 => done(world.entity_mut(bulb).remove::<RenderLayers>()),
                12 => world.get_mut::<PointLight>(bulb).unwrap().shadow_maps_enabled = false,
                _ => {}
            }
        });
        assert_eq!(light_lists(&mut pair.ours), light_lists(&mut pair.bevys), "frame {frame}");
        assert_eq!(ours[&CAMERA] == bevys[&CAMERA], frame % 8 >= 6, "frame {frame}");
    }
}
