//! The window, and a picture without one.

use casca_stage::canvas::Target;
use casca_stage::dial::Dials;
use casca_stage::fly::Fly;
use casca_stage::gpu::COLOUR;
use casca_stage::report::Report;
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use casca_tools::command_line::say;

use crate::common::Film;
use crate::points::operators::Looked;
use crate::points::options::Options;
use crate::points::panes::{Content, Panes};

/// The share of the cloud's length that the camera flies in a second.
const SPEED: f32 = 0.15;

/// The window.
pub fn start(looked: Looked, panes: Vec<Content>) -> Start {
    Start::new(format!("{} - casca points", looked.name), move |screen: &Screen| {
        let fly = Fly::new(looked.eye, looked.target - looked.eye);
        let panes = Panes::new(&screen.gpu, screen.format(), &panes);
        Ok(Viewer { looked, panes, fly, is_old: true, found: Vec::new() })
    })
}

/// Draws a picture without a window.
pub fn picture(options: &Options) -> Done {
    let looked = options.look.open(options.common.file.as_deref())?;
    let (gpu, folder) = options.common.studio("points")?;
    let film = Film::new(&gpu, options.common.size, false);
    let mut panes = Panes::new(&gpu, COLOUR, &options.panes);
    let camera = looked.camera(looked.eye, looked.target, panes.size(film.size()))?;
    let titles = panes.find(&gpu, &looked, &camera)?;
    panes.draw(&gpu, &film.canvas.picture(), &camera, 1.0);
    titles.iter().for_each(say);
    film.save(&gpu, &folder.join(format!("points-{}.png", looked.name)))
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

impl Demo for Viewer {
    fn dials(&mut self, dials: &mut Dials, _: &Screen) -> Done {
        self.is_old |= dials.button("find the visible points from here (Space)", Some(KeyCode::Space));
        Ok(())
    }

    fn turn(&mut self, x: f32, y: f32, _: &Screen) {
        self.fly.turn(x, y);
    }

    fn step(&mut self, seconds: f64, screen: &Screen) {
        self.fly.go(screen.way(seconds) * (SPEED * self.looked.length));
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
        Report { lines, keys, ..Report::default() }
    }
}
