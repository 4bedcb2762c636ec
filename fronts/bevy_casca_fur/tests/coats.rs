//! Coats: their layers, their boxes, their lives.

mod common;

use bevy_asset::Assets;
use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::{DynamicSkinnedMeshBounds, NoFrustumCulling, RenderLayers, Visibility};
use bevy_casca_fur::{ATTRIBUTE_FUR_LAYER, Coat, FurMaterial, Furry};
use bevy_ecs::prelude::*;
use bevy_image::Image;
use bevy_light::NotShadowCaster;
use bevy_math::{Mat4, Quat, Vec3, Vec3A};
use bevy_mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy_mesh::{Mesh, Mesh3d, Meshable, VertexAttributeValues};
use bevy_pbr::MeshMaterial3d;
use bevy_shape::{Cuboid, Sphere};
use bevy_transform::components::{GlobalTransform, Transform};
use casca_fur::glam;
use casca_fur::strands::Fur;
use common::*;

/// Animals in a row before the camera.
fn row(app: &mut bevy_app::App, count: u32) -> Vec<Entity> {
    let (ball, fur) = (ball(app), fur());
    let fur = material(app, fur);
    let far = |i: u32| Vec3::new(0.0, 0.0, -3.0 * 1.3f32.powi(i as i32));
    (0..count).map(|i| animal(app, &ball, &fur, far(i))).collect()
}

#[test]
fn layers_fall_with_distance() {
    let mut app = app();
    camera(&mut app);
    let animals = row(&mut app, 24);
    run(&mut app, 3);
    let found = all_layers(&mut app, &animals);
    assert_eq!(found[0], (24, false));
    assert_eq!(found[23], (0, true), "{found:?}");
    assert!(found.is_sorted_by(|a, b| a.0 >= b.0), "{found:?}");
    let kinds: std::collections::BTreeSet<u32> = found.iter().map(|f| f.0).collect();
    assert!(kinds.len() > 6, "{found:?}");
    // A layer for each 1.5 pixels of the height, at least, where they are not at their most.
    let focal = 360.0 / (std::f32::consts::FRAC_PI_8).tan();
    for (i, (layers, _)) in found.iter().enumerate() {
        let nearest = 3.0 * 1.3f32.powi(i as i32) - 1.1 * 3f32.sqrt();
        let pixels = 0.1 * focal / nearest;
        assert!(*layers >= ((pixels / 1.5) as u32).min(24), "{i}: {layers} for {pixels} pixels");
        assert!(*layers as f32 <= 2.0 * (pixels / 1.5).ceil(), "{i}: {layers} for {pixels} pixels");
    }
    // Meshes are shared.
    let mut of_coats = app.world_mut().query_filtered::<&Mesh3d, With<Coat>>();
    let meshes: std::collections::BTreeSet<_> = of_coats.iter(app.world()).map(|mesh| mesh.id()).collect();
    assert!(meshes.len() <= kinds.len(), "{} meshes for {} kinds", meshes.len(), kinds.len());
    // Nearer again: the last animal wakes.
    *app.world_mut().get_mut::<Transform>(animals[23]).unwrap() = Transform::from_xyz(0.0, 1.0, -3.0);
    run(&mut app, 2);
    assert_eq!(layers(&mut app, animals[23]), Some((24, false)));
    settings(&mut app).most_layers = 0;
    run(&mut app, 2);
    assert_eq!(layers(&mut app, animals[0]), Some((0, true)));
}

