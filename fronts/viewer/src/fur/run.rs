//! What the command line asks for, done.

use casca_stage::window::Start;
use casca_tools::command_line::{Outcome, make_folder, say};

use crate::common::Failed;
use crate::fur::choices::Choices;
use crate::fur::{field, levels, one, study, window};

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
        if self.study {
            study::study(&gpu, self, &subject)?;
            return Ok(Outcome::Well);
        }
        match (self.field, self.time) {
            (_, true) => field::time(&gpu, self, &subject)?,
            (Some(count), false) => return field::pictures(&gpu, self, &subject, count),
            (None, false) if self.levels => levels::levels(&gpu, self, &subject)?,
            (None, false) if self.coats => one::coats(&gpu, self, &subject)?,
            (None, false) => one::pictures(&gpu, self, &subject)?,
        }
        Ok(Outcome::Well)
    }
}
