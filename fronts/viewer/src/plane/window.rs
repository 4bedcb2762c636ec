//! The window: the eye walks by keys, or follows the mouse.

use casca_scenes::world::FRAME_SECONDS;
use casca_stage::canvas::Target;
use casca_stage::dial::Dials;
use casca_stage::panel::Panel;
use casca_stage::report::Report;
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec2;

use crate::plane::draw::{Places, legend, picture};
use crate::plane::level::Level;

/// Tiles that the eye walks in a second.
const SPEED: f32 = 5.0;
/// The window.
pub fn start(level: Level) -> Start {
    Start::new(format!("{} - casca plane", level.name), move |screen: &Screen| {
        let panel = Panel::new(&screen.gpu, screen.format());
        Ok(Viewer { level, panel, to: Vec2::ZERO, behind: 0.0, paused: false, seed: 0 })
    })
}

struct Viewer {
    level: Level,
    panel: Panel,
    /// How far the eye is to go in the next frame.
    to: Vec2,
    /// Time that the level is behind.
    behind: f64,
    paused: bool,
    /// The seed of the last floor plan.
    seed: u64,
}

impl Demo for Viewer {
    fn dials(&mut self, dials: &mut Dials, _: &Screen) -> Done {
        dials.switch("pause (Space)", Some(KeyCode::Space), &mut self.paused);
        if dials.button("another floor plan (N)", Some(KeyCode::KeyN)) {
            self.seed += 1;
            self.level = Level::floor_plan(self.seed)?;
        }
        Ok(())
    }

    fn turn(&mut self, x: f32, y: f32, screen: &Screen) {
        let (width, height) = screen.size();
        let size = Vec2::new(width as f32, height as f32);
        let places = Places::new(&self.level, size);
        self.to += places.tile(Vec2::new(x, y)) - places.tile(Vec2::ZERO);
    }

    fn step(&mut self, seconds: f64, screen: &Screen) {
        let way = screen.way(seconds);
        self.to += Vec2::new(way.x, -way.z) * SPEED;
        self.behind = (self.behind + seconds).min(2.0 * FRAME_SECONDS);
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        if self.behind >= FRAME_SECONDS {
            self.behind -= FRAME_SECONDS;
            let to = self.level.eye + std::mem::take(&mut self.to);
            if !self.paused {
                self.level.step(to)?;
            }
        }
        picture(&mut self.panel, (&screen.gpu, target, screen.scale()), &self.level);
        Ok(())
    }

    fn report(&self, _: &Screen) -> Report {
        let keys = "W A S D, a mouse button: walk   H: hides this";
        Report { lines: self.level.lines(), legend: legend(), keys, ..Report::default() }
    }
}
