//! Pictures without a window.

use std::error::Error;
use std::path::Path;

use casca_stage::gpu::Gpu;
use casca_stage::timing::{Clock, Instant};
use casca_tools::command_line::say;

use crate::common::{Film, say_stages};
use crate::light::options::Options;
use crate::light::picture::{LAYERS, Layer};
use crate::light::renderer::Renderer;
use crate::light::scene::Room;

/// Seconds that balls move between frames.
const SECONDS: f32 = 0.1;

/// Draws layers of a scene into files, after frames in which its balls move, and prints the time of
/// each stage of these.
pub fn pictures(
    gpu: &Gpu,
    room: &Room,
    options: &Options,
    (layers, folder): (&[Layer], &Path),
) -> Result<(), Box<dyn Error>> {
    let film = Film::new(gpu, options.common.size, false);
    let canvas = &film.canvas;
    let camera = room.camera(canvas.size());
    let (mut clock, mut begun) = (Clock::on(), Instant::now());
    let mut renderer = Renderer::new(gpu, &room.scene, options.settings())?;
    renderer.exposure = options.exposure;
    clock.add("cells", begun.elapsed());
    for frame in 0..options.common.frames.unwrap_or(1) {
        if frame > 0 {
            (clock, begun) = (Clock::on(), Instant::now());
            renderer.move_objects(gpu, &room.balls_at(frame as f32 * SECONDS).collect::<Vec<_>>())?;
            clock.add("move balls", begun.elapsed());
        }
        renderer.update(gpu, (&camera, canvas.size()), None, &mut clock)?;
        renderer.draw(gpu, &canvas.picture(), &camera, Layer::Picture, &mut clock)?;
        say_stages(&clock);
    }
    say(format_args!("{}: {}", room.scene.name, told(&renderer)));
    for (name, layer) in LAYERS.into_iter().filter(|(_, layer)| layers.contains(layer)) {
        renderer.draw(gpu, &canvas.picture(), &camera, layer, &mut Clock::off())?;
        film.save(gpu, &folder.join(format!("{}-{name}.png", room.scene.name)))?;
    }
    Ok(())
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
