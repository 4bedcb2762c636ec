//! Light by voxels against a path tracer, as charts (SVG), pictures (PNG), tables (CSV) and a page.

use std::path::PathBuf;

use casca_lab::command_line::{EXIT_CODES, Outcome};
use casca_lab::experiments::LabError;
use casca_lab::experiments::light::{HEAD, light};
use clap::Parser;

use crate::page::Page;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Compares light that is gathered from voxels with a path tracer",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
pub struct Options {
    /// A smoke run, whose figures mean nothing
    #[arg(long)]
    quick: bool,
    /// Seed of all that is random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Where the page goes, and its folder of charts and tables
    #[arg(long, default_value = "target/light")]
    out: PathBuf,
    /// No progress line
    #[arg(long)]
    quiet: bool,
}

/// Measures, prints the tables and writes charts, pictures, tables and page.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let page = Page {
        head: HEAD,
        files: Vec::new(),
        feature: "light",
        command: if options.quick { "light --quick" } else { "light" },
        out: &options.out,
        quick: options.quick,
        seed: options.seed,
        quiet: options.quiet,
    };
    page.make("light", |lab| Ok((light(lab)?, Outcome::Well)))
}
