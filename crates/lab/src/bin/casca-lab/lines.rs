//! Ambient occlusion of lines against rays, as a page with tables and charts.

use std::path::PathBuf;

use casca_lab::command_line::{EXIT_CODES, Outcome};
use casca_lab::experiments::LabError;
use casca_lab::experiments::lines::{self, HEAD};
use clap::Parser;

use crate::page::Page;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Compares the ambient occlusion of lines with rays: agreement, noise, times, stability",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
pub struct Options {
    /// Fewer pixels and rays: a smoke run
    #[arg(long)]
    quick: bool,
    /// Seed of lines, samples and rays
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The folder of the page
    #[arg(long, default_value = "target/lines")]
    out: PathBuf,
    /// No progress line
    #[arg(long)]
    quiet: bool,
}

/// Measures, prints the tables and writes the page.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let page = Page {
        head: HEAD,
        files: Vec::new(),
        feature: "experiments",
        command: if options.quick { "lines --quick" } else { "lines" },
        out: &options.out,
        quick: options.quick,
        seed: options.seed,
        quiet: options.quiet,
    };
    page.make("lines", |lab| Ok((lines::lines(lab)?, ())))?;
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smoke_run_writes_a_page_with_tables_and_charts() {
        let folder = std::env::temp_dir().join(format!("casca-lines-{}", std::process::id()));
        let options = Options { quick: true, seed: 1, out: folder.clone(), quiet: true };
        assert_eq!(run(&options).unwrap(), Outcome::Well);
        let page = std::fs::read_to_string(folder.join("lines.md")).unwrap();
        assert!(page.contains("optical depth") && page.contains("lines_error_by_time.svg"), "{page}");
        assert!(!page.contains("NaN"), "{page}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
