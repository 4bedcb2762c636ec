//! The plane: what an eye sees on a map with guards, in a window or into a picture.

mod draw;
mod level;
mod options;
mod window;

use casca_stage::gpu::COLOUR;
use casca_stage::panel::Panel;
use casca_stage::window::Start;
use casca_tools::command_line::{Outcome, say};

use crate::common::{Common, Failed, Film, Shows};
use crate::plane::options::FRAMES;

pub use options::Options;

impl Shows for Options {
    fn common(&self) -> &Common {
        &self.common
    }

    fn start(&self) -> Result<Start, Failed> {
        Ok(window::start(self.level()?))
    }

    fn work(&self) -> Result<Outcome, Failed> {
        let mut level = self.level()?;
        let (gpu, folder) = self.common.studio("plane")?;
        let film = Film::new(&gpu, self.common.size, false);
        for _ in 0..self.common.frames.unwrap_or(FRAMES) {
            level.step(level.eye)?;
        }
        let mut panel = Panel::new(&gpu, COLOUR);
        draw::picture(&mut panel, (&gpu, &film.canvas.picture(), 1.0), &level);
        level.lines().iter().for_each(say);
        film.save(&gpu, &folder.join(format!("plane-{}.png", level.name)))?;
        Ok(Outcome::Well)
    }
}
