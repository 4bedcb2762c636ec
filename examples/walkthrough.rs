//! The main job: an observer walks through a dynamic scene, and the library says
//! frame by frame what can be seen, checked against exact visibility.
//!
//! `cargo run --release --example walkthrough` needs no arguments; `--help` lists them.

use std::collections::HashSet;
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use casca::{Aabb, GridSpec, Method, Query, Settings};
use casca_harness::baselines::{Hzb, RayBuffer};
use casca_harness::drive::{Driver, grid_for, view_of};
use casca_harness::oracle::{ItemBuffer, Oracle, OracleOptions};
use casca_harness::pictures::{
    FrameCounts, FramePicture, TopView, buffers, chart, frame as frame_picture, top_view,
};
use casca_harness::scenes::{SceneKind, SceneOptions};
use casca_harness::world::{FRAME_SECONDS, World};
use casca_harness::{import, scenes};
use clap::{Parser, ValueEnum};
use glam::UVec3;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

/// Width over height of all pictures.
const ASPECT: f32 = 16.0 / 9.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Objects in the frustum
    Frustum,
    /// What the viewer's cell can see
    Cell,
    /// What the eye can see, at pixel precision
    Point,
    /// For comparison: a rasterised depth buffer, which loses objects
    Hzb,
    /// For comparison: a ray-cast depth buffer, which loses objects
    Rays,
}

#[derive(Debug, Parser)]
#[command(
    about = "Walks through a scene and says frame by frame what can be seen, with proof that nothing is lost"
)]
struct Options {
    /// spheres, city, rooms, forest, crowd or a glTF 2.0 file (.glb)
    #[arg(long, default_value = "spheres")]
    scene: String,
    /// How visibility is decided
    #[arg(long, value_enum, default_value = "point")]
    method: MethodName,
    /// Cells along x, y and z, such as 100x60x100, or fit: as many as suit the number of objects
    /// [default: as the scene asks]
    #[arg(long, value_parser = parse_grid)]
    grid: Option<GridChoice>,
    /// Frames to walk [default: the scene's path, 150 for procedural scenes]
    #[arg(long)]
    frames: Option<usize>,
    /// Seed of procedural scenes
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Pixels along each side of the direction masks (a power of two)
    #[arg(long, default_value_t = Settings::default().mask_resolution)]
    mask: u32,
    /// Width of a pixel of the occlusion buffers in degrees
    #[arg(long, default_value_t = Settings::default().pixel_degrees)]
    pixel: f32,
    /// Squares examined again for one undecided object, at most
    #[arg(long, default_value_t = Settings::default().refine_squares)]
    refine: u32,
    /// Patches of triangles drawn again in undecided pixels, in one query, at most
    #[arg(long, default_value_t = Settings::default().refine_patches)]
    patches: u32,
    /// Rays to each object that the PVS leaves out, in every frame
    #[arg(long, default_value_t = 16)]
    samples: usize,
    /// Left-out objects that get rays, in every frame
    #[arg(long, default_value_t = 20_000)]
    candidates: usize,
    /// Width of the exact item buffer in pixels
    #[arg(long, default_value_t = 1920)]
    width: usize,
    /// Writes all results to this file
    #[arg(long)]
    json: Option<PathBuf>,
    /// Where the pictures go
    #[arg(long, default_value = "target/walkthrough")]
    out: PathBuf,
    /// No progress bar
    #[arg(long)]
    quiet: bool,
}

#[derive(Debug, Clone, Copy)]
enum GridChoice {
    Dims(UVec3),
    Fit,
}

fn parse_grid(text: &str) -> Result<GridChoice, String> {
    if text == "fit" {
        return Ok(GridChoice::Fit);
    }
    let parts: Result<Vec<u32>, _> = text.split('x').map(str::parse).collect();
    match parts.as_deref() {
        Ok(&[x, y, z]) => Ok(GridChoice::Dims(UVec3::new(x, y, z))),
        _ => Err("expected three numbers such as 100x60x100, or fit".to_owned()),
    }
}

