//! Runs all experiments and writes the report, with its charts and tables, to `docs/report.md`;
//! `--quick` makes a smoke run in `target/report`.

use std::path::PathBuf;
use std::time::Instant;

use casca_lab::arguments::{Common, spinner};
use casca_lab::experiments::{EXPERIMENTS, Lab, LabError, write};
use casca_scenes::import;
use casca_tools::command_line::{EXIT_CODES, Outcome, make_folder, say, try_writing_into};
use clap::Parser;
use clap::builder::PossibleValuesParser;

/// The options.
#[derive(Debug, Parser)]
#[command(about = "Runs the experiments and writes the report", after_help = EXIT_CODES, allow_negative_numbers = true)]
pub struct Options {
    /// A smoke run, whose figures mean nothing
    #[arg(long)]
    quick: bool,
    /// Experiments to run, by their names [default: all]
    #[arg(
        long,
        value_delimiter = ',',
        value_parser = PossibleValuesParser::new(EXPERIMENTS.iter().map(|e| e.0))
    )]
    only: Vec<String>,
    /// glTF files that join the procedural scenes [default: those in ../shared/scenes, where they
    /// are]
    #[arg(long, value_delimiter = ',')]
    files: Option<Vec<PathBuf>>,
    /// Where report.md and its folder go [default: docs, or target/report for a quick or partial
    /// run]
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// The glTF files of a folder, in order of their names.
fn files_in(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> =
        entries.map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "glb")).collect();
    files.sort();
    files
}

/// Runs the experiments and writes the report.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let whole = !options.quick && options.only.is_empty();
    let out = options.out.clone();
    let out = out.unwrap_or_else(|| PathBuf::from(if whole { "docs" } else { "target/report" }));
    let folder = out.join("report");
    let files = options.files.clone().unwrap_or_else(|| files_in("../shared/scenes"));
    // The experiments take minutes: what cannot be read or written is said before them.
    files.iter().try_for_each(|file: &PathBuf| import::load(file).map(|_| ()))?;
    try_writing_into(&out, &["report.md"])?;
    make_folder(&folder)?;
    let bar = spinner(options.common.quiet);
    let progress = |what: &str| bar.set_message(what.to_owned());
    let lab = Lab { quick: options.quick, seed: options.common.seed, files, folder, progress: &progress };
    // Time that passes: most experiments use several threads.
    let start = Instant::now();
    let mut sections = Vec::new();
    for (name, experiment) in EXPERIMENTS {
        if !options.only.is_empty() && !options.only.iter().any(|o| o == name) {
            continue;
        }
        bar.set_prefix(*name);
        let began = Instant::now();
        sections.push(experiment(&lab)?);
        bar.suspend(|| say(format_args!("{name}: {:.0} s", began.elapsed().as_secs_f64())));
    }
    let names = |f: &PathBuf| f.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let files: Vec<String> = lab.files.iter().map(names).collect();
    let settings = format!(
        "Seed {}; files: {}. It took {:.0} minutes.",
        options.common.seed,
        if files.is_empty() { "none".to_owned() } else { files.join(", ") },
        start.elapsed().as_secs_f64() / 60.0
    );
    let quick = if options.quick { " --quick" } else { "" };
    let command = format!("cargo run --release -p casca-lab --features experiments -- report{quick}");
    let path = out.join("report.md");
    write(&path, &lab, &sections, &command, &settings)?;
    bar.finish_and_clear();
    say(path.display());
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(words: &[&str]) -> Result<Options, String> {
        Options::try_parse_from(std::iter::once(&"report").chain(words)).map_err(|e| e.to_string())
    }

    #[test]
    fn unknown_experiments_are_refused_with_the_names_of_all() {
        for bad in ["everything", "worth,", "", "thesis,-1"] {
            let said = options(&["--only", bad]).expect_err(bad);
            assert!(said.contains("worth, against, stability"), "{bad}: {said}");
        }
        assert_eq!(options(&["--only", "thesis,upkeep"]).unwrap().only, ["thesis", "upkeep"]);
        assert!(options(&["--seed", "-1"]).is_err());
    }

    #[test]
    fn a_missing_file_or_a_folder_that_is_none_is_named_before_the_experiments() {
        let place = std::env::temp_dir().join(format!("casca-report-place-{}", std::process::id()));
        std::fs::write(&place, "no folder").unwrap();
        let failure = |words: &[&str]| run(&options(words).unwrap()).unwrap_err().to_string();
        let name = place.to_str().unwrap();
        assert!(failure(&["--quiet", "--out", name]).contains(name));
        assert!(failure(&["--quiet", "--files", "no/such.glb"]).contains("no/such.glb"));
        // The file is there, but no scene.
        assert!(failure(&["--quiet", "--files", name]).contains(name));
        std::fs::remove_file(&place).unwrap();
    }
}
