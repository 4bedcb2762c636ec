//! Pictures without a window.

use std::error::Error;
use std::path::Path;

use casca_radiosity::lit::path::{PathTracer, Quantity};
use casca_radiosity::lit::{HdrImage, LitScene};
use casca_scenes::world::Camera;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::Gpu;
use casca_stage::timing::{Clock, Instant};
use casca_tools::command_line::{make_folder, say};
use casca_tools::pictures::{Tile, sheet};
use glam::Vec3;

use crate::common::Film;
use crate::light::options::Options;
use crate::light::picture::{LAYERS, Layer};
use crate::light::renderer::Renderer;
use crate::light::scene::Room;
use crate::times;

/// Times that the path tracer scatters light at most: walls of an albedo of 0.8 keep 1e-6 of it.
const MOST_BOUNCES: u32 = 64;
/// The seed of the path tracer.
const SEED: u64 = 1;
/// Frames that are timed, if no other number is given, and seconds that balls move between them.
const FRAMES: u32 = 5;
const SECONDS: f32 = 0.1;

/// Draws layers of a scene into files.
pub fn pictures(gpu: &Gpu, start: &Room, options: &Options, layers: &[Layer]) -> Result<(), Box<dyn Error>> {
    let out = options.common.folder("light");
    make_folder(&out)?;
    let film = Film::new(gpu, options.common.drawing.size, false);
    let canvas = &film.canvas;
    let camera = start.camera(canvas.size());
    let scene = &start.scene;
    let mut renderer = Renderer::new(gpu, scene, options.settings())?;
    renderer.exposure = options.exposure;
    renderer.update(gpu, (&camera, canvas.size()), None, &mut Clock::off())?;
    say(format_args!("{}: {}", scene.name, told(&renderer)));
    for (name, layer) in LAYERS.into_iter().filter(|(_, layer)| layers.contains(layer)) {
        renderer.draw(gpu, &canvas.picture(), &camera, layer, &mut Clock::off())?;
        film.save(gpu, &out.join(format!("{}-{name}.png", scene.name)))?;
        if layer == Layer::Picture && options.truth > 0 {
            let light = renderer.read_light(gpu)?.iter().map(|p| Vec3::from_slice(p)).collect();
            let (width, height) = canvas.size();
            let found = HdrImage::new(width as usize, height as usize, light)?;
            let path = out.join(format!("{}-beside-truth.png", scene.name));
            compare(&path, scene, options, (&camera, &found))?;
        }
    }
    Ok(())
}

/// Prints the time of each stage: of a first picture, and of pictures after the balls have moved.
pub fn time(gpu: &Gpu, start: &Room, options: &Options) -> Result<(), Box<dyn Error>> {
    let (mut clock, mut begun) = (Clock::on(), Instant::now());
    let mut renderer = Renderer::new(gpu, &start.scene, options.settings())?;
    clock.add("cells", begun.elapsed());
    let canvas = Canvas::new(gpu, options.common.drawing.size);
    let camera = start.camera(canvas.size());
    let mut frames = Vec::new();
    for number in 0..=options.common.drawing.frames.unwrap_or(FRAMES) {
        if number > 0 {
            (clock, begun) = (Clock::on(), Instant::now());
            renderer.move_objects(gpu, &start.balls_at(number as f32 * SECONDS).collect::<Vec<_>>())?;
            clock.add("move balls", begun.elapsed());
        }
        renderer.update(gpu, (&camera, canvas.size()), None, &mut clock)?;
        renderer.draw(gpu, &canvas.picture(), &camera, Layer::Picture, &mut clock)?;
        frames.push(clock.stages().to_vec());
    }
    say(format_args!("{}: {}", start.scene.name, told(&renderer)));
    let moved = frames.split_off(1);
    times::table(&[("first picture", frames), ("after a move", moved)]);
    Ok(())
}

/// Draws the picture by the path tracer, with light scattered as often as it takes, and says how
/// far off the light found is.
fn compare(
    path: &Path,
    scene: &LitScene,
    options: &Options,
    (camera, found): (&Camera, &HdrImage),
) -> Result<(), Box<dyn Error>> {
    let orders = Quantity::Radiance(0..=MOST_BOUNCES);
    let truth = PathTracer::new(scene).render(camera, found.size(), &orders, options.truth, SEED)?.image;
    let mean = |image: &HdrImage| {
        let sum: f64 = image.pixels().iter().map(|p| f64::from(p.element_sum())).sum();
        sum / (3 * image.pixels().len()) as f64
    };
    let (ours, theirs, rmse) = (mean(found), mean(&truth), found.rmse(&truth)?);
    let title = finding(ours / theirs);
    let subtitle = format!(
        "{}; light of all bounces; mean {ours:.4} and {theirs:.4}, RMSE {rmse:.4} with the noise of both",
        scene.name
    );
    let tile = |caption: String, image: &HdrImage| Tile {
        caption,
        width: image.size().0,
        rgb: image.srgb(options.exposure),
    };
    let row = vec![
        tile(format!("Radiosity cache: {} cells", options.resolution), found),
        tile(format!("Path tracer: {} samples a pixel", options.truth), &truth),
    ];
    sheet(path, &title, &subtitle, &[row])?;
    say(format_args!("{}: {title}; {subtitle}", path.display()));
    Ok(())
}

/// How bright the light found is, as a share of the truth.
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

/// What the cache holds.
pub fn told(renderer: &Renderer) -> String {
    let s = renderer.statistics();
    let [x, y, z] = s.dims;
    format!(
        "{x}x{y}x{z} cells, {} of {} states gathered, {} rays, {:.1} MB",
        s.gathered,
        2 * s.entries,
        s.rays,
        s.bytes as f64 / 1e6
    )
}