fn build(options: &Options) -> Result<World, Box<dyn Error>> {
    if let Ok(kind) = options.scene.parse::<SceneKind>() {
        let frames = options.frames.unwrap_or(150);
        return Ok(scenes::build(kind, &SceneOptions { seed: options.seed, frames, ..Default::default() }));
    }
    let path = PathBuf::from(&options.scene);
    if path.extension().is_none_or(|e| e != "glb" && e != "gltf") {
        return Err(format!(
            "--scene {}: neither a procedural scene (spheres, city, rooms, forest, crowd) nor a .glb or .gltf file",
            options.scene
        )
        .into());
    }
    let mut world = import::load(&path)?;
    if let Some(frames) = options.frames {
        world.frames = frames.min(world.frames);
    }
    Ok(world)
}

/// What one frame gave.
struct Frame {
    counts: FrameCounts,
    query_us: f64,
    update_us: f64,
    cells: u64,
}

fn percentile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n => values[((n - 1) as f64 * share).round() as usize],
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len().max(1) as f64;
    values.sum::<f64>() / n
}

fn run(options: &Options) -> Result<bool, Box<dyn Error>> {
    let mut world = build(options)?;
    world.set_frame(0);
    let start = Instant::now();
    let grid = match options.grid {
        Some(GridChoice::Fit) => {
            GridSpec::fit(Aabb::new(world.grid.min, world.grid.max), world.objects.len())?
        }
        Some(GridChoice::Dims(dims)) => grid_for(&world.grid, Some(dims))?,
        None => grid_for(&world.grid, None)?,
    };
    let bar =
        if options.quiet { ProgressBar::hidden() } else { ProgressBar::new(world.objects.len() as u64) };
    bar.set_style(ProgressStyle::with_template("preparing {bar:40} object {pos} of {len}, {eta} left")?);
    let mut driver = Driver::new(&world, &grid, |done| bar.set_position(done as u64))?;
    bar.finish_and_clear();
    let setup_ms = start.elapsed().as_secs_f64() * 1e3;

    let mut settings = Settings::default();
    settings.mask_resolution = options.mask;
    settings.pixel_degrees = options.pixel;
    settings.refine_squares = options.refine;
    settings.refine_patches = options.patches;
    let mut recording = settings;
    recording.record_cells = true;
    recording.method = Method::Cell;
    let mut frustum_settings = settings;
    frustum_settings.method = Method::Frustum;
    settings.method = match options.method {
        MethodName::Frustum => Method::Frustum,
        MethodName::Cell => Method::Cell,
        _ => Method::Point,
    };
    let mut query = Query::with_settings(settings)?;
    let height = |width: usize| (width as f32 / ASPECT).round() as usize;
    let mut hzb = Hzb::new(640, height(640));
    let mut ray_buffer = RayBuffer::new(&world.objects, 256, height(256));
    let mut frustum = Query::with_settings(frustum_settings)?;
    let mut recorder = Query::with_settings(recording)?;

    let oracle_options = OracleOptions {
        width: options.width,
        height: (options.width as f32 / ASPECT).round() as usize,
        samples_per_object: options.samples,
        max_candidates: options.candidates,
        seed: options.seed,
    };
    let mut oracle = Oracle::new(&world.objects, oracle_options);
    let path: Vec<_> = (0..world.frames).map(|f| world.camera(f, ASPECT).eye).collect();

    let bar = if options.quiet { ProgressBar::hidden() } else { ProgressBar::new(world.frames as u64) };
    bar.set_style(ProgressStyle::with_template("{msg} {bar:40} frame {pos} of {len}, {eta} left")?);
    bar.set_message(world.name.clone());
    std::fs::create_dir_all(&options.out)?;
    let mut frames: Vec<Frame> = Vec::with_capacity(world.frames);
    let (mut rays, mut pixels, mut unconfirmed) = (0u64, 0u64, 0);
    let mut losses = Vec::new();
    for number in 0..world.frames {
        let moved = world.set_frame(number);
        let camera = world.camera(number, ASPECT);
        let view = view_of(&camera)?;

        let start = Instant::now();
        driver.scene.begin_frame(number as f64 * FRAME_SECONDS)?;
        driver.update(&world.objects, &moved)?;
        let mut update = start.elapsed();
        query.run(&driver.scene, &view);
        let pvs = query.pvs();
        let in_frustum = frustum.run(&driver.scene, &view);
        let (pvs_count, frustum_count) =
            (driver.count(pvs, &world.objects), driver.count(in_frustum, &world.objects));
        let in_frustum: Vec<usize> =
            (0..world.objects.len()).filter(|&i| driver.sees(in_frustum, i)).collect();
        let start = Instant::now();
        let compared = match options.method {
            MethodName::Hzb => Some(hzb.frame(&world.objects, &in_frustum, &camera)),
            MethodName::Rays => Some(ray_buffer.frame(&world.objects, &in_frustum, &camera)),
            _ => None,
        };
        let time = if compared.is_some() { start.elapsed() } else { pvs.stats().elapsed };
        let query_us = time.as_secs_f64() * 1e6;
        let compared: Option<HashSet<usize>> = compared.map(|found| found.into_iter().collect());
        let sees = |object: usize| match &compared {
            Some(found) => found.contains(&object),
            None => driver.sees(pvs, object),
        };
        let pvs_count = match &compared {
            Some(found) => found.iter().filter(|&&i| world.objects[i].tested).count(),
            None => pvs_count,
        };
        let verdict = oracle.frame(&world.objects, &moved, &camera, &sees);
        rays += verdict.rays;
        pixels += verdict.item_rays;
        unconfirmed += verdict.unconfirmed.len();
        for lost in verdict.false_negatives {
            if losses.is_empty() {
                bar.suspend(|| eprintln!("visible objects are missing from the PVS; the first ones:"));
            }
            if losses.len() < 10 {
                let object = &world.objects[lost.object];
                bar.suspend(|| {
                    eprintln!(
                        "  frame {number}: object {} {:?} is seen ({:?}) along the ray from {} to {}",
                        lost.object, object.name, lost.found_by, lost.origin, lost.target
                    );
                });
            }
            losses.push((number, lost));
        }
        if number == world.frames / 2 {
            recorder.run(&driver.scene, &view);
            if let (Some(visited), Some(hidden)) = (recorder.visited_cells(), recorder.hidden_cells()) {
                let height = f64::from(camera.eye.y);
                let volumes: Vec<_> = driver
                    .scene
                    .ids()
                    .filter_map(|id| driver.scene.tbv(id).ok().flatten())
                    .filter(|(lo, hi)| lo.y <= height && height <= hi.y)
                    .collect();
                let title = format!("{}, frame {number}: the grid from above", world.name);
                let scene = &driver.scene;
                let picture = TopView { scene, visited, hidden, volumes: &volumes, camera, path: &path };
                top_view(&options.out.join("top_view.png"), &title, &picture)?;
            }
            let method = format!("{:?}", options.method).to_lowercase();
            let title = format!("{}, frame {number}: what {method} shows and hides", world.name);
            let mut exact = ItemBuffer::new(1280, height(1280));
            exact.render(&world.objects, &camera);
            let objects = &world.objects;
            let picture =
                FramePicture { exact: &exact, objects, camera, in_frustum: &in_frustum, sees: &sees };
            frame_picture(&options.out.join("frame.png"), &title, &picture)?;
            if options.method == MethodName::Point {
                let title = format!("{}, frame {number}: the occlusion buffers", world.name);
                buffers(&options.out.join("buffers.png"), &title, &query.occlusion_images())?;
            }
        }
        let cells = pvs.stats().cells_visited;
        let start = Instant::now();
        driver.scene.end_frame([query.pvs()])?;
        update += start.elapsed();
        let counts = FrameCounts { frustum: frustum_count, pvs: pvs_count, exact: verdict.exact.len() };
        frames.push(Frame { counts, query_us, update_us: update.as_secs_f64() * 1e6, cells });
        bar.inc(1);
    }
    bar.finish_and_clear();

    let counts: Vec<FrameCounts> = frames.iter().map(|f| f.counts).collect();
    let title = format!("{}: what the observer can see", world.name);
    chart(&options.out.join("walk.png"), &title, &counts)?;

    let mean_of = |of: fn(&FrameCounts) -> usize| mean(counts.iter().map(|c| of(c) as f64));
    let (mean_frustum, mean_pvs, mean_exact) =
        (mean_of(|c| c.frustum), mean_of(|c| c.pvs), mean_of(|c| c.exact));
    let ratio = mean_pvs / mean_exact.max(f64::MIN_POSITIVE);
    let mut query_us: Vec<f64> = frames.iter().map(|f| f.query_us).collect();
    let mut update_us: Vec<f64> = frames.iter().map(|f| f.update_us).collect();
    let (median_query, p99_query) = (percentile(&mut query_us, 0.5), percentile(&mut query_us, 0.99));
    let median_update = percentile(&mut update_us, 0.5);
    let cells: u64 = frames.iter().map(|f| f.cells).sum();
    let ns_per_cell = if cells > 0 { query_us.iter().sum::<f64>() * 1e3 / cells as f64 } else { 0.0 };
    let memory = driver.scene.memory();
    let dims = driver.scene.grid().dims();
    let method = format!("{:?}", options.method).to_lowercase();
    let objects = world.objects.iter().filter(|o| o.tested).count();

    let row = |name: &str, value: String| println!("{name:<34}{value:>16}");
    println!();
    row("scene", world.name.clone());
    row("method", method.clone());
    row("grid (cells)", format!("{}x{}x{}", dims.x, dims.y, dims.z));
    row("frames", frames.len().to_string());
    row("objects", objects.to_string());
    row("in the frustum (mean)", format!("{mean_frustum:.1}"));
    row("PVS (mean)", format!("{mean_pvs:.1}"));
    row("exactly visible (mean)", format!("{mean_exact:.1}"));
    row("PVS / exactly visible", format!("{ratio:.3}"));
    row("false negatives", losses.len().to_string());
    row("rays of proof", format!("{:.1} M", (rays + pixels) as f64 / 1e6));
    row("query time, median", format!("{median_query:.0} us"));
    row("query time, 99th percentile", format!("{p99_query:.0} us"));
    if cells > 0 {
        row("query time per visited cell", format!("{ns_per_cell:.2} ns"));
    }
    row("scene update, median", format!("{median_update:.0} us"));
    row("preparation and setup", format!("{setup_ms:.0} ms"));
    row("grid memory", format!("{:.2} MiB", memory.grid() as f64 / (1 << 20) as f64));
    println!("\npictures: walk.png, frame.png, buffers.png and top_view.png in {}", options.out.display());

    if let Some(file) = &options.json {
        let report = json!({
            "scene": world.name,
            "method": method,
            "grid": [dims.x, dims.y, dims.z],
            "seed": options.seed,
            "objects": objects,
            "frames": frames.len(),
            "mean_frustum": mean_frustum,
            "mean_pvs": mean_pvs,
            "mean_exact": mean_exact,
            "ratio": ratio,
            "false_negatives": losses.len(),
            "unconfirmed": unconfirmed,
            "oracle_rays": rays,
            "oracle_pixels": pixels,
            "median_query_us": median_query,
            "p99_query_us": p99_query,
            "ns_per_visited_cell": ns_per_cell,
            "median_update_us": median_update,
            "setup_ms": setup_ms,
            "grid_bytes": memory.grid(),
            "lost": losses.iter().map(|(frame, l)| json!({
                "frame": frame,
                "object": l.object,
                "origin": l.origin.to_array(),
                "target": l.target.to_array(),
            })).collect::<Vec<_>>(),
            "per_frame": frames.iter().map(|f| json!({
                "frustum": f.counts.frustum,
                "pvs": f.counts.pvs,
                "exact": f.counts.exact,
                "query_us": f.query_us,
                "update_us": f.update_us,
                "cells": f.cells,
            })).collect::<Vec<_>>(),
        });
        std::fs::write(file, serde_json::to_vec_pretty(&report)?)?;
    }
    Ok(losses.is_empty())
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(2),
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::FAILURE
        }
    }
}
