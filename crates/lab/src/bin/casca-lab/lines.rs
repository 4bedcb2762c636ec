//! Ambient occlusion of lines by columns against rays, as a page with tables and charts.

use casca_lab::experiments::LabError;
use casca_lab::experiments::lines::{self, HEAD};
use casca_tools::command_line::{EXIT_CODES, Outcome};
use clap::Parser;

use crate::arguments::{PageArguments, about};

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Compares the ambient occlusion of lines by columns with rays: agreement, noise, times, stability",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("out", about("target/lines", "Where the page goes, and its folder of charts, pictures and tables"))
)]
pub struct Options {
    #[command(flatten)]
    page: PageArguments,
}

/// Measures, prints the tables and writes the page.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let command = options.page.command("lines");
    let page = options.page.page(HEAD, &command);
    page.make("lines", |lab| Ok((lines::lines(lab)?, ())))?;
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smoke_run_writes_a_page_with_tables_and_charts() {
        let folder = std::env::temp_dir().join(format!("casca-lines-{}", std::process::id()));
        let words = ["lines", "--quick", "--quiet", "--out", folder.to_str().unwrap()];
        let options = Options::try_parse_from(words).unwrap();
        assert_eq!(run(&options).unwrap(), Outcome::Well);
        let page = std::fs::read_to_string(folder.join("lines.md")).unwrap();
        assert!(page.contains("optical depth") && page.contains("lines_error_by_time.svg"), "{page}");
        assert!(!page.contains("NaN"), "{page}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
