//! Furry animals: one, or a field of them among walls, in a window or in files.

mod choices;
mod field;
mod herd;
mod one;
mod walker;
mod window;

use casca_stage::window::Start;
use casca_tools::command_line::{Outcome, make_folder, say};

use crate::common::{Common, Failed, Shows};

pub use choices::Choices as Options;

impl Shows for Options {
    fn common(&self) -> &Common {
        &self.common
    }

    fn start(&self) -> Result<Start, Failed> {
        Ok(window::start(self.clone(), self.subject()?))
    }

    fn is_windowless(&self) -> bool {
        self.common.headless || self.time
    }

    fn work(&self) -> Result<Outcome, Failed> {
        make_folder(&self.out())?;
        let gpu = self.common.drawing.device()?;
        say(format_args!("drawing on {}", gpu.name));
        match self.field {
            Some(_) if self.time => field::time(&gpu, self)?,
            Some(_) => return field::pictures(&gpu, self),
            None => one::pictures(&gpu, self, &self.subject()?)?,
        }
        Ok(Outcome::Well)
    }
}
