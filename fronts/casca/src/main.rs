//! The program `casca`: levels examined, walked through, baked and served. `casca --help` lists what
//! it does.

use std::process::ExitCode;

use casca_cli::doctor;
use casca_lab::walk;
use casca_tools::command_line::{EXIT_CODES, Outcome, finish};
use clap::error::ErrorKind;
use clap::{ArgMatches, Args, Command, FromArgMatches, value_parser};
use clap_complete::Shell;

/// Why something failed.
type Failed = Box<dyn std::error::Error>;

/// One thing that the program does.
struct Job {
    name: &'static str,
    /// Adds its options to a command.
    options: fn(Command) -> Command,
    /// Does what they say.
    run: fn(&ArgMatches) -> Result<Outcome, Failed>,
}

fn jobs() -> Vec<Job> {
    let mut jobs = vec![
        Job {
            name: "doctor",
            options: doctor::Options::augment_args,
            run: |options| doctor::run(&doctor::Options::from_arg_matches(options)?),
        },
        Job {
            name: "walk",
            options: walk::Options::augment_args,
            run: |options| {
                let options = walk::Options::from_arg_matches(options)?;
                options
                    .check()
                    .unwrap_or_else(|why| command().error(ErrorKind::ArgumentConflict, why).exit());
                walk::run(&options).map_err(|why| -> Failed { why })
            },
        },
        Job {
            name: "bake",
            options: casca_bake::program::Options::augment_args,
            run: |options| Ok(casca_bake::program::run(&FromArgMatches::from_arg_matches(options)?)?),
        },
    ];
    #[cfg(feature = "serve")]
    jobs.push(Job {
        name: "serve",
        options: casca_server::program::Options::augment_args,
        run: |options| casca_server::program::run(&FromArgMatches::from_arg_matches(options)?),
    });
    jobs.push(Job {
        name: "completions",
        options: |command| {
            let shell = clap::arg!(<SHELL> "The shell").value_parser(value_parser!(Shell));
            command.about("Prints completions for a shell: bash, elvish, fish, powershell or zsh").arg(shell)
        },
        run: |options| {
            let shell = options.get_one::<Shell>("SHELL").copied().unwrap_or(Shell::Bash);
            clap_complete::generate(shell, &mut command(), "casca", &mut std::io::stdout());
            Ok(Outcome::Well)
        },
    });
    jobs
}

fn command() -> Command {
    let about = "Visibility culling: levels examined, walked through, baked and served";
    let command =
        Command::new("casca").about(about).version(env!("CARGO_PKG_VERSION")).after_help(EXIT_CODES);
    let command = command.subcommand_required(true).arg_required_else_help(true);
    command.subcommands(jobs().into_iter().map(|job| (job.options)(Command::new(job.name))))
}

fn run() -> Result<Outcome, Failed> {
    let matches = command().get_matches();
    let (name, options) = matches.subcommand().unwrap_or(("", &matches));
    match jobs().into_iter().find(|job| job.name == name) {
        Some(job) => (job.run)(options),
        None => Err("nothing is named: see --help".into()),
    }
}

fn main() -> ExitCode {
    finish(run())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_jobs_are_commands_that_say_what_they_do_and_others_are_refused() {
        let command = command();
        command.clone().debug_assert();
        for job in command.get_subcommands() {
            assert!(job.get_about().is_some(), "{}", job.get_name());
        }
        let said = command.clone().try_get_matches_from(["casca", "hair"]).unwrap_err().to_string();
        assert!(said.contains("hair"), "{said}");
        let mut script = Vec::new();
        clap_complete::generate(Shell::Bash, &mut command.clone(), "casca", &mut script);
        let script = String::from_utf8(script).unwrap();
        assert!(jobs().iter().all(|job| script.contains(&format!("casca,{})", job.name))), "{script}");
    }
}
