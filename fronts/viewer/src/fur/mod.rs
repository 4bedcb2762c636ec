//! Furry animals: one, or a field of them among walls, in a window or in files.

mod choices;
mod field;
mod one;
mod walker;
mod window;

use casca_stage::window::Start;
use casca_tools::command_line::Outcome;

use crate::common::{Common, Failed, Shows};

pub use choices::Choices as Options;

impl Shows for Options {
    fn common(&self) -> &Common {
        &self.common
    }

    fn start(&self) -> Result<Start, Failed> {
        Ok(window::start(self.clone(), self.subject()?))
    }

    fn work(&self) -> Result<Outcome, Failed> {
        let (gpu, folder) = self.common.studio("fur")?;
        match self.field {
            Some(_) => field::pictures(&gpu, self, &folder),
            None => one::pictures(&gpu, self, &self.subject()?, &folder).map(|()| Outcome::Well),
        }
    }
}
