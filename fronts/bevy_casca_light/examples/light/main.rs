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
use casca_lightmap::{Level, Probes, light};
use casca_radiosity::lit::path::PathTracer;
use casca_radiosity::lit::{LitObject, LitScene, Material};
use casca_scenes::world::{Camera, Mesh as OwnMesh};
use clap::Parser;

/// How the level is lit: on several small pages.
const HOW: Settings = Settings { texels: 8.0, side: 128, spacing: 0.4, cells: 48, rays: 64, live: false };
/// A white ball in the second room, which light reaches only through the door.
const BALL: (glam::Vec3, f32) = (glam::Vec3::new(2.0, 1.0, 2.2), 0.45);
const ANGLE: f32 = 60.0;
/// Cameras: the eye, its target, and the gain of the picture. The first is in the first room; those in the
/// second room look at the door and at the ball.
const EYES: [([Vec3; 2], f32); 4] = [
    ([Vec3::new(-0.3, 2.2, 3.6), Vec3::new(-3.0, 0.6, 1.0)], 0.1),
    ([Vec3::new(4.0, 1.4, 2.0), Vec3::new(0.0, 0.9, 2.0)], 0.6),
    ([Vec3::new(0.9, 1.9, 0.6), Vec3::new(3.0, 0.6, 3.0)], 0.6),
    ([Vec3::new(0.9, 1.9, 3.6), Vec3::new(3.0, 0.6, 1.0)], 0.6),
];
/// The eye whose picture is kept beside others.
const SHOWN: usize = 1;
/// So many bytes of a colour may be off, in all pixels but this share: those on edges of surfaces.
const BYTES: f32 = 2.0;
const EDGES: f32 = 0.01;
/// How far a face of a probe is off a path tracer's light there, of the greatest of them: by its rays, of
/// which few go through the door.
const OFF: f32 = 0.08;
/// Samples of the path tracer there, and the share of light that its balls send back.
const SAMPLES: u32 = 1024;
const DARK: f32 = 0.02;
/// Normals of the ball are so near to a direction, by their cosine.
const NEAR: f32 = 0.95;
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

    let pages = found.atlas.page_count;
    println!("{} texels on {pages} pages, {} probes", found.lit, found.probes.cubes.len());
    if pages < 2 {
        return Err("all texels are on one page".into());
    }
    let mut lit = app(&folder.join("lit.glb"))?;
    wait(&mut lit, "the level", |world| count::<LitLevel>(world) > 0)?;
    let pictures = pictures(&mut lit, true)?;
    beside(&level, &found.probes)?;
    // From here on rays meet the ball.
    add_ball(&mut level.scene, BALL, 1.0);
    let mut traced: Option<Vec<u8>> = None;
    for (i, (picture, (eye, gain))) in pictures.iter().zip(EYES).enumerate() {
        level.scene.camera = own_camera(eye);
        let rays = truth::rays(&level.scene.camera, (WIDTH, HEIGHT));
        let balls: Vec<_> = rays.iter().map(|ray| truth::on_ball(ray, BALL)).collect();
        let by_probes: Vec<_> =
            balls.iter().map(|at| at.map(|(at, n)| truth::by_probes(&found.probes, at, n))).collect();
        agree(&format!("eye {i}, texels"), (picture, gain), &truth::mapped(&level, &found, &rays))?;
        agree(&format!("eye {i}, probes"), (picture, gain), &by_probes)?;
        if out.is_some() && i == SHOWN {
            let size = (WIDTH as usize, HEIGHT as usize);
            let tracer = PathTracer::new(&level.scene);
            let image = tracer.render(&level.scene.camera, size, &(0..=64), arguments.samples, 1)?.image;
            let of = |c: &glam::Vec3| [&stored(*c, gain)[..], &[255.0]].concat();
            traced = Some(image.iter().flat_map(of).map(|b| b.round() as u8).collect());
        }
    }
    // The red wall is at the least z, and the green one at the greatest.
    let redness = |(eye, side): (usize, glam::Vec3)| {
        let rays = truth::rays(&own_camera(EYES[eye].0), (WIDTH, HEIGHT));
        let is_there = |ray| truth::on_ball(ray, BALL).is_some_and(|at| at.1.dot(side) > NEAR);
        let pixels = pictures[eye].chunks(4).zip(&rays).filter(|(_, ray)| is_there(*ray));
        let (red, green) = pixels.fold((0.0, 0.0), |(r, g), (p, _)| (r + linear(p[0]), g + linear(p[1])));
        red / green
    };
    let redder = redness((2, glam::Vec3::NEG_Z)) / redness((3, glam::Vec3::Z));
    println!("the ball is {redder:.2} times as red towards the red wall as towards the green one");
    if redder.is_nan() || redder < REDDER {
        return Err("red and green are mixed up".into());
    }
    let open = follow(&mut lit, out)?;
    println!("a shut door: the ball is black; an open one: {open:.2} bytes off");
    let mut anew = app(&folder.join("rooms.glb"))?;
    wait(&mut anew, "the level", |world| count::<PointLight>(world) > 0)?;
    let alone = self::pictures(&mut anew, false)?;
    if let Some(traced) = traced {
        let [a, b, c] = [&pictures[SHOWN], &traced, &alone[SHOWN]].map(|p| p.chunks(4 * WIDTH as usize));
        let all: Vec<u8> = a.zip(b).zip(c).flat_map(|((a, b), c)| [a, b, c].concat()).collect();
        save(out, "beside.png", (3 * WIDTH, HEIGHT), &all)?;
    }
    let world = anew.app.world_mut();
    let root = world.query_filtered::<Entity, With<WorldAssetRoot>>().single(world)?;
    world.entity_mut(root).insert(BakeLight { settings: HOW, sky: Vec3::ZERO });
    wait(&mut anew, "light", |world| count::<LitLevel>(world) > 0)?;
    for (i, (a, b)) in self::pictures(&mut anew, true)?.iter().zip(&pictures).enumerate() {
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
    world.entity_mut(camera).insert((
        Projection::Perspective(lens),
        Tonemapping::None,
        DebandDither::Disabled,
    ));
    if let Some(mut camera) = world.get_mut::<bevy::camera::Camera>(camera) {
        camera.clear_color = ClearColorConfig::Custom(Color::BLACK);
    }
    Ok(rendered)
}

