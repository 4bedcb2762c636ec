//! The window: a camera to fly with, sliders and a motion.

use casca_lines::gpu::context::GpuContext;
use casca_lines::gpu::culling::{Culling, Seen};
use casca_lines::gpu::numeric::MOST_THICK;
use casca_lines::gpu::renderer::{Look, Renderer};
use casca_lines::gpu::set::GpuLines;
use casca_lines::occlusion::Estimator;
use casca_lines::sets::colour::Legend;
use casca_stage::canvas::Target;
use casca_stage::dial::Dials;
use casca_stage::fly::Fly;
use casca_stage::report::Report;
use casca_stage::timing::{Clock, Instant};
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;

use crate::common::Failed;
use crate::lines::headless::{BACKGROUND, bundles};
use crate::lines::legend;
use crate::lines::options::{LOOKS, Options, Way};
use crate::lines::source::Source;

/// The share of the extent that the camera flies in a second.
const SPEED: f32 = 0.3;
const KEYS: [KeyCode; 4] = [KeyCode::Digit1, KeyCode::Digit2, KeyCode::Digit3, KeyCode::Digit4];

/// The window.
pub fn start(options: Options, source: Source) -> Start {
    Start::new(format!("{} - casca lines", source.name), |screen| Viewer::new(screen, options, source))
}

struct Viewer {
    options: Options,
    source: Source,
    look: usize,
    moving: bool,
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
        let start = source.start(&options, size)?;
        let view = source.view(&options, start, size)?;
        let set = source.at(0.0)?;
        let mut settings = source.settings(&options, &view);
        way = way.for_lines(&set, &settings.ao.estimator);
        options.estimator = way.in_window(false);
        settings = source.settings(&options, &view);
        let (lines, legend) = source.on_device(&screen.gpu, &set, &settings)?;
        Ok(Self {
            look: LOOKS.iter().position(|l| l.1 == Look::Occluded).unwrap_or(0),
            moving: false,
            renderer: Renderer::new(&screen.gpu, screen.format(), settings)?,
            culling: Culling::new(lines.bundles(), &source.context)?,
            context: source.context_on_device(&screen.gpu)?,
            lines,
            legend,
            fly: Fly::new(start[0], start[1] - start[0]),
            seconds: 0.0,
            shown: 0.0,
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
        self.options.estimator = self.way.in_window(self.moving);
        let eye = [self.fly.eye, self.fly.eye + self.fly.forward()];
        let view = self.source.view(&self.options, eye, screen.size().into())?;
        let mut settings = self.source.settings(&self.options, &view);
        if let Estimator::Places { line_radius, .. } = settings.ao.estimator {
            self.tube = kept(self.tube, line_radius);
            settings.ao.estimator = Estimator::places(settings.ao.radius, self.tube);
        }
        if self.shown != self.seconds || !self.lines.suits(&settings) {
            (self.lines, self.legend) =
                self.source.on_device(gpu, &self.source.at(self.seconds)?, &settings)?;
            self.culling.follow(self.lines.bundles())?;
            self.shown = self.seconds;
        }
        self.renderer.set_settings(gpu, settings)?;
        let seen = match self.options.cull {
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
    fn dials(&mut self, dials: &mut Dials, _: &Screen) -> Done {
        let options = &mut self.options;
        dials.choice("look", &KEYS, LOOKS.map(|look| look.0), &mut self.look);
        dials.number("radius, of the extent", &mut options.radius, 0.01..=0.5);
        let mut samples = options.samples();
        if dials.whole("samples", &mut samples, 8..=512, 1) {
            options.samples = Some(samples);
        }
        dials.number("factor", &mut options.factor, 0.0..=4.0);
        dials.number("tube radius in pixels", &mut options.tube, 0.1..=4.0);
        if self.source.moves() {
            dials.switch("moving (Space)", Some(KeyCode::Space), &mut self.moving);
        }
        dials.switch("culling (C)", Some(KeyCode::KeyC), &mut options.cull);
        let mut thickness = options.antialias.map_or(0, |thickness| thickness as u32);
        if dials.whole("pixels of smooth lines", &mut thickness, 0..=MOST_THICK as u32, 1) {
            options.antialias = (thickness > 0).then_some(thickness as f32);
        }
        Ok(())
    }

    fn turn(&mut self, x: f32, y: f32, _: &Screen) {
        self.fly.turn(x, y);
    }

    fn step(&mut self, seconds: f64, screen: &Screen) {
        self.fly.go(screen.way(seconds) * (SPEED * self.source.extent()));
        if self.moving {
            self.seconds += seconds.min(0.1);
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
        let look = LOOKS[self.look].1;
        self.renderer.paint(&screen.gpu, target, look, self.options.factor, BACKGROUND, &mut Clock::off())?;
        screen.gpu.wait()?;
        self.milliseconds = start.elapsed().as_secs_f64() * 1e3;
        self.say(screen, &seen);
        Ok(())
    }

    fn report(&self, _: &Screen) -> Report {
        Report {
            lines: self.said.clone(),
            legend: legend::entries(&self.legend),
            keys: "W A S D Q E, a mouse button: fly   1-4: looks   H: hides this",
            ..Report::default()
        }
    }
}
