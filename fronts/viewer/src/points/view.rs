//! The window, and a picture without one.

use std::error::Error;

use casca_stage::canvas::{Canvas, Target};
use casca_stage::dial::Dial;
use casca_stage::fly::Fly;
use casca_stage::gpu::COLOUR;
use casca_stage::report::Report;
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use casca_tools::command_line::{make_folder, say};
use casca_tools::image::write_png;
use glam::Vec3;

use crate::points::operators::Looked;
use crate::points::options::Options;
use crate::points::panes::{Content, Panes};

/// The share of the cloud's length that the camera flies in a second.
const SPEED: f32 = 0.15;

/// The window.
pub fn start(looked: Looked, panes: Vec<Content>) -> Start {
    Start::new(format!("{} - casca points", looked.name), move |screen| Viewer::new(screen, looked, &panes))
}

/// Draws a picture without a window.
pub fn picture(options: &Options) -> Done {
    let gpu = options.common.drawing.device()?;
    let looked = options.look.open(options.common.file.as_deref())?;
    let canvas = Canvas::new(&gpu, options.common.drawing.size);
    let mut panes = Panes::new(&gpu, COLOUR, &options.panes);
    let camera = looked.camera(looked.eye, looked.target, panes.size(canvas.size()))?;
    let titles = panes.find(&gpu, &looked, &camera)?;
    panes.draw(&gpu, &canvas.picture(), &camera, 1.0);
    let folder = options.common.folder("points");
    make_folder(&folder)?;
    let path = folder.join(format!("points-{}.png", looked.name));
    write_png(&path, canvas.size(), &canvas.read_picture(&gpu)?)?;
    titles.iter().for_each(say);
    say(format_args!("{}, drawn on {}", path.display(), gpu.name));
    Ok(())
}

struct Viewer {
    looked: Looked,
    panes: Panes,
    fly: Fly,
    /// Whether the visible points are those of another eye.
    is_old: bool,
    /// What was found last.
    found: Vec<String>,
}

/// The name of the dial that finds the visible points anew.
const FIND: &str = "find the visible points from here (Space)";

impl Viewer {
    fn new(screen: &Screen, looked: Looked, panes: &[Content]) -> Result<Self, Box<dyn Error>> {
        let fly = Fly::new(looked.eye, looked.target - looked.eye);
        let panes = Panes::new(&screen.gpu, screen.format(), panes);
        Ok(Self { looked, panes, fly, is_old: true, found: Vec::new() })
    }
}

impl Demo for Viewer {
    fn press(&mut self, key: KeyCode, _: &Screen) -> Done {
        self.is_old |= key == KeyCode::Space;
        Ok(())
    }

    fn turn(&mut self, x: f32, y: f32, _: &Screen) {
        self.fly.turn(x, y);
    }

    fn resize(&mut self, _: &Screen) {}

    fn step(&mut self, seconds: f64, screen: &Screen) {
        let way = screen.way() * (SPEED * self.looked.length * seconds.min(0.1) as f32);
        if way != Vec3::ZERO {
            self.fly.go(way);
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let size = self.panes.size(screen.size());
        let camera = self.looked.camera(self.fly.eye, self.fly.eye + self.fly.forward(), size)?;
        if std::mem::take(&mut self.is_old) {
            self.found = self.panes.find(&screen.gpu, &self.looked, &camera)?;
        }
        self.panes.draw(&screen.gpu, target, &camera, screen.scale());
        Ok(())
    }

    fn report(&self, _: &Screen) -> Report {
        let lines = self.looked.warnings.iter().chain(&self.found).cloned().collect();
        let keys = "W A S D Q E, a mouse button: fly   H: hides this";
        Report { lines, legend: Vec::new(), dials: vec![Dial::button(FIND)], keys }
    }

    fn set(&mut self, dial: &str, _: f64, _: bool, _: &Screen) -> Done {
        self.is_old |= dial == FIND;
        Ok(())
    }
}
