//! Shells beside the same strands, ray-traced: the error by height and layers, and the time, of
//! fragments that look one strand up and of those that walk along their rays; needs a graphics
//! adapter. `study coats.png` draws six coats beside their strands instead.
//!
//! `cargo run --release -p casca-fur --features gpu,scenes --example study` writes the tables of the
//! README. All pictures sample each pixel at 2x2 places.

use std::error::Error;
use std::path::Path;

use casca_fur::gpu::look::{Look, sky_pixel};
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::reference::Reference;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::Mesh;
use casca_fur::scenes::animals::Animal;
use casca_fur::scenes::threads;
use casca_fur::strands::Fur;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::camera::Camera;
use casca_tools::image::{halved, write_png};
use glam::{Affine3A, Vec3};

const LAYERS: [u32; 5] = [4, 8, 16, 32, 64];
/// Heights as shares of the radius: the two of the thesis, and a taller one.
const HEIGHTS: [f32; 3] = [0.02, 0.05, 0.1];
const DENSITY: f32 = 0.3;
const SIZE: (u32, u32) = (240, 180);
const TO_SUN: Vec3 = Vec3::new(0.45, 0.75, 0.5);
/// Colours that multiply those of the mesh, at roots and tips.
const ROOT: Vec3 = Vec3::new(0.85, 0.82, 0.8);
const TIP: Vec3 = Vec3::new(1.6, 1.57, 1.55);
/// Pixels nearer than this to one of the sky belong to an outline.
const OUTLINE: i64 = 4;

/// The error over the pixels in which either picture shows the animal, 0 to 1; and over those of
/// them that are no part of an outline.
fn errors(want: &[u8], got: &[u8]) -> [f64; 2] {
    let (width, height) = (i64::from(SIZE.0), i64::from(SIZE.1));
    let sky = sky_pixel();
    let at = |pixels: &[u8], x: i64, y: i64| -> [u8; 4] {
        std::array::from_fn(|i| pixels[(4 * (y * width + x)) as usize + i])
    };
    let is_sky = |x: i64, y: i64| at(want, x, y) == sky || at(got, x, y) == sky;
    let mut sums = [(0.0, 0.0); 2];
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let (a, b) = (at(want, x, y), at(got, x, y));
        if a == sky && b == sky {
            continue;
        }
        let square = (0..3).map(|i| (f64::from(a[i]) - f64::from(b[i])).powi(2)).sum::<f64>() / 3.0;
        let columns = (x - OUTLINE).max(0)..=(x + OUTLINE).min(width - 1);
        let mut rows = (y - OUTLINE).max(0)..=(y + OUTLINE).min(height - 1);
        let is_outline = rows.any(|v| columns.clone().any(|u| is_sky(u, v)));
        for (sum, counts) in sums.iter_mut().zip([true, !is_outline]) {
            if counts {
                *sum = (sum.0 + square, sum.1 + 1.0);
            }
        }
    }
    sums.map(|(sum, count)| (sum / f64::max(count, 1.0)).sqrt() / 255.0)
}

/// A renderer for a furry animal at a level of detail.
fn grown(gpu: &Gpu, mesh: &Mesh, fur: Fur, walked: bool) -> Result<Renderer, Box<dyn Error>> {
    Ok(Renderer::new(gpu, COLOUR, std::slice::from_ref(mesh), &Look { walked, ..Look::new(fur) })?)
}

/// The animal in the colours of its mesh, times those of roots and tips, with so many layers.
fn list(root: Vec3, tip: Vec3, layers: u32) -> DrawList {
    let (root, tip) = (root.to_array(), tip.to_array());
    DrawList::new(&[(Stand { mesh: 0, place: Affine3A::IDENTITY, root, tip }, layers)], Vec::new())
}

/// The sun over an animal of a radius.
fn sun(radius: f32, shadows: bool) -> Sun {
    Sun { towards: TO_SUN, center: Vec3::ZERO, radius: 1.6 * radius, shadows }
}

fn camera(radius: f32, eye: Vec3, target: Vec3, angle: f32) -> Camera {
    Camera::look_at(eye * radius, target * radius, angle, 4.0 / 3.0, 0.01 * radius, 20.0 * radius)
}

/// Shells beside the same strands, ray-traced, at several heights.
fn study(gpu: &Gpu, animal: &Animal) -> Result<(), Box<dyn Error>> {
    let (mesh, radius) = (&animal.levels()[0], animal.radius());
    // The shoulder and the head from so near that strands are some pixels wide.
    let camera = camera(radius, Vec3::new(0.75, 0.55, 1.0), Vec3::new(0.35, 0.2, 0.15), 38.0);
    let canvas = Canvas::new(gpu, (2 * SIZE.0, 2 * SIZE.1));
    println!("| height | rays | layers | RMSE | away from outlines |\n|---|---|---|---|---|");
    for height in HEIGHTS {
        let fur = Fur::for_radius(radius, height, DENSITY)?;
        let fur = Fur { bend: Vec3::new(-0.49, -0.49, 0.0), ..fur };
        let strands = Reference::new(mesh, &Look::new(fur))?;
        let picture = |side| strands.picture(&camera, SIZE, side, &[ROOT, TIP], TO_SUN.normalize());
        let truth = picture(2);
        let [all, inside] = errors(&truth, &picture(3));
        println!("| {height} | of strands, at 3x3 places | | {all:.3} | {inside:.3} |");
        for (walked, way) in [(false, "looked up"), (true, "walked along")] {
            let mut renderer = grown(gpu, mesh, fur, walked)?;
            for layers in LAYERS {
                let shells = list(ROOT, TIP, layers);
                renderer.draw(gpu, &canvas.picture(), &camera, &shells, &sun(radius, false))?;
                let shells = halved(&canvas.read_picture(gpu)?, canvas.size());
                let [all, inside] = errors(&truth, &shells);
                println!("| {height} | {way} | {layers} | {all:.3} | {inside:.3} |");
            }
        }
    }
    Ok(())
}

