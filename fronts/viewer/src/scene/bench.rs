//! What culling brings: the time of a frame with it over the time without.

use std::error::Error;
use std::time::{Duration, Instant};

use casca_scenes::generated::{self, SceneKind, SceneOptions};
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};

use crate::scene::draw::{Painter, coloured};
use crate::scene::playback::{Method, Playback};
use crate::scene::renderer::{Marks, Renderer};

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
        let new = |_| Playback::new(generated::build(SceneKind::Spheres, &options));
        let mut playbacks = methods.iter().map(new).collect::<Result<Vec<_>, _>>()?;
        let canvas = Canvas::new(gpu, size);
        let mut renderer = Renderer::new(gpu, COLOUR, &playbacks[0].geometry);
        let aspect = canvas.aspect();
        let mut times: Vec<(Vec<Duration>, Vec<Duration>, usize)> = vec![Default::default(); methods.len()];
        for i in 0..FRAMES + 1 {
            for ((method, playback), (frames, queries, drawn)) in
                methods.iter().zip(&mut playbacks).zip(&mut times)
            {
                let camera = playback.path_camera(aspect);
                let start = Instant::now();
                let mut query = Duration::ZERO;
                let mut visible = 0;
                playback.frame(*method, &camera, &mut |frame| {
                    let list = coloured(frame.geometry, frame.objects, &frame.visible);
                    let mut painter = Painter { gpu, canvas: &canvas, renderer: &mut renderer };
                    painter.picture(&camera, &list, &Marks::default());
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
                let step = playback.world.frames / FRAMES;
                (0..step).for_each(|_| playback.advance());
            }
        }
        let (objects, all) = (playbacks[0].world.objects.len(), median(&mut times[0].0));
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
