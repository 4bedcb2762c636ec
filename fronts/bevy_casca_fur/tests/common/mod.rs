//! Apps with fur, without a renderer and a window.
#![allow(dead_code)]

use bevy_app::{App, TaskPoolPlugin};
use bevy_asset::{AssetApp, AssetPlugin, Assets, Handle};
use bevy_camera::visibility::Visibility;
use bevy_camera::{Camera, Camera3d, CameraPlugin, ComputedCameraValues, RenderTargetInfo};
use bevy_casca_fur::{Coat, FurExtension, FurMaterial, FurPlugin, FurSettings, Furry, fur_material};
use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec3};
use bevy_mesh::{Mesh, Mesh3d, MeshPlugin, MeshVertexAttribute, Meshable, VertexAttributeValues};
use bevy_pbr::StandardMaterial;
use bevy_shape::Sphere;
use bevy_transform::TransformPlugin;
use bevy_transform::components::Transform;
use casca_fur::strands::Fur;

pub fn app() -> App {
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), TransformPlugin, AssetPlugin::default(), MeshPlugin));
    app.init_asset::<bevy_image::Image>();
    app.add_plugins((CameraPlugin, FurPlugin));
    app
}

/// Fur of 10% of a radius of 1.
pub fn fur() -> Fur {
    Fur::for_radius(1.0, 0.1, 0.3).unwrap()
}

pub fn material(app: &mut App, fur: Fur) -> Handle<FurMaterial> {
    let material = fur_material(StandardMaterial::default(), FurExtension::new(fur));
    app.world_mut().resource_mut::<Assets<FurMaterial>>().add(material)
}

/// Gives a material other strands.
pub fn grow(app: &mut App, of: &Handle<FurMaterial>, strands: Fur) {
    let mut materials = app.world_mut().resource_mut::<Assets<FurMaterial>>();
    materials.get_mut(of).unwrap().extension.strands = strands;
}

pub fn add(app: &mut App, mesh: Mesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

/// A ball of radius 1.
pub fn ball(app: &mut App) -> Handle<Mesh> {
    add(app, Sphere::new(1.0).mesh().uv(16, 9))
}

pub fn animal(app: &mut App, mesh: &Handle<Mesh>, fur: &Handle<FurMaterial>, at: Vec3) -> Entity {
    let bundle = (Mesh3d(mesh.clone()), Furry(fur.clone()), Transform::from_translation(at));
    app.world_mut().spawn(bundle).id()
}

/// A camera of 1280 by 720 pixels at the origin, which looks along -z.
pub fn camera(app: &mut App) -> Entity {
    let target_info = Some(RenderTargetInfo { physical_size: UVec2::new(1280, 720), scale_factor: 1.0 });
    let computed = ComputedCameraValues { target_info, ..Default::default() };
    let camera = Camera { computed, ..Default::default() };
    app.world_mut().spawn((camera, Camera3d::default(), Transform::default())).id()
}

/// The coat of an animal.
pub fn coat(app: &mut App, animal: Entity) -> Option<Entity> {
    let world = app.world_mut();
    let mut coats = world.query_filtered::<(Entity, &ChildOf), With<Coat>>();
    coats.iter(world).find(|(_, parent)| parent.parent() == animal).map(|(coat, _)| coat)
}

/// The layers of an animal, and whether its coat is hidden.
pub fn layers(app: &mut App, animal: Entity) -> Option<(u32, bool)> {
    let coat = coat(app, animal)?;
    let entity = app.world().entity(coat);
    let hidden = entity.get::<Visibility>() == Some(&Visibility::Hidden);
    Some((entity.get::<Coat>()?.layers(), hidden))
}

/// The same of animals with coats.
pub fn all_layers(app: &mut App, animals: &[Entity]) -> Vec<(u32, bool)> {
    animals.iter().map(|&animal| layers(app, animal).unwrap()).collect()
}

/// The values of an attribute of three floats.
pub fn floats(mesh: &Mesh, attribute: MeshVertexAttribute) -> Vec<[f32; 3]> {
    match mesh.attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(values)) => values.clone(),
        _ => panic!("no floats"),
    }
}

/// The mesh of the coat of an animal.
pub fn shells(app: &mut App, animal: Entity) -> Mesh {
    let coat = coat(app, animal).unwrap();
    let id = app.world().get::<Mesh3d>(coat).unwrap().id();
    app.world().resource::<Assets<Mesh>>().get(id).unwrap().clone()
}

pub fn settings(app: &mut App) -> Mut<'_, FurSettings> {
    app.world_mut().resource_mut()
}

pub fn run(app: &mut App, frames: u32) {
    (0..frames).for_each(|_| app.update());
}
