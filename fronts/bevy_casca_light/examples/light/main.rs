//! Two rooms lit by `casca-lightmap` and drawn by Bevy: beside what its texels and probes say, beside a path
//! tracer and beside Bevy alone; and then with a door that moves, and lit in the world.
//!
//! `cargo run -p bevy_casca_light --example light` in `fronts/bevy_casca/rendered`, with Rust 1.97.1 or newer
//! and any graphics adapter, also one in software. `--out FOLDER` keeps the pictures.

mod level;
mod truth;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use bevy::camera::Exposure;
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::gltf::GltfAssetLabel;
use bevy::light::{GlobalAmbientLight, IrradianceVolume};
use bevy::pbr::Lightmap;
use bevy::prelude::*;
use bevy_casca_light::{BakeLight, CascaLightPlugin, LitLevel, Moves, Settings};
use bevy_casca_rendered::rendered::{HEIGHT, Rendered, WIDTH, save};
use casca_lightmap::{Level, light};
use casca_radiosity::lit::path::PathTracer;
use casca_radiosity::lit::{LitObject, Material};
use casca_scenes::world::{Camera, Mesh as OwnMesh};
use clap::Parser;

/// How the level is lit.
const HOW: Settings = Settings { texels: 8.0, side: 1024, spacing: 0.4, cells: 48, rays: 64, live: false };
/// What light is multiplied by in pictures.
const GAIN: f32 = 0.5;
/// A white ball in the second room, which light reaches only through the door.
const BALL: (glam::Vec3, f32) = (glam::Vec3::new(2.0, 1.0, 2.2), 0.45);
const ANGLE: f32 = 60.0;
/// Eyes and what they look at: in the first room, and in the second one towards the ball and the door.
const EYES: [[Vec3; 2]; 3] = [
    [Vec3::new(-0.3, 2.2, 3.6), Vec3::new(-3.0, 0.6, 1.0)],
    [Vec3::new(4.0, 1.4, 2.0), Vec3::new(0.0, 0.9, 2.0)],
    [Vec3::new(0.9, 1.9, 0.6), Vec3::new(3.0, 0.6, 3.0)],
];
/// The one from which the ball is compared with a path tracer's.
const BESIDE: usize = 1;
/// So many bytes of a colour may be off, in all pixels but this share: those on edges of surfaces.
const BYTES: f32 = 2.0;
const EDGES: f32 = 0.01;
/// The mean light of a side of the ball by probes over that by rays: cubes have six directions.
const OFF: f32 = 0.25;
/// How much redder the ball is at least on the side of the red wall than on that of the green one.
const REDDER: f32 = 1.5;
/// The mean difference of a level that was lit in the world, in bytes: texels lie elsewhere.
const ALIKE: f32 = 1.5;
/// Updates until something that is done in the background is there, and how long each waits.
const MOST_UPDATES: u32 = 6000;
const WAIT: Duration = Duration::from_millis(50);

/// Compares levels that casca lit and Bevy draws with what casca and a path tracer say.
#[derive(Parser)]
struct Arguments {
    /// The folder of PNG files
    #[arg(long)]
    out: Option<PathBuf>,
    /// Samples of the path tracer
    #[arg(long, default_value_t = 8)]
    samples: u32,
}

type Any<T> = Result<T, Box<dyn Error>>;

