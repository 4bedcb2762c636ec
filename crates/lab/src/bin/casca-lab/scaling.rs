//! How times and memory grow with objects, triangles, pixels and threads, as charts (SVG), tables (CSV) and a page.

use std::path::PathBuf;

use casca_lab::command_line::{EXIT_CODES, Outcome};
use casca_lab::experiments::{HEAD, LabError, Reach, scaling_to};
use clap::Parser;

use crate::page::Page;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Charts times and memory by objects, triangles, pixels and threads",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
pub struct Options {
    /// Also a million objects, 100,000 visible ones and ten million triangles: takes minutes and some GB
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// A smoke run, whose figures mean nothing
    #[arg(long)]
    quick: bool,
    /// Seed of all that is random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Where the page goes, and its folder of charts and tables
    #[arg(long, default_value = "target/scaling")]
    out: PathBuf,
    /// No progress line
    #[arg(long)]
    quiet: bool,
}

/// Measures, prints the tables and writes charts, tables and page.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let reach = match (options.full, options.quick) {
        (true, _) => Reach::Full,
        (_, true) => Reach::Smoke,
        _ => Reach::Short,
    };
    let page = Page {
        head: HEAD,
        files: Vec::new(),
        feature: "experiments",
        command: if options.full { "scaling --full" } else { "scaling" },
        out: &options.out,
        quick: reach == Reach::Smoke,
        seed: options.seed,
        quiet: options.quiet,
    };
    page.make("scaling", |lab| Ok((scaling_to(lab, reach)?, ())))?;
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_exclude_each_other_and_a_folder_that_is_none_is_named_before_the_work() {
        let options = |words: &[&str]| Options::try_parse_from(std::iter::once(&"scaling").chain(words));
        assert!(options(&["--full", "--quick"]).is_err() && options(&["--full"]).unwrap().full);
        let place = std::env::temp_dir().join(format!("casca-scaling-{}", std::process::id()));
        std::fs::write(&place, "no folder").unwrap();
        let name = place.to_str().unwrap();
        let said = run(&options(&["--quiet", "--out", name]).unwrap()).unwrap_err().to_string();
        assert!(said.contains(name), "{said}");
        std::fs::remove_file(&place).unwrap();
    }
}
