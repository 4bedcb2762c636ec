//! One program for casca and the systems around it: scenes, the plane, points, light, lines and
//! fur, in windows or pictures.
//!
//! `cargo run --release -p casca-viewer` opens a window with a list to choose from; `-- --help`
//! lists the systems, `-- scene --help` the options of one.

use std::process::ExitCode;

use casca_tools::command_line::{EXIT_CODES, Outcome, finish};
use casca_viewer::chooser;
use casca_viewer::common::{Drawing, Failed};
use casca_viewer::systems::SYSTEMS;
use casca_viewer::{fur, light, lines, plane, points, scene};
use clap::{Parser, Subcommand};

#[derive(Debug, Parser)]
#[command(
    name = "casca-viewer",
    about = "Shows what casca and the systems around it find visible: in a window, or in pictures",
    long_about = "Shows what casca and the systems around it find visible: in a window, or in pictures.\n\nWithout a command, \
                  a window opens with a list to choose from.",
    after_help = EXIT_CODES,
    args_conflicts_with_subcommands = true
)]
struct CommandLine {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    drawing: Drawing,
}

#[derive(Debug, Subcommand)]
enum Command {
    Scene(Box<scene::Options>),
    Plane(Box<plane::Options>),
    Points(Box<points::Options>),
    Light(Box<light::Options>),
    Lines(Box<lines::Options>),
    Fur(Box<fur::Options>),
}

fn run(line: &CommandLine) -> Result<Outcome, Failed> {
    match &line.command {
        Some(Command::Scene(options)) => options.run(),
        Some(Command::Plane(options)) => options.run(),
        Some(Command::Points(options)) => options.run(),
        Some(Command::Light(options)) => options.run(),
        Some(Command::Lines(options)) => options.run(),
        Some(Command::Fur(options)) => options.run(),
        None => line.drawing.open(chooser::start(&SYSTEMS)).map(|()| Outcome::Well),
    }
}

fn main() -> ExitCode {
    finish(run(&CommandLine::parse()))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn all_systems_are_commands_and_choices_with_the_same_options() {
        let command = CommandLine::command();
        command.clone().debug_assert();
        let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        assert_eq!(names, SYSTEMS.map(|system| system.name));
        for system in command.get_subcommands() {
            for option in ["file", "headless", "size", "out", "frames", "software"] {
                assert!(
                    system.get_arguments().any(|a| a.get_id() == option),
                    "{} {option}",
                    system.get_name()
                );
            }
            assert!(system.get_about().is_some(), "{}", system.get_name());
        }
    }

    #[test]
    fn a_wrong_system_is_refused_and_those_that_there_are_are_named() {
        let said = CommandLine::try_parse_from(["casca-viewer", "hair"]).unwrap_err().to_string();
        assert!(said.contains("hair"), "{said}");
        assert!(CommandLine::try_parse_from(["casca-viewer", "--size", "0x9"]).is_err());
    }
}
