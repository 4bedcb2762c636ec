//! The window: a camera to fly with, sliders and a motion.

use casca_lines::gpu::antialiasing::Antialiasing;
use casca_lines::gpu::context::GpuContext;
use casca_lines::gpu::culling::{Culling, Seen};
use casca_lines::gpu::numeric::MOST_THICK;
use casca_lines::gpu::renderer::{Look, Renderer};
use casca_lines::gpu::set::GpuLines;
use casca_lines::occlusion::{AoOptions, Estimator};
use casca_lines::sets::colour::Legend;
use casca_stage::canvas::Target;
use casca_stage::dial::Dial;
use casca_stage::fly::Fly;
use casca_stage::report::Report;
use casca_stage::timing::{Clock, Instant};
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::common::Failed;
use crate::lines::headless::{BACKGROUND, bundles};
use crate::lines::legend;
use crate::lines::options::{Options, Way};
use crate::lines::source::{Source, sets};

/// The share of the extent that the camera flies in a second.
const SPEED: f32 = 0.3;
const LOOKS: [(Look, &str, KeyCode); 4] = [
    (Look::Plain, "plain", KeyCode::Digit1),
    (Look::Diffuse, "diffuse", KeyCode::Digit2),
    (Look::Occluded, "occluded", KeyCode::Digit3),
    (Look::Occlusion, "occlusion", KeyCode::Digit4),
];

/// The window.
pub fn start(options: Options, source: Source) -> Start {
    Start::new(format!("{} - casca lines", source.name), |screen| Viewer::new(screen, options, source))
}

/// What sliders and boxes change.
#[derive(Clone, Copy, PartialEq)]
struct Dials {
    radius: f32,
    samples: u32,
    factor: f32,
    tube: f32,
    moving: bool,
    cull: bool,
    smooth: bool,
    /// The thickness of smooth lines, in pixels.
    thickness: f32,
    look: Look,
}

/// Names of dials.
const LOOK: &str = "look";
const RADIUS: &str = "radius, of the extent";
const SAMPLES: &str = "samples";
const FACTOR: &str = "factor";
const TUBE: &str = "tube radius in pixels";
const MOVING: &str = "moving (Space)";
const CULL: &str = "culling (C)";
const SMOOTH: &str = "smooth lines";
const THICKNESS: &str = "pixels of smooth lines";

impl Dials {
    fn listed(&self) -> Vec<Dial> {
        let look = LOOKS.iter().position(|(look, ..)| *look == self.look);
        vec![
            Dial::choice(LOOK, LOOKS.map(|(_, name, _)| name), look.unwrap_or(0)),
            Dial::number(RADIUS, self.radius, 0.01..=0.5, 0.0),
            Dial::number(SAMPLES, self.samples, 8.0..=512.0, 1.0),
            Dial::number(FACTOR, self.factor, 0.0..=4.0, 0.0),
            Dial::number(TUBE, self.tube, 0.1..=4.0, 0.0),
            Dial::switch(MOVING, self.moving),
            Dial::switch(CULL, self.cull),
            Dial::switch(SMOOTH, self.smooth),
            Dial::number(THICKNESS, self.thickness, 1.0..=f64::from(MOST_THICK), 0.0),
        ]
    }

    fn antialiasing(&self) -> Antialiasing {
        let thickness = self.thickness;
        if self.smooth { Antialiasing::Four { thickness } } else { Antialiasing::None }
    }

    fn set(&mut self, dial: &str, value: f64) {
        match dial {
            LOOK => self.look = LOOKS.get(value as usize).map_or(self.look, |(look, ..)| *look),
            RADIUS => self.radius = value as f32,
            SAMPLES => self.samples = value as u32,
            FACTOR => self.factor = value as f32,
            TUBE => self.tube = value as f32,
            MOVING => self.moving = value != 0.0,
            CULL => self.cull = value != 0.0,
            SMOOTH => self.smooth = value != 0.0,
            THICKNESS => self.thickness = value as f32,
            _ => {}
        }
    }
}

struct Viewer {
    options: Options,
    source: Source,
    dials: Dials,
    renderer: Renderer,
    lines: GpuLines,
    legend: Legend,
    culling: Culling,
    context: Vec<GpuContext>,
    fly: Fly,
    seconds: f64,
    /// The time that the lines on the device are of.
    shown: f64,
    milliseconds: f64,
    /// The radius of the tubes that values of places were computed for; 0 at first.
    tube: f32,
    /// The estimator that was asked for; that of the options may change with the motion.
    way: Way,
    /// The last trouble with a setting.
    trouble: String,
    /// What it has to say.
    said: Vec<String>,
}

