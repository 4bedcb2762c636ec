//! The window: a camera to fly with, and sliders for lights, layers and settings.

use std::error::Error;
use std::time::Duration;

use casca_scenes::world::Camera;
use casca_stage::canvas::Target;
use casca_stage::fly::Fly;
use casca_stage::report::Report;
use casca_stage::timing::{Clock, Instant};
use casca_stage::window::{self, Demo, Done, Screen};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::light::controls::Controls;
use crate::light::headless::told;
use crate::light::layer::Layer;
use crate::light::options::Options;
use crate::light::renderer::{Renderer, Updated};
use crate::light::scene::Start;

/// The share of the scene's length that the camera flies in a second.
const SPEED: f32 = 0.1;
/// The processor's time for light in a frame.
const BUDGET: Duration = Duration::from_millis(40);
/// Keys of the layers.
const LAYERS: [KeyCode; 6] =
    [KeyCode::Digit1, KeyCode::Digit2, KeyCode::Digit3, KeyCode::Digit4, KeyCode::Digit5, KeyCode::Digit6];
const KEYS: &str = "W A S D Q E, a mouse button: fly   1-6: layers\nSpace: balls   H: hides all this";

/// The window.
pub fn start(start: Start, options: &Options) -> window::Start {
    let controls = Controls::new(options, &start.scene.lights, start.bounds);
    let title = format!("{} - casca light", start.scene.name);
    window::Start::new(title, move |screen| Viewer::new(screen, start, controls))
}

struct Viewer {
    start: Start,
    renderer: Renderer,
    fly: Fly,
    controls: Controls,
    seconds: f32,
    /// Why the last change of a setting was not made, such as a resolution that the adapter cannot
    /// hold.
    trouble: String,
    /// What the last frame had to say.
    said: Vec<String>,
}

impl Viewer {
    fn new(screen: &Screen, start: Start, controls: Controls) -> Result<Self, Box<dyn Error>> {
        let renderer = Renderer::new(&screen.gpu, &start.scene, controls.settings)?;
        let camera = start.scene.camera;
        Ok(Self {
            renderer,
            fly: Fly::new(camera.eye, -camera.view.row(2).truncate()),
            controls,
            seconds: 0.0,
            trouble: String::new(),
            said: Vec::new(),
            start,
        })
    }

    fn camera(&self, aspect: f32) -> Camera {
        self.start.looking(self.fly.eye, self.fly.eye + self.fly.forward(), aspect)
    }

    /// Does what the controls ask for. The cache is made again when a slider is let go.
    fn apply(&mut self, screen: &Screen, before: &Controls, is_held: bool) -> Done {
        if self.controls.settings != self.renderer.settings() && !is_held {
            return self.remake(screen);
        }
        if self.controls.lamps != before.lamps {
            let set = self.renderer.set_lights(&self.controls.lights());
            self.trouble = set.err().map_or(String::new(), |why| why.to_string());
        }
        Ok(())
    }

    /// Makes the cache again with other settings. If it cannot be made, the old one stays.
    fn remake(&mut self, screen: &Screen) -> Done {
        for (object, place) in self.start.balls_at(self.seconds).collect::<Vec<_>>() {
            self.start.scene.objects[object].transform = place;
        }
        self.start.scene.lights = self.controls.lights();
        match Renderer::new(&screen.gpu, &self.start.scene, self.controls.settings) {
            Ok(new) => {
                self.renderer = new;
                self.trouble.clear();
            }
            Err(why) => {
                self.trouble = why.to_string();
                self.controls.settings = self.renderer.settings();
                self.renderer.set_lights(&self.start.scene.lights)?;
            }
        }
        Ok(())
    }
}

/// How far the light is.
fn progress(updated: &Updated) -> String {
    match updated {
        Updated { settled: true, .. } => "light has settled".to_owned(),
        Updated { waiting, old, .. } => {
            format!("{waiting} surfaces in cells wait for rays, {old} for direct light")
        }
    }
}

impl Demo for Viewer {
    fn press(&mut self, key: KeyCode, _: &Screen) -> Done {
        match key {
            KeyCode::Space => self.controls.moving ^= true,
            _ => {
                if let Some(layer) = LAYERS.iter().position(|k| *k == key) {
                    self.controls.layer = Layer::EVERY[layer];
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
        let way = screen.way() * (SPEED * (max - min).length() * seconds);
        if way != Vec3::ZERO {
            self.fly.go(way);
        }
        if self.controls.moving {
            self.seconds += seconds;
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let (gpu, start) = (&screen.gpu, Instant::now());
        let camera = self.camera(screen.aspect());
        if self.controls.moving {
            let balls: Vec<_> = self.start.balls_at(self.seconds).collect();
            self.renderer.move_objects(gpu, &balls)?;
        }
        let view = (&camera, target.size());
        // What the adapter holds no more, such as too many rays, stays as it was.
        let updated = self.renderer.update(gpu, view, Some(BUDGET), &mut Clock::off());
        let updated = updated.unwrap_or_else(|why| {
            self.trouble = why.to_string();
            Updated::default()
        });
        self.renderer.exposure = self.controls.exposure;
        self.renderer.draw(gpu, target, &camera, self.controls.layer, &mut Clock::off())?;
        gpu.wait()?;
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        let numbers = [
            format!("{milliseconds:.0} ms a frame on {}", gpu.name),
            told(&self.renderer),
            progress(&updated),
        ];
        self.said = numbers.into();
        Ok(())
    }

    fn report(&self, _: &Screen) -> Report {
        let mut lines = self.said.clone();
        lines.extend(Some(self.trouble.clone()).filter(|why| !why.is_empty()));
        Report { lines, legend: Vec::new(), dials: self.controls.dials(), keys: KEYS }
    }

    fn set(&mut self, dial: &str, value: f64, is_held: bool, screen: &Screen) -> Done {
        let before = self.controls.clone();
        self.controls.set(dial, value);
        self.apply(screen, &before, is_held)
    }
}