#[test]
fn a_budget_is_kept_and_what_is_hidden_takes_none_of_it() {
    let mut app = app();
    camera(&mut app);
    let animals = row(&mut app, 12);
    run(&mut app, 3);
    let ball = app.world().get::<Mesh3d>(animals[0]).unwrap().0.clone();
    let fur = app.world().get::<Furry>(animals[0]).unwrap().0.clone();
    let vertices = app.world().resource::<Assets<Mesh>>().get(&ball).unwrap().count_vertices() as f64;
    let weight = |app: &mut bevy_app::App| {
        let of = |a: &Entity| f64::from(layers(app, *a).unwrap().0 + 1) * vertices;
        animals.iter().map(of).sum::<f64>()
    };
    let free = weight(&mut app);
    settings(&mut app).pixel_weight = 0.0;
    let mut last = 0.0;
    for share in [0.1, 0.3, 0.5, 0.9] {
        settings(&mut app).budget = free * share;
        run(&mut app, 2);
        let spent = weight(&mut app);
        assert!(spent <= free * share || spent == 12.0 * vertices, "{spent} of {}", free * share);
        assert!(spent >= last && spent > 0.4 * free * share, "{spent} of {}", free * share);
        last = spent;
    }
    // A hundred behind the camera, and one that is not shown, change nothing.
    let before = all_layers(&mut app, &animals);
    let behind: Vec<Entity> =
        (0..100).map(|i| animal(&mut app, &ball, &fur, Vec3::new(0.0, 0.0, 3.0 + i as f32))).collect();
    let secret = animal(&mut app, &ball, &fur, Vec3::new(0.0, 0.0, -3.0));
    app.world_mut().entity_mut(secret).insert(Visibility::Hidden);
    run(&mut app, 4);
    assert_eq!(before, all_layers(&mut app, &animals));
    let seen = |e: Entity, app: &mut bevy_app::App| {
        let coat = coat(app, e).unwrap();
        app.world().get::<bevy_camera::visibility::ViewVisibility>(coat).unwrap().get()
    };
    assert!(!seen(secret, &mut app) && behind.iter().all(|&e| !seen(e, &mut app)));
    assert!(seen(animals[0], &mut app));
}

/// The corners of an extruded mesh at some heights.
fn extruded(mesh: &Mesh, fur: &Fur) -> Vec<Vec3> {
    let normals = floats(mesh, Mesh::ATTRIBUTE_NORMAL);
    let corners = floats(mesh, Mesh::ATTRIBUTE_POSITION).into_iter().zip(normals);
    let at = |(p, n): ([f32; 3], [f32; 3])| {
        let (p, n) = (glam::Vec3::from(p), glam::Vec3::from(n).normalize());
        (0..=8).map(move |h| fur.extruded(p, n, h as f32 / 8.0))
    };
    corners.flat_map(at).map(|p| Vec3::from_array(p.to_array())).collect()
}

fn contains(aabb: &Aabb, point: Vec3) -> bool {
    (Vec3A::from(point) - aabb.center).abs().cmple(aabb.half_extents).all()
}

#[test]
fn boxes_contain_all_layers() {
    let mut app = app();
    camera(&mut app);
    let meshes = [Mesh::from(Cuboid::new(0.3, 2.0, 1.0)), Sphere::new(0.7).mesh().uv(12, 7)];
    let mut tightest = f32::INFINITY;
    for (i, mesh) in meshes.into_iter().enumerate() {
        for k in 0..24_u32 {
            let turn = |seed: u32| ((k * 7919 + seed * 104_729) % 1000) as f32 / 500.0 - 1.0;
            let bend = glam::Vec3::new(turn(1), turn(2), turn(3)) * 2.3 * f32::from(k > 0);
            let shifted = mesh.clone().translated_by(Vec3::new(1000.0 * turn(4), 5.0, 0.0));
            let fur = Fur { bend, ..Fur::for_radius(1.0, 0.05 + 0.01 * k as f32, 0.2).unwrap() };
            let (handle, material) = (add(&mut app, shifted.clone()), material(&mut app, fur));
            let animal = animal(&mut app, &handle, &material, Vec3::new(0.0, 0.0, -6.0));
            run(&mut app, 2);
            let coat = coat(&mut app, animal).unwrap();
            let aabb = *app.world().get::<Aabb>(coat).unwrap();
            let points = extruded(&shifted, &fur);
            assert!(points.iter().all(|&p| contains(&aabb, p)), "mesh {i}, fur {k}");
            let far = points.iter().map(|&p| (Vec3A::from(p) - aabb.center).abs() / aabb.half_extents);
            tightest = tightest.min(1.0 - far.map(|f| f.max_element()).fold(0.0, f32::max));
        }
    }
    assert!(tightest < 0.01, "boxes are wide: {tightest}");
}

