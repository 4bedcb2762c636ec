//! Light by voxels against a path tracer, as charts (SVG), pictures (PNG), tables (CSV) and a page.

use casca_lab::experiments::LabError;
use casca_lab::experiments::light::{HEAD, light};
use casca_tools::command_line::{EXIT_CODES, Outcome};
use clap::Parser;

use crate::arguments::{PageArguments, about};
use crate::page::Page;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Compares light that is gathered from voxels with a path tracer",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("out", about("target/light", "Where the page goes, and its folder of charts, pictures and tables"))
)]
pub struct Options {
    #[command(flatten)]
    page: PageArguments,
}

/// Measures, prints the tables and writes charts, pictures, tables and page.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let command = options.page.command("light");
    let page = Page { feature: "light", ..options.page.page(HEAD, &command) };
    page.make("light", |lab| Ok((light(lab)?, Outcome::Well)))
}
