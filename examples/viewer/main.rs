//! Draws exactly what the PVS says, in a window or into pictures.
//!
//! `cargo run --release --features demo --example viewer` opens a window; `-- --help` lists the options.
//! How casca is wired into a render loop is in `frame_loop.rs`.

mod bench;
mod canvas;
mod frame_loop;
mod geometry;
mod gpu;
mod headless;
mod overlays;
mod panel;
mod proof;
mod renderer;
mod stage;
mod window;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use casca_harness::scenes::{SceneKind, SceneOptions};
use clap::Parser;

use gpu::Gpu;
use overlays::Layer;
use stage::{Method, Stage, world_of};

#[derive(Debug, Parser)]
#[command(about = "Draws exactly what casca finds visible: in a window, or into pictures")]
struct Options {
    /// spheres, city, rooms, forest, crowd, or glTF 2.0 files (.glb), comma-separated
    /// [default: all procedural scenes]
    #[arg(long, value_delimiter = ',')]
    scene: Vec<String>,
    /// How what is drawn is decided: all, frustum, point, cell, hzb or rays
    #[arg(long, default_value = "point")]
    method: Method,
    /// Draws pictures without a window
    #[arg(long)]
    headless: bool,
    /// Compares pictures of everything with pictures of what each method leaves; fails if point or cell lose a pixel
    #[arg(long)]
    proof: bool,
    /// Measures frames with and without culling, at 5,000 and 50,000 objects
    #[arg(long)]
    bench: bool,
    /// Pictures, evenly spread over the path of each scene
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// Where pictures go
    #[arg(long, default_value = "target/viewer")]
    out: PathBuf,
    /// Size of pictures and of the window
    #[arg(long, default_value = "1280x720", value_parser = parse_size)]
    size: (u32, u32),
    /// Pictures are taken from behind and above the camera that is culled for
    #[arg(long)]
    bird: bool,
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
    let (width, height) = text.split_once('x').ok_or("expected a size such as 1280x720")?;
    let pixels =
        |n: &str| n.parse::<u32>().ok().filter(|n| *n > 0).ok_or(format!("{n} is no number of pixels"));
    Ok((pixels(width)?, pixels(height)?))
}

fn parse_layer(text: &str) -> Result<Layer, String> {
    let names = ["hidden", "volumes", "cells", "caps", "buffers", "frustum"];
    let found = names.into_iter().zip(Layer::EVERY).find(|(name, _)| *name == text);
    found.map(|(_, layer)| layer).ok_or_else(|| format!("expected some of {}", names.join(", ")))
}

/// Whether all that was to be proved holds.
fn run(options: &Options) -> Result<bool, Box<dyn Error>> {
    let scenes: Vec<String> = match &options.scene[..] {
        [] => SceneKind::ALL.map(|kind| kind.name().to_owned()).to_vec(),
        given => given.to_vec(),
    };
    let scene_options = SceneOptions { seed: options.seed, ..SceneOptions::default() };
    if !(options.headless || options.proof || options.bench) {
        window::open(scenes, &scene_options, options.method, (options.size, options.software))?;
        return Ok(true);
    }
    let gpu = Gpu::headless(options.software)?;
    println!("drawing on {}", gpu.name);
    let mut holds = true;
    if options.bench {
        bench::bench(&gpu, options.size)?;
    }
    for scene in scenes.iter().filter(|_| options.headless || options.proof) {
        let mut stage = Stage::new(world_of(scene, &scene_options)?)?;
        if options.proof {
            let methods = [Method::Point, Method::Cell, Method::Hzb, Method::Rays];
            let plan = (options.size, options.frames as usize);
            let rows = proof::prove(&gpu, &mut stage, plan, &methods, Some(&options.out))?;
            holds &= proof::report(&stage.world.name, stage.world.objects.len(), &rows);
        } else {
            let plan = headless::Plan {
                method: options.method,
                frames: options.frames as usize,
                out: &options.out,
                size: options.size,
                bird: options.bird,
                layers: &options.layers,
            };
            headless::pictures(&gpu, &mut stage, &plan)?;
        }
    }
    Ok(holds)
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => {
            eprintln!("pixels differ where none may");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
