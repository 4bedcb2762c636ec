//! The window: a camera to fly with, sliders and a motion.

use std::ops::RangeInclusive;
use std::time::Instant;

use casca_lines::gpu::culling::{Culling, Seen};
use casca_lines::gpu::renderer::{Look, Renderer};
use casca_lines::gpu::set::GpuLines;
use casca_lines::occlusion::{AoOptions, Estimator};
use casca_stage::canvas::Target;
use casca_stage::egui::emath::Numeric;
use casca_stage::egui::{Align2, Slider, SliderClamping};
use casca_stage::fly::{Fly, way};
use casca_stage::panel::{Panel, controls};
use casca_stage::timing::Clock;
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::common::Failed;
use crate::lines::headless::BACKGROUND;
use crate::lines::options::Options;
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
    look: Look,
}

struct Viewer {
    options: Options,
    source: Source,
    dials: Dials,
    renderer: Renderer,
    lines: GpuLines,
    culling: Culling,
    panel: Panel,
    fly: Fly,
    seconds: f64,
    /// The time that the lines on the device are of.
    shown: f64,
    milliseconds: f64,
    /// The last trouble with a setting.
    trouble: String,
}

impl Viewer {
    fn new(screen: &Screen, options: Options, source: Source) -> Result<Self, Failed> {
        let size = <[u32; 2]>::from(screen.size());
        let start = source.start(&options, size, 0)?;
        let view = source.view(&options, start, size)?;
        let seconds = f64::from(options.at);
        let lines = GpuLines::new(&screen.gpu, &source.at(seconds)?)?;
        Ok(Self {
            dials: Dials {
                radius: options.radius,
                samples: options.samples,
                factor: options.factor,
                tube: options.tube,
                moving: false,
                cull: options.cull,
                look: Look::Occluded,
            },
            renderer: Renderer::new(&screen.gpu, screen.format(), source.settings(&options, &view))?,
            culling: Culling::new(lines.bundles(), &source.walls)?,
            lines,
            panel: Panel::on(screen),
            fly: Fly::new(start[0], start[1] - start[0]),
            seconds,
            shown: seconds,
            milliseconds: 0.0,
            trouble: String::new(),
            options,
            source,
        })
    }

    /// Moves the lines, and computes the picture that the dials ask for.
    fn update(&mut self, screen: &Screen) -> Result<Seen, Failed> {
        let gpu = &screen.gpu;
        if self.shown != self.seconds {
            self.lines = GpuLines::new(gpu, &self.source.at(self.seconds)?)?;
            self.culling.follow(self.lines.bundles())?;
            self.shown = self.seconds;
        }
        let eye = [self.fly.eye, self.fly.eye + self.fly.forward()];
        let view = self.source.view(&self.options, eye, screen.size().into())?;
        let Dials { radius, samples, tube, cull, .. } = self.dials;
        let mut settings = self.source.settings(&self.options, &view);
        let scaled = settings.ao.radius * radius / self.options.radius;
        let estimator = match settings.ao.estimator {
            Estimator::OpticalDepth { line_radius } => {
                Estimator::OpticalDepth { line_radius: line_radius * tube / self.options.tube }
            }
            other => other,
        };
        settings.ao = AoOptions { estimator, radius: scaled, ..settings.ao };
        (settings.samples, settings.sets) = (samples, sets(samples));
        self.renderer.set_settings(gpu, settings)?;
        let seen = match cull {
            true => self.culling.look(&view, settings.reach(&view)?)?,
            false => Seen::all(self.lines.bundles().len()),
        };
        self.renderer.update(gpu, &view, (&self.lines, &seen), &self.source.walls, &mut Clock::off())?;
        Ok(seen)
    }

    fn show(&mut self, screen: &Screen, target: &Target, seen: &Seen) {
        let bundles = self.lines.bundles().len();
        let lines = [
            format!("{} on {}: {:.0} ms a frame", self.source.name, screen.gpu.name, self.milliseconds),
            format!("{bundles} bundles: {} drawn, {} in columns", seen.drawn.len(), seen.read.len()),
            self.trouble.clone(),
        ];
        let mut dials = self.dials;
        self.panel.control(screen, target, &mut |context| {
            controls(context, "dials", Align2::LEFT_TOP, [10.0, 10.0], &mut |ui| {
                lines.iter().filter(|line| !line.is_empty()).for_each(|line| {
                    ui.label(line);
                });
                ui.horizontal(|ui| {
                    for (look, name, _) in LOOKS {
                        ui.selectable_value(&mut dials.look, look, name);
                    }
                });
                ui.add(slider(&mut dials.radius, 0.01..=0.5).text("radius, of the extent"));
                ui.add(slider(&mut dials.samples, 8..=512).logarithmic(true).text("samples"));
                ui.add(slider(&mut dials.factor, 0.0..=4.0).text("factor"));
                ui.add(slider(&mut dials.tube, 0.1..=4.0).text("tube radius in pixels"));
                ui.checkbox(&mut dials.moving, "moving (Space)");
                ui.checkbox(&mut dials.cull, "culling (C)");
                ui.label("W A S D Q E, right mouse button: fly");
            });
        });
        self.dials = dials;
    }
}

/// A slider that leaves a value of the command line beyond its range as it is, until it is dragged.
fn slider<N: Numeric>(value: &mut N, range: RangeInclusive<N>) -> Slider<'_> {
    Slider::new(value, range).clamping(SliderClamping::Edits)
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
        let way = way(&screen.keys) * (SPEED * self.source.extent() * seconds as f32);
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
        self.show(screen, target, &seen);
        Ok(())
    }
}
