//! Errors and times of the operators on point clouds, as charts (SVG), pictures (PNG), tables (CSV)
//! and a page.

use std::path::PathBuf;

use casca_lab::experiments::LabError;
use casca_lab::experiments::points::{HEAD, points};
use casca_tools::command_line::{EXIT_CODES, Outcome, say};
use clap::Parser;

use crate::arguments::{SizedPage, about};
use crate::page::Page;
use crate::report::files_in;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Errors and times of the operators on point clouds, beside clouds whose truth is known",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("out", about("target/points", "Where the page goes, and its folder of charts, pictures and tables")),
    mut_arg("full", |a| a.help("Hulls of ten million points and splats of a hundred million: takes some GB of memory"))
)]
pub struct Options {
    /// glTF files that are sampled, too [default: the files in ../shared/scenes]
    #[arg(long, value_delimiter = ',')]
    files: Option<Vec<PathBuf>>,
    #[command(flatten)]
    sized: SizedPage,
}

/// Measures, prints the tables, and writes charts, pictures, tables and page.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let files = options.files.clone().unwrap_or_else(|| {
        let mut files = files_in("../shared/scenes");
        // The same triangles as in sponza.glb.
        files.retain(|f| !f.ends_with("sponza-parts.glb"));
        files
    });
    if files.is_empty() {
        say("skipped: no files to sample");
    }
    let command = options.sized.command("points");
    let page = Page { files, ..options.sized.page.page(HEAD, &command) };
    page.make("points", |lab| Ok((points(lab, options.sized.effort())?, ())))?;
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quick_run_writes_a_page_and_a_file_that_is_not_there_is_named() {
        let options = |words: &[&str]| Options::try_parse_from(std::iter::once(&"points").chain(words));
        assert!(options(&["--full", "--quick"]).is_err());
        let place = std::env::temp_dir().join(format!("casca-points-page-{}", std::process::id()));
        let out = place.to_str().unwrap();
        let mut quick = options(&["--quick", "--quiet", "--out", out]).unwrap();
        quick.files = Some(Vec::new());
        assert_eq!(run(&quick).unwrap(), Outcome::Well);
        let page = std::fs::read_to_string(place.join("points.md")).unwrap();
        for file in ["points-radius.svg", "points-failure-noise.png", "points-clusters.csv"] {
            assert!(page.contains(file) && place.join("report").join(file).exists(), "{file}");
        }
        quick.files = Some(vec![place.join("none.glb")]);
        assert!(run(&quick).unwrap_err().to_string().contains("none.glb"));
        std::fs::remove_dir_all(&place).unwrap();
    }
}
