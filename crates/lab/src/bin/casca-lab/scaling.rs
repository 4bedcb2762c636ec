//! How times and memory grow with objects, triangles, pixels and threads, as charts (SVG), tables
//! (CSV) and a page.

use casca_lab::experiments::{HEAD, LabError, scaling_to};
use casca_tools::command_line::{EXIT_CODES, Outcome};
use clap::Parser;

use crate::arguments::{SizedPage, about};

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Charts times and memory by objects, triangles, pixels and threads",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("out", about("target/scaling", "Where the page goes, and its folder of charts, pictures and tables")),
    mut_arg("full", |a| a.help("Also a million objects, 100,000 visible ones and ten million triangles: takes minutes and some GB"))
)]
pub struct Options {
    #[command(flatten)]
    sized: SizedPage,
}

/// Measures, prints the tables and writes charts, tables and page.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let command = options.sized.command("scaling");
    let page = options.sized.page.page(HEAD, &command);
    page.make("scaling", |lab| Ok((scaling_to(lab, options.sized.effort())?, ())))?;
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_exclude_each_other_and_a_folder_that_is_none_is_named_before_the_work() {
        let options = |words: &[&str]| Options::try_parse_from(std::iter::once(&"scaling").chain(words));
        assert!(options(&["--full", "--quick"]).is_err() && options(&["--full"]).unwrap().sized.full);
        let place = std::env::temp_dir().join(format!("casca-scaling-{}", std::process::id()));
        std::fs::write(&place, "no folder").unwrap();
        let name = place.to_str().unwrap();
        let said = run(&options(&["--quiet", "--out", name]).unwrap()).unwrap_err().to_string();
        assert!(said.contains(name), "{said}");
        std::fs::remove_file(&place).unwrap();
    }
}
