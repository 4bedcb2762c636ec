//! The proof in pixels: a picture of everything and a picture of what a method leaves must be the
//! same.
//!
//! Solids are drawn exactly, by a ray through each pixel, since a sphere of triangles would show
//! more than the sphere hides. Where two surfaces have the same depth to the last bit, the first
//! one drawn wins, in the same order in both pictures. So a pixel may differ only if an object that
//! was left out is nearest there, or as near as the nearest: both count as a loss.

use std::error::Error;
use std::path::Path;

use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::image::write_png;

use crate::scene::draw::{Painter, coloured};
use crate::scene::playback::{Method, Playback};
use crate::scene::renderer::Renderer;

/// What the pictures of one method gave, over all frames.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// The method.
    pub method: Method,
    /// Frames compared.
    pub frames: usize,
    /// Pixels that differ, in colour or in the object that they show.
    pub pixels: usize,
    /// Frames with such pixels.
    pub bad_frames: usize,
    /// Objects drawn.
    pub drawn: usize,
}

/// Compares `frames` pictures, spread over the path of a scene. Writes those that differ to `out`.
///
/// # Errors
/// What is drawn cannot be had or written.
pub fn prove(
    gpu: &Gpu,
    playback: &mut Playback,
    (size, frames): ((u32, u32), usize),
    methods: &[Method],
    out: Option<&Path>,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let canvas = Canvas::new(gpu, size);
    let mut renderer = Renderer::new(gpu, COLOUR, &playback.geometry);
    let mut rows: Vec<Row> =
        methods.iter().map(|&method| Row { method, frames: 0, pixels: 0, bad_frames: 0, drawn: 0 }).collect();
    let last = playback.world.frames.saturating_sub(1);
    for i in 0..frames {
        let at = last * (i * 2 + 1) / (frames * 2);
        // Every frame is walked, so that hidden objects are in their volumes.
        let mut camera = playback.path_camera(canvas.aspect());
        loop {
            playback.frame(Method::Point, &camera, &mut |_| Ok(()))?;
            if playback.ticks >= at {
                break;
            }
            playback.ticks += 1;
            camera = playback.path_camera(canvas.aspect());
        }
        let sets = playback.compare(methods, &camera)?;
        let objects = &playback.world.objects;
        let mut painter = Painter { gpu, canvas: &canvas, renderer: &mut renderer };
        let mut shoot = |set: &[usize]| painter.shot(&camera, &coloured(&playback.geometry, objects, set));
        let everything: Vec<usize> = (0..objects.len()).collect();
        let want = shoot(&everything)?;
        for (row, set) in rows.iter_mut().zip(&sets) {
            let got = shoot(set)?;
            let differing = want.differing(&got);
            let count = differing.len();
            row.frames += 1;
            row.pixels += count;
            row.bad_frames += usize::from(count > 0);
            row.drawn += set.len();
            let Some(&first) = differing.first() else { continue };
            let scene = &playback.world.name;
            if let Some(out) = out {
                let name = format!("{scene}-{at:04}-{}-differs.png", row.method);
                write_png(&out.join(name), canvas.size(), &got.pixels)?;
            }
            let name = |item: u32| objects.get(item as usize).map_or("nothing", |o| o.name.as_str());
            let (wanted, shown, width) = (want.items[first], got.items[first], canvas.size().0 as usize);
            eprintln!(
                "{scene} frame {at}, {}: {count} pixels differ; at ({}, {}) everything shows object {wanted} {:?}, the method {shown} {:?}",
                row.method,
                first % width,
                first / width,
                name(wanted),
                name(shown),
            );
        }
    }
    Ok(rows)
}

/// Prints what was compared; whether no method lost a pixel.
pub fn report(scene: &str, objects: usize, rows: &[Row]) -> bool {
    for row in rows {
        let n = row.frames.max(1);
        println!(
            "{scene:<14} {objects:>7} objects  {:<8} {:>8.1} drawn  {:>3} frames  {:>6} pixels differ in {} frames",
            row.method,
            row.drawn as f64 / n as f64,
            row.frames,
            row.pixels,
            row.bad_frames
        );
    }
    rows.iter().all(|row| row.pixels == 0)
}