impl Viewer {
    fn new(screen: &Screen, mut options: Options, source: Source) -> Result<Self, Failed> {
        let mut way = options.estimator;
        options.estimator = way.in_window(false);
        let size = <[u32; 2]>::from(screen.size());
        let start = source.start(&options, size, 0)?;
        let view = source.view(&options, start, size)?;
        let seconds = f64::from(options.at);
        let set = source.at(seconds)?;
        let mut settings = source.settings(&options, &view);
        way = way.for_lines(&set, &settings.ao.estimator);
        options.estimator = way.in_window(false);
        settings = source.settings(&options, &view);
        let (lines, legend) = source.on_device(&screen.gpu, &set, &settings)?;
        Ok(Self {
            dials: Dials {
                radius: options.radius,
                samples: options.samples(),
                factor: options.factor,
                tube: options.tube,
                moving: false,
                cull: options.cull,
                smooth: options.antialias.is_some(),
                thickness: options.antialias.unwrap_or(1.0),
                look: Look::Occluded,
            },
            renderer: Renderer::new(&screen.gpu, screen.format(), settings)?,
            culling: Culling::new(lines.bundles(), &source.context)?,
            context: source.context_on_device(&screen.gpu)?,
            lines,
            legend,
            fly: Fly::new(start[0], start[1] - start[0]),
            seconds,
            shown: seconds,
            milliseconds: 0.0,
            tube: 0.0,
            way,
            trouble: String::new(),
            said: Vec::new(),
            options,
            source,
        })
    }

    /// Moves the lines, and computes the picture that the dials ask for.
    fn update(&mut self, screen: &Screen) -> Result<Seen, Failed> {
        let gpu = &screen.gpu;
        self.options.follow(&mut self.dials.samples, self.way.in_window(self.dials.moving));
        let eye = [self.fly.eye, self.fly.eye + self.fly.forward()];
        let view = self.source.view(&self.options, eye, screen.size().into())?;
        let Dials { radius, samples, tube, cull, .. } = self.dials;
        let mut settings = self.source.settings(&self.options, &view);
        let scaled = settings.ao.radius * radius / self.options.radius;
        let thick = |line_radius: f32| line_radius * tube / self.options.tube;
        let estimator = match settings.ao.estimator {
            Estimator::Rays { line_radius } => Estimator::Rays { line_radius: thick(line_radius) },
            Estimator::Places { line_radius, .. } => {
                self.tube = kept(self.tube, thick(line_radius));
                Estimator::places(scaled, self.tube)
            }
        };
        settings.ao = AoOptions { estimator, radius: scaled };
        (settings.samples, settings.sets) = (samples, sets(samples));
        settings.antialiasing = self.dials.antialiasing();
        if self.shown != self.seconds || !self.lines.suits(&settings) {
            (self.lines, self.legend) =
                self.source.on_device(gpu, &self.source.at(self.seconds)?, &settings)?;
            self.culling.follow(self.lines.bundles())?;
            self.shown = self.seconds;
        }
        self.renderer.set_settings(gpu, settings)?;
        let seen = match cull {
            true => self.culling.look(&view, settings.reach(&view))?,
            false => Seen::all(self.lines.bundles().len()),
        };
        self.renderer.update(gpu, &view, (&self.lines, &seen), &self.context, &mut Clock::off())?;
        Ok(seen)
    }

    fn say(&mut self, screen: &Screen, seen: &Seen) {
        self.said = vec![
            format!("{} on {}: {:.0} ms a frame", self.source.name, screen.gpu.name, self.milliseconds),
            bundles(&self.lines, seen),
        ];
        self.said.extend(Some(self.trouble.clone()).filter(|why| !why.is_empty()));
    }
}

/// The radius of tubes that a frame takes instead of the best one. Tubes of another radius make all
/// places send rays anew, so that the old one stays while it is near.
fn kept(old: f32, best: f32) -> f32 {
    if (best * 0.8..=best * 1.25).contains(&old) { old } else { best }
}

impl Demo for Viewer {
    fn press(&mut self, key: KeyCode, _: &Screen) -> Done {
        match key {
            KeyCode::Space => self.dials.moving ^= true,
            KeyCode::KeyC => self.dials.cull ^= true,
            _ => {
                if let Some((look, ..)) = LOOKS.iter().find(|l| l.2 == key) {
                    self.dials.look = *look;
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
        let seconds = seconds.min(0.1);
        let way = screen.way() * (SPEED * self.source.extent() * seconds as f32);
        if way != Vec3::ZERO {
            self.fly.go(way);
        }
        if self.dials.moving {
            self.seconds += seconds;
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let start = Instant::now();
        let seen = match self.update(screen) {
            Ok(seen) => {
                self.trouble.clear();
                seen
            }
            // The program goes on with the last picture or the background, so that the dial can be
            // turned back.
            Err(why) => {
                self.trouble = why.to_string();
                Seen::default()
            }
        };
        let Dials { look, factor, .. } = self.dials;
        self.renderer.paint(&screen.gpu, target, look, factor, BACKGROUND, &mut Clock::off())?;
        screen.gpu.wait()?;
        self.milliseconds = start.elapsed().as_secs_f64() * 1e3;
        self.say(screen, &seen);
        Ok(())
    }

    fn report(&self, _: &Screen) -> Report {
        Report {
            lines: self.said.clone(),
            legend: legend::entries(&self.legend),
            dials: self.dials.listed(),
            keys: "W A S D Q E, a mouse button: fly   H: hides this",
        }
    }

    fn set(&mut self, dial: &str, value: f64, _: bool, _: &Screen) -> Done {
        self.dials.set(dial, value);
        Ok(())
    }
}
