//! What culling brings: the time of a frame with it over the time without.

use std::error::Error;
use std::time::{Duration, Instant};

use casca_lab::scenes::{self, SceneKind, SceneOptions};

use super::canvas::{Canvas, coloured};
use super::gpu::{COLOUR, Gpu};
use super::renderer::{Marks, Renderer};
use super::stage::{Method, Stage};

/// Frames measured for each method.
const FRAMES: usize = 15;

/// Prints medians of whole frames: report what moved, query, make the list, upload, draw, wait.
///
/// # Errors
/// What is drawn cannot be had.
pub fn bench(gpu: &Gpu, size: (u32, u32)) -> Result<(), Box<dyn Error>> {
    println!("on {}, {}x{} pixels, {FRAMES} frames", gpu.name, size.0, size.1);
    println!(
        "{:>8} {:<8} {:>8} {:>11} {:>11} {:>8}",
        "objects", "method", "drawn", "frame ms", "query ms", "ratio"
    );
    for scale in [1.0, 10.0] {
        let options = SceneOptions { scale, ..SceneOptions::default() };
        let methods = [Method::All, Method::Frustum, Method::Point, Method::Cell];
        // Each has a scene of its own, so that each pays for what moves.
        let new = |_| Stage::new(scenes::build(SceneKind::Spheres, &options));
        let mut stages = methods.iter().map(new).collect::<Result<Vec<_>, _>>()?;
        let canvas = Canvas::new(gpu, size);
        let mut renderer = Renderer::new(gpu, COLOUR, &stages[0].geometry);
        let aspect = canvas.size.0 as f32 / canvas.size.1 as f32;
        let mut times: Vec<(Vec<Duration>, Vec<Duration>, usize)> = vec![Default::default(); methods.len()];
        for i in 0..FRAMES + 1 {
            for ((method, stage), (frames, queries, drawn)) in methods.iter().zip(&mut stages).zip(&mut times)
            {
                let camera = stage.path_camera(aspect);
                let start = Instant::now();
                let mut query = Duration::ZERO;
                let mut visible = 0;
                stage.frame(*method, &camera, &mut |frame| {
                    let list = coloured(frame.geometry, frame.objects, &frame.visible);
                    canvas.draw(gpu, &mut renderer, &camera, &list, &Marks::default());
                    gpu.wait()?;
                    (query, visible) = (frame.time, frame.visible.len());
                    Ok(())
                })?;
                // The first round only warms up.
                if i > 0 {
                    frames.push(start.elapsed());
                    queries.push(query);
                    *drawn += visible;
                }
                let step = stage.world.frames / FRAMES;
                (0..step).for_each(|_| stage.advance());
            }
        }
        let (objects, all) = (stages[0].world.objects.len(), median(&mut times[0].0));
        for (method, (frame_times, query_times, drawn)) in methods.iter().zip(&mut times) {
            let frame = median(frame_times);
            println!(
                "{:>8} {method:<8} {:>8.1} {:>11.2} {:>11.2} {:>8.3}",
                objects,
                *drawn as f64 / FRAMES as f64,
                frame * 1e3,
                median(query_times) * 1e3,
                frame / all.max(f64::MIN_POSITIVE)
            );
        }
    }
    Ok(())
}

fn median(times: &mut [Duration]) -> f64 {
    times.sort_unstable();
    times.get(times.len() / 2).map_or(0.0, Duration::as_secs_f64)
}
