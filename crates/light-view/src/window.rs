//! The window: a camera to fly with, and keys for lights, layers and settings.

use std::error::Error;
use std::time::Instant;

use casca_lab::lit::Light;
use casca_lab::world::Camera;
use casca_light::cones::ConeCount;
use casca_light::culling::{Culling, may_see};
use casca_light::picture::Layer;
use casca_light::renderer::{Renderer, Settings, Updated};
use casca_light::timing::Clock;
use casca_stage::canvas::Target;
use casca_stage::egui::{Align2, RichText};
use casca_stage::fly::{Fly, way};
use casca_stage::panel::{Panel, boxed};
use casca_stage::window::{Demo, Done, Screen, WindowOptions};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::headless::told;
use crate::options::Options;
use crate::scene::Start;

/// The share of the scene's length that the camera flies in a second.
const SPEED: f32 = 0.1;
/// Keys of the layers.
const LAYERS: [KeyCode; 7] = [
    KeyCode::Digit1,
    KeyCode::Digit2,
    KeyCode::Digit3,
    KeyCode::Digit4,
    KeyCode::Digit5,
    KeyCode::Digit6,
    KeyCode::Digit7,
];
/// Resolutions that a key goes through.
const RESOLUTIONS: [u32; 4] = [64, 128, 256, 512];
const HELP: &str = "W A S D Q E, right mouse button: fly
1-7: layers: picture, albedo, normals, direct, indirect, occlusion, voxels
N: cells    [ ]: cone step    , .: narrowest reflection    - =: exposure
K: 6 or 16 cones    B: second bounce    C: culling    Space: balls move
L: next light    O: that light on or off    Up, Down: its strength
H: this help";

/// Opens the window and stays until it is closed.
pub fn open(start: Start, options: &Options) -> Done {
    let title = format!("casca-light: {}", start.scene.name);
    let window = WindowOptions { title, size: options.size, software: options.software, frames: None };
    let (settings, exposure, cull) = (options.settings(), options.exposure, options.cull);
    casca_stage::window::open(&window, move |screen| Viewer::new(screen, start, settings, exposure, cull))
}

struct Viewer {
    start: Start,
    renderer: Renderer,
    culling: Culling,
    panel: Panel,
    fly: Fly,
    layer: Layer,
    cull: bool,
    moving: bool,
    seconds: f32,
    help: bool,
    /// The light that keys change, and which of them are on and how strong.
    light: usize,
    strengths: Vec<f32>,
    /// The last trouble with a setting, such as a resolution that the adapter cannot hold.
    trouble: String,
}

impl Viewer {
    fn new(
        screen: &Screen,
        start: Start,
        settings: Settings,
        exposure: f32,
        cull: bool,
    ) -> Result<Self, Box<dyn Error>> {
        let mut renderer = Renderer::new(&screen.gpu, &start.scene, settings)?;
        renderer.exposure = exposure;
        let camera = start.scene.camera;
        Ok(Self {
            culling: Culling::new(&start.scene, renderer.volume())?,
            renderer,
            panel: Panel::new(&screen.gpu, screen.format()),
            fly: Fly::new(camera.eye, -camera.view.row(2).truncate()),
            layer: Layer::Picture,
            cull,
            moving: true,
            seconds: 0.0,
            help: true,
            light: 0,
            strengths: vec![1.0; start.scene.lights.len()],
            trouble: String::new(),
            start,
        })
    }

    fn camera(&self, aspect: f32) -> Camera {
        self.start.looking(self.fly.eye, self.fly.eye + self.fly.forward(), aspect)
    }

    fn set(&mut self, screen: &Screen, settings: Settings) {
        let set = self.renderer.set_settings(&screen.gpu, settings);
        self.trouble = set.err().map_or(String::new(), |e| e.to_string());
    }

    /// Another resolution: all voxels are made again. If the adapter cannot hold them, the old ones stay.
    fn next_resolution(&mut self, screen: &Screen) -> Done {
        let settings = *self.renderer.settings();
        let next = RESOLUTIONS.into_iter().find(|&n| n > settings.resolution).unwrap_or(RESOLUTIONS[0]);
        for (object, place) in self.start.balls_at(self.seconds).collect::<Vec<_>>() {
            self.start.scene.objects[object].transform = place;
        }
        match Renderer::new(&screen.gpu, &self.start.scene, Settings { resolution: next, ..settings }) {
            Ok(new) => {
                let exposure = std::mem::replace(&mut self.renderer, new).exposure;
                self.renderer.exposure = exposure;
                self.culling = Culling::new(&self.start.scene, self.renderer.volume())?;
                self.set_lights(screen)?;
                self.trouble.clear();
            }
            Err(why) => self.trouble = why.to_string(),
        }
        Ok(())
    }

    fn set_lights(&mut self, screen: &Screen) -> Done {
        let scaled = |(l, s): (&Light, &f32)| Light { color: l.color * *s, ..*l };
        let lights: Vec<Light> = self.start.scene.lights.iter().zip(&self.strengths).map(scaled).collect();
        Ok(self.renderer.set_lights(&screen.gpu, &lights)?)
    }

