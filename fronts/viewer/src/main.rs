//! One program for casca and the systems around it: scenes, the plane, points, light, lines and
//! fur, in windows or pictures.
//!
//! `cargo run --release -p casca-viewer -- scene` opens a window above a city; `-- --help` lists the
//! systems, `-- scene --help` the options of one.

use std::process::ExitCode;

use casca_tools::command_line::{EXIT_CODES, Outcome, finish};
use casca_viewer::common::Failed;
use casca_viewer::systems::SYSTEMS;
use clap::Command;

const ABOUT: &str = "Shows what casca and the systems around it find visible: in a window, or in pictures";

fn command() -> Command {
    let command = Command::new("casca-viewer").about(ABOUT).after_help(EXIT_CODES);
    let command = command.subcommand_required(true).arg_required_else_help(true);
    command.subcommands(SYSTEMS.map(|system| (system.options)(Command::new(system.name))))
}

fn run() -> Result<Outcome, Failed> {
    let matches = command().get_matches();
    let (name, options) = matches.subcommand().unwrap_or(("", &matches));
    match SYSTEMS.into_iter().find(|system| system.name == name) {
        Some(system) => (system.run)(options),
        None => Err("no system is named: see --help".into()),
    }
}

fn main() -> ExitCode {
    finish(run())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_systems_are_commands_with_the_same_options_and_others_are_refused() {
        let command = command();
        command.clone().debug_assert();
        let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        assert_eq!(names, SYSTEMS.map(|system| system.name));
        for system in command.get_subcommands() {
            for option in ["file", "headless", "size", "out", "frames", "software"] {
                let has = system.get_arguments().any(|a| a.get_id() == option);
                assert!(has, "{} {option}", system.get_name());
            }
            assert!(system.get_about().is_some(), "{}", system.get_name());
        }
        let said = command.clone().try_get_matches_from(["casca-viewer", "hair"]).unwrap_err().to_string();
        assert!(said.contains("hair"), "{said}");
        assert!(command.try_get_matches_from(["casca-viewer", "scene", "--size", "0x9"]).is_err());
    }
}
