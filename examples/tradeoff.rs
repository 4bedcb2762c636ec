//! Speed against accuracy: every method at several settings on every scene, beside the
//! methods that engines use today, as a chart (PNG and SVG) and a table (CSV).
//!
//! `cargo run --release --example tradeoff` needs no arguments; `--help` lists them. All
//! queries run on one thread. "Visible" is an exact item buffer, one ray a pixel.

use std::collections::HashSet;
use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

use casca::{Method, Query, Settings};
use casca_harness::baselines::{Hzb, RayBuffer};
use casca_harness::drive::{Driver, grid_for, view_of};
use casca_harness::import;
use casca_harness::oracle::ItemBuffer;
use casca_harness::pictures::{TradeoffPoint, tradeoff};
use casca_harness::scenes::{SceneKind, SceneOptions, build};
use casca_harness::world::{Camera, FRAME_SECONDS, Object, World};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

const ASPECT: f32 = 16.0 / 9.0;

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

/// A method at a setting.
enum Contender {
    Casca(Box<Query>),
    Hzb(Box<Hzb>),
    Rays(Box<RayBuffer>),
}

struct Entry {
    method: &'static str,
    setting: String,
    contender: Contender,
    ms: Vec<f64>,
    found: usize,
    lost: usize,
}

fn entries(world: &World) -> Result<Vec<Entry>, Box<dyn Error>> {
    let mut entries = Vec::new();
    let mut add = |method, setting: String, contender| {
        entries.push(Entry { method, setting, contender, ms: Vec::new(), found: 0, lost: 0 });
    };
    let query = |change: &dyn Fn(&mut Settings)| -> Result<Contender, casca::Error> {
        let mut settings = Settings::default();
        change(&mut settings);
        Ok(Contender::Casca(Box::new(Query::with_settings(settings)?)))
    };
    for (pixels, squares, patches) in [
        (80.0, 0, 0),
        (160.0, 0, 0),
        (160.0, 64, 0),
        (360.0, 64, 0),
        (360.0, 256, 3000),
        (640.0, 256, 6000),
        (1280.0, 4096, 16_000),
    ] {
        let setting = format!("{pixels} px a side, refined {squares}/{patches}");
        let change = |s: &mut Settings| {
            (s.pixel_degrees, s.refine_squares, s.refine_patches) = (90.0 / pixels, squares, patches);
        };
        add("point", setting, query(&change)?);
    }
    for mask in [64, 256, 1024] {
        let contender = query(&|s| (s.method, s.mask_resolution) = (Method::Cell, mask))?;
        add("cell (holds for the whole cell)", format!("mask {mask}"), contender);
    }
    for (w, h) in [(320, 180), (640, 360), (1280, 720), (2560, 1440)] {
        add("hzb (rasterised depth)", format!("{w}x{h}"), Contender::Hzb(Box::new(Hzb::new(w, h))));
    }
    for (w, h) in [(128, 72), (256, 144), (512, 288)] {
        let rays = RayBuffer::new(&world.objects, w, h);
        add("rays (ray-cast depth)", format!("{w}x{h}"), Contender::Rays(Box::new(rays)));
    }
    Ok(entries)
}