    fn show(&mut self, screen: &Screen, target: &Target, updated: &Updated, milliseconds: f64) {
        let settings = self.renderer.settings();
        let numbers = told(&self.renderer, updated);
        let light = match self.strengths.get(self.light) {
            Some(strength) => format!("light {} of {}: x{strength:.2}", self.light + 1, self.strengths.len()),
            None => "no lights but surfaces that emit".to_owned(),
        };
        let lines = [
            format!("{} on {}: {milliseconds:.0} ms a frame", self.layer.name(), screen.gpu.name),
            numbers,
            format!(
                "step {:.2} texels, reflections from {:.1} degrees, {} cones, bounce {}, culling {}, exposure {:.2}",
                settings.step,
                settings.aperture.atan().to_degrees(),
                settings.cones.cones().len(),
                on_or_off(settings.bounce),
                on_or_off(self.cull),
                self.renderer.exposure
            ),
            light,
        ];
        let (help, trouble) = (self.help, &self.trouble);
        self.panel.draw(&screen.gpu, target, screen.scale(), &|context| {
            boxed(context, "numbers", Align2::LEFT_TOP, [10.0, 10.0], &mut |ui| {
                lines.iter().for_each(|line| {
                    ui.label(line);
                });
                if !trouble.is_empty() {
                    ui.label(RichText::new(trouble).strong());
                }
            });
            if help {
                boxed(context, "help", Align2::LEFT_BOTTOM, [10.0, -10.0], &mut |ui| {
                    ui.label(HELP);
                });
            }
        });
    }
}

fn on_or_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

impl Demo for Viewer {
    fn press(&mut self, key: KeyCode, screen: &Screen) -> Done {
        let old = *self.renderer.settings();
        let more = |value: f32, factor: f32, (low, high): (f32, f32)| (value * factor).clamp(low, high);
        match key {
            KeyCode::KeyN => return self.next_resolution(screen),
            KeyCode::BracketLeft => {
                self.set(screen, Settings { step: more(old.step, 0.8, (0.1, 5.0)), ..old })
            }
            KeyCode::BracketRight => {
                self.set(screen, Settings { step: more(old.step, 1.25, (0.1, 5.0)), ..old })
            }
            KeyCode::Comma => {
                self.set(screen, Settings { aperture: more(old.aperture, 0.8, (0.001, 1.0)), ..old })
            }
            KeyCode::Period => {
                self.set(screen, Settings { aperture: more(old.aperture, 1.25, (0.001, 1.0)), ..old })
            }
            KeyCode::Minus => self.renderer.exposure *= 0.8,
            KeyCode::Equal => self.renderer.exposure *= 1.25,
            KeyCode::KeyK => {
                let cones = if old.cones == ConeCount::Six { ConeCount::Sixteen } else { ConeCount::Six };
                self.set(screen, Settings { cones, ..old });
            }
            KeyCode::KeyB => self.set(screen, Settings { bounce: !old.bounce, ..old }),
            KeyCode::KeyC => self.cull ^= true,
            KeyCode::Space => self.moving ^= true,
            KeyCode::KeyH => self.help ^= true,
            KeyCode::KeyL => self.light = (self.light + 1) % self.strengths.len().max(1),
            KeyCode::KeyO | KeyCode::ArrowUp | KeyCode::ArrowDown => {
                if let Some(strength) = self.strengths.get_mut(self.light) {
                    *strength = match key {
                        KeyCode::ArrowUp => *strength * 1.25,
                        KeyCode::ArrowDown => *strength * 0.8,
                        _ if *strength > 0.0 => 0.0,
                        _ => 1.0,
                    };
                    return self.set_lights(screen);
                }
            }
            _ => {
                if let Some(layer) = LAYERS.iter().position(|k| *k == key) {
                    self.layer = Layer::EVERY[layer];
                }
            }
        }
        Ok(())
    }

    fn turn(&mut self, x: f32, y: f32, _: &Screen) {
        self.fly.turn(x, y);
    }

    fn resize(&mut self, _: &Screen) {}

    fn step(&mut self, seconds: f64, screen: &Screen) {
        let seconds = seconds.min(0.1) as f32;
        let (min, max) = self.start.bounds;
        let way = way(&screen.keys) * (SPEED * (max - min).length() * seconds);
        if way != Vec3::ZERO {
            self.fly.go(way);
        }
        if self.moving {
            self.seconds += seconds;
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let (gpu, start) = (&screen.gpu, Instant::now());
        let camera = self.camera(screen.aspect());
        if self.moving {
            for (ball, place) in self.start.balls_at(self.seconds) {
                self.renderer.move_object(gpu, ball, place)?;
                self.culling.move_object(ball, place)?;
            }
        }
        let reach = match self.cull {
            true => self.culling.look(&camera)?.map(|sight| self.renderer.reach(&|b| may_see(&sight, b))),
            false => None,
        };
        let updated = self.renderer.update(gpu, reach.as_ref(), &mut Clock::off())?;
        self.renderer.draw(gpu, target, &camera, self.layer, &mut Clock::off())?;
        gpu.wait()?;
        self.show(screen, target, &updated, start.elapsed().as_secs_f64() * 1e3);
        Ok(())
    }
}
