//! Pictures without a window.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use casca::internals::QueryInternals;
use casca_scenes::world::Camera;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::panel::Panel;
use casca_stage::report::Report;
use casca_stage::wgpu::Color;
use casca_tools::animation::write_animation;
use casca_tools::command_line::{make_folder, say};
use casca_tools::image::{halved, write_png};

use crate::scene::birds_eye::{above_scene, from_above, place_in};
use crate::scene::draw::{Check, Painter, coloured};
use crate::scene::geometry::DrawList;
use crate::scene::legend;
use crate::scene::overlays::{Layer, Overlays};
use crate::scene::panel::{self, Numbers};
use crate::scene::playback::{Frame, Method, Playback};
use crate::scene::renderer::{Marks, Renderer};

/// For how long an animation shows each picture, in milliseconds.
const MILLISECONDS: u16 = 160;

/// What to draw.
pub struct Plan<'a> {
    /// How the scene is culled.
    pub method: Method,
    /// How many pictures of the path, evenly spread.
    pub frames: usize,
    /// The frame that all of them show instead.
    pub at: Option<usize>,
    /// Where they go.
    pub out: &'a Path,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Whether they show the whole scene from above.
    pub birds_eye: bool,
    /// Whether they are also written as one animation.
    pub animation: bool,
    /// Layers that are on.
    pub layers: &'a [Layer],
    /// Whether they are without numbers.
    pub bare: bool,
}

