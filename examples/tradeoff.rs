//! Speed against accuracy: every method at several settings on every scene, beside the
//! methods that engines use today, as a chart (PNG and SVG) and a table (CSV).
//!
//! `cargo run --release --example tradeoff` needs no arguments; `--help` lists them. All
//! queries run on one thread. "Visible" is an exact item buffer, one ray a pixel. The report
//! (`--example report`) holds the same for all scenes, with what it recommends.

use std::path::PathBuf;

use casca_harness::import;
use casca_harness::lab::LabError;
use casca_harness::lab::tradeoff::{Sampling, SceneTradeoff, chart, measure, table};
use casca_harness::scenes::{SceneKind, SceneOptions, build};
use casca_harness::world::World;
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

#[derive(Debug, Parser)]
#[command(about = "Charts speed against accuracy for all methods and settings")]
struct Options {
    /// Scenes: procedural ones or glTF files [default: all procedural ones]
    #[arg(long, value_delimiter = ',')]
    scenes: Vec<String>,
    /// Frames of each walk that are measured, evenly spread
    #[arg(long, default_value_t = 30)]
    frames: usize,
    /// Times each frame is measured; the least counts
    #[arg(long, default_value_t = 3)]
    repeats: usize,
    /// Width of the item buffer that says what is visible
    #[arg(long, default_value_t = 2560)]
    width: usize,
    /// Seed of procedural scenes
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Where the chart and the table go
    #[arg(long, default_value = "target/tradeoff")]
    out: PathBuf,
    /// No progress bar
    #[arg(long)]
    quiet: bool,
}

fn open(name: &str, seed: u64) -> Result<World, LabError> {
    Ok(match name.parse::<SceneKind>() {
        Ok(kind) => build(kind, &SceneOptions { seed, ..SceneOptions::default() }),
        Err(_) => import::load(&PathBuf::from(name))?,
    })
}

fn print(scene: &SceneTradeoff) {
    println!(
        "\n{}: {} frames, {:.1} objects in the frustum, {:.1} visible",
        scene.scene, scene.frames, scene.in_frustum, scene.visible
    );
    println!("{:<34}{:<32}{:>9}{:>9}{:>9}{:>9}  front", "method", "setting", "ms", "PVS", "PVS/EVS", "lost");
    for p in &scene.points {
        println!(
            "{:<34}{:<32}{:>9.3}{:>9.1}{:>9.3}{:>9.3}{}",
            p.method,
            p.setting,
            p.ms,
            p.ratio * scene.visible,
            p.ratio,
            p.lost,
            if p.front { "  *" } else { "" }
        );
    }
    println!("the automatic settings are {:.1}% behind the front", scene.automatic_distance() * 100.0);
}

fn main() -> Result<(), LabError> {
    let mut options = Options::parse();
    if options.scenes.is_empty() {
        options.scenes = SceneKind::ALL.iter().map(|k| k.name().to_owned()).collect();
    }
    std::fs::create_dir_all(&options.out)?;
    let sampling = Sampling { frames: options.frames, repeats: options.repeats, width: options.width };
    let mut scenes = Vec::new();
    for name in &options.scenes {
        let world = open(name, options.seed)?;
        let frames = options.frames.min(world.frames) as u64;
        let bar = if options.quiet { ProgressBar::hidden() } else { ProgressBar::new(frames) };
        bar.set_style(ProgressStyle::with_template("{msg} {bar:40} frame {pos} of {len}, {eta} left")?);
        bar.set_message(world.name.clone());
        let scene = measure(world, &sampling, |done| bar.set_position(done as u64))?;
        bar.finish_and_clear();
        print(&scene);
        scenes.push(scene);
    }
    std::fs::write(options.out.join("tradeoff.csv"), table(&scenes).csv())?;
    for file in ["tradeoff.png", "tradeoff.svg"] {
        chart(&options.out.join(file), &scenes)?;
    }
    println!("\nchart and table: {}", options.out.join("tradeoff.{png,svg,csv}").display());
    Ok(())
}
