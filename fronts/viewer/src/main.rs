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
use clap::{ArgMatches, Args, Command, FromArgMatches};

const ABOUT: &str = "Shows what casca and the systems around it find visible: in a window, or in pictures";

fn command() -> Command {
    let long = format!("{ABOUT}.\n\nWithout a command, a window opens with a list to choose from.");
    // Options come with words of their own, which these replace.
    let command = Drawing::augment_args(Command::new("casca-viewer")).about(ABOUT).long_about(long);
    let command = command.after_help(EXIT_CODES).args_conflicts_with_subcommands(true);
    command.subcommands(SYSTEMS.map(|system| (system.options)(Command::new(system.name))))
}

fn run(matches: &ArgMatches) -> Result<Outcome, Failed> {
    let chosen = matches.subcommand().and_then(|(name, options)| {
        SYSTEMS.into_iter().find(|system| system.name == name).map(|system| (system, options))
    });
    match chosen {
        Some((system, options)) => (system.run)(options),
        None => Drawing::from_arg_matches(matches)?.open(chooser::start(&SYSTEMS)).map(|()| Outcome::Well),
    }
}

fn main() -> ExitCode {
    finish(run(&command().get_matches()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_systems_are_commands_and_choices_with_the_same_options() {
        let command = command();
        command.clone().debug_assert();
        assert_eq!(command.get_about().map(ToString::to_string).as_deref(), Some(ABOUT));
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
        let said = command().try_get_matches_from(["casca-viewer", "hair"]).unwrap_err().to_string();
        assert!(said.contains("hair"), "{said}");
        assert!(command().try_get_matches_from(["casca-viewer", "--size", "0x9"]).is_err());
    }
}
