//! Light with all of its bounces, by a radiosity cache: in a window or into pictures.

mod headless;
mod options;
mod picture;
mod renderer;
mod scene;
mod window;

#[cfg(test)]
mod tests;

use casca_stage::window::Start;
use casca_tools::command_line::Outcome;

use crate::common::{Common, Failed, Shows};

use options::Instead;
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
        self.common.headless || self.instead.is_some()
    }

    fn work(&self) -> Result<Outcome, Failed> {
        if let Some(Instead::Bake(options)) = &self.instead {
            return casca_lightmap::program::run(options);
        }
        let layers = self.check()?;
        let start = self.open()?;
        let (gpu, folder) = self.common.studio("light")?;
        headless::pictures(&gpu, &start, self, (&layers, &folder))?;
        Ok(Outcome::Well)
    }
}
