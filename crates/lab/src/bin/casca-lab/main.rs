//! The command line of casca's test scenes: walks checked against exact visibility, measurements,
//! the report, prepared meshes and levels in files.
//!
//! `cargo run --release -p casca-lab -- walk` needs no further arguments; `-- help` lists the
//! commands. `tradeoff`, `buffer`, `scaling`, `reach`, `coherence`, `sight`, `world`, `lines`,
//! `points` and `report` are built with `--features experiments`, and `light` with `--features
//! light`.

mod arguments;
#[cfg(feature = "experiments")]
mod buffer;
#[cfg(feature = "experiments")]
mod coherence;
mod failure;
mod level;
#[cfg(feature = "light")]
mod light;
mod limits;
#[cfg(feature = "experiments")]
mod lines;
#[cfg(feature = "experiments")]
mod page;
#[cfg(feature = "experiments")]
mod points;
mod prepare;
mod progress;
#[cfg(feature = "experiments")]
mod reach;
#[cfg(feature = "experiments")]
mod report;
#[cfg(feature = "experiments")]
mod scaling;
#[cfg(feature = "experiments")]
mod sight;
#[cfg(feature = "experiments")]
mod tradeoff;
mod walk;
#[cfg(feature = "experiments")]
mod world;

use std::process::ExitCode;

use casca_tools::command_line::{EXIT_CODES, Outcome, finish};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

use failure::Failure;

/// Where the commands are that are not always built.
const MORE: &str = if cfg!(feature = "experiments") {
    ""
} else {
    "Built with --features experiments, there are also:\n  tradeoff   Charts speed against accuracy for all \
     methods and settings\n  buffer     Times a \
     sampled occlusion buffer, beside the default method\n  scaling    Charts times and memory by objects, \
     triangles, pixels and threads\n  reach      Charts sets for eyes that may go some way\n  coherence  Times the frames of a walking camera, by each way to \
     answer them\n  sight      Times questions about boxes and points\n  world      Charts a drive through a land larger than a grid\n  lines      Compares the occlusion of lines by columns with rays\n  points     Errors and times of the operators on point clouds\n  report     Runs the experiments and writes the report\n\
     Built with --features light, which needs a C++ compiler, there is also:\n  light      Compares light gathered from voxels with a path tracer\n\n"
};

#[derive(Debug, Parser)]
#[command(
    name = "casca-lab",
    about = "Walks, measurements and files for casca",
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
    Tradeoff(tradeoff::Options),
    #[cfg(feature = "experiments")]
    Buffer(buffer::Options),
    #[cfg(feature = "experiments")]
    Scaling(scaling::Options),
    #[cfg(feature = "experiments")]
    Reach(reach::Options),
    #[cfg(feature = "experiments")]
    Coherence(coherence::Options),
    #[cfg(feature = "experiments")]
    Sight(sight::Options),
    #[cfg(feature = "experiments")]
    World(world::Options),
    #[cfg(feature = "light")]
    Light(light::Options),
    #[cfg(feature = "experiments")]
    Lines(lines::Options),
    #[cfg(feature = "experiments")]
    Points(points::Options),
    #[cfg(feature = "experiments")]
    Report(report::Options),
    Prepare(prepare::Options),
    Level(level::Options),
}

impl Command {
    /// Says why the options make no sense together, if they do not.
    fn check(&self) -> Result<(), String> {
        match self {
            Self::Walk(options) => options.check(),
            _ => Ok(()),
        }
    }

    fn run(&self) -> Result<Outcome, Failure> {
        match self {
            Self::Walk(options) => walk::run(options),
            #[cfg(feature = "experiments")]
            Self::Tradeoff(options) => tradeoff::run(options),
            #[cfg(feature = "experiments")]
            Self::Buffer(options) => buffer::run(options),
            #[cfg(feature = "experiments")]
            Self::Scaling(options) => scaling::run(options),
            #[cfg(feature = "experiments")]
            Self::Reach(options) => reach::run(options),
            #[cfg(feature = "experiments")]
            Self::Coherence(options) => coherence::run(options),
            #[cfg(feature = "experiments")]
            Self::Sight(options) => sight::run(options),
            #[cfg(feature = "experiments")]
            Self::World(options) => world::run(options),
            #[cfg(feature = "light")]
            Self::Light(options) => light::run(options),
            #[cfg(feature = "experiments")]
            Self::Lines(options) => lines::run(options),
            #[cfg(feature = "experiments")]
            Self::Points(options) => points::run(options),
            #[cfg(feature = "experiments")]
            Self::Report(options) => report::run(options),
            Self::Prepare(options) => prepare::run(options),
            Self::Level(options) => level::run(options),
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
        let mut names = vec![
            "walk",
            "tradeoff",
            "buffer",
            "scaling",
            "reach",
            "coherence",
            "sight",
            "world",
            "lines",
            "points",
            "report",
            "prepare",
            "level",
        ];
        if cfg!(feature = "light") {
            names.push("light");
        }
        for name in names {
            assert!(CommandLine::try_parse_from(["casca-lab", name]).is_ok(), "{name}");
            let help = CommandLine::try_parse_from(["casca-lab", name, "--help"]).unwrap_err().to_string();
            assert!(help.contains("4  nothing was checked"), "{name}: {help}");
        }
        assert!(CommandLine::try_parse_from(["casca-lab", "run"]).is_err());
        assert!(CommandLine::try_parse_from(["casca-lab"]).is_err());
    }
}
