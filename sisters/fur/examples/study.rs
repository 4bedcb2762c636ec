//! Shells beside the same strands, ray-traced: the error by height and layers, with rays that are
//! followed through slabs and without, as in the thesis. `study [SEED]`; needs a graphics adapter.
//!
//! `cargo run --release -p casca-fur --features gpu,scenes --example study` writes the table of the
//! README. Both pictures sample each pixel at 2x2 places.

use std::error::Error;

use casca_fur::gpu::look::{Look, sky_pixel};
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::reference::Reference;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::scenes::animals::Animal;
use casca_fur::strands::Fur;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::camera::Camera;
use casca_tools::image::halved;
use glam::{Affine3A, Vec3};

const LAYERS: [u32; 5] = [4, 8, 16, 32, 64];
/// Heights as shares of the radius: the two of the thesis, and a taller one.
const HEIGHTS: [f32; 3] = [0.02, 0.05, 0.1];
const DENSITY: f32 = 0.3;
const SIZE: (u32, u32) = (240, 180);
const TO_SUN: Vec3 = Vec3::new(0.45, 0.75, 0.5);
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

fn main() -> Result<(), Box<dyn Error>> {
    let Some(gpu) = Gpu::for_tests() else { return Ok(()) };
    let seed = std::env::args().nth(1).map_or(Ok(1), |word| word.parse())?;
    let animal = Animal::new(seed, 96)?;
    let (mesh, radius) = (&animal.levels()[0], animal.radius());
    // The shoulder and the head from so near that strands are some pixels wide.
    let (eye, target) = (Vec3::new(0.75, 0.55, 1.0) * radius, Vec3::new(0.35, 0.2, 0.15) * radius);
    let aspect = SIZE.0 as f32 / SIZE.1 as f32;
    let camera = Camera::look_at(eye, target, 38.0, aspect, 0.01 * radius, 20.0 * radius);
    let sun = Sun { towards: TO_SUN, center: Vec3::ZERO, radius: 1.6 * radius, shadows: false };
    let (root, tip) = (Vec3::new(0.85, 0.82, 0.8), Vec3::new(1.6, 1.57, 1.55));
    let stand = Stand { mesh: 0, place: Affine3A::IDENTITY, root: root.to_array(), tip: tip.to_array() };
    let canvas = Canvas::new(&gpu, (2 * SIZE.0, 2 * SIZE.1));
    println!("| height | rays | layers | RMSE | away from outlines |\n|---|---|---|---|---|");
    for height in HEIGHTS {
        let fur = Fur::for_radius(radius, height, DENSITY)?;
        let mut look = Look::new(Fur { bend: Vec3::new(-0.49, -0.49, 0.0), ..fur });
        let strands = Reference::new(mesh, &look)?;
        let picture = |side| strands.picture(&camera, SIZE, side, &[root, tip], TO_SUN.normalize());
        let truth = picture(2);
        let [all, inside] = errors(&truth, &picture(3));
        println!("| {height} | of strands, at 3x3 places | | {all:.3} | {inside:.3} |");
        let mut renderer = Renderer::new(&gpu, COLOUR, std::slice::from_ref(mesh), &look)?;
        for marched in [true, false] {
            look.marched = marched;
            renderer.set_look(&gpu, &look);
            for layers in LAYERS {
                let list = DrawList::new(&[(stand, layers)], Vec::new());
                renderer.draw(&gpu, &canvas.picture(), &camera, &list, &sun)?;
                let shells = halved(&canvas.read_picture(&gpu)?, canvas.size());
                let [all, inside] = errors(&truth, &shells);
                let way = if marched { "followed" } else { "plain, as in the thesis" };
                println!("| {height} | {way} | {layers} | {all:.3} | {inside:.3} |");
            }
        }
    }
    Ok(())
}
