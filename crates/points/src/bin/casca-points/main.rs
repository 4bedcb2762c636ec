//! Looks at point clouds, and says which points of them can be seen. `casca-points --help` lists the commands.

mod house;
mod view;
mod visible;

use std::error::Error;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Debug, Parser)]
#[command(
    about = "The points of a point cloud that an eye can see",
    after_help = "Exit codes: 0 all is well, 2 the command line is wrong, 3 something else failed",
    allow_negative_numbers = true
)]
struct Options {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    View(view::View),
    Visible(visible::Visible),
}

/// What a command ends with.
type Done = Result<(), Box<dyn Error>>;

fn main() -> ExitCode {
    let done = match Options::parse().command {
        Command::View(view) => view.run(),
        Command::Visible(visible) => visible.run(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(3)
        }
    }
}