#[test]
fn changes_of_meshes_and_materials_are_followed() {
    let mut app = app();
    camera(&mut app);
    let animals = row(&mut app, 2);
    run(&mut app, 4);
    let mesh = app.world().get::<Mesh3d>(animals[0]).unwrap().0.clone();
    let fur_handle = app.world().get::<Furry>(animals[0]).unwrap().0.clone();
    let before = shells(&mut app, animals[0]).count_vertices();
    let wide = Sphere::new(2.0).mesh().uv(8, 5);
    let vertices = wide.count_vertices();
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&mesh, wide.clone()).unwrap();
    run(&mut app, 3);
    let after = shells(&mut app, animals[0]);
    assert!(after.count_vertices() != before);
    assert_eq!(after.count_vertices() % vertices, 0);
    let coat_of = coat(&mut app, animals[0]).unwrap();
    let aabb = |app: &bevy_app::App, coat: Entity| *app.world().get::<Aabb>(coat).unwrap();
    let old = aabb(&app, coat_of);
    assert!(extruded(&wide, &fur()).iter().all(|&p| contains(&old, p)));
    // Longer fur.
    let long = Fur { height: 0.5, ..fur() };
    grow(&mut app, &fur_handle, long);
    run(&mut app, 2);
    let new = aabb(&app, coat_of);
    assert!(new.half_extents.x > old.half_extents.x + 0.3);
    assert!(extruded(&wide, &long).iter().all(|&p| contains(&new, p)));
    // Another material, layers of rendering, no shadow.
    let other = material(&mut app, fur());
    let more = (Furry(other.clone()), RenderLayers::layer(3), NotShadowCaster, NoFrustumCulling);
    app.world_mut().entity_mut(animals[0]).insert(more);
    run(&mut app, 2);
    let of_coat = app.world().entity(coat_of);
    assert_eq!(of_coat.get::<MeshMaterial3d<FurMaterial>>().unwrap().0, other);
    assert_eq!(of_coat.get::<RenderLayers>(), Some(&RenderLayers::layer(3)));
    assert!(of_coat.contains::<NotShadowCaster>() && of_coat.contains::<NoFrustumCulling>());
    app.world_mut().entity_mut(animals[0]).remove::<(RenderLayers, NotShadowCaster, NoFrustumCulling)>();
    run(&mut app, 2);
    let of_coat = app.world().entity(coat_of);
    assert!(!of_coat.contains::<NotShadowCaster>() && !of_coat.contains::<RenderLayers>());
}

#[test]
fn coats_come_and_go_with_their_animals() {
    let mut app = app();
    camera(&mut app);
    let animals = row(&mut app, 4);
    run(&mut app, 2);
    let coats: Vec<Entity> = animals.iter().map(|&a| coat(&mut app, a).unwrap()).collect();
    // One is despawned, one loses its fur, one its mesh; the coat of one is despawned by somebody.
    app.world_mut().entity_mut(animals[0]).despawn();
    app.world_mut().entity_mut(animals[1]).remove::<Furry>();
    app.world_mut().entity_mut(animals[2]).remove::<Mesh3d>();
    app.world_mut().entity_mut(coats[3]).despawn();
    run(&mut app, 2);
    assert!(coats.iter().all(|&coat| app.world().get_entity(coat).is_err()));
    assert!(layers(&mut app, animals[1]).is_none() && layers(&mut app, animals[2]).is_none());
    assert!(layers(&mut app, animals[3]).is_some_and(|(layers, _)| layers > 0));
    // A copy of a coat goes, whichever of the two it is.
    let coat_of = coat(&mut app, animals[3]).unwrap();
    let made = app.world().get::<Coat>(coat_of).unwrap().clone();
    let mesh = app.world().get::<Mesh3d>(coat_of).unwrap().clone();
    let material = app.world().get::<MeshMaterial3d<FurMaterial>>(coat_of).unwrap().clone();
    app.world_mut().spawn((made, mesh, material, Aabb::default(), ChildOf(animals[3])));
    run(&mut app, 2);
    // One that is nobody's goes, too.
    let coat_of = coat(&mut app, animals[3]).unwrap();
    app.world_mut().entity_mut(coat_of).remove::<ChildOf>();
    run(&mut app, 2);
    assert!(coat(&mut app, animals[3]).is_some());
    let world = app.world_mut();
    assert_eq!(world.query::<&Coat>().iter(world).count(), 1);
}

