//! Levels are loaded and lit, and probes follow doors, without a renderer.

use std::path::PathBuf;
use std::time::Duration;

use bevy::image::{CompressedImageFormats, ImageLoader};
use bevy::prelude::*;
use bevy_casca_light::{BakeLight, CascaLightPlugin, LitLevel, Moves, Settings};
use bevy_light::IrradianceVolume;
use bevy_pbr::Lightmap;
use casca_lightmap::{Level, light};
use wgpu_types::TextureFormat;

#[path = "../examples/light/level.rs"]
mod level;

/// Boxes are inverted and multiplied in single precision, at some metres.
const ROUNDING: f32 = 1e-3;
const HOW: Settings = Settings { texels: 2.0, side: 512, spacing: 1.0, cells: 24, rays: 16, live: false };

/// A folder of files, which goes with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(String, Vec<u8>)]) -> Self {
        let folder = std::env::temp_dir().join(format!("bevy-casca-light-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        files.iter().for_each(|(name, bytes)| std::fs::write(folder.join(name), bytes).unwrap());
        Self(folder)
    }

    fn app(&self) -> App {
        let mut app = App::new();
        let file_path = self.0.to_str().unwrap().to_owned();
        app.add_plugins((
            TaskPoolPlugin::default(),
            AssetPlugin { file_path, ..default() },
            TransformPlugin,
            bevy::mesh::MeshPlugin,
            bevy::image::ImagePlugin::default(),
            bevy::world_serialization::WorldSerializationPlugin,
            bevy::gltf::GltfPlugin::default(),
            CascaLightPlugin,
        ));
        // As Bevy's renderer does.
        app.register_asset_loader(ImageLoader::new(CompressedImageFormats::NONE));
        app.init_asset::<StandardMaterial>();
        level::register(&mut app);
        app.finish();
        app.cleanup();
        app
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Updates until something is there.
fn until<T>(app: &mut App, mut found: impl FnMut(&mut World) -> Option<T>) -> T {
    for _ in 0..6000 {
        app.update();
        if let Some(found) = found(app.world_mut()) {
            return found;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("nothing came");
}

/// Spawns the scene of a file, and waits until a thing named `far` is there.
fn spawn(app: &mut App) -> Entity {
    let scene = app.world().resource::<AssetServer>().load("lit.glb#Scene0");
    let root = app.world_mut().spawn(WorldAssetRoot(scene)).id();
    until(app, |world| world.query::<&Name>().iter(world).any(|name| name.as_str() == "far").then_some(()));
    root
}

fn files(live: bool) -> (Vec<(String, Vec<u8>)>, casca_lightmap::Light) {
    let bytes = level::level().unwrap();
    let level = Level::read("rooms", &bytes, None).unwrap();
    let how = Settings { live, ..HOW };
    let found = light(&level.scene, &level.placed, &how, &mut |_, _, _| {}).unwrap();
    (level.lit("lit", &found, &how).unwrap(), found)
}

fn lightmaps(world: &mut World) -> Vec<Lightmap> {
    world.query::<&Lightmap>().iter(world).cloned().collect()
}

fn volume(world: &mut World) -> Option<(GlobalTransform, IrradianceVolume)> {
    world.query::<(&GlobalTransform, &IrradianceVolume)>().iter(world).next().map(|(p, v)| (*p, v.clone()))
}

#[test]
fn a_lit_level_has_its_lightmaps_and_probes_where_the_files_say() {
    for live in [false, true] {
        let (files, found) = files(live);
        let folder = Folder::new("lit", &files);
        let mut app = folder.app();
        spawn(&mut app);
        let maps = lightmaps(app.world_mut());
        // All but the door, which moves.
        let mut wanted: Vec<[f32; 4]> = found
            .atlas
            .meshes
            .iter()
            .flat_map(|m| &m.instances)
            .map(|rect| [rect.min[0], rect.min[1], rect.max[0], rect.max[1]])
            .collect();
        let mut rects: Vec<[f32; 4]> = maps
            .iter()
            .map(|map| [map.uv_rect.min.x, map.uv_rect.min.y, map.uv_rect.max.x, map.uv_rect.max.y])
            .collect();
        assert_eq!(maps.len(), 13);
        wanted.sort_by(|a, b| a.partial_cmp(b).unwrap());
        rects.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(rects, wanted);
        let (place, volume) = volume(app.world_mut()).unwrap();
        let (probes, cube) = (&found.probes, place.compute_transform());
        let corner = |half: f32| (cube.translation + half * cube.scale).to_array();
        assert_eq!((corner(-0.5), corner(0.5)), (probes.min.to_array(), probes.max.to_array()));
        assert_eq!((volume.intensity, volume.affects_lightmapped_meshes), (1.0, false));
        let size = until(&mut app, |world| {
            let images = world.resource::<Assets<Image>>();
            let (page, voxels) = (images.get(&maps[0].image)?, images.get(&volume.voxels)?);
            assert!(
                [page, voxels].iter().all(|i| i.texture_descriptor.format == TextureFormat::Rgb9e5Ufloat)
            );
            Some(voxels.texture_descriptor.size)
        });
        let n = probes.counts;
        assert_eq!([size.width, size.height, size.depth_or_array_layers], [n.x, 2 * n.y, 3 * n.z]);
        let world = app.world_mut();
        let lamp = world.query::<&PointLight>().single(world).unwrap();
        assert_eq!(lamp.affects_lightmapped_mesh_diffuse, live);
    }
}

#[test]
fn files_that_say_nonsense_are_loaded_without_light() {
    let (files, _) = files(false);
    let glb = String::from_utf8_lossy(&files[0].1).into_owned();
    assert!(glb.contains("\"uv_rect\"") && glb.contains("\"lightmaps\""));
    for (from, to, maps, has_probes) in [
        // Of the same length.
        ("\"lightmaps\"", "\"lightmapz\"", 0, false),
        ("\"spacing\"", "\"spicing\"", 0, false),
        ("\"uv_rect\"", "\"uv_rext\"", 0, true),
        ("\"lightmap\":0", "\"lightmap\":9", 0, true),
        ("lit.lightmap0.ktx2", "../lightmap0.ktx2.", 13, true),
        ("\"TEXCOORD_1\"", "\"TEXCOORD_7\"", 0, true),
    ] {
        let mut bytes = files[0].1.clone();
        let (from, to) = (from.as_bytes(), to.as_bytes());
        let mut count = 0;
        for at in 0..bytes.len() - from.len() {
            if bytes[at..].starts_with(from) {
                bytes[at..at + from.len()].copy_from_slice(&to[..from.len()]);
                count += 1;
            }
        }
        assert!(count > 0);
        let folder = Folder::new("nonsense", &[("lit.glb".into(), bytes), files[2].clone()]);
        let mut app = folder.app();
        spawn(&mut app);
        assert_eq!(lightmaps(app.world_mut()).len(), maps, "{}", String::from_utf8_lossy(to));
        assert_eq!(volume(app.world_mut()).is_some(), has_probes);
    }
}

#[test]
fn a_level_is_lit_in_the_world_whatever_its_place_and_probes_follow_its_door() {
    let (mut files, found) = files(false);
    files.truncate(1);
    files[0].1 = level::level().unwrap();
    let folder = Folder::new("world", &files);
    let mut app = folder.app();
    let root = spawn(&mut app);
    let place = Transform::from_xyz(7.0, 0.0, -3.0).with_rotation(Quat::from_rotation_y(1.0));
    let door = until(&mut app, |world| {
        let mut names = world.query::<(Entity, &Name)>();
        names.iter(world).find(|(_, name)| name.as_str() == "door").map(|(entity, _)| entity)
    });
    // Materials come by Bevy's renderer.
    let world = app.world_mut();
    let white = world.resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial::from(Color::WHITE));
    let meshes: Vec<Entity> = world.query_filtered::<Entity, With<Mesh3d>>().iter(world).collect();
    for mesh in &meshes {
        world.entity_mut(*mesh).insert(MeshMaterial3d(white.clone()));
    }
    world.entity_mut(door).insert(Moves);
    world.entity_mut(root).insert(place);
    app.update();
    app.world_mut().entity_mut(root).insert(BakeLight { settings: HOW, sky: Vec3::ZERO });
    app.update();
    // It gets another mesh meanwhile, and keeps it.
    let other = meshes.into_iter().find(|mesh| *mesh != door).unwrap();
    app.world_mut().entity_mut(other).insert(Mesh3d::default());
    let first = until(&mut app, volume);
    assert_eq!(app.world().get::<Mesh3d>(other), Some(&Mesh3d::default()));
    assert!(app.world().get::<BakeLight>(root).is_none() && app.world().get::<LitLevel>(root).is_some());
    let mut maps = app.world_mut().query_filtered::<&Mesh3d, With<Lightmap>>();
    let maps: Vec<Handle<Mesh>> = maps.iter(app.world()).map(|mesh| mesh.0.clone()).collect();
    let meshes = app.world().resource::<Assets<Mesh>>();
    assert_eq!(maps.len(), 12);
    assert!(maps.iter().all(|mesh| meshes.get(mesh).unwrap().contains_attribute(Mesh::ATTRIBUTE_UV_1)));
    let cube = (place.compute_affine().inverse() * first.0.affine()).to_scale_rotation_translation();
    let size = (found.probes.max - found.probes.min).to_array();
    let is_there = cube.0.abs_diff_eq(Vec3::from_array(size), ROUNDING);
    assert!(is_there && cube.1.abs_diff_eq(Quat::IDENTITY, ROUNDING), "{cube:?}");
    // By texel: the light beyond the door, which is in the upper half along x.
    let beyond = |world: &mut World, volume: &IrradianceVolume| {
        let image = world.resource::<Assets<Image>>().get(&volume.voxels).unwrap();
        let (width, data) = (image.width() as usize, image.data.as_ref().unwrap());
        let texel = |(i, t): (usize, &[u8; 4])| {
            if 2 * (i % width) > width { casca_lightmap::unpacked(u32::from_le_bytes(*t)).x } else { 0.0 }
        };
        data.as_chunks().0.iter().enumerate().map(texel).sum::<f32>()
    };
    let mut light = Vec::new();
    let mut old = first.1;
    for at in [None, Some(Vec3::ZERO), Some(level::OPEN)] {
        if let Some(at) = at {
            app.world_mut().get_mut::<Transform>(door).unwrap().translation = at;
        }
        let new = until(&mut app, |world| volume(world).filter(|v| v.1.voxels != old.voxels));
        light.push(beyond(app.world_mut(), &new.1));
        old = new.1;
    }
    println!("{light:?}");
    // A level may go when it hears that all is done.
    app.add_observer(|lit: On<Remove<BakeLight>>, mut commands: Commands| {
        commands.entity(lit.entity).despawn();
    });
    app.world_mut().entity_mut(root).insert(BakeLight { settings: HOW, sky: Vec3::ZERO });
    until(&mut app, |world| world.get_entity(root).is_err().then_some(()));
    assert!(volume(app.world_mut()).is_none());
    assert!(light[0] > 1.0 && light[1] == 0.0 && (light[2] / light[0] - 1.0).abs() < 0.01, "{light:?}");
}