fn main() -> Any<()> {
    let arguments = Arguments::parse();
    let out = arguments.out.as_deref();
    let bytes = level::level()?;
    let mut level = Level::read("rooms", &bytes, None)?;
    let found = light(&level.scene, &level.placed, &HOW, &mut |_, _, _| {})?;
    let folder = std::env::temp_dir().join(format!("casca-light-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    for (name, bytes) in
        level.lit("lit", &found, &HOW)?.into_iter().chain([("rooms.glb".into(), bytes.clone())])
    {
        std::fs::write(folder.join(name), bytes)?;
    }

    println!("{} texels, {} probes", found.lit, found.probes.cubes.len());
    let mut lit = app(&folder.join("lit.glb"))?;
    wait(&mut lit, "the level", |world| count::<LitLevel>(world) > 0)?;
    let pictures = pictures(&mut lit, "lit", out)?;
    // The ball is in the scene for the path tracer, and hides what is behind it.
    let object = LitObject {
        mesh: Arc::new(OwnMesh::ball(4)),
        materials: vec![level.scene.materials.len() as u32; OwnMesh::ball(4).triangles.len()].into(),
        uv: Arc::default(),
        transform: glam::Affine3A::from_scale_rotation_translation(
            glam::Vec3::splat(BALL.1),
            glam::Quat::IDENTITY,
            BALL.0,
        ),
    };
    level.scene.objects.push(object);
    level.scene.materials.push(Material::matt(glam::Vec3::ONE));
    for (i, (picture, [eye, to])) in pictures.iter().zip(EYES).enumerate() {
        level.scene.camera = own_camera([eye, to]);
        let rays = truth::rays(&level.scene.camera, (WIDTH, HEIGHT));
        let balls: Vec<_> = rays.iter().map(|ray| truth::on_ball(ray, BALL)).collect();
        let by_probes =
            balls.iter().map(|at| at.map(|(at, n)| truth::by_probes(&found.probes, at, n))).collect();
        agree(&format!("eye {i}, texels"), picture, &truth::mapped(&level, &found, &rays))?;
        agree(&format!("eye {i}, probes"), picture, &by_probes)?;
        if out.is_none() && i != BESIDE {
            continue;
        }
        let (size, samples) = ((WIDTH as usize, HEIGHT as usize), arguments.samples);
        let traced =
            PathTracer::new(&level.scene).render(&level.scene.camera, size, &(0..=64), samples, 1)?;
        let of =
            |c: &glam::Vec3| [stored(*c), [255.0; 3]].concat().into_iter().take(4).map(|b| b.round() as u8);
        let bytes: Vec<u8> = traced.image.iter().flat_map(of).collect();
        save(out, &format!("traced-{i}.png"), (WIDTH, HEIGHT), &bytes)?;
        if i == BESIDE {
            sides(picture, &traced.image, &balls)?;
        }
    }

    let (door, open) = follow(&mut lit, out)?;
    println!("a shut door: the ball is black; an open one: {open:.2} bytes off; {door}");
    let mut anew = app(&folder.join("rooms.glb"))?;
    wait(&mut anew, "the level", |world| count::<PointLight>(world) > 0)?;
    self::pictures(&mut anew, "bevy", out)?;
    let root = of::<WorldAssetRoot>(anew.app().world_mut())?;
    anew.app().world_mut().entity_mut(root).insert(BakeLight { settings: HOW, sky: Vec3::ZERO });
    wait(&mut anew, "light", |world| count::<LitLevel>(world) > 0)?;
    for (i, (a, b)) in self::pictures(&mut anew, "anew", out)?.iter().zip(&pictures).enumerate() {
        let off = a.iter().zip(b).map(|(a, b)| f32::from(a.abs_diff(*b))).sum::<f32>() / a.len() as f32;
        println!("eye {i}, lit in the world: {off:.2} bytes off the mean");
        if off > ALIKE {
            return Err("a level that is lit in the world is not as the file's".into());
        }
    }
    Ok(std::fs::remove_dir_all(folder)?)
}

/// An app with a level and a ball, without light of its own.
fn app(file: &Path) -> Any<Rendered> {
    let fill = |world: &mut World| {
        world.insert_resource(GlobalAmbientLight::NONE);
        let scene =
            world.resource::<AssetServer>().load(GltfAssetLabel::Scene(0).from_asset(file.to_owned()));
        world.spawn(WorldAssetRoot(scene));
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Sphere::new(BALL.1).mesh().uv(128, 64));
        let white = StandardMaterial { base_color: Color::WHITE, perceptual_roughness: 1.0, ..default() };
        let white = world.resource_mut::<Assets<StandardMaterial>>().add(white);
        let place = Transform::from_translation(Vec3::from_array(BALL.0.to_array()));
        world.spawn((Mesh3d(mesh), MeshMaterial3d(white), place));
    };
    let add = |app: &mut App| {
        app.add_plugins(CascaLightPlugin);
        level::register(app);
    };
    let mut rendered = Rendered::with_plugins(None, add, fill, Transform::default())?;
    let (world, camera) = rendered.world_and_camera();
    let lens = PerspectiveProjection { fov: ANGLE.to_radians(), ..default() };
    // So that its factor is the gain.
    let exposure = Exposure { ev100: -(1.2 * GAIN).log2() };
    world.entity_mut(camera).insert((
        Projection::Perspective(lens),
        exposure,
        Tonemapping::None,
        DebandDither::Disabled,
    ));
    if let Some(mut camera) = world.get_mut::<bevy::camera::Camera>(camera) {
        camera.clear_color = ClearColorConfig::Custom(Color::BLACK);
    }
    Ok(rendered)
}

fn own_camera(eye: [Vec3; 2]) -> Camera {
    let [eye, to] = eye.map(|p| glam::Vec3::from_array(p.to_array()));
    Camera::look_at(eye, to, ANGLE, WIDTH as f32 / HEIGHT as f32, 0.1, 50.0)
}

fn count<C: Component>(world: &mut World) -> usize {
    world.query::<&C>().iter(world).count()
}

fn of<C: Component>(world: &mut World) -> Any<Entity> {
    let found = world.query_filtered::<Entity, With<C>>().iter(world).next();
    found.ok_or_else(|| format!("there is no {}", std::any::type_name::<C>()).into())
}

/// Updates until something is so.
fn wait(rendered: &mut Rendered, what: &str, is_so: impl Fn(&mut World) -> bool) -> Any<()> {
    for _ in 0..MOST_UPDATES {
        rendered.app().update();
        if is_so(rendered.app().world_mut()) {
            return Ok(());
        }
        std::thread::sleep(WAIT);
    }
    Err(format!("{what} did not come").into())
}

/// Pictures from all eyes. Surfaces mirror nothing, and the lamp casts shadows.
fn pictures(rendered: &mut Rendered, name: &str, out: Option<&Path>) -> Any<Vec<Vec<u8>>> {
    // Images and shaders come some frames later.
    wait(rendered, "images", |world| {
        let mut maps = world.query::<&Lightmap>();
        let maps: Vec<_> = maps.iter(world).map(|map| map.image.id()).collect();
        let images = world.resource::<Assets<Image>>();
        maps.into_iter().all(|id| images.contains(id))
    })?;
    let world = rendered.app().world_mut();
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    for (_, material) in materials.iter_mut() {
        material.reflectance = 0.0;
    }
    for mut lamp in world.query::<&mut PointLight>().iter_mut(world) {
        lamp.shadow_maps_enabled = name != "bevy";
    }
    let mut all = Vec::new();
    for (i, [eye, to]) in EYES.into_iter().enumerate() {
        let (world, camera) = rendered.world_and_camera();
        world.entity_mut(camera).insert(Transform::from_translation(eye).looking_at(to, Vec3::Y));
        rendered.prepare(10);
        all.push(rendered.capture()?);
        save(out, &format!("{name}-{i}.png"), (WIDTH, HEIGHT), &all[i])?;
    }
    Ok(all)
}

/// What a colour is stored as, before it is rounded.
fn stored(color: glam::Vec3) -> [f32; 3] {
    color.to_array().map(|c| Srgba::gamma_function_inverse((GAIN * c).min(1.0)) * 255.0)
}

/// Checks that pixels are as they must be, where that is known.
fn agree(what: &str, picture: &[u8], wanted: &Vec<Option<glam::Vec3>>) -> Any<()> {
    let (mut all, mut wrong, mut light) = (0, 0, 0.0);
    for (pixel, wanted) in picture.chunks(4).zip(wanted) {
        let Some(wanted) = wanted else { continue };
        all += 1;
        light += f32::from(pixel[1]);
        let off = stored(*wanted).iter().zip(pixel).any(|(a, b)| (a - f32::from(*b)).abs() > BYTES);
        wrong += u32::from(off);
    }
    println!(
        "{what}: {wrong} of {all} pixels are off by more than {BYTES} bytes; their mean is {:.1}",
        light / all as f32
    );
    if wrong as f32 > EDGES * all as f32 {
        Err(format!("{what} are not as casca says").into())
    } else {
        Ok(())
    }
}

/// Checks the light of the four sides of the ball beside that which was traced.
fn sides(picture: &[u8], traced: &[glam::Vec3], balls: &[Option<(glam::Vec3, glam::Vec3)>]) -> Any<()> {
    let mut ratios = Vec::new();
    for side in [glam::Vec3::NEG_Z, glam::Vec3::Z, glam::Vec3::Y, glam::Vec3::NEG_Y] {
        let (mut by_bevy, mut by_rays) = (glam::Vec3::ZERO, glam::Vec3::ZERO);
        for ((pixel, traced), at) in picture.chunks(4).zip(traced).zip(balls) {
            if at.is_some_and(|(_, normal)| normal.dot(side) > 0.7) {
                let of = |i: usize| Srgba::gamma_function(f32::from(pixel[i]) / 255.0) / GAIN;
                by_bevy += glam::Vec3::new(of(0), of(1), of(2));
                by_rays += *traced;
            }
        }
        let off = (by_bevy - by_rays).abs().element_sum() / by_rays.element_sum();
        println!("the ball towards {side}: {:.1}% off the path tracer", 100.0 * off);
        if off.is_nan() || off > OFF {
            return Err("the ball is not lit as it should be".into());
        }
        ratios.push([by_bevy, by_rays].map(|c| c.x / c.y));
    }
    let redder = [0, 1].map(|i| ratios[0][i] / ratios[1][i]);
    println!("its red side is redder than the green one by {:.2}, and {:.2} by rays", redder[0], redder[1]);
    if redder.iter().any(|r| *r < REDDER) { Err("red and green are mixed up".into()) } else { Ok(()) }
}

/// Shuts the door and opens it again; the ball follows.
fn follow(lit: &mut Rendered, out: Option<&Path>) -> Any<(String, f32)> {
    let world = lit.app().world_mut();
    let mut names = world.query::<(Entity, &Name)>();
    let door = names.iter(world).find(|(_, name)| name.as_str() == "door").ok_or("there is no door")?.0;
    world.entity_mut(door).insert(Moves);
    // Faster than by default.
    world.query::<&mut LitLevel>().iter_mut(world).for_each(|mut level| level.cells = HOW.cells);
    let mut pictures = Vec::new();
    let mut steps = 0;
    for (name, place) in [("open", level::OPEN), ("shut", Vec3::ZERO), ("again", level::OPEN)] {
        let world = lit.app().world_mut();
        let old = world.query::<&IrradianceVolume>().iter(world).next().map(|v| v.voxels.id());
        world.entity_mut(door).insert(Transform::from_translation(place));
        wait(lit, "new probes", |world| {
            world.query::<&IrradianceVolume>().iter(world).next().map(|v| v.voxels.id()) != old
        })?;
        steps += 1;
        lit.prepare(10);
        let (world, camera) = lit.world_and_camera();
        let [eye, to] = EYES[2];
        world.entity_mut(camera).insert(Transform::from_translation(eye).looking_at(to, Vec3::Y));
        lit.prepare(4);
        pictures.push(lit.capture()?);
        save(out, &format!("door-{name}.png"), (WIDTH, HEIGHT), &pictures[pictures.len() - 1])?;
    }
    let balls = truth::rays(&own_camera(EYES[2]), (WIDTH, HEIGHT));
    let ball: Vec<usize> =
        (0..balls.len()).filter(|i| truth::on_ball(&balls[*i], (BALL.0, 0.9 * BALL.1)).is_some()).collect();
    let light = |picture: &[u8]| {
        ball.iter().map(|i| u32::from(picture[4 * i]) + u32::from(picture[4 * i + 1])).sum::<u32>()
    };
    if ball.is_empty() || light(&pictures[0]) == 0 || light(&pictures[1]) > 0 {
        return Err(format!("light on the ball: {} and {}", light(&pictures[0]), light(&pictures[1])).into());
    }
    let off = |i: &usize| f32::from(pictures[0][4 * i].abs_diff(pictures[2][4 * i]));
    let off = ball.iter().map(off).sum::<f32>() / ball.len() as f32;
    if off > ALIKE {
        Err("an open door is not as before".into())
    } else {
        Ok((format!("{steps} refreshes"), off))
    }
}
