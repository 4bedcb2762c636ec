//! The window: sliders for the fur, and a camera to fly with.

use std::error::Error;

use casca_fur::gpu::records::{DrawList, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_scenes::world::Camera;
use casca_stage::canvas::Target;
use casca_stage::dial::Dials;
use casca_stage::fly::Fly;
use casca_stage::gpu::{DEPTH, Gpu};
use casca_stage::report::Report;
use casca_stage::wgpu::{self, util::TextureBlitter};
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::fur::choices::{Choices, Subject};
use crate::fur::field::{Stage, camera_at};
use crate::fur::one;

/// Units or radii that the camera flies in a second.
const SPEED: f32 = 1.5;

const KEYS: &str = "W A S D, E Q: fly   mouse button: look\nP: walk   H: hides this   Esc: close";
/// The window.
pub fn start(choices: Choices, subject: Subject) -> Start {
    let title = match choices.field {
        Some(count) => format!("{count} animals - casca fur"),
        None => format!("{} - casca fur", subject.name),
    };
    Start::new(title, |screen| Viewer::new(screen, choices, subject))
}

/// What is shown.
enum Shown {
    One(Subject, Box<Renderer>),
    Many(Box<Stage>),
}

struct Viewer {
    choices: Choices,
    shown: Shown,
    fly: Fly,
    culled: bool,
    walking: bool,
    time: f64,
    /// The level of detail that was drawn last, of one object.
    level: u32,
    large: Option<(Target, TextureBlitter)>,
    /// The shadow map, and the eye that it was drawn for.
    sun: Option<(Sun, Vec3)>,
    milliseconds: f64,
    counts: (usize, usize),
}

impl Viewer {
    fn new(screen: &Screen, choices: Choices, subject: Subject) -> Result<Self, Box<dyn Error>> {
        let (gpu, format) = (&screen.gpu, screen.format());
        let (shown, camera) = match choices.field {
            Some(_) => {
                let stage = Stage::new(gpu, format, &choices)?;
                let camera = camera_at(&stage.field, 0.3, screen.aspect());
                (Shown::Many(Box::new(stage)), camera)
            }
            None => {
                let renderer = one::renderer(gpu, format, &choices, &subject)?;
                let camera = one::camera(subject.radius, screen.aspect());
                (Shown::One(subject, Box::new(renderer)), camera)
            }
        };
        Ok(Self {
            fly: Fly::new(camera.eye, -camera.view.row(2).truncate()),
            culled: true,
            walking: choices.walk,
            choices,
            shown,
            time: 0.0,
            level: 0,
            large: None,
            sun: None,
            milliseconds: 0.0,
            counts: (0, 0),
        })
    }

    /// The size of things.
    fn radius(&self) -> f32 {
        if let Shown::One(subject, _) = &self.shown { subject.radius } else { 1.0 }
    }

    fn camera(&self, aspect: f32) -> Camera {
        let r = self.radius();
        let far = if let Shown::Many(stage) = &self.shown {
            stage.field.ground().max.length() * 2.0
        } else {
            40.0 * r
        };
        Camera::look_at(self.fly.eye, self.fly.eye + self.fly.forward(), 55.0, aspect, 0.02 * r, far)
    }

    /// Draws the fur and all around it.
    fn picture(&mut self, gpu: &Gpu, target: &Target, camera: &Camera) -> Result<(), Box<dyn Error>> {
        let radius = self.radius();
        let (list, counts): (DrawList, (usize, usize));
        match &mut self.shown {
            Shown::One(subject, renderer) => {
                let level = one::level_at(subject, camera, target.size());
                if level != self.level {
                    // A level casts its own shadow.
                    (self.level, self.sun) = (level, None);
                }
                list = one::level_list(subject, level, self.choices.layers, self.time)?;
                counts = (1, list.shells());
                if self.sun.is_none() {
                    let sun = one::sun(radius);
                    renderer.cast_shadows(gpu, &list, &sun)?;
                    self.sun = Some((sun, camera.eye));
                }
                let Some((sun, _)) = &self.sun else { return Ok(()) };
                renderer.draw(gpu, target, camera, &list, sun)?;
            }
            Shown::Many(stage) => {
                if self.sun.is_none_or(|(_, eye)| eye.distance(camera.eye) > 1.0) {
                    self.sun = Some((stage.cast_shadows(gpu, camera)?, camera.eye));
                }
                let Some((sun, _)) = &self.sun else { return Ok(()) };
                let (list, animals) = stage.look(camera, self.culled, self.choices.layers)?;
                counts = (animals, list.shells());
                stage.renderer.draw(gpu, target, camera, &list, sun)?;
            }
        }
        self.counts = counts;
        Ok(())
    }

    /// Takes over what sliders changed; values that do not go together are left as they were.
    fn change(&mut self, gpu: &Gpu, old: Choices) -> Result<(), Box<dyn Error>> {
        let choices = &self.choices;
        let changed = match &mut self.shown {
            Shown::One(subject, renderer) => {
                choices.look(subject.radius).map(|look| renderer.set_look(gpu, &look)).is_ok()
            }
            // Made anew: the bounds of its animals hold the fur that they have.
            Shown::Many(stage) => {
                let made = Stage::new(gpu, stage.renderer.format(), choices);
                made.map(|made| **stage = made).is_ok()
            }
        };
        if !changed {
            self.choices = old;
        }
        self.sun = None;
        Ok(())
    }

    fn line(&self) -> String {
        let (animals, shells) = self.counts;
        let level = match &self.shown {
            Shown::One(..) => format!(", level of detail {}", self.level),
            Shown::Many(_) => String::new(),
        };
        format!("{:.1} ms   {animals} objects, {shells} shells{level}", self.milliseconds)
    }
}

impl Demo for Viewer {
    /// A field is made anew when the dial is let go.
    fn dials(&mut self, dials: &mut Dials, screen: &Screen) -> Done {
        let (old, choices) = (self.choices.clone(), &mut self.choices);
        if dials.whole("layers", &mut choices.layers, 0..=96, 1) {
            self.sun = None;
        }
        let is_other = dials.number("height", &mut choices.height, 0.0..=0.3)
            | dials.number("density", &mut choices.density, 0.02..=1.0)
            | dials.number("thickness", &mut choices.thickness, 0.004..=0.05)
            | dials.number("bend", &mut choices.bend, 0.0..=2.0)
            | dials.number("clump", &mut choices.clump, 0.0..=1.0)
            | dials.number("curl", &mut choices.curl, 0.0..=1.0);
        if !matches!(&self.shown, Shown::One(subject, _) if subject.walker.is_none()) {
            dials.switch("walk (P)", Some(KeyCode::KeyP), &mut self.walking);
        }
        if matches!(self.shown, Shown::Many(_)) {
            dials.switch("culled by casca", None, &mut self.culled);
            if is_other && dials.is_held() {
                return Ok(());
            }
        }
        if is_other { self.change(&screen.gpu, old) } else { Ok(()) }
    }

    fn turn(&mut self, x: f32, y: f32, _: &Screen) {
        self.fly.turn(x, y);
    }

    fn resize(&mut self, _: &Screen) {
        self.large = None;
    }

    fn step(&mut self, seconds: f64, screen: &Screen) {
        self.fly.go(screen.way(seconds) * (SPEED * self.radius()));
        self.milliseconds = 0.9 * self.milliseconds + 0.1 * seconds * 1e3;
        if self.walking {
            self.time += seconds.min(0.1);
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let gpu = &screen.gpu;
        let camera = self.camera(screen.aspect());
        if self.walking {
            if let Shown::Many(stage) = &mut self.shown {
                stage.field.walk(self.time)?;
            }
            self.sun = None;
        }
        let (width, height) = screen.size();
        let fits = 2 * width.max(height) <= gpu.device.limits().max_texture_dimension_2d;
        // Strands are thinner than a pixel. A processor that draws has no time for this.
        if fits && gpu.adapter.get_info().device_type != wgpu::DeviceType::Cpu {
            let (large, blitter) = self.large.take().unwrap_or_else(|| twice(gpu, target));
            self.picture(gpu, &large, &camera)?;
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            blitter.copy(&gpu.device, &mut encoder, &large.colour, &target.colour);
            gpu.queue.submit([encoder.finish()]);
            self.large = Some((large, blitter));
        } else {
            self.picture(gpu, target, &camera)?;
        }
        Ok(())
    }

    fn report(&self, _: &Screen) -> Report {
        Report { lines: vec![self.line()], keys: KEYS, ..Report::default() }
    }
}

/// A target of twice the size, and what makes it smaller: the mean of four pixels.
fn twice(gpu: &Gpu, target: &Target) -> (Target, TextureBlitter) {
    let (width, height) = target.size();
    let format = target.colour.texture().format();
    let [colour, depth] = [format, DEPTH].map(|format| gpu.texture((2 * width, 2 * height), format));
    let blitter = wgpu::util::TextureBlitterBuilder::new(&gpu.device, format)
        .sample_type(wgpu::FilterMode::Linear)
        .build();
    (Target::new(&colour, &depth), blitter)
}
