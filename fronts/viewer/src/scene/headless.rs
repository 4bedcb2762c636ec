//! Pictures without a window.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::panel::Panel;
use casca_stage::report::Report;
use casca_stage::wgpu::Color;
use casca_tools::animation::write_animation;
use casca_tools::command_line::say;
use casca_tools::image::write_png;

use crate::common::Film;
use crate::scene::birds_eye::{above_scene, drawn, place_in};
use crate::scene::draw::Painter;
use crate::scene::options::{FRAMES, Options};
use crate::scene::overlays::{Layer, Overlays};
use crate::scene::panel;
use crate::scene::playback::{Method, Playback};
use crate::scene::renderer::Renderer;

/// For how long an animation shows each picture, in milliseconds.
const MILLISECONDS: u16 = 160;

/// How fast things fade: by about a fifth over the length of the scene.
pub fn haze(playback: &Playback) -> f32 {
    0.25 / (playback.world.grid.max - playback.world.grid.min).length().max(1e-3)
}

/// Draws the path of a scene into PNG files, each frame checked by an item buffer; returns how many
/// visible objects were lost, over all pictures.
pub fn pictures(
    gpu: &Gpu,
    playback: &mut Playback,
    options: &Options,
    folder: &Path,
) -> Result<usize, Box<dyn Error>> {
    let (is_above, method) = (options.birds_eye, options.method);
    let mut overlays = Overlays::default();
    // From above, edges of the frustum in the air would only confuse.
    overlays.is_frustum_flat = is_above;
    options.layers.iter().for_each(|&layer| overlays.on[layer as usize] = true);
    overlays.on[Layer::Frustum as usize] |= is_above;
    let mut renderer = Renderer::new(gpu, COLOUR, &playback.geometry);
    if is_above {
        renderer.sky = Color::WHITE;
    } else {
        renderer.haze = haze(playback);
    }
    // From above, everything is small: pictures are drawn at twice the size, for smooth edges.
    let film = Film::new(gpu, options.common.size, is_above);
    let (mut panel, canvas) = (Panel::new(gpu, COLOUR), &film.canvas);
    let scale = (canvas.size().0 / film.size().0) as f32;
    let name = playback.world.name.clone();
    let last = playback.world.frames.saturating_sub(1);
    let (mut lost, mut strip) = (0, Vec::new());
    let frames = if options.at.is_some() { 1 } else { options.common.frames.unwrap_or(FRAMES) as usize };
    for picture in 0..frames {
        let at = options.at.map_or(last * (picture * 2 + 1) / (frames * 2), |at| at as usize);
        while playback.ticks < at {
            let camera = playback.path_camera(canvas.aspect());
            playback.frame(method, &camera, &mut |_| Ok(()))?;
            playback.ticks += 1;
        }
        let camera = playback.path_camera(canvas.aspect());
        playback.frame(method, &camera, &mut |frame| {
            let mut painter = Painter { gpu, canvas, renderer: &mut renderer };
            let check = painter.check(&frame.camera, (frame.geometry, frame.objects), &frame.visible)?;
            lost += check.lost.len();
            let start = Instant::now();
            let watcher = if is_above { above_scene(frame.level, canvas.aspect()) } else { frame.camera };
            let (list, mut marks, legend) = drawn(&frame, &mut overlays, (&watcher, is_above), &check.lost)?;
            marks.lines.iter_mut().for_each(|line| line.width *= scale);
            painter.picture(&watcher, &list, &marks);
            gpu.wait()?;
            let (target, shown, all) = (canvas.picture(), frame.visible.len(), frame.objects.len());
            let over = (gpu, &target, scale);
            if is_above {
                let who = match method {
                    Method::Point | Method::Cell => "casca",
                    Method::Frustum => "the frustum",
                    Method::All => "no culling",
                };
                let title = format!("{name}: {who} draws {shown} of {all} objects");
                panel::caption(&mut panel, over, &title, &legend, place_in(&watcher, frame.camera.eye));
            } else if !options.bare {
                let device = (&*gpu.name, start.elapsed());
                let lines = panel::numbers((&name, method), &frame, device, Some(&check));
                let report = Report { lines, legend, ..Report::default() };
                panel::draw(&mut panel, over, None, Some(&report));
            }
            let path = folder.join(format!("{name}-{at:04}-{method}.png"));
            let pixels = film.read(gpu)?;
            write_png(&path, film.size(), &pixels)?;
            say(format_args!(
                "{}: {shown} of {all} objects drawn, {} visible in pixels, {} lost",
                path.display(),
                check.shown.len(),
                check.lost.len()
            ));
            if options.animation {
                strip.push(pixels);
            }
            Ok(())
        })?;
    }
    if options.animation {
        let path = folder.join(format!("{name}-{method}-animation.png"));
        write_animation(&path, film.size(), &strip, MILLISECONDS)?;
        say(format_args!("{}: {} pictures", path.display(), strip.len()));
    }
    Ok(lost)
}