/// Adds a matt ball to a scene.
fn add_ball(scene: &mut LitScene, (middle, radius): (glam::Vec3, f32), albedo: f32) {
    let mesh = OwnMesh::ball(4);
    let materials = vec![scene.materials.len() as u32; mesh.triangles.len()].into();
    let transform =
        glam::Affine3A::from_translation(middle) * glam::Affine3A::from_scale(glam::Vec3::splat(radius));
    scene.objects.push(LitObject { mesh: Arc::new(mesh), materials, uv: Arc::default(), transform });
    scene.materials.push(Material::matt(glam::Vec3::splat(albedo)));
}

fn own_camera(eye: [Vec3; 2]) -> Camera {
    let [eye, to] = eye.map(|p| glam::Vec3::from_array(p.to_array()));
    Camera::look_at(eye, to, ANGLE, WIDTH as f32 / HEIGHT as f32, 0.1, 50.0)
}

fn count<C: Component>(world: &mut World) -> usize {
    world.query::<&C>().iter(world).count()
}

/// Updates until something is so.
fn wait(rendered: &mut Rendered, what: &str, is_so: impl Fn(&mut World) -> bool) -> Any<()> {
    for _ in 0..MOST_UPDATES {
        rendered.app.update();
        if is_so(rendered.app.world_mut()) {
            return Ok(());
        }
        std::thread::sleep(WAIT);
    }
    Err(format!("{what} did not come").into())
}

/// Pictures from all eyes. Surfaces mirror nothing; lamps of files cast no shadows by themselves.
fn pictures(rendered: &mut Rendered, shadows: bool) -> Any<Vec<Vec<u8>>> {
    // Images and shaders come some frames later.
    wait(rendered, "images", |world| {
        let mut maps = world.query::<&Lightmap>();
        let maps: Vec<_> = maps.iter(world).map(|map| map.image.id()).collect();
        let images = world.resource::<Assets<Image>>();
        maps.into_iter().all(|id| images.contains(id))
    })?;
    let world = rendered.app.world_mut();
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    for (_, material) in materials.iter_mut() {
        material.reflectance = 0.0;
    }
    for mut lamp in world.query::<&mut PointLight>().iter_mut(world) {
        lamp.shadow_maps_enabled = shadows;
    }
    let mut all = Vec::new();
    rendered.prepare(10);
    for eye in EYES {
        look(rendered, eye);
        all.push(rendered.capture()?);
    }
    Ok(all)
}

/// Looks from an eye.
fn look(rendered: &mut Rendered, ([eye, to], gain): ([Vec3; 2], f32)) {
    let (world, camera) = rendered.world_and_camera();
    // Its factor is the gain.
    let exposure = Exposure { ev100: -(1.2 * gain).log2() };
    world.entity_mut(camera).insert((Transform::from_translation(eye).looking_at(to, Vec3::Y), exposure));
    rendered.prepare(4);
}