/// Draws the path of a scene into PNG files; returns how many visible objects were lost, over all
/// pictures.
///
/// # Errors
/// What is drawn cannot be had or written.
pub fn pictures(gpu: &Gpu, playback: &mut Playback, plan: &Plan<'_>) -> Result<usize, Box<dyn Error>> {
    make_folder(plan.out)?;
    let mut studio = Studio::new(gpu, playback, plan);
    let name = playback.world.name.clone();
    let last = playback.world.frames.saturating_sub(1);
    let (mut lost, mut strip) = (0, Vec::new());
    for picture in 0..plan.frames {
        let at = plan.at.unwrap_or(last * (picture * 2 + 1) / (plan.frames * 2).max(1));
        let aspect = studio.canvas.aspect();
        while playback.ticks() < at {
            let camera = playback.path_camera(aspect);
            playback.frame(plan.method, &camera, &mut |_| Ok(()))?;
            playback.advance();
        }
        let camera = playback.path_camera(aspect);
        playback.frame(plan.method, &camera, &mut |frame| {
            let check = studio.draw(&name, &frame)?;
            lost += check.lost.len();
            let path = plan.out.join(format!("{name}-{at:04}-{}.png", plan.method));
            let pixels = studio.read()?;
            write_png(&path, studio.size(), &pixels)?;
            say(format_args!(
                "{}: {} of {} objects drawn, {} visible in pixels, {} lost",
                path.display(),
                frame.visible.len(),
                frame.objects.len(),
                check.shown.len(),
                check.lost.len()
            ));
            if plan.animation {
                strip.push(pixels);
            }
            Ok(())
        })?;
    }
    if plan.animation {
        let path = plan.out.join(format!("{name}-{}-animation.png", plan.method));
        write_animation(&path, studio.size(), &strip, MILLISECONDS)?;
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
    plan: &'a Plan<'a>,
    canvas: Canvas,
    renderer: Renderer,
    panel: Panel,
    overlays: Overlays,
}

impl<'a> Studio<'a> {
    fn new(gpu: &'a Gpu, playback: &Playback, plan: &'a Plan<'a>) -> Self {
        let mut overlays = Overlays::default();
        // From above, edges of the frustum in the air would only confuse.
        overlays.is_frustum_flat = plan.birds_eye;
        plan.layers.iter().for_each(|&layer| overlays.toggle(layer));
        if plan.birds_eye && !overlays.is_on(Layer::Frustum) {
            overlays.toggle(Layer::Frustum);
        }
        let mut renderer = Renderer::new(gpu, COLOUR, &playback.geometry);
        if plan.birds_eye {
            renderer.sky = Color::WHITE;
        } else {
            renderer.haze = haze(playback);
        }
        // From above, everything is small: pictures are drawn at twice the size, for smooth edges.
        let factor = if plan.birds_eye { 2 } else { 1 };
        let canvas = Canvas::new(gpu, (plan.size.0 * factor, plan.size.1 * factor));
        Self { gpu, plan, canvas, renderer, panel: Panel::new(gpu, COLOUR), overlays }
    }

    /// Width and height of the pictures.
    fn size(&self) -> (u32, u32) {
        let (width, height) = self.canvas.size();
        if self.plan.birds_eye { (width / 2, height / 2) } else { (width, height) }
    }

    /// The picture drawn last.
    fn read(&self) -> Result<Vec<u8>, Box<dyn Error>> {
        let pixels = self.canvas.read_picture(self.gpu)?;
        Ok(if self.plan.birds_eye { halved(&pixels, self.canvas.size()) } else { pixels })
    }

    /// Draws a frame, checked by an item buffer.
    fn draw(&mut self, scene: &str, frame: &Frame<'_>) -> Result<Check, Box<dyn Error>> {
        let mut painter = Painter { gpu: self.gpu, canvas: &self.canvas, renderer: &mut self.renderer };
        let check = painter.check(&frame.camera, (frame.geometry, frame.objects), &frame.visible)?;
        let marks = self.overlays.marks(frame, &check.lost)?;
        if self.plan.birds_eye {
            self.draw_from_above(scene, frame, marks, &check.lost)?;
        } else {
            self.draw_from_the_eye(scene, frame, &marks, &check)?;
        }
        Ok(check)
    }

    fn draw_from_the_eye(
        &mut self,
        scene: &str,
        frame: &Frame<'_>,
        marks: &Marks,
        check: &Check,
    ) -> Result<(), Box<dyn Error>> {
        let start = Instant::now();
        let list = coloured(frame.geometry, frame.objects, &frame.visible);
        self.paint(&frame.camera, &list, marks);
        self.gpu.wait()?;
        if self.plan.bare {
            return Ok(());
        }
        let numbers = Numbers {
            scene,
            device: &self.gpu.name,
            method: self.plan.method,
            visible: (frame.visible.len(), frame.objects.len()),
            times: (frame.time, start.elapsed()),
            check: Some((check.shown.len(), check.lost.len())),
        };
        let legend = legend::of_marks(marks, &frame.camera);
        let report = Report { lines: numbers.lines(), legend, ..Report::default() };
        let images =
            if self.overlays.is_on(Layer::Buffers) { frame.query.occlusion_images() } else { Vec::new() };
        let target = (self.gpu, &self.canvas.picture(), 1.0);
        panel::draw(&mut self.panel, target, &images, None, Some(&report));
        Ok(())
    }

    fn draw_from_above(
        &mut self,
        scene: &str,
        frame: &Frame<'_>,
        mut marks: Marks,
        lost: &[usize],
    ) -> Result<(), Box<dyn Error>> {
        let grid = frame.scene.grid();
        let watcher = above_scene((grid.min(), grid.max()), self.canvas.aspect());
        let above = from_above(frame, &mut self.overlays, (&watcher, lost))?;
        marks.widen(2.0);
        self.paint(&watcher, &above.list, &marks);
        let mut legend = above.legend;
        legend::join(&mut legend, legend::of_marks(&marks, &watcher));
        let (drawn, all) = (frame.visible.len(), frame.objects.len());
        let who = match self.plan.method {
            Method::Point | Method::Cell => "casca",
            Method::Frustum => "the frustum",
            Method::All => "no culling",
        };
        let title = format!("{scene}: {who} draws {drawn} of {all} objects");
        let eye = place_in(&watcher, frame.camera.eye);
        let target = (self.gpu, &self.canvas.picture(), 2.0);
        panel::caption(&mut self.panel, target, &title, &legend, eye);
        Ok(())
    }

    fn paint(&mut self, watcher: &Camera, list: &DrawList, marks: &Marks) {
        let mut painter = Painter { gpu: self.gpu, canvas: &self.canvas, renderer: &mut self.renderer };
        painter.picture(watcher, list, marks);
    }
}
