//! A drive through a land larger than a grid, as charts (SVG), tables (CSV) and a page.

use casca_lab::experiments::world::world_to;
use casca_lab::experiments::{HEAD, LabError};
use casca_tools::command_line::{EXIT_CODES, Outcome};
use clap::Parser;

use crate::arguments::{PageArguments, about};

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Charts a drive through a land larger than a grid, and checks it against exact visibility",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("out", about("target/world", "Where the page goes, and its folder of charts, pictures and tables"))
)]
pub struct Options {
    #[command(flatten)]
    page: PageArguments,
}

/// Drives, prints the tables, writes charts, tables and page, and tells whether a set lacked
/// something.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let command = options.page.command("world");
    let drive = options.page.page(HEAD, &command).make("world", world_to)?;
    Ok(if drive.lost == [0, 0] { Outcome::Well } else { Outcome::Lost })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quick_drive_makes_a_page() {
        let place = std::env::temp_dir().join(format!("casca-world-{}", std::process::id()));
        let out = place.to_str().unwrap();
        let quick = Options::try_parse_from(["world", "--quick", "--quiet", "--out", out]).unwrap();
        assert_eq!(run(&quick).unwrap(), Outcome::Well);
        let page = std::fs::read_to_string(place.join("world.md")).unwrap();
        assert!(page.contains("A world larger than a grid") && place.join("report/world-times.svg").exists());
        std::fs::remove_dir_all(&place).unwrap();
    }
}