#[test]
fn nothing_is_marked_changed_where_nothing_changes() {
    #[derive(Resource, Default)]
    struct Changes(usize);
    type Anything = Or<(Changed<Coat>, Changed<Mesh3d>, Changed<Aabb>, Changed<Visibility>)>;
    let mut app = app();
    camera(&mut app);
    row(&mut app, 12);
    app.init_resource::<Changes>();
    run(&mut app, 4);
    let count = |changed: Query<(), (With<Coat>, Anything)>, mut changes: ResMut<Changes>| {
        changes.0 += changed.iter().count();
    };
    app.add_systems(bevy_app::Last, count);
    // The first run of a system finds all that changed before.
    run(&mut app, 1);
    app.world_mut().resource_mut::<Changes>().0 = 0;
    run(&mut app, 4);
    assert_eq!(app.world().resource::<Changes>().0, 0);
}

#[test]
fn the_nearest_of_several_cameras_counts_and_none_is_needed() {
    let mut app = app();
    let animals = row(&mut app, 9);
    run(&mut app, 2);
    assert_eq!(layers(&mut app, animals[8]), Some((1, false)), "nobody looks");
    let first = camera(&mut app);
    run(&mut app, 3);
    let one = all_layers(&mut app, &animals);
    let second = camera(&mut app);
    *app.world_mut().get_mut::<Transform>(second).unwrap() =
        Transform::from_xyz(0.0, 0.0, -3.0 * 1.3f32.powi(8) - 4.0).looking_to(Vec3::Z, Vec3::Y);
    run(&mut app, 3);
    let two = all_layers(&mut app, &animals);
    assert!(two[8].0 == 24 && one[8].0 < 12 && two[0] == one[0], "{one:?} {two:?}");
    // Parallel rays: all are as large.
    let lens = bevy_camera::OrthographicProjection {
        scaling_mode: bevy_camera::ScalingMode::FixedVertical { viewport_height: 20.0 },
        area: bevy_math::Rect::new(-17.0, -10.0, 17.0, 10.0),
        ..bevy_camera::OrthographicProjection::default_3d()
    };
    app.world_mut().entity_mut(second).despawn();
    app.world_mut().entity_mut(first).insert(bevy_camera::Projection::Orthographic(lens));
    run(&mut app, 3);
    let flat = all_layers(&mut app, &animals);
    // 0.1 of 20 units on 720 pixels: 3.6 pixels, three layers.
    assert!(flat.iter().all(|layers| layers.0 == 3), "{flat:?}");
    app.world_mut().entity_mut(first).despawn();
    run(&mut app, 3);
    assert_eq!(layers(&mut app, animals[0]), Some((3, false)));
}

#[test]
fn meshes_that_nobody_uses_are_dropped() {
    let mut app = app();
    let eye = camera(&mut app);
    row(&mut app, 1);
    let mut most = 0;
    for i in 0..40 {
        *app.world_mut().get_mut::<Transform>(eye).unwrap() = Transform::from_xyz(0.0, 0.0, i as f32);
        run(&mut app, 2);
        most = most.max(app.world().resource::<Assets<Mesh>>().len());
    }
    assert!(most > 5, "{most}");
    run(&mut app, 250);
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 2, "the skin and its layers");
}

