//! Draws exactly what the PVS says, in a window or into pictures.
//!
//! `cargo run --release -p casca-viewer` opens a window; `-- --help` lists the options. `-- --headless --birds-eye
//! --animation` makes the animation at the top of README.md.

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use casca_scenes::generated::{SceneKind, SceneOptions};
use casca_scenes::name::SceneName;
use casca_stage::command_line::{EXIT_CODES, Outcome, finish, make_folder, say};
use casca_stage::gpu::Gpu;
use casca_viewer::overlays::Layer;
use casca_viewer::playback::{Method, Playback};
use casca_viewer::{bench, headless, proof, window};
use clap::{Parser, value_parser};

/// Width and height of pictures and of the window. Larger ones are more than some devices have room for.
const SIDES: std::ops::RangeInclusive<u32> = 1..=8192;

#[derive(Debug, Parser)]
#[command(
    about = "Draws exactly what casca finds visible: in a window, or into pictures",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
struct Options {
    /// spheres, city, rooms, forest, crowd, or glTF 2.0 files (.glb), comma-separated
    /// [default: the procedural scenes of solids]
    #[arg(long, value_delimiter = ',')]
    scene: Vec<SceneName>,
    /// How what is drawn is decided: all, frustum, point, cell, hzb or rays
    #[arg(long, default_value = "point")]
    method: Method,
    /// Draws pictures without a window; exits with 1 if their item buffers show objects that are not drawn
    #[arg(long)]
    headless: bool,
    /// Compares pictures of everything with pictures of what each method leaves; exits with 1 if point or cell lose a pixel
    #[arg(long)]
    proof: bool,
    /// Measures frames with and without culling, at 5,000 and 50,000 objects
    #[arg(long)]
    bench: bool,
    /// Pictures, evenly spread over the path of each scene
    #[arg(long, default_value_t = 5, value_parser = value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// Where pictures go
    #[arg(long, default_value = "target/viewer")]
    out: PathBuf,
    /// Size of pictures and of the window, up to 8192x8192
    #[arg(long, default_value = "1280x720", value_parser = parse_size)]
    size: (u32, u32),
    /// Pictures show the whole scene from above, with the camera, its frustum and the culled objects
    #[arg(long, requires = "headless")]
    birds_eye: bool,
    /// Also writes the pictures as one animated PNG
    #[arg(long, requires = "headless")]
    animation: bool,
    /// Layers over the pictures, comma-separated: hidden, volumes, cells, caps, buffers, frustum
    #[arg(long, value_delimiter = ',', value_parser = parse_layer)]
    layers: Vec<Layer>,
    /// Seed of procedural scenes
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Draws with a software adapter
    #[arg(long)]
    software: bool,
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    casca_stage::image::parse_size(text, SIDES)
}

fn parse_layer(text: &str) -> Result<Layer, String> {
    let names = ["hidden", "volumes", "cells", "caps", "buffers", "frustum"];
    let found = names.into_iter().zip(Layer::EVERY).find(|(name, _)| *name == text);
    found.map(|(_, layer)| layer).ok_or_else(|| format!("expected some of {}", names.join(", ")))
}

/// Whether all that was to be proved holds.
fn run(options: &Options) -> Result<Outcome, Box<dyn Error>> {
    let scenes = match &options.scene[..] {
        [] => SceneKind::SOLIDS.map(SceneName::Built).to_vec(),
        given => given.to_vec(),
    };
    // A proof takes minutes: what cannot be read or written is said before it.
    scenes.iter().try_for_each(SceneName::check)?;
    if options.headless || options.proof {
        make_folder(&options.out)?;
    }
    let scene_options = SceneOptions { seed: options.seed, ..SceneOptions::default() };
    if !(options.headless || options.proof || options.bench) {
        window::open(scenes, &scene_options, options.method, (options.size, options.software))?;
        return Ok(Outcome::Well);
    }
    let gpu = Gpu::headless(options.software)?;
    say(format_args!("drawing on {}", gpu.name));
    let mut holds = true;
    if options.bench {
        bench::bench(&gpu, options.size)?;
    }
    for scene in scenes.iter().filter(|_| options.headless || options.proof) {
        let mut playback = Playback::new(scene.open(&scene_options)?)?;
        if options.proof {
            let methods = [Method::Point, Method::Cell, Method::Hzb, Method::Rays];
            let plan = (options.size, options.frames as usize);
            let rows = proof::prove(&gpu, &mut playback, plan, &methods, Some(&options.out))?;
            holds &= proof::report(&playback.world.name, playback.world.objects.len(), &rows);
        } else {
            let plan = headless::Plan {
                method: options.method,
                frames: options.frames as usize,
                out: &options.out,
                size: options.size,
                birds_eye: options.birds_eye,
                animation: options.animation,
                layers: &options.layers,
            };
            holds &= headless::pictures(&gpu, &mut playback, &plan)? == 0;
        }
    }
    if !holds {
        eprintln!("visible objects were lost");
        return Ok(Outcome::Lost);
    }
    Ok(Outcome::Well)
}

fn main() -> ExitCode {
    finish(run(&Options::parse()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(words: &[&str]) -> Result<Options, String> {
        Options::try_parse_from(std::iter::once(&"viewer").chain(words)).map_err(|e| e.to_string())
    }

    #[test]
    fn absurd_values_are_refused_with_what_is_expected() {
        for (words, word) in [
            (["--size", "0x720"], "from 1 to 8192"),
            (["--size", "99999x99999"], "from 1 to 8192"),
            (["--size", "NaNx1"], "from 1 to 8192"),
            (["--size", "1280"], "1280x720"),
            (["--frames", "0"], "1..=10000"),
            (["--frames", "4294967295"], "1..=10000"),
            (["--scene", "city,house"], "spheres, city"),
            (["--layers", "hidden,all"], "frustum"),
            (["--method", "best"], "point"),
            (["--seed", "-1"], "--seed"),
        ] {
            let said = options(&words).expect_err(words[1]);
            assert!(said.contains(word), "{words:?}: {said}");
        }
        assert_eq!(options(&["--size", "8192x1"]).unwrap().size, (8192, 1));
        assert!(options(&["--animation"]).unwrap_err().contains("--headless"));
    }

    #[test]
    fn a_missing_scene_or_a_folder_that_is_none_is_named_before_anything_is_drawn() {
        let place = std::env::temp_dir().join(format!("casca-viewer-{}", std::process::id()));
        std::fs::write(&place, "no folder").unwrap();
        let failure = |words: &[&str]| run(&options(words).unwrap()).unwrap_err().to_string();
        let name = place.to_str().unwrap();
        assert!(failure(&["--headless", "--out", name]).contains(name));
        assert!(failure(&["--proof", "--out", name]).contains(name));
        assert!(failure(&["--headless", "--scene", "city,no/such.glb"]).contains("no/such.glb"));
        std::fs::remove_file(&place).unwrap();
    }
}
