//! Light with all of its bounces, by a radiosity cache: in a window or into pictures, and its time.

mod frame;
mod headless;
mod options;
mod picture;
mod renderer;
mod scene;
mod window;

#[cfg(test)]
mod tests;

use casca_stage::window::Start;
use casca_tools::command_line::{Outcome, say};

use crate::common::{Common, Failed, Shows};

pub use options::Options;

impl Shows for Options {
    fn common(&self) -> &Common {
        &self.common
    }

    fn start(&self) -> Result<Start, Failed> {
        self.check()?;
        Ok(window::start(self.open()?, self))
    }

    fn is_windowless(&self) -> bool {
        self.common.headless || self.time
    }

    fn work(&self) -> Result<Outcome, Failed> {
        let layers = self.check()?;
        let start = self.open()?;
        let gpu = self.common.drawing.device()?;
        say(format_args!("drawing on {}", gpu.name));
        if self.common.headless {
            headless::pictures(&gpu, &start, self, &layers)?;
        }
        if self.time {
            headless::time(&gpu, &start, self)?;
        }
        Ok(Outcome::Well)
    }
}
