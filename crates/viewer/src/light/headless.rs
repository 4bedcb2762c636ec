//! Pictures without a window.

use std::error::Error;
use std::path::Path;

use casca_light::culling::{Culling, may_see};
use casca_light::picture::Layer;
use casca_light::reach::Reach;
use casca_light::renderer::{Renderer, Updated};
use casca_scenes::lit::{HdrImage, LitScene};
use casca_scenes::world::Camera;
use casca_stage::canvas::Canvas;
use casca_stage::command_line::{make_folder, say};
use casca_stage::gpu::Gpu;
use casca_stage::image::write_png;
use casca_stage::pictures::{Tile, sheet};
use casca_stage::timing::Clock;
use casca_truth::oracle::path::{PathTracer, Quantity};
use glam::Vec3;

use crate::light::options::Options;
use crate::light::scene::Start;

/// Times that the path tracer scatters light at most: walls of an albedo of 0.8 keep 1e-6 of it.
const MOST_BOUNCES: u32 = 64;
/// The seed of the path tracer.
const SEED: u64 = 1;

/// Draws layers of a scene into files.
pub fn pictures(gpu: &Gpu, start: &Start, options: &Options, layers: &[Layer]) -> Result<(), Box<dyn Error>> {
    let out = options.common.folder("light");
    make_folder(&out)?;
    let canvas = Canvas::new(gpu, options.common.drawing.size);
    let camera = start.camera(canvas.size());
    let mut renderer = Renderer::new(gpu, &start.scene, options.settings())?;
    renderer.exposure = options.exposure;
    let reach = if options.cull { Some(reach_of(&renderer, start, &camera)?) } else { None };
    let updated = renderer.update(gpu, reach.as_ref(), &mut Clock::off())?;
    say(format_args!("{}: {}", start.scene.name, told(&renderer, &updated)));
    for &layer in layers {
        renderer.draw(gpu, &canvas.picture(), &camera, layer, &mut Clock::off())?;
        let path = out.join(format!("{}-{}.png", start.scene.name, layer.name()));
        write_png(&path, canvas.size(), &canvas.read_picture(gpu)?)?;
        say(path.display());
        if layer == Layer::Picture && options.truth > 0 {
            let light = renderer.read_light(gpu)?.iter().map(|p| Vec3::from_slice(p)).collect();
            let (width, height) = canvas.size();
            let found = HdrImage::new(width as usize, height as usize, light)?;
            let path = out.join(format!("{}-beside-truth.png", start.scene.name));
            let cones = options.settings().cones.cones().len();
            let caption = format!("Voxels: {} cells, {cones} cones", options.resolution);
            let most = if options.no_bounce { 2 } else { 3 };
            compare(&path, &start.scene, options, (&camera, &found), (caption, most))?;
        }
    }
    Ok(())
}

/// Draws the picture by the path tracer, with light scattered up to `most` times, and says how far
/// off the light found is.
pub fn compare(
    path: &Path,
    scene: &LitScene,
    options: &Options,
    (camera, found): (&Camera, &HdrImage),
    (caption, most): (String, u32),
) -> Result<(), Box<dyn Error>> {
    // What is left of light after so many times is black.
    let orders = Quantity::Radiance(0..=most.min(MOST_BOUNCES));
    let truth = PathTracer::new(scene).render(camera, found.size(), &orders, options.truth, SEED)?.image;
    let mean = |image: &HdrImage| {
        let sum: f64 = image.pixels().iter().map(|p| f64::from(p.element_sum())).sum();
        sum / (3 * image.pixels().len()) as f64
    };
    let (ours, theirs, rmse) = (mean(found), mean(&truth), found.rmse(&truth)?);
    let title = finding(ours / theirs);
    let subtitle = format!(
        "{}; light scattered {} on its way; mean {ours:.4} and {theirs:.4}, RMSE {rmse:.4}",
        scene.name,
        if most > MOST_BOUNCES { "as often as it takes".to_owned() } else { format!("up to {most} times") }
    );
    let tile = |caption: String, image: &HdrImage| Tile {
        caption,
        width: image.size().0,
        rgb: image.srgb(options.exposure),
    };
    let row =
        vec![tile(caption, found), tile(format!("Path tracer: {} samples a pixel", options.truth), &truth)];
    sheet(path, &title, &subtitle, &[row])?;
    say(format_args!("{}: {title}; {subtitle}", path.display()));
    Ok(())
}

/// How bright the light by voxels is, as a share of the truth.
fn finding(share: f64) -> String {
    let percent = 100.0 * (share - 1.0).abs();
    if !share.is_finite() {
        "By the path tracer the picture is black".to_owned()
    } else if percent < 0.5 {
        "Light is as bright on the mean as by a path tracer".to_owned()
    } else {
        let more = if share > 1.0 { "brighter" } else { "darker" };
        format!("Light is {percent:.0} % {more} on the mean than by a path tracer")
    }
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
fn reach_of(renderer: &Renderer, start: &Start, camera: &Camera) -> Result<Reach, Box<dyn Error>> {
    let mut culling = Culling::new(&start.scene, renderer.volume())?;
    let sight = culling.look(camera)?.ok_or("the query has not run")?;
    Ok(renderer.reach(&|b| may_see(&sight, b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_says_how_much_brighter_or_darker() {
        assert!(finding(1.004).contains("as bright"));
        assert!(finding(1.43).contains("43 % brighter"));
        assert!(finding(0.8).contains("20 % darker"));
        assert!(finding(f64::NAN).contains("black") && finding(f64::INFINITY).contains("black"));
    }
}
