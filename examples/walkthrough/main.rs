//! The main job: an observer walks through a dynamic scene, and the library says
//! frame by frame what can be seen, checked against exact visibility.
//!
//! `cargo run --release --example walkthrough` needs no arguments; `--help` lists them.

mod options;

use std::collections::HashSet;
use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use casca::{Aabb, GridSpec, Method, Query};
use casca_lab::baselines::{Hzb, RayBuffer};
use casca_lab::command_line::{Outcome, PathError, finish, say, try_writing, try_writing_into};
use casca_lab::drive::{Driver, grid_for, view_of};
use casca_lab::import::ImportError;
use casca_lab::measure::timed;
use casca_lab::oracle::{ItemBuffer, Oracle, OracleOptions};
use casca_lab::pictures::{
    FrameCounts, FramePicture, TopView, buffers, chart, frame as frame_picture, top_view,
};
use casca_lab::scenes::SceneOptions;
use casca_lab::world::{FRAME_SECONDS, World};
use indicatif::{ProgressBar, ProgressStyle};
use options::{GridChoice, MethodName, Options};
use serde_json::json;

/// Width over height of all pictures.
const ASPECT: f32 = 16.0 / 9.0;
/// The pictures.
const PICTURES: [&str; 4] = ["walk.svg", "frame.png", "buffers.png", "top_view.svg"];

fn build(options: &Options) -> Result<World, ImportError> {
    let frames = options.frames.map(|n| n as usize);
    let mut scene_options = SceneOptions { seed: options.seed, ..SceneOptions::default() };
    scene_options.frames = frames.unwrap_or(scene_options.frames);
    let mut world = options.scene.open(&scene_options)?;
    world.frames = world.frames.min(frames.unwrap_or(usize::MAX));
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

fn run(options: &Options) -> Result<Outcome, Box<dyn Error>> {
    // A walk takes minutes: what cannot be written is said before it.
    try_writing_into(&options.out, &PICTURES)?;
    options.json.as_deref().map_or(Ok(()), try_writing)?;
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

    let settings = options.settings();
    let mut recording = settings;
    recording.record_cells = true;
    recording.method = Method::Cell;
    let mut frustum_settings = settings;
    frustum_settings.method = Method::Frustum;
    let mut query = Query::with_settings(settings)?;
    let height = |width: usize| (width as f32 / ASPECT).round() as usize;
    let mut hzb = Hzb::new(640, height(640));
    let mut ray_buffer = RayBuffer::new(&world.objects, 256, height(256));
    let mut frustum = Query::with_settings(frustum_settings)?;
    let mut recorder = Query::with_settings(recording)?;

    let oracle_options = OracleOptions {
        width: options.width as usize,
        height: height(options.width as usize),
        samples_per_object: options.samples as usize,
        max_candidates: options.candidates as usize,
        seed: options.seed,
    };
    let mut oracle = Oracle::new(&world.objects, oracle_options);
    let path: Vec<_> = (0..world.frames).map(|f| world.camera(f, ASPECT).eye).collect();

    let bar = if options.quiet { ProgressBar::hidden() } else { ProgressBar::new(world.frames as u64) };
    bar.set_style(ProgressStyle::with_template("{msg} {bar:40} frame {pos} of {len}, {eta} left")?);
    bar.set_message(world.name.clone());
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
        let ((), mut time) = timed(|| {
            query.run(&driver.scene, &view);
        });
        let pvs = query.pvs();
        let in_frustum = frustum.run(&driver.scene, &view);
        let (pvs_count, frustum_count) =
            (driver.count(pvs, &world.objects), driver.count(in_frustum, &world.objects));
        let in_frustum: Vec<usize> =
            (0..world.objects.len()).filter(|&i| driver.sees(in_frustum, i)).collect();
        let objects = &world.objects;
        let compared = match options.method {
            MethodName::Hzb => Some(timed(|| hzb.frame(objects, &in_frustum, &camera))),
            MethodName::Rays => Some(timed(|| ray_buffer.frame(objects, &in_frustum, &camera))),
            _ => None,
        };
        let compared: Option<HashSet<usize>> = compared.map(|(found, spent)| {
            time = spent;
            found.into_iter().collect()
        });
        let query_us = time.as_secs_f64() * 1e6;
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
                top_view(&options.out.join("top_view.svg"), &title, &picture)?;
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
    chart(&options.out.join("walk.svg"), &title, &counts)?;

    let mean_of = |of: fn(&FrameCounts) -> usize| mean(counts.iter().map(|c| of(c) as f64));
    let (mean_frustum, mean_pvs, mean_exact) =
        (mean_of(|c| c.frustum), mean_of(|c| c.pvs), mean_of(|c| c.exact));
    // Rays look only at what the PVS leaves out: without an item buffer nothing counts what is visible.
    let mean_exact = (options.width > 0).then_some(mean_exact);
    let ratio = mean_exact.filter(|exact| *exact > 0.0).map(|exact| mean_pvs / exact);
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

    let row = |name: &str, value: String| say(format_args!("{name:<34}{value:>16}"));
    say("");
    row("scene", world.name.clone());
    row("method", method.clone());
    row("grid (cells)", format!("{}x{}x{}", dims.x, dims.y, dims.z));
    row("frames", frames.len().to_string());
    row("objects", objects.to_string());
    row("in the frustum (mean)", format!("{mean_frustum:.1}"));
    row("PVS (mean)", format!("{mean_pvs:.1}"));
    let unknown = || "unknown".to_owned();
    row("exactly visible (mean)", mean_exact.map_or_else(unknown, |n| format!("{n:.1}")));
    row("PVS / exactly visible", ratio.map_or_else(unknown, |n| format!("{n:.3}")));
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
    say(format_args!(
        "\npictures: walk.svg, frame.png, buffers.png and top_view.svg in {}",
        options.out.display()
    ));

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
        std::fs::write(file, serde_json::to_vec_pretty(&report)?).map_err(PathError::write(file))?;
    }
    Ok(match (losses.len(), objects, rays + pixels) {
        (1.., _, _) => Outcome::Lost,
        (0, 0, _) | (0, _, 0) => {
            eprintln!("nothing was checked: no ray was shot at anything that could be lost");
            Outcome::NothingChecked
        }
        _ => Outcome::Well,
    })
}

fn main() -> ExitCode {
    finish(run(&Options::from_command_line()))
}
