//! Work in the background: worlds are lit, and probes follow what moves.

use std::collections::HashMap;

use bevy_asset::{AssetId, Assets, Handle};
use bevy_ecs::prelude::*;
use bevy_image::Image;
use bevy_light::{DirectionalLight, IrradianceVolume, PointLight, SpotLight};
use bevy_math::{Rect, Vec3};
use bevy_mesh::{Mesh, Mesh3d};
use bevy_pbr::Lightmap;
use bevy_tasks::futures::check_ready;
use bevy_tasks::{AsyncComputeTaskPool, Task};
use bevy_transform::components::{GlobalTransform, Transform};
use casca_lightmap::{BakeError, Following, Light, OutputMesh, Placed, Probes, Settings, light};
use glam::Affine3A;

use crate::lit::{LitLevel, image, volume};
use crate::world::{Found, Surroundings};

/// Lights what stands below an entity, in the background: give it to the root of a level when that is
/// loaded. Its meshes then get lightmaps, but for those that move, and it gets probes and a [`LitLevel`].
/// This goes when all is done, or cannot be.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct BakeLight {
    /// How it is lit.
    pub settings: Settings,
    /// Radiance of the sky.
    pub sky: Vec3,
}

/// A mesh, and its entities.
type Places = (Handle<Mesh>, Vec<Entity>);

/// A level that is being lit.
#[derive(Component)]
pub(crate) struct Baking {
    task: Task<Result<Light, BakeError>>,
    /// The entities by mesh that is lit, in the order of its places.
    entities: Vec<Places>,
}

/// Probes that follow what moves.
#[derive(Component)]
pub(crate) struct Follower {
    /// While nothing is to be done.
    idle: Option<Box<Following>>,
    task: Option<Task<Result<Box<Following>, BakeError>>>,
    /// What moves: its entity, its number, and where it is in the probes.
    movers: Vec<(Entity, usize, Affine3A)>,
}

pub(crate) fn bake(
    mut commands: Commands,
    around: Surroundings,
    levels: Query<(Entity, &BakeLight), Without<Baking>>,
) {
    for (root, how) in &levels {
        let Some((frame, _)) = around.frame(root) else { continue };
        let Found { scene, objects } = around.scene(root, &frame, how.sky);
        let mut numbers: HashMap<AssetId<Mesh>, usize> = HashMap::new();
        let (mut placed, mut entities): (Vec<Placed>, Vec<Places>) = Default::default();
        for ((entity, mesh, _), object) in objects.iter().zip(&scene.objects).filter(|(o, _)| !o.2) {
            let number = *numbers.entry(mesh.id()).or_insert_with(|| {
                placed.push(Placed { mesh: (*object.mesh).clone(), places: Vec::new() });
                entities.push((mesh.clone(), Vec::new()));
                placed.len() - 1
            });
            placed[number].places.push(object.transform);
            entities[number].1.push(*entity);
        }
        let settings = how.settings;
        let task = async move { light(&scene, &placed, &settings, &mut |_, _, _| {}) };
        let task = AsyncComputeTaskPool::get().spawn(task);
        commands.entity(root).try_insert(Baking { task, entities });
    }
}

pub(crate) fn finish(
    mut commands: Commands,
    mut levels: Query<(Entity, &BakeLight, &mut Baking)>,
    around: Query<&GlobalTransform>,
    drawn: Query<&Mesh3d>,
    (mut meshes, mut images): (ResMut<Assets<Mesh>>, ResMut<Assets<Image>>),
) {
    for (root, how, mut baking) in &mut levels {
        let Some(done) = check_ready(&mut baking.task) else { continue };
        commands.entity(root).remove::<(BakeLight, Baking)>();
        let found = match done {
            Ok(found) => found,
            Err(why) => {
                bevy_log::error!("{root} gets no light: {why}");
                continue;
            }
        };
        let size = [found.atlas.width, found.atlas.height, 0];
        let texels = found.texels.chunks((size[0] * size[1]).max(1) as usize);
        let pages: Vec<Handle<Image>> = texels.map(|page| images.add(image(size, page))).collect();
        for ((old, entities), layout) in baking.entities.iter().zip(&found.atlas.meshes) {
            let Some(mesh) = meshes.get(old).and_then(|mesh| mapped(mesh, layout)) else { continue };
            let mesh = meshes.add(mesh);
            let has_it = |entity: &Entity| drawn.get(*entity).is_ok_and(|mesh| mesh.0 == *old);
            // Some have another mesh by now.
            for (entity, rect) in entities.iter().zip(&layout.instances).filter(|(e, _)| has_it(e)) {
                let Some(page) = pages.get(rect.page as usize) else { continue };
                let uv_rect = Rect { min: rect.min.into(), max: rect.max.into() };
                let lightmap = Lightmap { image: page.clone(), uv_rect, ..Lightmap::default() };
                commands.entity(*entity).try_insert((Mesh3d(mesh.clone()), lightmap));
            }
        }
        let scale = around.get(root).map_or(Vec3::ONE, |place| place.scale());
        let (lit, probes) =
            (LitLevel::of(how.sky, &how.settings), of_probes(&found.probes, scale, &mut images));
        // Whoever hears that all is done may take the level away.
        commands.entity(root).queue_silenced(move |mut root: EntityWorldMut| {
            root.insert(lit).with_child(probes);
        });
    }
}

