//! The window: a camera to fly with, and sliders for lights, layers and settings.

use std::error::Error;
use std::time::Duration;

use casca_radiosity::Light;
use casca_scenes::world::Camera;
use casca_stage::canvas::Target;
use casca_stage::dial::Dials;
use casca_stage::fly::Fly;
use casca_stage::report::Report;
use casca_stage::timing::{Clock, Instant};
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::light::headless::told;
use crate::light::options::{EXPOSURES, Options};
use crate::light::picture::LAYERS;
use crate::light::renderer::{Renderer, Settings, Updated};
use crate::light::scene::Room;

/// The share of the scene's length that the camera flies in a second.
const SPEED: f32 = 0.1;
/// The processor's time for light in a frame.
const BUDGET: Duration = Duration::from_millis(40);
/// Keys of the layers.
const KEYS: [KeyCode; 6] =
    [KeyCode::Digit1, KeyCode::Digit2, KeyCode::Digit3, KeyCode::Digit4, KeyCode::Digit5, KeyCode::Digit6];
const HELP: &str = "W A S D Q E, a mouse button: fly   1-6: layers\nSpace: balls   H: hides all this";

/// The strongest that a light can be made, as a factor.
const STRONGEST: f32 = 10.0;

/// The window.
pub fn start(room: Room, options: &Options) -> Start {
    let options = options.clone();
    Start::new(format!("{} - casca light", room.scene.name), move |screen| Viewer::new(screen, room, options))
}

/// A light, and how strong it is.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lamp {
    /// The light of the scene, where it was moved to.
    light: Light,
    /// A factor of its strength.
    strength: f32,
}

struct Viewer {
    room: Room,
    renderer: Renderer,
    fly: Fly,
    options: Options,
    lamps: Vec<Lamp>,
    /// The place of the layer that is shown.
    layer: usize,
    /// Whether the balls move.
    moving: bool,
    seconds: f32,
    /// Why the last change of a setting was not made, such as a resolution that the adapter cannot
    /// hold.
    trouble: String,
    /// What the last frame had to say.
    said: Vec<String>,
}

impl Viewer {
    fn new(screen: &Screen, room: Room, options: Options) -> Result<Self, Box<dyn Error>> {
        let camera = room.scene.camera;
        Ok(Self {
            renderer: Renderer::new(&screen.gpu, &room.scene, options.settings())?,
            fly: Fly::new(camera.eye, -camera.view.row(2).truncate()),
            lamps: room.scene.lights.iter().map(|&light| Lamp { light, strength: 1.0 }).collect(),
            layer: 0,
            moving: true,
            seconds: 0.0,
            trouble: String::new(),
            said: Vec::new(),
            options,
            room,
        })
    }

    /// The lights as they shine.
    fn lights(&self) -> Vec<Light> {
        self.lamps.iter().map(|lamp| lamp.light.scaled(lamp.strength)).collect()
    }

    fn camera(&self, aspect: f32) -> Camera {
        self.room.looking(self.fly.eye, self.fly.eye + self.fly.forward(), aspect)
    }

    /// Makes the cache again with other settings. If it cannot be made, the old one stays.
    fn remake(&mut self, screen: &Screen) -> Done {
        for (object, place) in self.room.balls_at(self.seconds).collect::<Vec<_>>() {
            self.room.scene.objects[object].transform = place;
        }
        self.room.scene.lights = self.lights();
        match Renderer::new(&screen.gpu, &self.room.scene, self.options.settings()) {
            Ok(new) => {
                self.renderer = new;
                self.trouble.clear();
            }
            Err(why) => {
                self.trouble = why.to_string();
                let Settings { resolution, rays, .. } = self.renderer.settings;
                (self.options.lighting.resolution, self.options.rays) = (resolution, rays);
                self.renderer.set_lights(&self.room.scene.lights)?;
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
    /// The cache is made again when a slider is let go.
    fn dials(&mut self, dials: &mut Dials, screen: &Screen) -> Done {
        dials.choice("layer", &KEYS, LAYERS.map(|(name, _)| name), &mut self.layer);
        let options = &mut self.options;
        let is_other = dials.whole("cells", &mut options.lighting.resolution, 16..=256, 8)
            | dials.whole("rays of a surface in a cell", &mut options.rays, 4..=512, 1);
        let (mut is_own, mut exposure) = (options.exposure.is_none(), options.exposure.unwrap_or(1.0));
        dials.switch("exposure by the picture", None, &mut is_own);
        if dials.number("exposure", &mut exposure, EXPOSURES) {
            is_own = false;
        }
        options.exposure = (!is_own).then_some(exposure);
        dials.switch("balls move (Space)", Some(KeyCode::Space), &mut self.moving);
        let (mut changed, (min, max)) = (false, self.room.bounds);
        for (number, lamp) in self.lamps.iter_mut().enumerate() {
            let name = format!("light {}", number + 1);
            changed |= dials.number(&format!("{name}, strength"), &mut lamp.strength, 0.0..=STRONGEST);
            let (what, vector, [low, high]) = match &mut lamp.light {
                Light::Sun { direction, .. } => ("along ", direction, [Vec3::NEG_ONE, Vec3::ONE]),
                Light::Point { position, .. } | Light::Spot { position, .. } => ("", position, [min, max]),
            };
            for (axis, along) in ["x", "y", "z"].into_iter().enumerate() {
                let range = low[axis]..=high[axis];
                changed |= dials.number(&format!("{name}, {what}{along}"), &mut vector[axis], range);
            }
        }
        if is_other && !dials.is_held() && self.options.settings() != self.renderer.settings {
            return self.remake(screen);
        }
        if changed {
            let set = self.renderer.set_lights(&self.lights());
            self.trouble = set.err().map_or(String::new(), |why| why.to_string());
        }
        Ok(())
    }

    fn turn(&mut self, x: f32, y: f32, _: &Screen) {
        self.fly.turn(x, y);
    }

    fn step(&mut self, seconds: f64, screen: &Screen) {
        let (min, max) = self.room.bounds;
        self.fly.go(screen.way(seconds) * (SPEED * (max - min).length()));
        if self.moving {
            self.seconds += seconds.min(0.1) as f32;
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let (gpu, start) = (&screen.gpu, Instant::now());
        let camera = self.camera(screen.aspect());
        if self.moving {
            let balls: Vec<_> = self.room.balls_at(self.seconds).collect();
            self.renderer.move_objects(gpu, &balls)?;
        }
        let view = (&camera, target.size());
        // What the adapter holds no more, such as too many rays, stays as it was.
        let updated = self.renderer.update(gpu, view, Some(BUDGET), &mut Clock::off());
        let updated = updated.unwrap_or_else(|why| {
            self.trouble = why.to_string();
            Updated::default()
        });
        self.renderer.exposure = self.options.exposure;
        self.renderer.draw(gpu, target, &camera, LAYERS[self.layer].1, &mut Clock::off())?;
        gpu.wait()?;
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        self.said = [
            format!("{milliseconds:.0} ms a frame on {}", gpu.name),
            told(&self.renderer),
            progress(&updated),
        ]
        .into();
        Ok(())
    }

    fn report(&self, _: &Screen) -> Report {
        let mut lines = self.said.clone();
        lines.extend(Some(self.trouble.clone()).filter(|why| !why.is_empty()));
        Report { lines, keys: HELP, ..Report::default() }
    }
}
