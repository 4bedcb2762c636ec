//! The window: sliders for the fur, and a camera to fly with.

use std::error::Error;

use crate::fur::herd::{Demand, Way, camera_at};
use casca_fur::gpu::records::{DrawList, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_scenes::world::Camera;
use casca_stage::canvas::Target;
use casca_stage::dial::Dial;
use casca_stage::fly::Fly;
use casca_stage::gpu::{DEPTH, Gpu};
use casca_stage::report::Report;
use casca_stage::wgpu::{self, util::TextureBlitter};
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::fur::choices::{Choices, Subject};
use crate::fur::field::Stage;
use crate::fur::one;

/// Units or radii that the camera flies in a second.
const SPEED: f32 = 1.5;

const KEYS: &str = "W A S D, E Q: fly   mouse button: look\nP: walk   H: hides this   Esc: close";
/// Names of dials.
const LAYERS: &str = "layers";
const HEIGHT: &str = "height";
const DENSITY: &str = "density";
const THICKNESS: &str = "thickness";
const BEND: &str = "bend";
const PLAIN: &str = "plain shells, as in the thesis";
const SMOOTH: &str = "smooth: twice the size";
const WALKING: &str = "walk (P)";
const CULLED: &str = "culled by";
const BUDGET: &str = "budget";

/// The window.
pub fn start(choices: Choices, subject: Subject) -> Start {
    let title = match choices.field {
        Some(count) if subject.species.is_some() => format!("{count} of {} - casca fur", subject.name),
        Some(count) => format!("{count} animals - casca fur"),
        None => format!("{} - casca fur", subject.name),
    };
    Start::new(title, |screen| Viewer::new(screen, choices, subject))
}

/// What is shown.
enum Shown {
    One(Subject, Box<Renderer>),
    Many(Subject, Box<Stage>),
}

struct Viewer {
    choices: Choices,
    shown: Shown,
    fly: Fly,
    way: Way,
    walking: bool,
    time: f64,
    /// The level of detail that was drawn last, of one object.
    level: u32,
    /// Draws at twice the size.
    smooth: bool,
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
            Some(count) => {
                let stage = Stage::new(gpu, format, &choices, &subject, count, choices.walk)?;
                let camera = camera_at(&stage.herd.field, 0.3, screen.aspect());
                (Shown::Many(subject, Box::new(stage)), camera)
            }
            None => {
                let renderer = one::renderer(gpu, format, &choices, &subject)?;
                let camera = one::camera(subject.radius, screen.aspect());
                (Shown::One(subject, Box::new(renderer)), camera)
            }
        };
        Ok(Self {
            fly: Fly::new(camera.eye, -camera.view.row(2).truncate()),
            way: if choices.field.is_some() { Way::Visible } else { Way::All },
            smooth: gpu.adapter.get_info().device_type != wgpu::DeviceType::Cpu,
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
        let far = if let Shown::Many(_, stage) = &self.shown {
            stage.herd.field.ground().max.length() * 2.0
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
                let by_distance = || one::level_at(subject, camera, target.size());
                let level = self.choices.level.unwrap_or_else(by_distance);
                if level != self.level {
                    // A level casts its own shadow.
                    (self.level, self.sun) = (level, None);
                }
                let mut made = one::level_list(subject, level, self.choices.layers);
                if let Some(walker) = &subject.walker {
                    walker.pose(&mut made, self.time)?;
                }
                list = made;
                counts = (1, list.shells());
                if self.sun.is_none() {
                    let sun = one::sun(radius);
                    renderer.cast_shadows(gpu, &list, &sun)?;
                    self.sun = Some((sun, camera.eye));
                }
                let Some((sun, _)) = &self.sun else { return Ok(()) };
                renderer.draw(gpu, target, camera, &list, sun)?;
            }
            Shown::Many(_, stage) => {
                if self.sun.is_none_or(|(_, eye)| eye.distance(camera.eye) > 1.0) {
                    self.sun = Some((stage.cast_shadows(gpu, camera)?, camera.eye));
                }
                let Some((sun, _)) = &self.sun else { return Ok(()) };
                let demand = Demand {
                    way: self.way,
                    layers: self.choices.layers,
                    budget: f64::from(self.choices.budget),
                    height: target.size().1,
                };
                let drawn = stage.herd.look(camera, &demand)?;
                counts = (drawn.animals, drawn.list.shells());
                stage.renderer.draw(gpu, target, camera, &drawn.list, sun)?;
            }
        }
        self.counts = counts;
        Ok(())
    }

    /// Takes over what sliders changed; values that do not go together are left as they were.
    fn change(&mut self, gpu: &Gpu, old: Choices) -> Result<(), Box<dyn Error>> {
        let radius = match &self.shown {
            Shown::One(subject, _) => subject.radius,
            // As the field was made: bounds hold for its fur only.
            Shown::Many(..) => return self.rebuild(gpu, old),
        };
        let Ok(look) = self.choices.look(radius) else {
            self.choices = old;
            return Ok(());
        };
        if let Shown::One(_, renderer) = &mut self.shown {
            renderer.set_look(gpu, &look);
        }
        self.sun = None;
        Ok(())
    }

    /// Makes the field anew: the bounds of its animals hold the fur that they have.
    fn rebuild(&mut self, gpu: &Gpu, old: Choices) -> Result<(), Box<dyn Error>> {
        let (Shown::Many(subject, stage), Some(count)) = (&mut self.shown, self.choices.field) else {
            return Ok(());
        };
        let format = stage.renderer.format();
        match Stage::new(gpu, format, &self.choices, subject, count, self.choices.walk) {
            Ok(made) => **stage = made,
            Err(_) => self.choices = old,
        }
        self.sun = None;
        Ok(())
    }

    fn line(&self) -> String {
        let (animals, shells) = self.counts;
        let level = match &self.shown {
            Shown::One(..) => format!(", level of detail {}", self.level),
            Shown::Many(..) => String::new(),
        };
        format!("{:.1} ms   {animals} objects, {shells} shells{level}", self.milliseconds)
    }

    fn dials(&self) -> Vec<Dial> {
        let choices = &self.choices;
        let mut dials = vec![
            Dial::number(LAYERS, choices.layers, 0.0..=96.0, 1.0),
            Dial::number(HEIGHT, choices.height, 0.0..=0.3, 0.0),
            Dial::number(DENSITY, choices.density, 0.02..=1.0, 0.0),
            Dial::number(THICKNESS, choices.thickness, 0.004..=0.05, 0.0),
            Dial::number(BEND, choices.bend, 0.0..=2.0, 0.0),
            Dial::switch(PLAIN, choices.plain),
            Dial::switch(SMOOTH, self.smooth),
        ];
        if matches!(self.shown, Shown::Many(..)) {
            dials.push(Dial::switch(WALKING, self.walking));
            let way = Way::EVERY.iter().position(|way| *way == self.way);
            dials.push(Dial::choice(CULLED, Way::EVERY.map(Way::name), way.unwrap_or(0)));
            dials.push(Dial::number(BUDGET, choices.budget, 0.05..=1.0, 0.0));
        }
        dials
    }
}

