//! What the command line asks for, done.

use casca_stage::window::Start;
use casca_tools::command_line::{Outcome, make_folder, say};

use crate::common::Failed;
use crate::fur::choices::Choices;
use crate::fur::{field, one, window};

impl Choices {
    /// The window.
    ///
    /// # Errors
    /// The file that grows fur cannot be taken.
    pub fn start(&self) -> Result<Start, Failed> {
        Ok(window::start(self.clone(), self.subject()?))
    }

    /// Opens a window, draws pictures or prints times.
    ///
    /// # Errors
    /// The fur cannot be had, drawn or written.
    pub fn run(&self) -> Result<Outcome, Failed> {
        if !self.draws_files() {
            return self.common.drawing.open(self.start()?).map(|()| Outcome::Well);
        }
        let subject = self.subject()?;
        make_folder(&self.out())?;
        let gpu = self.common.drawing.device()?;
        say(format_args!("drawing on {}", gpu.name));
        match self.field {
            Some(count) if self.time => field::time(&gpu, self, &subject, count)?,
            Some(count) => return field::pictures(&gpu, self, &subject, count),
            None => one::pictures(&gpu, self, &subject)?,
        }
        Ok(Outcome::Well)
    }
}