/// The least time of three, in turn, of the shadow map and of a picture of 640x480 with 16 layers.
fn cost(gpu: &Gpu, animal: &Animal) -> Result<(), Box<dyn Error>> {
    let radius = animal.radius();
    let fur = Fur { spacing: 0.011 * radius, ..Fur::for_radius(radius, 0.08, 0.45)? };
    let camera = camera(radius, Vec3::new(1.1, 0.4, 1.35), Vec3::new(0.05, 0.0, 0.0), 50.0);
    let (canvas, shells) = (Canvas::new(gpu, (640, 480)), list(ROOT, TIP, 16));
    println!("| level of detail | rays | shadow map, ms | picture, ms |\n|---|---|---|---|");
    for (level, mesh) in animal.levels().iter().enumerate().take(2) {
        let mut best = [[f64::INFINITY; 2]; 2];
        let mut renderers = [grown(gpu, mesh, fur, false)?, grown(gpu, mesh, fur, true)?];
        for _ in 0..3 {
            for (renderer, best) in renderers.iter_mut().zip(&mut best) {
                let mut times = [threads(); 3];
                renderer.cast_shadows(gpu, &shells, &sun(radius, true))?;
                gpu.wait()?;
                times[1] = threads();
                renderer.draw(gpu, &canvas.picture(), &camera, &shells, &sun(radius, true))?;
                gpu.wait()?;
                times[2] = threads();
                *best = std::array::from_fn(|i| best[i].min(times[i + 1] - times[i]));
            }
        }
        for (way, [shadows, picture]) in ["looked up", "walked along"].iter().zip(best) {
            println!("| {level} | {way} | {shadows:.0} | {picture:.0} |");
        }
    }
    Ok(())
}

/// Six coats: the seed of the animal; height, density, spacing, clump and curl of its fur, how it
/// bends, and how much lighter its tips are than its colours.
const COATS: [(u64, [f32; 5], Vec3, Vec3); 6] = [
    (1, [0.09, 0.45, 0.008, 0.6, 0.0], Vec3::new(-0.5, -0.5, 0.0), Vec3::splat(1.6)),
    (2, [0.035, 0.5, 0.007, 0.2, 0.0], Vec3::new(-0.9, -0.4, 0.0), Vec3::new(1.5, 1.35, 1.2)),
    (3, [0.13, 0.5, 0.011, 1.0, 0.15], Vec3::new(-0.5, -0.9, 0.0), Vec3::splat(2.0)),
    (4, [0.09, 0.6, 0.009, 0.3, 1.0], Vec3::new(-0.1, -0.2, 0.0), Vec3::splat(2.8)),
    (5, [0.12, 0.5, 0.009, 0.8, 0.2], Vec3::new(-0.3, -0.3, 0.0), Vec3::new(2.4, 1.5, 0.8)),
    (6, [0.06, 0.4, 0.006, 0.1, 0.0], Vec3::new(-0.2, 0.0, 0.0), Vec3::splat(1.9)),
];

/// Six coats of 32 layers, each beside its strands, ray-traced.
fn coats(gpu: &Gpu, path: &Path) -> Result<(), Box<dyn Error>> {
    let size = (320, 240);
    let canvas = Canvas::new(gpu, (2 * size.0, 2 * size.1));
    let mut rows = vec![Vec::new(); 3 * 240];
    for (i, (seed, [height, density, spacing, clump, curl], bend, tip)) in COATS.into_iter().enumerate() {
        let animal = Animal::new(seed, 96)?;
        let (mesh, radius) = (&animal.levels()[0], animal.radius());
        let fur = Fur::for_radius(radius, height, density)?;
        let fur = Fur { spacing: spacing * radius, bend, clump, curl, ..fur };
        let camera = camera(radius, Vec3::new(0.85, 0.34, 0.94), Vec3::new(0.15, 0.05, 0.0), 50.0);
        let shells = list(ROOT, tip, 32);
        grown(gpu, mesh, fur, false)?.draw(gpu, &canvas.picture(), &camera, &shells, &sun(radius, false))?;
        let shells = halved(&canvas.read_picture(gpu)?, canvas.size());
        let strands = Reference::new(mesh, &Look::new(fur))?;
        let traced = strands.picture(&camera, size, 2, &[ROOT, tip], TO_SUN.normalize());
        println!("coat {i}: {} strands", strands.strands());
        for (y, row) in shells.chunks(4 * 320).zip(traced.chunks(4 * 320)).enumerate() {
            rows[240 * (i / 2) + y].extend([row.0, row.1].concat());
        }
    }
    Ok(write_png(path, (4 * 320, 3 * 240), &rows.concat())?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let Some(gpu) = Gpu::for_tests() else { return Ok(()) };
    if let Some(path) = std::env::args_os().nth(1) {
        return coats(&gpu, Path::new(&path));
    }
    let animal = Animal::new(1, 96)?;
    study(&gpu, &animal)?;
    cost(&gpu, &animal)
}
