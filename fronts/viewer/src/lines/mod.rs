//! Dense sets of lines with ambient occlusion, in a window or into pictures, and the time of each
//! stage.

mod headless;
mod legend;
mod options;
mod source;
mod times;
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

    fn is_windowless(&self) -> bool {
        self.common.headless || self.time
    }

    fn work(&self) -> Result<Outcome, Failed> {
        let source = Source::open(self)?;
        if self.time {
            times::print(self, &source)?
        } else {
            headless::pictures(self, &source)?
        };
        Ok(Outcome::Well)
    }
}
