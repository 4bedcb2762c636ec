//! What the command line asks for, done.

use std::io::{self, ErrorKind};

use casca_stage::window::{Done, Start};
use casca_tools::command_line::Outcome;

use crate::common::Failed;
use crate::points::options::{Command, Options};
use crate::points::view;

impl Options {
    /// The window.
    ///
    /// # Errors
    /// The cloud cannot be had.
    pub fn start(&self) -> Result<Start, Failed> {
        Ok(view::start(self.look.open(self.common.file.as_deref())?, self.panes.clone()))
    }

    /// Opens a window, draws a picture, or does what a command says.
    ///
    /// # Errors
    /// What is shown cannot be had, or what is written cannot be.
    pub fn run(&self) -> Result<Outcome, Failed> {
        quiet(self.command())?;
        Ok(Outcome::Well)
    }

    fn command(&self) -> Done {
        match &self.command {
            Some(Command::Visible(visible)) => visible.run(),
            Some(Command::Generate(generate)) => generate.run(),
            Some(Command::Bricks(cut)) => cut.run(),
            Some(Command::Walk(walk)) => walk.run(),
            None if self.common.headless => view::picture(self),
            None => self.common.drawing.open(self.start()?),
        }
    }
}

/// That nobody reads the output any more, as after `| head`, is no error. Errors of files are texts
/// that name them.
fn quiet(done: Done) -> Done {
    let nobody_reads =
        |error: &Failed| error.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == ErrorKind::BrokenPipe);
    match done {
        Err(error) if nobody_reads(&error) => Ok(()),
        done => done,
    }
}