/// What a colour is stored as, before it is rounded.
fn stored(color: glam::Vec3, gain: f32) -> [f32; 3] {
    color.to_array().map(|c| Srgba::gamma_function_inverse((gain * c).min(1.0)) * 255.0)
}

fn linear(byte: u8) -> f32 {
    Srgba::gamma_function(f32::from(byte) / 255.0)
}

/// Checks that pixels are as they must be, where that is known.
fn agree(what: &str, (picture, gain): (&[u8], f32), wanted: &[Option<glam::Vec3>]) -> Any<()> {
    let (mut all, mut wrong, mut light) = (0, 0, 0.0);
    for (pixel, wanted) in picture.chunks(4).zip(wanted) {
        let Some(wanted) = wanted else { continue };
        all += 1;
        light += f32::from(pixel[1]);
        let off = |(a, b): (&f32, &u8)| (a - f32::from(*b)).abs() > BYTES;
        wrong += u32::from(stored(*wanted, gain).iter().zip(pixel).any(off));
    }
    let mean = light / all as f32;
    println!("{what}: {wrong} of {all} pixels are off by more than {BYTES} bytes; their mean is {mean:.1}");
    if wrong as f32 > EDGES * all as f32 {
        Err(format!("{what} are not as casca says").into())
    } else {
        Ok(())
    }
}

/// Checks some probes beside a path tracer's light on balls that are too small and dark to change any.
fn beside(level: &Level, probes: &Probes) -> Any<()> {
    const FACES: [glam::Vec3; 3] = [glam::Vec3::X, glam::Vec3::Y, glam::Vec3::Z];
    let faces = FACES.iter().flat_map(|f| [*f, -*f]);
    let mut worst = 0.0_f32;
    for near in [BALL.0, glam::Vec3::new(-3.0, 1.0, 2.0), glam::Vec3::new(3.5, 1.5, 0.5)] {
        let far = |i: &usize| probes.place(*i).distance(near);
        let all = 0..probes.cubes.len();
        let probe = all.min_by(|a, b| far(a).total_cmp(&far(b))).ok_or("there are no probes")?;
        let (at, cube) = (probes.place(probe), probes.cubes[probe]);
        let mut scene = level.scene.clone();
        // Lights that are no surfaces are left to Bevy: their first light is no part of probes.
        add_ball(&mut scene, (at, 0.02), DARK);
        let tracer = PathTracer::new(&scene);
        let most = cube.iter().map(|c| c.max_element()).fold(0.0, f32::max);
        for (face, found) in faces.clone().zip(cube) {
            let camera = Camera::look_at(at + face * 0.2, at, 1.0, 1.0, 0.05, 50.0);
            let image = tracer.render(&camera, (8, 8), &(2..=64), SAMPLES, 1)?.image;
            let wanted = image.iter().sum::<glam::Vec3>() / (64.0 * DARK);
            worst = worst.max((wanted - found).abs().max_element() / most);
        }
    }
    println!("18 faces of probes are off a path tracer's light by {:.1}% at most", 100.0 * worst);
    if worst > OFF { Err("probes are not lit as they should be".into()) } else { Ok(()) }
}

/// Shuts the door and opens it again; the ball follows.
fn follow(lit: &mut Rendered, out: Option<&Path>) -> Any<f32> {
    let world = lit.app.world_mut();
    let mut names = world.query::<(Entity, &Name)>();
    let door = names.iter(world).find(|(_, name)| name.as_str() == "door").ok_or("there is no door")?.0;
    world.entity_mut(door).insert(Moves);
    // Faster than by default.
    world.query::<&mut LitLevel>().iter_mut(world).for_each(|mut level| level.cells = HOW.cells);
    let mut pictures = Vec::new();
    for (name, place) in [("open", level::OPEN), ("shut", Vec3::ZERO), ("again", level::OPEN)] {
        let world = lit.app.world_mut();
        let old = world.query::<&IrradianceVolume>().iter(world).next().map(|v| v.voxels.id());
        world.entity_mut(door).insert(Transform::from_translation(place));
        wait(lit, "new probes", |world| {
            world.query::<&IrradianceVolume>().iter(world).next().map(|v| v.voxels.id()) != old
        })?;
        look(lit, EYES[2]);
        pictures.push(lit.capture()?);
        save(out, &format!("door-{name}.png"), (WIDTH, HEIGHT), &pictures[pictures.len() - 1])?;
    }
    let balls = truth::rays(&own_camera(EYES[2].0), (WIDTH, HEIGHT));
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
    if off > ALIKE { Err("an open door is not as before".into()) } else { Ok(off) }
}
