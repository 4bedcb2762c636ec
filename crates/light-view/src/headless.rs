//! Pictures without a window.

use std::error::Error;

use casca_lab::command_line::say;
use casca_lab::lit::HdrImage;
use casca_lab::oracle::path::{PathTracer, Quantity};
use casca_light::culling::{Culling, may_see};
use casca_light::picture::Layer;
use casca_light::reach::Reach;
use casca_light::renderer::{Renderer, Updated};
use casca_light::timing::Clock;
use casca_stage::canvas::{Canvas, write_png};
use casca_stage::gpu::Gpu;
use glam::Vec3;

use crate::options::Options;
use crate::scene::Start;

/// Draws layers of a scene into files.
pub fn pictures(gpu: &Gpu, start: &Start, options: &Options, layers: &[Layer]) -> Result<(), Box<dyn Error>> {
    let canvas = Canvas::new(gpu, options.size);
    let camera = start.camera(canvas.size());
    let mut renderer = Renderer::new(gpu, &start.scene, options.settings())?;
    renderer.exposure = options.exposure;
    let reach = if options.cull { Some(reach_of(&renderer, start, &camera)?) } else { None };
    let updated = renderer.update(gpu, reach.as_ref(), &mut Clock::off())?;
    say(format_args!("{}: {}", start.scene.name, told(&renderer, &updated)));
    for &layer in layers {
        renderer.draw(gpu, &canvas.picture(), &camera, layer, &mut Clock::off())?;
        let path = options.out.join(format!("{}-{}.png", start.scene.name, layer.name()));
        write_png(&path, canvas.size(), &canvas.read_picture(gpu)?)?;
        say(path.display());
        if layer == Layer::Picture && options.truth > 0 {
            let light = renderer.read_light(gpu)?.iter().map(|p| Vec3::from_slice(p)).collect();
            compare(start, options, canvas.size(), light)?;
        }
    }
    Ok(())
}

/// Draws the picture by the path tracer, with light scattered as often as by voxels, and says how far off the light found is.
fn compare(
    start: &Start,
    options: &Options,
    (w, h): (u32, u32),
    found: Vec<Vec3>,
) -> Result<(), Box<dyn Error>> {
    let size = (w as usize, h as usize);
    let found = HdrImage::new(size.0, size.1, found)?;
    let orders = Quantity::Radiance(0..=if options.no_bounce { 2 } else { 3 });
    let camera = start.camera((w, h));
    let truth = PathTracer::new(&start.scene).render(&camera, size, &orders, options.truth, 1)?;
    let path = options.out.join(format!("{}-beside-truth.png", start.scene.name));
    let [ours, theirs] = [&found, &truth.image].map(|image| image.srgb(options.exposure));
    let rows = ours.chunks(3 * size.0).zip(theirs.chunks(3 * size.0)).flat_map(|(a, b)| [a, b]);
    let pixels: Vec<u8> = rows
        .flatten()
        .copied()
        .collect::<Vec<u8>>()
        .chunks(3)
        .flat_map(|p| [p[0], p[1], p[2], 255])
        .collect();
    write_png(&path, (2 * w, h), &pixels)?;
    let mean = |image: &HdrImage| image.pixels().iter().sum::<Vec3>() / image.pixels().len().max(1) as f32;
    say(format_args!(
        "{}: RMSE {:.4}; mean {:.4}, by the path tracer {:.4}",
        path.display(),
        found.rmse(&truth.image)?,
        mean(&found),
        mean(&truth.image)
    ));
    Ok(())
}

/// What an update did.
pub fn told(renderer: &Renderer, updated: &Updated) -> String {
    let [x, y, z] = renderer.volume().dims.to_array();
    let Updated { bricks, merged, shaded, bounced, .. } = updated;
    format!(
        "{x}x{y}x{z} cells, {bricks} bricks with voxels: {merged} voxelized, {shaded} lit, {bounced} bounced into"
    )
}

/// The bricks that a picture can read, as the library sees the scene.
fn reach_of(
    renderer: &Renderer,
    start: &Start,
    camera: &casca_lab::world::Camera,
) -> Result<Reach, Box<dyn Error>> {
    let mut culling = Culling::new(&start.scene, renderer.volume())?;
    let sight = culling.look(camera)?.ok_or("the query has not run")?;
    Ok(renderer.reach(&|b| may_see(&sight, b)))
}
