//! Renders scenes by Bevy with and without `bevy_casca`, and compares the pictures in every pixel, and their times.
//!
//! `cargo run --bin pixels -- --frames 20`, with Rust 1.97.1 or newer and any graphics adapter, also one in software.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use bevy::camera::RenderTarget;
use bevy::light::DirectionalLightShadowMap;
use bevy::prelude::{Assets, Image};
use bevy::render::render_resource::TextureFormat;
use bevy_casca::{CascaScene, CascaSettings};
use bevy_casca_rendered::rendered::{HEIGHT, Rendered, WIDTH, save};
use bevy_casca_rendered::scenes::Scene;
use bevy_casca_rendered::town;
use clap::Parser;

/// Renders scenes by Bevy with and without bevy_casca, and compares all pixels.
#[derive(Parser)]
struct Arguments {
    /// Pictures of each scene
    #[arg(long, default_value_t = 20)]
    frames: u32,
    /// The scene; all if none is named
    #[arg(long)]
    scene: Option<Scene>,
    /// Loads a town of so many things instead, 1,000 in each frame, and measures frames
    #[arg(long)]
    load: Option<usize>,
    /// The folder of PNG files: the picture in the middle of each scene, and all that differ
    #[arg(long)]
    out: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if let Some(size) = arguments.load {
        return ExitCode::from(u8::from(load(size).inspect_err(|why| eprintln!("{why}")).is_err()));
    }
    let mut alike = true;
    let all = arguments.scene.map_or(Scene::ALL.to_vec(), |scene| vec![scene]);
    for scene in all {
        let differ = compare(scene, arguments.frames, arguments.out.as_deref());
        alike &= differ.inspect_err(|why| eprintln!("{why}")) == Ok(0);
    }
    ExitCode::from(u8::from(!alike))
}

/// Frames after everything came.
const FRAMES: usize = 120;

/// Frames that wait for the plugin, at most.
const PATIENCE: usize = 2000;

/// Measures whole frames of both, in turn. Picture and shadow maps are so small that a processor draws them fast.
fn load(size: usize) -> Result<(), String> {
    let settings = [Some(CascaSettings::default()), None];
    let mut apps = Vec::new();
    for settings in settings {
        let mut app = Rendered::with_plugins(settings, |_| (), town::sun, town::street(0.0))?;
        let (world, camera) = app.world_and_camera();
        world.insert_resource(DirectionalLightShadowMap { size: 16 });
        let picture = Image::new_target_texture(16, 9, TextureFormat::Rgba8UnormSrgb, None);
        let target = world.resource_mut::<Assets<Image>>().add(picture);
        world.entity_mut(camera).insert(RenderTarget::Image(target.into()));
        let mut things = town::things(world, size).into_iter();
        // With a few, all pipelines are there.
        things.by_ref().take(100).for_each(|thing| thing.spawn(world));
        app.prepare(40);
        apps.push((app, things, [Vec::new(), Vec::new()]));
    }
    let mut drawn = [0; 2];
    for _ in 0..PATIENCE {
        let known = apps[0].0.casca().and_then(CascaScene::scene).map_or(0, |scene| scene.len());
        let is_there = apps[0].1.len() == 0 && known >= size;
        let after = apps[0].2[1].len();
        if after == FRAMES {
            break;
        }
        for ((app, things, times), drawn) in apps.iter_mut().zip(&mut drawn) {
            let (world, _) = app.world_and_camera();
            things.by_ref().take(1000).for_each(|thing| thing.spawn(world));
            let start = Instant::now();
            app.draw(town::street(after as f32 / 60.0));
            times[usize::from(is_there)].push(start.elapsed().as_secs_f64() * 1e3);
            *drawn += if is_there { app.drawn() } else { 0 };
        }
    }
    let [ours, all] = drawn.map(|drawn| drawn / FRAMES);
    println!("{size} things, ms: median, mean, 99%, most; drawn: {ours} of {all}");
    for (part, name) in ["in which things come", "after that"].into_iter().enumerate() {
        let [casca, bevy] = [0, 1].map(|i| {
            let times: &mut Vec<f64> = &mut apps[i].2[part];
            times.sort_by(f64::total_cmp);
            let mean = times.iter().sum::<f64>() / times.len() as f64;
            let at =
                |share| times.get(times.len().saturating_sub(1) * share / 100).copied().unwrap_or(f64::NAN);
            [at(50), mean, at(99), at(100)]
        });
        let over = [0, 1, 2, 3].map(|i| casca[i] / bevy[i]);
        let frames = apps[0].2[part].len();
        println!("{frames} frames {name}: Bevy {bevy:.1?}, casca {casca:.1?}, over Bevy's {over:.2?}");
    }
    Ok(())
}

/// Renders a scene twice. Returns the number of pictures that differ.
fn compare(scene: Scene, frames: u32, out: Option<&Path>) -> Result<u32, String> {
    let of_scene = format!("{scene:?}").to_lowercase();
    let settings = Some(CascaSettings::default());
    let (mut casca, mut bevy) = (Rendered::new(scene, settings)?, Rendered::new(scene, None)?);
    let (mut pictures, mut pixels) = (0, 0);
    let (mut drawn, mut lamps, mut took) = ([0; 2], [0; 2], [Duration::ZERO; 2]);
    for frame in 0..frames {
        let start = Instant::now();
        let with = casca.picture(scene, frame)?;
        let middle = Instant::now();
        let without = bevy.picture(scene, frame)?;
        took = [took[0] + (middle - start), took[1] + middle.elapsed()];
        let differ = with.chunks(4).zip(without.chunks(4)).filter(|(a, b)| a != b).count();
        pictures += u32::from(differ > 0);
        pixels += differ;
        drawn = [drawn[0] + casca.drawn(), drawn[1] + bevy.drawn()];
        lamps = [lamps[0] + casca.lamps(), lamps[1] + bevy.lamps()];
        let folder = out.filter(|_| differ > 0 || frame == frames / 2);
        for (name, picture) in [("casca", with), ("bevy", without)] {
            save(folder, &format!("{of_scene}-{frame}-{name}.png"), (WIDTH, HEIGHT), &picture)?;
        }
    }
    println!(
        "{of_scene}: {pictures} of {frames} pictures differ, in {pixels} pixels; \
         drawn {} of {}, {:.1} of {:.1} lamps shine, in {:.2} of the time; {} meshes hide",
        drawn[0] / frames.max(1) as usize,
        drawn[1] / frames.max(1) as usize,
        lamps[0] as f32 / frames.max(1) as f32,
        lamps[1] as f32 / frames.max(1) as f32,
        took[0].as_secs_f64() / took[1].as_secs_f64(),
        casca.casca().map_or(0, CascaScene::occluders)
    );
    Ok(pictures)
}