/// Takes the light that lightmaps have out of lights.
pub(crate) fn dim(
    levels: Query<(Entity, &LitLevel), Added<LitLevel>>,
    parents: Query<&ChildOf>,
    mut points: Query<(Entity, &mut PointLight)>,
    mut spots: Query<(Entity, &mut SpotLight)>,
    mut suns: Query<&mut DirectionalLight>,
) {
    for (root, _) in levels.iter().filter(|level| !level.1.live) {
        let is_below = |e: Entity| e == root || parents.iter_ancestors(e).any(|e| e == root);
        for (_, mut light) in points.iter_mut().filter(|l| is_below(l.0)) {
            light.affects_lightmapped_mesh_diffuse = false;
        }
        for (_, mut light) in spots.iter_mut().filter(|l| is_below(l.0)) {
            light.affects_lightmapped_mesh_diffuse = false;
        }
        suns.iter_mut().for_each(|mut sun| sun.affects_lightmapped_mesh_diffuse = false);
    }
}

/// Probes as a child of a level whose root has a scale.
fn of_probes(probes: &Probes, scale: Vec3, images: &mut Assets<Image>) -> (Transform, IrradianceVolume) {
    let (size, texels) = probes.texture();
    let corner = |p: glam::Vec3| Vec3::from_array(p.to_array()) / scale;
    volume((corner(probes.min), corner(probes.max)), images.add(image(size.to_array(), &texels)))
}

/// A mesh with the coordinates of a layout, of which it has one vertex for each corner of a triangle.
fn mapped(mesh: &Mesh, layout: &OutputMesh) -> Option<Mesh> {
    let mut mesh = mesh.clone();
    mesh.try_duplicate_vertices().ok()?;
    let uv: Vec<[f32; 2]> = layout.indices.iter().map(|v| layout.vertices[*v as usize].uv).collect();
    // Not so where nothing could be unwrapped.
    if mesh.count_vertices() != uv.len() {
        return None;
    }
    // Bevy draws nothing that has a second set of coordinates alone.
    if !mesh.contains_attribute(Mesh::ATTRIBUTE_UV_0) {
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, uv.clone());
    }
    Some(mesh.with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, uv))
}

pub(crate) fn follow(
    mut commands: Commands,
    mut around: Surroundings,
    mut levels: Query<(Entity, &LitLevel, Option<&mut Follower>)>,
    mut volumes: Query<(&ChildOf, &mut Transform, &mut IrradianceVolume)>,
) {
    let pool = AsyncComputeTaskPool::get();
    for (root, level, follower) in levels.iter_mut() {
        let Some((frame, scale)) = around.frame(root).filter(|_| around.is_any_moving()) else { continue };
        let Some(mut follower) = follower else {
            let Found { scene, objects } = around.scene(root, &frame, level.sky);
            let moving =
                |(i, o): (usize, &(Entity, _, bool))| o.2.then(|| (o.0, i, scene.objects[i].transform));
            let movers = objects.iter().enumerate().filter_map(moving).collect();
            let settings = Settings { spacing: level.spacing, cells: level.cells, ..Settings::default() };
            let task = pool.spawn(async move { Following::new(scene, &settings).map(Box::new) });
            commands.entity(root).try_insert(Follower { idle: None, task: Some(task), movers });
            continue;
        };
        if let Some(done) = follower.task.as_mut().and_then(check_ready) {
            follower.task = None;
            match done {
                Ok(following) => {
                    let scale = Vec3::from_array(scale.to_array());
                    let mut of_root = volumes.iter_mut().filter(|volume| volume.0.parent() == root);
                    if let Some((_, mut place, mut volume)) = of_root.next() {
                        (*place, *volume) = of_probes(&following.probes, scale, &mut around.images);
                    }
                    follower.idle = Some(following);
                }
                Err(why) => bevy_log::error!("the probes of {root} no longer follow what moves: {why}"),
            }
        }
        let mut moved = Vec::new();
        if follower.idle.is_some() {
            for (entity, number, old) in &mut follower.movers {
                let place = around.place(&frame, *entity);
                if place != *old {
                    *old = place;
                    moved.push((*number, place));
                }
            }
        }
        if let Some(mut following) = follower.idle.take_if(|_| !moved.is_empty()) {
            follower.task = Some(pool.spawn(async move {
                following.moved(&moved)?;
                Ok(following)
            }));
        }
    }
}