fn open(name: &str, seed: u64) -> Result<World, Box<dyn Error>> {
    Ok(match name.parse::<SceneKind>() {
        Ok(kind) => build(kind, &SceneOptions { seed, ..SceneOptions::default() }),
        Err(_) => import::load(&PathBuf::from(name))?,
    })
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Runs one method on one frame and returns the tested objects that it finds visible.
fn measure(
    entry: &mut Entry,
    repeats: usize,
    driver: &Driver,
    objects: &[Object],
    in_frustum: &[usize],
    camera: &Camera,
) -> Result<HashSet<usize>, Box<dyn Error>> {
    let view = view_of(camera)?;
    let mut best = f64::INFINITY;
    let mut found = HashSet::new();
    for repeat in 0..repeats.max(1) {
        let start = Instant::now();
        let visible = match &mut entry.contender {
            Contender::Casca(query) => {
                query.run(&driver.scene, &view);
                None
            }
            Contender::Hzb(hzb) => Some(hzb.frame(objects, in_frustum, camera)),
            Contender::Rays(rays) => Some(rays.frame(objects, in_frustum, camera)),
        };
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
        if repeat == 0 {
            found = match (&entry.contender, visible) {
                (Contender::Casca(query), _) => {
                    (0..objects.len()).filter(|&i| driver.sees(query.pvs(), i)).collect()
                }
                (_, visible) => visible.into_iter().flatten().collect(),
            };
            found.retain(|&i| objects[i].tested);
        }
    }
    entry.ms.push(best);
    Ok(found)
}

fn run_scene(name: &str, options: &Options, points: &mut Vec<TradeoffPoint>) -> Result<(), Box<dyn Error>> {
    let mut world = open(name, options.seed)?;
    world.set_frame(0);
    let mut driver = Driver::new(&world, &grid_for(&world.grid, None)?, |_| ())?;
    let mut entries = entries(&world)?;
    let mut settings = Settings::default();
    settings.method = Method::Frustum;
    let mut frustum = Query::with_settings(settings)?;
    let mut walker = Query::new();
    let mut exact = ItemBuffer::new(options.width, (options.width as f32 / ASPECT).round() as usize);
    let step = (world.frames / options.frames.max(1)).max(1);
    let bar = if options.quiet { ProgressBar::hidden() } else { ProgressBar::new(world.frames as u64) };
    bar.set_style(ProgressStyle::with_template("{msg} {bar:40} frame {pos} of {len}, {eta} left")?);
    bar.set_message(world.name.clone());
    let (mut visible_sum, mut frustum_sum, mut measured) = (0, 0, 0);
    for number in 0..world.frames {
        let moved = world.set_frame(number);
        let camera = world.camera(number, ASPECT);
        driver.scene.begin_frame(number as f64 * FRAME_SECONDS)?;
        driver.update(&world.objects, &moved)?;
        if number % step == step / 2 {
            let pvs = frustum.run(&driver.scene, &view_of(&camera)?);
            let in_frustum: Vec<usize> = (0..world.objects.len()).filter(|&i| driver.sees(pvs, i)).collect();
            exact.render(&world.objects, &camera);
            let seen = exact.visible().iter().enumerate().filter(|(_, pixels)| **pixels > 0);
            let visible: HashSet<usize> = seen.map(|(i, _)| i).filter(|&i| world.objects[i].tested).collect();
            for entry in &mut entries {
                let found = measure(entry, options.repeats, &driver, &world.objects, &in_frustum, &camera)?;
                entry.found += found.len();
                entry.lost += visible.difference(&found).count();
            }
            visible_sum += visible.len();
            frustum_sum += in_frustum.iter().filter(|&&i| world.objects[i].tested).count();
            measured += 1;
        }
        driver.scene.end_frame([walker.run(&driver.scene, &view_of(&camera)?)])?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    let per_frame = |n: usize| n as f64 / f64::from(measured.max(1));
    println!(
        "\n{}: {} frames, {:.1} objects in the frustum, {:.1} visible at {}x{}",
        world.name,
        measured,
        per_frame(frustum_sum),
        per_frame(visible_sum),
        exact.width(),
        exact.height()
    );
    println!("{:<34}{:<32}{:>9}{:>9}{:>9}{:>9}", "method", "setting", "ms", "PVS", "PVS/EVS", "lost");
    for entry in &mut entries {
        let point = TradeoffPoint {
            scene: world.name.clone(),
            method: entry.method.to_owned(),
            setting: entry.setting.clone(),
            ms: median(&mut entry.ms),
            ratio: entry.found as f64 / visible_sum.max(1) as f64,
            lost: per_frame(entry.lost),
        };
        println!(
            "{:<34}{:<32}{:>9.3}{:>9.1}{:>9.3}{:>9.3}",
            point.method,
            point.setting,
            point.ms,
            per_frame(entry.found),
            point.ratio,
            point.lost
        );
        points.push(point);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut options = Options::parse();
    if options.scenes.is_empty() {
        options.scenes = SceneKind::ALL.iter().map(|k| k.name().to_owned()).collect();
    }
    std::fs::create_dir_all(&options.out)?;
    let mut points = Vec::new();
    for name in &options.scenes {
        run_scene(name, &options, &mut points)?;
    }
    let mut csv = String::from("scene,method,setting,ms,pvs_over_evs,lost_per_frame\n");
    for p in &points {
        writeln!(csv, "{},{},\"{}\",{:.4},{:.4},{:.4}", p.scene, p.method, p.setting, p.ms, p.ratio, p.lost)?;
    }
    std::fs::write(options.out.join("tradeoff.csv"), csv)?;
    let title = "Speed against accuracy, one thread";
    for file in ["tradeoff.png", "tradeoff.svg"] {
        tradeoff(&options.out.join(file), title, &points)?;
    }
    println!("\nchart and table: {}", options.out.join("tradeoff.{png,svg,csv}").display());
    Ok(())
}
