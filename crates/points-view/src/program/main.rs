//! Looks at point clouds, and says which points of them can be seen. `casca-points --help` lists the commands.

mod house;
mod large;
mod operators;
mod panes;
mod view;
mod visible;

use std::error::Error;
use std::io::{self, ErrorKind, Write};
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
    Generate(large::Generate),
    Bricks(large::Cut),
    Walk(large::Walk),
}

/// Nothing, or why a command failed.
type Done = Result<(), Box<dyn Error>>;

fn main() -> ExitCode {
    let done = match Options::parse().command {
        Command::View(view) => view.run(),
        Command::Visible(visible) => visible.run(),
        Command::Generate(generate) => generate.run(),
        Command::Bricks(cut) => cut.run(),
        Command::Walk(walk) => walk.run(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // Nobody reads the output any more, as after `| head`. Errors of files are texts that name them.
        Err(error)
            if error.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == ErrorKind::BrokenPipe) =>
        {
            ExitCode::SUCCESS
        }
        Err(error) => {
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(3)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_values_are_refused_with_the_values_that_are_expected() {
        for (words, expected) in [
            ("view --eye 1,2", "three numbers"),
            ("view --eye 1,2,NaN", "three numbers"),
            ("view --eye 1,x,2,3", "three numbers"),
            ("view --eye 1,2,3,4", "three numbers"),
            ("view --radius -1", "from 0 up"),
            ("view --radius NaN", "from 0 up"),
            ("view --log10-radius inf", "a finite number"),
            ("walk x --pixels -1", "from 0 up"),
            ("walk x --speed inf", "from 0 up"),
            ("walk x --side nan", "from 0 up"),
            ("walk x --height nan", "a finite number"),
            ("view --size 0x720", "from 1 to 8192"),
            ("view --size 99999x99999", "from 1 to 8192"),
            ("view --fov 180", "from 1 to 170"),
            ("view --headless --panes everything", "possible values: points"),
            ("view --out x", "--headless"),
            ("visible --operator hpr", "--out"),
        ] {
            let words = std::iter::once("casca-points").chain(words.split(' '));
            let said = Options::try_parse_from(words).unwrap_err().to_string();
            assert!(said.contains(expected), "{said}");
        }
    }
}
