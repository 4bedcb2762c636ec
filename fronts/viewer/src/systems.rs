//! The systems: their names, and the windows that they open.

use casca_stage::window::Start;
use casca_tools::command_line::Outcome;
use clap::{ArgMatches, Command};

use crate::common::{Failed, Shows, parsed};
use crate::{fur, light, lines, plane, points, scene};

/// A system that can be chosen.
#[derive(Clone, Copy)]
pub struct System {
    /// Its name, as on the command line.
    pub name: &'static str,
    /// What it shows, in a line.
    pub line: &'static str,
    /// Whether it needs more than WebGL has: compute shaders, or storage buffers.
    pub computes: bool,
    /// The options that its window in a page has if no others are given.
    words: &'static [&'static str],
    /// What its window shows with some options.
    start: fn(&[&str]) -> Result<Start, Failed>,
    /// Adds its options to a command.
    pub options: fn(Command) -> Command,
    /// Does what options say.
    pub run: fn(&ArgMatches) -> Result<Outcome, Failed>,
}

/// All of them.
pub const SYSTEMS: [System; 6] = [
    System::of::<scene::Options>(
        "view",
        "a city from above: what a camera in the streets sees, and what casca culls",
    ),
    System::of::<plane::Options>("plane", "a map from above: what an eye sees, and which guards it can see"),
    System::of::<points::Options>("points", "the scan of a house: which of its points can be seen from here")
        .computes(),
    System {
        words: &["--balls", "3"],
        ..System::of::<light::Options>("light", "the Cornell box: light that bounces between its walls")
            .computes()
    },
    System::of::<lines::Options>("lines", "thousands of lines: the ones behind are darkened").computes(),
    System::of::<fur::Options>("fur", "a furry animal: strands in layers").computes(),
];

impl System {
    const fn of<A: Shows>(name: &'static str, line: &'static str) -> Self {
        Self {
            name,
            line,
            computes: false,
            words: &[],
            start: |words| parsed::<A>(words)?.start(),
            options: A::augment_args,
            run: |matches| A::from_arg_matches(matches)?.run(),
        }
    }

    const fn computes(self) -> Self {
        Self { computes: true, ..self }
    }
}

/// What a page shows for a command line: the name of a system, and its options.
///
/// # Errors
/// There is no such system, it has no such options, or what is shown cannot be had.
pub fn start(words: &[&str]) -> Result<Start, Failed> {
    let (name, options) = words.split_first().unwrap_or((&"", &[]));
    match SYSTEMS.iter().find(|system| system.name == *name) {
        Some(system) if options.is_empty() => (system.start)(system.words),
        Some(system) => (system.start)(options),
        None => {
            let names = SYSTEMS.map(|system| system.name).join(", ");
            Err(format!("{name:?} is none of {names}").into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_start_a_system_or_are_refused_by_name() {
        assert!(start(&["view", "rooms"]).is_ok());
        let refused = |words: &[&str]| start(words).err().map(|why| why.to_string()).unwrap_or_default();
        assert!(refused(&["hair"]).contains("view, plane"), "{}", refused(&["hair"]));
        assert!(refused(&[]).contains("view, plane"));
        assert!(refused(&["view", "--size", "0x9"]).contains("8192"));
        assert!(refused(&["view", "none.glb"]).contains("none.glb"));
    }
}
