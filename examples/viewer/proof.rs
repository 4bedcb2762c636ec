//! The proof in pixels: a picture of everything and a picture of what a method leaves must be the same.
//!
//! Solids are drawn exactly, by a ray through each pixel, since a sphere of triangles would show more
//! than the sphere hides. Where two surfaces have the same depth to the last bit, the first one
//! drawn wins, in the same order in both pictures. So a pixel may differ only if an object that was left out
//! is nearest there, or as near as the nearest: both count as a loss.

use std::error::Error;
use std::path::Path;

use casca_lab::command_line::make_folder;

use super::canvas::{Canvas, coloured, write_png};
use super::gpu::{COLOUR, Gpu};
use super::renderer::Renderer;
use super::stage::{Method, Stage};

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
    stage: &mut Stage,
    (size, frames): ((u32, u32), usize),
    methods: &[Method],
    out: Option<&Path>,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let canvas = Canvas::new(gpu, size);
    let mut renderer = Renderer::new(gpu, COLOUR, &stage.geometry);
    let aspect = canvas.size.0 as f32 / canvas.size.1 as f32;
    let mut rows: Vec<Row> =
        methods.iter().map(|&method| Row { method, frames: 0, pixels: 0, bad_frames: 0, drawn: 0 }).collect();
    let last = stage.world.frames.saturating_sub(1);
    for i in 0..frames {
        let at = last * (i * 2 + 1) / (frames * 2);
        // Every frame is walked, so that hidden objects are in their volumes.
        let mut camera = stage.path_camera(aspect);
        loop {
            stage.frame(Method::Point, &camera, &mut |_| Ok(()))?;
            if stage.ticks() >= at {
                break;
            }
            stage.advance();
            camera = stage.path_camera(aspect);
        }
        let sets = stage.compare(methods, &camera)?;
        let objects = &stage.world.objects;
        let everything: Vec<usize> = (0..objects.len()).collect();
        let mut shoot = |set: &[usize]| -> Result<_, Box<dyn Error>> {
            let list = coloured(&stage.geometry, objects, set);
            let pixels = canvas.pixels(gpu, &mut renderer, &camera, &list)?;
            Ok((pixels, canvas.items(gpu, &mut renderer, &camera, &list)?))
        };
        let (want, items) = shoot(&everything)?;
        for (row, set) in rows.iter_mut().zip(&sets) {
            let (got, shown) = shoot(set)?;
            let differs: Vec<bool> = (0..items.len())
                .map(|p| items[p] != shown[p] || want[p * 4..][..4] != got[p * 4..][..4])
                .collect();
            let count = differs.iter().filter(|d| **d).count();
            row.frames += 1;
            row.pixels += count;
            row.bad_frames += usize::from(count > 0);
            row.drawn += set.len();
            if let (Some(out), true) = (out, count > 0) {
                let name = format!("{}-{at:04}-{}-differs.png", stage.world.name, row.method);
                make_folder(out)?;
                write_png(&out.join(name), canvas.size, &marked(&want, &differs, canvas.size))?;
            }
            if let (true, Some(p)) = (count > 0 && row.method.is_safe(), differs.iter().position(|d| *d)) {
                let name = |item: u32| objects.get(item as usize).map_or("nothing", |o| o.name.as_str());
                eprintln!(
                    "{} frame {at}, {}: {count} pixels differ; at ({}, {}) everything shows object {} {:?}, \
                     the method {} {:?}",
                    stage.world.name,
                    row.method,
                    p % canvas.size.0 as usize,
                    p / canvas.size.0 as usize,
                    items[p],
                    name(items[p]),
                    shown[p],
                    name(shown[p]),
                );
            }
        }
    }
    Ok(rows)
}

/// A pale picture with the pixels that differ in red, and some around each.
fn marked(picture: &[u8], differs: &[bool], (width, height): (u32, u32)) -> Vec<u8> {
    let mut pale: Vec<u8> = picture.iter().map(|v| 140 + v / 3).collect();
    let (width, height) = (width as usize, height as usize);
    for (p, _) in differs.iter().enumerate().filter(|(_, d)| **d) {
        let (x, y) = (p % width, p / width);
        for near_y in y.saturating_sub(1)..(y + 2).min(height) {
            for near_x in x.saturating_sub(1)..(x + 2).min(width) {
                pale[(near_y * width + near_x) * 4..][..4].copy_from_slice(&[220, 0, 30, 255]);
            }
        }
    }
    pale
}

/// Prints what was compared; whether all methods that promise it lost no pixel.
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
    rows.iter().all(|row| !row.method.is_safe() || row.pixels == 0)
}
