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
use crate::scene::draw::{Check, Painter};
use crate::scene::options::{FRAMES, Options};
use crate::scene::overlays::{Layer, Overlays};
use crate::scene::panel;
use crate::scene::playback::{Frame, Method, Playback};
use crate::scene::renderer::Renderer;

/// For how long an animation shows each picture, in milliseconds.
const MILLISECONDS: u16 = 160;

/// Draws the path of a scene into PNG files; returns how many visible objects were lost, over all
/// pictures.
///
/// # Errors
/// What is drawn cannot be had or written.
pub fn pictures(
    gpu: &Gpu,
    playback: &mut Playback,
    options: &Options,
    folder: &Path,
) -> Result<usize, Box<dyn Error>> {
    let mut studio = Studio::new(gpu, playback, options);
    let name = playback.world.name.clone();
    let last = playback.world.frames.saturating_sub(1);
    let (mut lost, mut strip) = (0, Vec::new());
    let frames = if options.at.is_some() { 1 } else { options.common.frames.unwrap_or(FRAMES) as usize };
    for picture in 0..frames {
        let at = options.at.map_or(last * (picture * 2 + 1) / (frames * 2), |at| at as usize);
        let aspect = studio.film.canvas.aspect();
        while playback.ticks < at {
            let camera = playback.path_camera(aspect);
            playback.frame(options.method, &camera, &mut |_| Ok(()))?;
            playback.ticks += 1;
        }
        let camera = playback.path_camera(aspect);
        playback.frame(options.method, &camera, &mut |frame| {
            let check = studio.draw(&name, &frame)?;
            lost += check.lost.len();
            let path = folder.join(format!("{name}-{at:04}-{}.png", options.method));
            let pixels = studio.film.read(gpu)?;
            write_png(&path, studio.film.size(), &pixels)?;
            say(format_args!(
                "{}: {} of {} objects drawn, {} visible in pixels, {} lost",
                path.display(),
                frame.visible.len(),
                frame.objects.len(),
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
        let path = folder.join(format!("{name}-{}-animation.png", options.method));
        write_animation(&path, studio.film.size(), &strip, MILLISECONDS)?;
        say(format_args!("{}: {} pictures", path.display(), strip.len()));
    }
    Ok(lost)
}

/// How fast things fade: by about a fifth over the length of the scene.
pub fn haze(playback: &Playback) -> f32 {
    0.25 / (playback.world.grid.max - playback.world.grid.min).length().max(1e-3)
}

/// All that pictures are drawn with.
struct Studio<'a> {
    gpu: &'a Gpu,
    options: &'a Options,
    film: Film,
    renderer: Renderer,
    panel: Panel,
    overlays: Overlays,
}

impl<'a> Studio<'a> {
    fn new(gpu: &'a Gpu, playback: &Playback, options: &'a Options) -> Self {
        let mut overlays = Overlays::default();
        // From above, edges of the frustum in the air would only confuse.
        overlays.is_frustum_flat = options.birds_eye;
        options.layers.iter().for_each(|&layer| overlays.on[layer as usize] = true);
        overlays.on[Layer::Frustum as usize] |= options.birds_eye;
        let mut renderer = Renderer::new(gpu, COLOUR, &playback.geometry);
        if options.birds_eye {
            renderer.sky = Color::WHITE;
        } else {
            renderer.haze = haze(playback);
        }
        // From above, everything is small: pictures are drawn at twice the size, for smooth edges.
        let film = Film::new(gpu, options.common.size, options.birds_eye);
        Self { gpu, options, film, renderer, panel: Panel::new(gpu, COLOUR), overlays }
    }

    /// Draws a frame, checked by an item buffer.
    fn draw(&mut self, scene: &str, frame: &Frame<'_>) -> Result<Check, Box<dyn Error>> {
        let Self { gpu, options, film, renderer, panel, overlays } = self;
        let mut painter = Painter { gpu, canvas: &film.canvas, renderer };
        let check = painter.check(&frame.camera, (frame.geometry, frame.objects), &frame.visible)?;
        let start = Instant::now();
        let (grid, is_above) = (frame.scene.grid(), options.birds_eye);
        let watcher =
            if is_above { above_scene((grid.min(), grid.max()), film.canvas.aspect()) } else { frame.camera };
        let (list, mut marks, legend) = drawn(frame, overlays, (&watcher, is_above), &check.lost)?;
        let scale = (film.canvas.size().0 / film.size().0) as f32;
        marks.lines.iter_mut().for_each(|line| line.width *= scale);
        painter.picture(&watcher, &list, &marks);
        gpu.wait()?;
        let target = film.canvas.picture();
        if is_above {
            let who = match options.method {
                Method::Point | Method::Cell => "casca",
                Method::Frustum => "the frustum",
                Method::All => "no culling",
            };
            let title =
                format!("{scene}: {who} draws {} of {} objects", frame.visible.len(), frame.objects.len());
            let eye = place_in(&watcher, frame.camera.eye);
            panel::caption(panel, (gpu, &target, scale), &title, &legend, eye);
        } else if !options.bare {
            let (name, drawing) = ((scene, options.method), (&*gpu.name, start.elapsed()));
            let lines = panel::numbers(name, frame, drawing, Some(&check));
            let report = Report { lines, legend, ..Report::default() };
            panel::draw(panel, (gpu, &target, scale), None, Some(&report));
        }
        Ok(check)
    }
}
