//! Renders scenes by Bevy with and without `bevy_casca`, and compares the pictures in every pixel, and their times.
//!
//! `cargo run --bin pixels -- --frames 20`, with Rust 1.97.1 or newer and any graphics adapter, also one in software.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use bevy_casca::{CascaScene, CascaSettings};
use bevy_casca_rendered::rendered::{HEIGHT, Rendered, WIDTH, save};
use bevy_casca_rendered::scenes::Scene;
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
    /// The folder of PNG files: the picture in the middle of each scene, and all that differ
    #[arg(long)]
    out: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let mut alike = true;
    let all = arguments.scene.map_or(Scene::ALL.to_vec(), |scene| vec![scene]);
    for scene in all {
        let differ = compare(scene, arguments.frames, arguments.out.as_deref());
        alike &= differ.inspect_err(|why| eprintln!("{why}")) == Ok(0);
    }
    ExitCode::from(u8::from(!alike))
}

/// Renders a scene twice. Returns the number of pictures that differ.
fn compare(scene: Scene, frames: u32, out: Option<&Path>) -> Result<u32, String> {
    let of_scene = format!("{scene:?}").to_lowercase();
    let settings = Some(CascaSettings::default());
    let (mut casca, mut bevy) = (Rendered::new(scene, settings)?, Rendered::new(scene, None)?);
    let (mut pictures, mut pixels) = (0, 0);
    let (mut drawn, mut took) = ([0; 2], [Duration::ZERO; 2]);
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
        let folder = out.filter(|_| differ > 0 || frame == frames / 2);
        for (name, picture) in [("casca", with), ("bevy", without)] {
            save(folder, &format!("{of_scene}-{frame}-{name}.png"), (WIDTH, HEIGHT), &picture)?;
        }
    }
    println!(
        "{of_scene}: {pictures} of {frames} pictures differ, in {pixels} pixels; \
         drawn {} of {}, in {:.2} of the time; {} meshes hide",
        drawn[0] / frames.max(1) as usize,
        drawn[1] / frames.max(1) as usize,
        took[0].as_secs_f64() / took[1].as_secs_f64(),
        casca.casca().map_or(0, CascaScene::occluders)
    );
    Ok(pictures)
}
