//! Boxes around hidden entities.
#![cfg(feature = "gizmos")]

mod common;

use std::any::TypeId;

use bevy_app::App;
use bevy_asset::Assets;
use bevy_casca::{CascaGizmos, CascaGizmosPlugin, CascaScene, NoOcclusionCulling};
use bevy_gizmos::config::GizmoConfigStore;
use bevy_gizmos::{GizmoAsset, GizmoHandles, GizmoPlugin};
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use common::{CAMERA, entity, headless, opaque, settle, spawn_box, spawn_camera};

/// The corners of a box are those of 12 edges, in a strip or as lines.
fn corners(app: &App) -> Vec<Vec3> {
    let handles = app.world().resource::<GizmoHandles>();
    let handle = handles.handles().get(&TypeId::of::<CascaGizmos>()).unwrap();
    let Some(handle) = handle else { return Vec::new() };
    let asset = app.world().resource::<Assets<GizmoAsset>>().get(handle).unwrap();
    let all = asset.buffer().buffer();
    all.list_positions.iter().chain(all.strip_positions).copied().filter(|at| at.is_finite()).collect()
}

#[test]
fn boxes_are_around_what_is_hidden() {
    let mut app = headless(true);
    app.add_plugins((bevy_time::TimePlugin, GizmoPlugin, CascaGizmosPlugin));
    let world = app.world_mut();
    opaque(world, 0, Vec3::new(0.0, 0.0, -10.0), Vec3::new(20.0, 20.0, 0.5));
    spawn_box(world, 1, Vec3::new(3.0, 0.0, -20.0), Vec3::ONE);
    spawn_box(world, 2, Vec3::new(0.0, 0.0, -5.0), Vec3::ONE);
    spawn_box(world, 3, Vec3::new(0.0, 0.0, 50.0), Vec3::ONE);
    let at = Transform::default().looking_to(Vec3::NEG_Z, Vec3::Y);
    spawn_camera(world, CAMERA, at);
    // It sees all, and does not count.
    let second =
        spawn_camera(world, CAMERA + 1, Transform::from_xyz(0.0, 99.0, 0.0).looking_to(Vec3::NEG_Y, Vec3::Z));
    world.entity_mut(second).insert(NoOcclusionCulling);
    settle(&mut app);
    app.update();
    let hidden = |app: &App| {
        let corners = corners(app);
        let near = |middle: Vec3| corners.iter().filter(|at| at.distance(middle) < 1.0).count();
        [Vec3::new(3.0, 0.0, -20.0), Vec3::new(0.0, 0.0, -5.0), Vec3::new(0.0, 0.0, 50.0)].map(near)
    };
    let [behind, before, out] = hidden(&app);
    assert!(behind >= 8 && before == 0 && out == 0, "{behind} {before} {out}");

    // It moves out of sight: its volume is drawn, which is larger than the box.
    for frame in 0..20 {
        let mover = entity(app.world_mut(), 1);
        app.world_mut().get_mut::<Transform>(mover).unwrap().translation.x = 3.0 + 0.01 * frame as f32;
        app.update();
    }
    let casca = app.world().resource::<CascaScene>();
    let scene = casca.scene().unwrap();
    let volumes: Vec<_> = scene.ids().filter_map(|id| scene.tbv(id).unwrap()).collect();
    assert_eq!(volumes.len(), 1);
    let low = Vec3::from_array(volumes[0].0.as_vec3().to_array());
    assert!(corners(&app).iter().any(|at| at.distance(low) < 1e-3));

    app.world_mut().resource_mut::<GizmoConfigStore>().config_mut::<CascaGizmos>().1.most = 0;
    app.update();
    assert_eq!(corners(&app).len(), 0);
}
