//! Point clouds: which points of them can be seen, in a window, in pictures and in files.

mod house;
mod large;
mod operators;
mod options;
mod panes;
mod view;

use casca_stage::window::Start;
use casca_tools::command_line::Outcome;

use crate::common::{Common, Failed, Shows};
use crate::points::options::Command;

pub use options::Options;

impl Shows for Options {
    fn common(&self) -> &Common {
        &self.common
    }

    fn start(&self) -> Result<Start, Failed> {
        Ok(view::start(self.look.open(self.common.file.as_deref())?, self.panes.clone()))
    }

    fn is_windowless(&self) -> bool {
        self.common.headless || self.command.is_some()
    }

    fn work(&self) -> Result<Outcome, Failed> {
        match &self.command {
            Some(Command::Visible(visible)) => visible.run()?,
            Some(Command::Bricks(cut)) => cut.run()?,
            Some(Command::Walk(walk)) => walk.run()?,
            None => view::picture(self)?,
        }
        Ok(Outcome::Well)
    }
}
