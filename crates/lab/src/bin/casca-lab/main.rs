//! The command line of casca's test scenes: walks checked against exact visibility, and the report.
//!
//! `cargo run --release -p casca-lab -- walk` needs no further arguments; `-- help` lists the
//! commands. `report` is built with `--features experiments`.

#[cfg(feature = "experiments")]
mod report;

use std::process::ExitCode;

use casca_lab::arguments::Failure;
use casca_lab::walk;
use casca_tools::command_line::{EXIT_CODES, Outcome, finish};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

/// Where the command is that is not always built.
const MORE: &str = if cfg!(feature = "experiments") {
    ""
} else {
    "Built with --features experiments, there is also:\n  report   Runs the experiments and writes the report\n\n"
};

#[derive(Debug, Parser)]
#[command(
    name = "casca-lab",
    about = "Walks and measurements for casca",
    after_help = format!("{MORE}{EXIT_CODES}")
)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Walk(walk::Options),
    #[cfg(feature = "experiments")]
    Report(report::Options),
}

impl Command {
    /// Says why the options make no sense together, if they do not.
    fn check(&self) -> Result<(), String> {
        match self {
            Self::Walk(options) => options.check(),
            #[cfg(feature = "experiments")]
            Self::Report(_) => Ok(()),
        }
    }

    fn run(&self) -> Result<Outcome, Failure> {
        match self {
            Self::Walk(options) => walk::run(options),
            #[cfg(feature = "experiments")]
            Self::Report(options) => report::run(options),
        }
    }
}

fn main() -> ExitCode {
    let CommandLine { command } = CommandLine::parse();
    if let Err(why) = command.check() {
        CommandLine::command().error(ErrorKind::ArgumentConflict, why).exit();
    }
    finish(command.run())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_needs_no_options_and_tells_the_exit_codes() {
        CommandLine::command().debug_assert();
        let more = if cfg!(feature = "experiments") { &["report"][..] } else { &[] };
        for name in ["walk"].iter().chain(more) {
            assert!(CommandLine::try_parse_from(["casca-lab", name]).is_ok(), "{name}");
            let help = CommandLine::try_parse_from(["casca-lab", name, "--help"]).unwrap_err().to_string();
            assert!(help.contains("4  nothing was checked"), "{name}: {help}");
        }
        assert!(CommandLine::try_parse_from(["casca-lab", "run"]).is_err());
        assert!(CommandLine::try_parse_from(["casca-lab"]).is_err());
    }
}
