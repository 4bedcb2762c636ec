//! The command line, and what it asks for, done.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::PathBuf;

use casca_points::MAX_SIDE;
use casca_points::files::PlyWriter;
use casca_stage::window::Done;
use casca_tools::command_line::{EXIT_CODES, say};
use casca_tools::image::parse_size;
use clap::{Args, Subcommand};

use crate::common::{Common, one_of};
use crate::points::large::{Cut, Walk};
use crate::points::operators::{Look, Operator};
use crate::points::panes::{CONTENTS, Content};

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
    #[arg(long, value_delimiter = ',', default_value = "points,discs,hpr,splat,surface",
        value_parser = |text: &str| one_of(text, &CONTENTS))]
    pub(super) panes: Vec<Content>,
}

/// What is done with a cloud instead of showing it.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    Visible(Visible),
    Bricks(Cut),
    Walk(Walk),
}

/// Writes the points of a cloud that an eye can see, as PLY
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Visible {
    /// A PLY, LAS, LAZ or E57 file [default: a scan of a house, made by rules]
    file: Option<PathBuf>,
    #[command(flatten)]
    look: Look,
    /// The way to find them
    #[arg(long, value_enum, default_value = "discs")]
    operator: Operator,
    /// The picture of the splat operator: points outside of it are not visible
    #[arg(long, default_value = "1024x768", value_parser = |text: &str| parse_size(text, 1..=MAX_SIDE))]
    size: (u32, u32),
    /// The file to write
    #[arg(long)]
    out: PathBuf,
}

impl Visible {
    pub(super) fn run(&self) -> Done {
        let looked = self.look.open(self.file.as_deref())?;
        let camera = looked.camera(looked.eye, looked.target, self.size)?;
        let (visible, time) = looked.visible(self.operator, &camera)?;
        let some = looked.cloud.subset(&visible);
        let named = |e: io::Error| format!("cannot write {}: {e}", self.out.display());
        let file = File::create(&self.out).map_err(named)?;
        PlyWriter::write_all(BufWriter::new(file), &some).map_err(named)?;
        let (all, seen, seconds) = (looked.cloud.len(), some.len(), time.as_secs_f64());
        say(format_args!("{seen} of {all} points are visible, found in {seconds:.3} s"));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::parsed;

    #[test]
    fn absurd_values_are_refused_with_the_values_that_are_expected() {
        for (words, expected) in [
            ("--eye 1,x,2", "three numbers"),
            ("--spacing NaN", "from 0.02 to 1"),
            ("--headless --panes everything", "expected points, discs"),
            ("visible --operator hpr", "--out"),
            ("--headless walk x", "cannot be used with"),
        ] {
            let words: Vec<&str> = words.split(' ').collect();
            let said = parsed::<Options>(&words).unwrap_err();
            assert!(said.contains(expected), "{words:?}: {said}");
        }
    }
}