#[test]
fn coats_of_posed_skins_have_boxes_around_all_layers() {
    let mut app = app();
    camera(&mut app);
    let fur = Fur { bend: glam::Vec3::new(0.0, -1.0, 0.5), ..fur() };
    let mesh = Mesh::from(Cuboid::new(1.0, 3.0, 1.0));
    let high = |p: &[f32; 3]| p[1] > 0.0;
    let positions = floats(&mesh, Mesh::ATTRIBUTE_POSITION);
    let joints: Vec<[u16; 4]> = positions.iter().map(|p| [u16::from(high(p)), 0, 0, 0]).collect();
    let mesh = mesh
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints))
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[1.0, 0.0, 0.0, 0.0]; positions.len()]);
    let (handle, material) = (add(&mut app, mesh.clone()), material(&mut app, fur));
    let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]);
    let inverse_bindposes = app.world_mut().resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    let turn = Quat::from_rotation_z(0.9);
    let at = Transform::from_xyz(0.4, 0.2, -6.0).with_rotation(turn).with_scale(Vec3::new(1.0, 2.0, 1.5));
    let bones = [Transform::from_xyz(0.0, 0.0, -6.0), at];
    let bones = bones.map(|bone| app.world_mut().spawn(bone).id()).to_vec();
    let animal = animal(&mut app, &handle, &material, Vec3::new(0.0, 0.0, -6.0));
    let skinned = SkinnedMesh { inverse_bindposes, joints: bones.clone() };
    app.world_mut().entity_mut(animal).insert((skinned, DynamicSkinnedMeshBounds));
    run(&mut app, 4);
    let coat = coat(&mut app, animal).unwrap();
    let of_coat = app.world().entity(coat);
    assert_eq!(of_coat.get::<SkinnedMesh>().unwrap().joints, bones);
    let aabb = of_coat.get::<Aabb>().unwrap();
    let from_world = of_coat.get::<GlobalTransform>().unwrap().affine().inverse();
    let bone = |i: usize| app.world().get::<GlobalTransform>(bones[i]).unwrap().affine();
    let places: Vec<usize> = positions.iter().map(|p| usize::from(high(p))).collect();
    let points = extruded(&mesh, &fur);
    for (i, &p) in points.iter().enumerate() {
        let posed = from_world.transform_point3(bone(places[i / 9]).transform_point3(p));
        assert!(contains(aabb, posed), "{posed} outside of {aabb:?}");
    }
    assert!(of_coat.contains::<DynamicSkinnedMeshBounds>());
    assert!(shells(&mut app, animal).contains_attribute(Mesh::ATTRIBUTE_JOINT_INDEX));
    assert!(shells(&mut app, animal).contains_attribute(ATTRIBUTE_FUR_LAYER));
}

#[test]
fn tables_of_strands_come_with_materials_are_shared_and_go() {
    let mut app = app();
    let (first, second) = (material(&mut app, fur()), material(&mut app, Fur { height: 0.2, ..fur() }));
    let tables = |app: &mut bevy_app::App| -> Vec<Option<Vec<u8>>> {
        run(app, 2);
        app.world().resource::<Assets<Image>>().iter().map(|(_, image)| image.data.clone()).collect()
    };
    let bytes = |fur: Fur| Some(fur.table().into_iter().flat_map(u32::to_le_bytes).collect());
    assert_eq!(tables(&mut app), [bytes(fur())], "fur of any height has the same points");
    let other = Fur { seed: 7, ..fur() };
    grow(&mut app, &first, other);
    let both = tables(&mut app);
    assert!(both.len() == 2 && both.contains(&bytes(other)) && both.contains(&bytes(fur())));
    drop(second);
    assert_eq!(tables(&mut app), [bytes(other)]);
}
