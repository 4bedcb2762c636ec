//! Dense sets of lines with ambient occlusion, in a window or into pictures.

mod headless;
mod legend;
mod options;
mod source;
mod window;

use casca_stage::window::Start;
use casca_tools::command_line::Outcome;

use crate::common::{Common, Failed, Shows};
use crate::lines::source::Source;

pub use options::Options;

impl Shows for Options {
    fn common(&self) -> &Common {
        &self.common
    }

    fn start(&self) -> Result<Start, Failed> {
        Ok(window::start(self.clone(), Source::open(self)?))
    }

    fn work(&self) -> Result<Outcome, Failed> {
        headless::pictures(self, &Source::open(self)?)?;
        Ok(Outcome::Well)
    }
}