impl Demo for Viewer {
    fn press(&mut self, key: KeyCode, _: &Screen) -> Done {
        self.walking ^= key == KeyCode::KeyP;
        Ok(())
    }

    fn turn(&mut self, x: f32, y: f32, _: &Screen) {
        self.fly.turn(x, y);
    }

    fn resize(&mut self, _: &Screen) {
        self.large = None;
    }

    fn step(&mut self, seconds: f64, screen: &Screen) {
        self.fly.go(screen.way() * (SPEED * self.radius() * seconds.min(0.1) as f32));
        self.milliseconds = 0.9 * self.milliseconds + 0.1 * seconds * 1e3;
        if self.walking {
            self.time += seconds.min(0.1);
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let gpu = &screen.gpu;
        let camera = self.camera(screen.aspect());
        if self.walking {
            if let Shown::Many(_, stage) = &mut self.shown {
                stage.herd.walk(self.time)?;
            }
            self.sun = None;
        }
        let (width, height) = screen.size();
        let fits = 2 * width.max(height) <= gpu.device.limits().max_texture_dimension_2d;
        if self.smooth && fits {
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
        Report { lines: vec![self.line()], legend: Vec::new(), dials: self.dials(), keys: KEYS }
    }

    /// A field is made anew when the dial is let go.
    fn set(&mut self, dial: &str, value: f64, is_held: bool, screen: &Screen) -> Done {
        let old = self.choices.clone();
        let (on, choices) = (value != 0.0, &mut self.choices);
        match dial {
            LAYERS => {
                choices.layers = value as u32;
                self.sun = None;
                return Ok(());
            }
            SMOOTH => self.smooth = on,
            WALKING => self.walking = on,
            CULLED => self.way = Way::EVERY.get(value as usize).copied().unwrap_or(self.way),
            BUDGET => choices.budget = value as f32,
            HEIGHT => choices.height = value as f32,
            DENSITY => choices.density = value as f32,
            THICKNESS => choices.thickness = value as f32,
            BEND => choices.bend = value as f32,
            PLAIN => choices.plain = on,
            _ => {}
        }
        let is_fur = [HEIGHT, DENSITY, THICKNESS, BEND, PLAIN].contains(&dial);
        let waits = is_held && matches!(self.shown, Shown::Many(..));
        if is_fur && !waits { self.change(&screen.gpu, old) } else { Ok(()) }
    }
}

/// A target of twice the size, and what makes it smaller: the mean of four pixels.
fn twice(gpu: &Gpu, target: &Target) -> (Target, TextureBlitter) {
    let (width, height) = target.size();
    let format = target.colour.texture().format();
    let size = wgpu::Extent3d { width: 2 * width, height: 2 * height, depth_or_array_layers: 1 };
    let colour = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("twice the size"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let blitter = wgpu::util::TextureBlitterBuilder::new(&gpu.device, format)
        .sample_type(wgpu::FilterMode::Linear)
        .build();
    (Target::new(&colour, &gpu.texture((2 * width, 2 * height), DEPTH)), blitter)
}
