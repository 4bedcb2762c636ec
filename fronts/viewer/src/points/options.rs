//! The command line.

use casca_tools::command_line::EXIT_CODES;
use clap::{Args, Subcommand};

use crate::common::Common;
use crate::points::large::{Cut, Generate, Walk};
use crate::points::operators::Look;
use crate::points::panes::Content;
use crate::points::visible::Visible;

/// Shows all points of a cloud beside those that each operator finds visible, and its surface
///
/// In the window: W A S D Q E fly (Shift: faster), the right mouse button looks around, Escape
/// quits, Space finds the visible points from here. Until then the last result stays, so you can
/// fly around it and see what was hidden from the old viewpoint.
#[derive(Debug, Args)]
#[command(
    after_help = EXIT_CODES, allow_negative_numbers = true, args_conflicts_with_subcommands = true,
    mut_arg("file", |file| file.help("A PLY, LAS, LAZ or E57 file [default: a scan of a house, made by rules]"))
)]
pub struct Options {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
    /// What all systems take.
    #[command(flatten)]
    pub common: Common,
    #[command(flatten)]
    pub(super) look: Look,
    /// The panes, comma-separated
    #[arg(long, value_enum, value_delimiter = ',', default_value = "points,discs,hpr,splat,surface")]
    pub(super) panes: Vec<Content>,
}

/// What is done with a cloud instead of showing it.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    Visible(Visible),
    Generate(Generate),
    Bricks(Cut),
    Walk(Walk),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::parsed;

    #[test]
    fn absurd_values_are_refused_with_the_values_that_are_expected() {
        for (words, expected) in [
            ("--eye 1,x,2", "three numbers"),
            ("--radius -1", "from 0 to"),
            ("--spacing NaN", "from 0.02 to 1"),
            ("--log10-radius inf", "expected a number"),
            ("walk x --height nan", "expected a number"),
            ("--fov 180", "from 1 to 170"),
            ("--headless --panes everything", "possible values: points"),
            ("visible --operator hpr", "--out"),
            ("--headless walk x", "cannot be used with"),
        ] {
            let words: Vec<&str> = words.split(' ').collect();
            let said = parsed::<Options>(&words).unwrap_err();
            assert!(said.contains(expected), "{words:?}: {said}");
        }
    }
}
